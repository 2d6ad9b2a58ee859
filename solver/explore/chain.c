#include "solver/explore/chain.h"

#include <math.h>
#include <stdlib.h>

/* Part by which a walk has to get shorter to be another one: less is rounding. */
static const double least_gain = 1e-9;

enum { LEAST_CHAINS = 4, LEAST_CHAINS_LIGHT = 8 };

size_t chain_length(size_t members, bool light) {
  size_t share = members / (light ? LEAST_CHAINS_LIGHT : LEAST_CHAINS);
  size_t most = light ? CHAIN_LENGTH_MAX : CHAIN_LENGTH_HEAVY;
  return share < 1 ? 1 : share < most ? share : most;
}

static double scaled(double value, const struct chain_dimension *dimension) {
  return dimension->logarithmic && !dimension->categorical ? log(value) : value;
}

/* point[members x dimensions]: the values between 0 and 1, categorical ones as they are. */
static void normalise(const double *value, const struct chain_dimension *dimension, size_t members,
                      size_t dimensions, double *point) {
  for (size_t d = 0; d < dimensions; d++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t m = 0; m < members; m++) {
      double at = scaled(value[m * dimensions + d], &dimension[d]);
      point[m * dimensions + d] = at;
      low = fmin(low, at);
      high = fmax(high, at);
    }
    for (size_t m = 0; m < members && !dimension[d].categorical; m++) {
      double *at = &point[m * dimensions + d];
      *at = high > low ? (*at - low) / (high - low) : isnan(*at) ? NAN : 0;
    }
  }
}

/* Square of the distance: of a dimension that only one of the two has 1, of different words as much
 * as all dimensions can have. */
static double apart(const double *a, const double *b, const struct chain_dimension *dimension,
                    size_t dimensions) {
  double sum = 0;
  for (size_t d = 0; d < dimensions; d++) {
    double difference = a[d] - b[d];
    if (isnan(difference)) {
      sum += !isnan(a[d]) || !isnan(b[d]);
    } else {
      sum += !dimension[d].categorical ? difference * difference
             : difference != 0         ? (double)dimensions
                                       : 0;
    }
  }
  return sum;
}

/* walk[members]: all designs, put into the order in which they are visited. */
static void greedy(const double *point, const struct chain_dimension *dimension, size_t members,
                   size_t dimensions, size_t *walk) {
  for (size_t k = 1; k < members; k++) {
    const double *here = &point[walk[k - 1] * dimensions];
    size_t best = k;
    double least = INFINITY;
    for (size_t m = k; m < members; m++) {
      double distance = apart(here, &point[walk[m] * dimensions], dimension, dimensions);
      if (distance < least || (distance == least && walk[m] < walk[best])) {
        least = distance;
        best = m;
      }
    }
    size_t next = walk[best];
    walk[best] = walk[k];
    walk[k] = next;
  }
}

/* The distances between designs, and the order in which they are visited. */
struct tour {
  const double *point;
  const struct chain_dimension *dimension;
  size_t members, dimensions;
  size_t *walk;
};

/* Between the designs at two places of the walk. */
static double leg(const struct tour *tour, size_t i, size_t j) {
  return sqrt(apart(&tour->point[tour->walk[i] * tour->dimensions],
                    &tour->point[tour->walk[j] * tour->dimensions], tour->dimension,
                    tour->dimensions));
}

static void reverse(size_t *walk, size_t from, size_t to) {
  for (; from < to; from++, to--) {
    size_t kept = walk[from];
    walk[from] = walk[to];
    walk[to] = kept;
  }
}

/* Turns stretches of the walk round while that shortens it: the greedy walk saves the longest legs
 * for its end. */
static void shorten(const struct tour *tour) {
  enum { PASSES = 30 };
  size_t last = tour->members - 1;
  bool shorter = tour->members > 2;
  for (int pass = 0; pass < PASSES && shorter; pass++) {
    shorter = false;
    for (size_t i = 0; i < last; i++) {
      for (size_t j = i + 2; j <= last; j++) {
        double now = leg(tour, i, i + 1) + (j < last ? leg(tour, j, j + 1) : 0);
        double then = leg(tour, i, j) + (j < last ? leg(tour, i + 1, j + 1) : 0);
        if (then < now * (1 - least_gain)) {
          reverse(tour->walk, i + 1, j);
          shorter = true;
        }
      }
    }
  }
}

/* Whether a word changes between the designs at two places of the walk. */
static bool words_differ(const struct tour *tour, size_t i, size_t j) {
  const double *a = &tour->point[tour->walk[i] * tour->dimensions];
  const double *b = &tour->point[tour->walk[j] * tour->dimensions];
  for (size_t d = 0; d < tour->dimensions; d++) {
    if (tour->dimension[d].categorical && a[d] != b[d] && !(isnan(a[d]) && isnan(b[d]))) {
      return true;
    }
  }
  return false;
}

/* Where the chain that begins at `from` ends: with the last member if that is near enough; where a
 * word changes, unless the chain is short then; or after the longest leg of its second half, of
 * equals the last. */
static size_t cut(const struct tour *tour, size_t from, size_t length) {
  size_t to = from + length, best = to;
  double longest = -1;
  if (to >= tour->members) {
    return tour->members;
  }
  for (size_t end = from + (length + 3) / 4; end <= to; end++) {
    if (words_differ(tour, end - 1, end)) {
      return end;
    }
  }
  for (size_t end = from + (length + 1) / 2; end <= to; end++) {
    double jump = leg(tour, end - 1, end);
    if (jump >= longest) {
      longest = jump;
      best = end;
    }
  }
  return best;
}

/* A stretch of the walk. */
struct stretch {
  size_t from, to;
};

static int longer_first(const void *a, const void *b) {
  const struct stretch *x = a, *y = b;
  size_t p = x->to - x->from, q = y->to - y->from;
  return p != q ? (p < q) - (p > q) : (x->from > y->from) - (x->from < y->from);
}

/* Cuts the walk into chains, and numbers them so that the longest is begun first: workers that
 * share them end at about the same time then (Graham 1969). */
static enum status number_chains(const struct tour *tour, size_t length, struct chain_place *place,
                                 struct error *error) {
  struct stretch *chain = malloc(sizeof *chain * (tour->members + 1));
  size_t count = 0;
  if (!chain) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory to order %zu designs",
                     tour->members);
  }
  for (size_t from = 0; from < tour->members; from = chain[count++].to) {
    chain[count] = (struct stretch){from, cut(tour, from, length)};
  }
  qsort(chain, count, sizeof *chain, longer_first);
  for (size_t c = 0; c < count; c++) {
    for (size_t k = chain[c].from; k < chain[c].to; k++) {
      place[tour->walk[k]] = (struct chain_place){c, k - chain[c].from};
    }
  }
  free(chain);
  return STATUS_OK;
}

enum status chain_order(const double *value, const struct chain_dimension *dimension,
                        size_t members, size_t dimensions, size_t length, struct chain_place *place,
                        struct error *error) {
  double *point = malloc(sizeof *point * (members * dimensions + 1));
  size_t *walk = malloc(sizeof *walk * (members + 1));
  struct tour tour = {point, dimension, members, dimensions, walk};
  enum status status = STATUS_OK;
  if (!point || !walk) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory to order %zu designs", members);
    goto done;
  }
  normalise(value, dimension, members, dimensions, point);
  for (size_t m = 0; m < members; m++) {
    walk[m] = m;
  }
  if (dimensions > 0) {
    greedy(point, dimension, members, dimensions, walk);
    shorten(&tour);
  }
  status = number_chains(&tour, length, place, error);
done:
  free(point);
  free(walk);
  return status;
}
