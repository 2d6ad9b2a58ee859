#include "solver/identify/doubt.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/identify/estimate.h"

static const double swinging = 0.2, calm = 0.7; /* damping ratios */

/* ---- the values as they are --------------------------------------------------------------- */

/* What a least-squares fit changes. */
struct values {
  struct point_estimate *estimate;
  struct shared_estimate rest[HLPV_MODES_MAX], mass, gamma;
};

static enum status keep(const struct identification *id, struct values *values,
                        struct error *error) {
  values->estimate = malloc(id->point_count * sizeof *values->estimate);
  if (!values->estimate) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the estimates");
  }
  memcpy(values->estimate, id->estimate, id->point_count * sizeof *id->estimate);
  memcpy(values->rest, id->rest, sizeof values->rest);
  values->mass = id->mass;
  values->gamma = id->gamma;
  return STATUS_OK;
}

static void restore(struct identification *id, const struct values *values) {
  memcpy(id->estimate, values->estimate, id->point_count * sizeof *id->estimate);
  memcpy(id->rest, values->rest, sizeof values->rest);
  id->mass = values->mass;
  id->gamma = values->gamma;
}

/* Sum of squares of the residuals of a group as they stand. */
static double cost(const struct identification *id, const struct group *group) {
  double sum = 0.0;
  for (size_t i = group->first; i < group->first + group->count; i++) {
    for (size_t r = 0; r < id->point[i].rows; r++) {
      sum += id->point[i].residual[r] * id->point[i].residual[r];
    }
  }
  return sum;
}

/* Least change of the sum of squares of a group that is more than noise. */
static double least_change(const struct identification *id, const struct group *group, double sum) {
  double freedom = 0.0;
  for (size_t i = group->first; i < group->first + group->count; i++) {
    freedom += (double)id->point[i].rows - (double)id->point[i].starts - IDENTIFY_COEFFICIENTS;
  }
  return IDENTIFY_SURE * sum / fmax(freedom, 1.0);
}

/* ---- swings ------------------------------------------------------------------------------- */

/* Tests one point of a group, whose sum of squares is *sum and may change. */
static enum status doubt_point(struct identification *id, struct group *group, size_t index,
                               double *sum, struct error *error) {
  struct point_estimate *estimate = &id->estimate[index];
  double critical = 2.0 * sqrt(estimate->value[IDENTIFY_STIFFNESS] * id->mass.value);
  double ratio = estimate->value[IDENTIFY_DAMPING] / critical;
  struct values values;
  if (ratio >= swinging) {
    return STATUS_OK;
  }
  enum status status = keep(id, &values, error);
  if (status != STATUS_OK) {
    return status;
  }
  estimate->value[IDENTIFY_DAMPING] = calm * critical;
  estimate->damping = DAMPING_UNSEEN;
  status = estimate_fit(id, group, error);
  double now = cost(id, group);
  bool sure = status == STATUS_DIVERGED || now - *sum > least_change(id, group, *sum);
  if (sure) {
    restore(id, &values);
    if (ratio < 1e-5) {
      estimate->value[IDENTIFY_DAMPING] = 0.0;
      estimate->damping = DAMPING_BOUND;
    }
    status = estimate_fit(id, group, error);
    now = cost(id, group);
  }
  *sum = now;
  free(values.estimate);
  return status;
}

enum status doubt_swings(struct identification *id, struct error *error) {
  enum status status = STATUS_OK;
  for (size_t g = 0; g < id->group_count; g++) {
    struct group *group = &id->group[g];
    double sum = cost(id, group);
    for (size_t i = group->first; i < group->first + group->count && status == STATUS_OK; i++) {
      status = doubt_point(id, group, i, &sum, error);
    }
  }
  return status;
}

/* ---- inertia ------------------------------------------------------------------------------ */

/* Divides the mass by a factor, or multiplies everything else; nothing swings any more. */
static void lighten(struct identification *id, double factor) {
  id->mass.value /= id->mass.free ? factor : 1.0;
  id->gamma.value *= id->gamma.free ? factor : 1.0;
  for (size_t i = 0; i < id->point_count; i++) {
    double *value = id->estimate[i].value;
    value[IDENTIFY_STIFFNESS] *= id->gamma.free ? factor : 1.0;
    value[IDENTIFY_DAMPING] *= id->gamma.free ? factor : 1.0;
    double critical = 2.0 * sqrt(value[IDENTIFY_STIFFNESS] * id->mass.value);
    value[IDENTIFY_DAMPING] = fmax(value[IDENTIFY_DAMPING], calm * critical);
  }
}

enum status doubt_inertia(struct identification *id, struct error *error) {
  struct group all = {.first = 0, .count = id->point_count};
  struct values values;
  double with = cost(id, &all);
  enum status status = keep(id, &values, error);
  if (status != STATUS_OK) {
    return status;
  }
  lighten(id, 100.0);
  id->mass.free = id->gamma.free = false;
  status = estimate_fit(id, &all, error);
  id->inertia = status == STATUS_DIVERGED || cost(id, &all) - with > least_change(id, &all, with);
  restore(id, &values);
  free(values.estimate);
  return status == STATUS_DIVERGED ? STATUS_OK : status;
}
