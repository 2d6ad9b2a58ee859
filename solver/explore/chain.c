#include "solver/explore/chain.h"

#include <math.h>
#include <stdlib.h>

size_t chain_length(size_t members, bool light) {
  enum { LEAST_CHAINS = 8 };
  size_t share = members / LEAST_CHAINS;
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

/* Square of the distance: of a dimension that only one of the two has, or of different words, 1. */
static double apart(const double *a, const double *b, const struct chain_dimension *dimension,
                    size_t dimensions) {
  double sum = 0;
  for (size_t d = 0; d < dimensions; d++) {
    double difference = a[d] - b[d];
    if (isnan(difference)) {
      sum += !isnan(a[d]) || !isnan(b[d]);
    } else {
      sum += dimension[d].categorical ? difference != 0 : difference * difference;
    }
  }
  return sum;
}

/* walk[members]: the designs in the order in which they are visited. */
static void greedy(const double *point, const struct chain_dimension *dimension, size_t members,
                   size_t dimensions, size_t *walk) {
  for (size_t m = 0; m < members; m++) {
    walk[m] = m;
  }
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

enum status chain_order(const double *value, const struct chain_dimension *dimension,
                        size_t members, size_t dimensions, size_t length, struct chain_place *place,
                        struct error *error) {
  double *point = malloc(sizeof *point * (members * dimensions + 1));
  size_t *walk = malloc(sizeof *walk * (members + 1));
  enum status status = STATUS_OK;
  if (!point || !walk) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory to order %zu designs", members);
    goto done;
  }
  normalise(value, dimension, members, dimensions, point);
  greedy(point, dimension, members, dimensions, walk);
  size_t chains = (members + length - 1) / length;
  for (size_t c = 0, from = 0; c < chains; c++) {
    size_t to = members * (c + 1) / chains;
    for (size_t k = from; k < to; k++) {
      place[walk[k]] = (struct chain_place){c, k - from};
    }
    from = to;
  }
done:
  free(point);
  free(walk);
  return status;
}
