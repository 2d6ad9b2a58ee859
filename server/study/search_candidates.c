#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/study/search.h"
#include "solver/explore/random.h"
#include "solver/explore/sequence.h"

enum { POINTS = 1 << 11, ELITE = 12, ROUNDS = 7, AROUND = 24 };

static const double apart = 0.05; /* of the range of a parameter */

/* ---- one candidate ------------------------------------------------------------------------ */

static double below(double x) {
  return 0.5 * erfc(-x / M_SQRT2);
}

/* The place of a metric among those of the search. */
static size_t place_of(const struct search *search, size_t metric) {
  size_t i = 0;
  while (search->metric[i] != metric) {
    i++;
  }
  return i;
}

static double chance_of(const struct search *search, const struct candidate *candidate) {
  double chance = 1.0;
  for (size_t i = 0; i < search->query->conditions; i++) {
    const struct condition *condition = &search->query->condition[i];
    if (condition->of.parameter) {
      double value = candidate->design[condition->of.column];
      bool met = condition->at_least ? value >= condition->limit : value <= condition->limit;
      chance = met ? chance : 0.0;
      continue;
    }
    size_t at = place_of(search, condition->of.column);
    double room = candidate->mean[at] - condition->limit;
    double sure = fmax(candidate->deviation[at], 1e-9 * search->spread[at]);
    chance *= sure > 0.0 ? below((condition->at_least ? room : -room) / sure)
                         : (condition->at_least ? room >= 0.0 : room <= 0.0);
  }
  return chance;
}

static bool sums_hold(const struct search *search, const double *design) {
  for (size_t i = 0; i < search->sums; i++) {
    double sum = 0.0, size = 0.0;
    for (size_t k = 0; k < search->space->parameters; k++) {
      sum += search->sum[i].factor[k] * design[k];
      size += fabs(search->sum[i].factor[k] * design[k]);
    }
    if (sum < search->sum[i].low - 1e-12 * size || sum > search->sum[i].high + 1e-12 * size) {
      return false;
    }
  }
  return true;
}

/* Predicts the design; false when it breaks a constraint of the study. */
static bool evaluate(const struct search *search, struct candidate *candidate) {
  const struct search_query *query = search->query;
  space_round(search->space, candidate->design);
  if (!sums_hold(search, candidate->design)) {
    return false;
  }
  for (size_t i = 0; i < search->metrics; i++) {
    model_predict(search->model[i], candidate->design, &candidate->mean[i],
                  &candidate->deviation[i]);
  }
  double goal = query->goal.parameter ? candidate->design[query->goal.column]
                                      : candidate->mean[place_of(search, query->goal.column)];
  candidate->goal = query->most ? -goal : goal;
  candidate->chance = chance_of(search, candidate);
  return isfinite(candidate->goal) && isfinite(candidate->chance);
}

bool candidate_better(const struct search *search, const struct candidate *a,
                      const struct candidate *b) {
  bool good = a->chance >= search->query->chance, other = b->chance >= search->query->chance;
  if (good != other) {
    return good;
  }
  return good ? a->goal < b->goal : a->chance > b->chance;
}

/* ---- the best ones ------------------------------------------------------------------------ */

static bool differs(const struct space *space, const double *a, const double *b) {
  double u[SURROGATE_PARAMETERS_MAX], v[SURROGATE_PARAMETERS_MAX];
  space_place(space, a, u);
  space_place(space, b, v);
  for (size_t k = 0; k < space->parameters; k++) {
    if (fabs(u[k] - v[k]) > apart) {
      return true;
    }
  }
  return false;
}

/* Puts a candidate into its place of the list, in which no two are alike; returns the new count. */
static size_t insert(const struct search *search, struct candidate *list, size_t count, size_t room,
                     const struct candidate *candidate) {
  size_t at = 0, kept = 0;
  while (at < count && !candidate_better(search, candidate, &list[at])) {
    if (!differs(search->space, list[at].design, candidate->design)) {
      return count;
    }
    at++;
  }
  /* Worse ones that are like it go. */
  for (size_t i = at; i < count; i++) {
    if (differs(search->space, list[i].design, candidate->design)) {
      list[at + kept++] = list[i];
    }
  }
  count = at + kept;
  if (at == room) {
    return count;
  }
  count -= count == room;
  memmove(list + at + 1, list + at, (count - at) * sizeof *list);
  list[at] = *candidate;
  return count + 1;
}

static size_t try_design(const struct search *search, struct candidate *list, size_t count,
                         size_t room, const double *u) {
  struct candidate candidate;
  space_design(search->space, u, candidate.design);
  return evaluate(search, &candidate) ? insert(search, list, count, room, &candidate) : count;
}

/* A place near u: a step of about `size` of each range. */
static void step(const struct search *search, const double *u, double size, uint64_t *random,
                 double *v) {
  for (size_t k = 0; k < search->space->parameters; k++) {
    double r = random_uniform(random) + random_uniform(random) + random_uniform(random) - 1.5;
    bool word = search->space->axis[k].words > 0;
    /* Words change now and then. */
    v[k] = !word                               ? u[k] + 2.0 * size * r
           : random_uniform(random) < size / 2 ? random_uniform(random)
                                               : u[k];
    v[k] = fmin(fmax(v[k], 0.0), word ? 0x1.fffffp-1 : 1.0);
    if (search->space->axis[k].whole) {
      v[k] = fmin(v[k], 0x1.fffffp-1);
    }
  }
}

enum status search_candidates(const struct search *search, struct candidate *best, size_t room,
                              size_t *count, struct error *error) {
  size_t parameters = search->space->parameters;
  double u[SURROGATE_PARAMETERS_MAX], v[SURROGATE_PARAMETERS_MAX];
  struct sequence *sequence;
  uint64_t random = 3;
  *count = 0;
  enum status status = sequence_create(SEQUENCE_SOBOL, (int)parameters, true, 3, &sequence, error);
  struct candidate *start = malloc(ELITE * sizeof *start);
  if (status == STATUS_OK && !start) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a search.");
  }
  for (size_t i = 0; i < POINTS && status == STATUS_OK; i++) {
    sequence_next(sequence, u);
    *count = try_design(search, best, *count, room, u);
  }
  double size = 0.2;
  for (int round = 0; round < ROUNDS && status == STATUS_OK; round++, size *= 0.6) {
    size_t from = *count < ELITE ? *count : ELITE;
    memcpy(start, best, from * sizeof *start);
    for (size_t i = 0; i < from * AROUND; i++) {
      space_place(search->space, start[i / AROUND].design, u);
      step(search, u, size, &random, v);
      *count = try_design(search, best, *count, room, v);
    }
  }
  free(start);
  sequence_destroy(sequence);
  return status;
}
