/* The evaluations of a search: kept, compared, and stood in for where one fails. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/explore/optimise_internal.h"

static size_t first_limit(const struct optimise_search *search) {
  return search->functions - search->problem->limits;
}

double optimise_objective(const struct optimise_search *search,
                          const struct optimise_record *record, double *gradient) {
  size_t n = search->n, residuals = search->problem->residuals;
  /* A failed point has no residuals: its objective stands in the first place. */
  if (residuals == 0 || !record->solved) {
    if (gradient) {
      memcpy(gradient, record->gradient, n * sizeof *gradient);
    }
    return record->value[0];
  }
  double sum = 0;
  if (gradient) {
    memset(gradient, 0, n * sizeof *gradient);
  }
  for (size_t i = 0; i < residuals; i++) {
    sum += 0.5 * record->value[i] * record->value[i];
    for (size_t k = 0; gradient && k < n; k++) {
      gradient[k] += record->value[i] * record->gradient[i * n + k];
    }
  }
  return sum;
}

double optimise_violation(const struct optimise_search *search,
                          const struct optimise_record *record) {
  const struct optimise_problem *problem = search->problem;
  double most = 0;
  for (size_t i = first_limit(search); i < search->functions; i++) {
    most = fmax(most, record->value[i]);
  }
  for (size_t i = 0; i < problem->sides; i++) {
    most = fmax(most, problem->side(problem->context, i, record->x, NULL));
  }
  return most;
}

/* Whether record a is the better one: within the limits before outside of them. */
static bool better(const struct optimise_search *search, size_t a, size_t b) {
  double tolerance = search->problem->tolerance;
  double out_a = optimise_violation(search, &search->record[a]);
  double out_b = optimise_violation(search, &search->record[b]);
  if (out_a <= tolerance && out_b <= tolerance) {
    return optimise_objective(search, &search->record[a], NULL) <
           optimise_objective(search, &search->record[b], NULL);
  }
  return out_a < out_b;
}

/* What a method is told about a point where there is nothing: worse than all that is known, rising
 * with the distance from the best point; the limits are those of the best point, linearised. */
static void stand_in(const struct optimise_search *search, struct optimise_record *record) {
  const struct optimise_record *good = &search->record[search->best];
  size_t n = search->n;
  double rise = fmax(fabs(search->worst), 1.0), squares = 0;
  memset(record->value, 0, search->functions * sizeof *record->value);
  memset(record->gradient, 0, search->functions * n * sizeof *record->gradient);
  for (size_t i = first_limit(search); i < search->functions; i++) {
    record->value[i] = good->value[i];
    memcpy(record->gradient + i * n, good->gradient + i * n, n * sizeof *record->gradient);
    for (size_t k = 0; k < n; k++) {
      record->value[i] += good->gradient[i * n + k] * (record->x[k] - good->x[k]);
    }
  }
  for (size_t k = 0; k < n; k++) {
    double d = record->x[k] - good->x[k];
    squares += d * d;
    record->gradient[k] = 2 * rise * d;
  }
  record->value[0] = search->worst + rise * (1 + squares);
}

/* Takes account of a solved record. */
static void take(struct optimise_search *search, size_t index) {
  const struct optimise_record *record = &search->record[index];
  double objective = optimise_objective(search, record, NULL);
  bool first = search->best == OPTIMISE_NONE;
  search->worst = first ? objective : fmax(search->worst, objective);
  if (first || better(search, index, search->best)) {
    search->best = index;
  }
  search->reached =
      search->reached ||
      (search->problem->residuals > 0 && sqrt(2 * objective) <= search->problem->target &&
       optimise_violation(search, record) <= search->problem->tolerance);
}

static struct optimise_record *find(const struct optimise_search *search, const double *x) {
  for (size_t i = search->count; i > 0; i--) {
    struct optimise_record *record = &search->record[i - 1];
    if (memcmp(record->x, x, search->n * sizeof *x) == 0) {
      return record;
    }
  }
  return NULL;
}

static bool room_for(struct optimise_search *search, const double *x,
                     struct optimise_record *record) {
  size_t n = search->n, functions = search->functions;
  double *memory = calloc(n + functions * (1 + n), sizeof *memory);
  if (!memory) {
    search->end = OPTIMISE_END_MEMORY;
    return false;
  }
  *record = (struct optimise_record){memory, memory + n, memory + n + functions, false};
  memcpy(record->x, x, n * sizeof *x);
  return true;
}

struct optimise_record *optimise_look(struct optimise_search *search, const double *x) {
  const struct optimise_problem *problem = search->problem;
  double inside[OPTIMISE_PARAMETERS_MAX];
  for (size_t k = 0; k < search->n; k++) {
    inside[k] = fmin(fmax(x[k], 0.0), 1.0) + 0.0; /* no -0, which would differ from 0 below */
  }
  struct optimise_record *record = find(search, inside);
  if (record || search->end != OPTIMISE_END_NONE) {
    return record;
  }
  if (search->count == problem->budget) {
    search->end = OPTIMISE_END_SPENT;
    return NULL;
  }
  record = &search->record[search->count];
  if (!room_for(search, inside, record)) {
    return NULL;
  }
  enum optimise_reply reply =
      problem->evaluate(problem->context, record->x, record->value, record->gradient);
  if (reply == OPTIMISE_HALT) {
    search->end = OPTIMISE_END_HALTED;
    free(record->x);
    return NULL;
  }
  record->solved = reply == OPTIMISE_SOLVED;
  search->count++;
  if (record->solved) {
    take(search, search->count - 1);
  } else if (search->best != OPTIMISE_NONE) {
    stand_in(search, record);
  } else {
    search->end = OPTIMISE_END_LOST;
    return NULL;
  }
  return record;
}
