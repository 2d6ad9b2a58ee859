#include "solver/snap/calibrate.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>
#include <math.h>
#include <string.h>

#include "solver/snap/study.h"

static const double tolerance = 1e-5;

struct attempt {
  struct snap_spec *spec;
  const struct calibrate_options *options;
  struct calibrate_result *result;
  enum status status;
  struct error *error;
};

static double unit_of_metric(const struct snap_calibrate *c) {
  return strstr(c->metric, "_kPa") ? 1e3 : 1e-3;
}

static enum status metric_of(struct attempt *a, double number, double *metric) {
  struct snap_study study;
  enum status status = snap_set(a->spec, number, a->error);
  if (status != STATUS_OK) {
    return status;
  }
  status = snap_study_open(a->spec, &study, a->error);
  study.deadline_s = a->options->deadline_s;
  study.cancelled = a->options->cancelled;
  if (status == STATUS_OK) {
    status = snap_study_metric(&study, a->spec->calibrate.metric, metric, a->error);
  }
  snap_study_close(&study);
  return status;
}

/* Metric less target; NAN after a failure. */
static double miss(double number, void *context) {
  struct attempt *a = context;
  struct calibrate_result *r = a->result;
  const struct snap_calibrate *c = &a->spec->calibrate;
  double metric = NAN;
  for (int i = 0; i < r->count; i++) {
    if (r->number[i] == number) {
      return r->metric[i] - c->target;
    }
  }
  if (a->status == STATUS_OK && r->count < CALIBRATE_EVALUATIONS_MAX) {
    a->status = metric_of(a, number, &metric);
    r->number[r->count] = number;
    r->metric[r->count++] = metric;
    if (a->options->progress) {
      fprintf(a->options->progress,
              "{\"event\":\"progress\",\"fraction\":0,\"stage\":\"calibration\",\"number_%s\":%.9g,"
              "\"metric\":%.9g}\n",
              c->unit, number / c->unit_si, metric / unit_of_metric(c));
      fflush(a->options->progress);
    }
  }
  return a->status == STATUS_OK ? metric - c->target : NAN;
}

static enum status find_root(struct attempt *a, gsl_root_fsolver *solver) {
  const struct snap_calibrate *c = &a->spec->calibrate;
  double range = c->to - c->from, unit = unit_of_metric(c);
  double low = miss(c->from, a), high = miss(c->to, a);
  if (a->status != STATUS_OK) {
    return a->status;
  }
  if (low * high > 0.0) {
    return error_set(a->error, STATUS_DIVERGED, "/calibrate",
                     "%s is %.6g at %.6g %s and %.6g at %.6g %s: the target of %.6g is not between "
                     "them; widen the range",
                     c->metric, (low + c->target) / unit, c->from / c->unit_si, c->unit,
                     (high + c->target) / unit, c->to / c->unit_si, c->unit, c->target / unit);
  }
  gsl_function function = {.function = miss, .params = a};
  gsl_root_fsolver_set(solver, &function, c->from, c->to);
  for (int i = 0; i < CALIBRATE_EVALUATIONS_MAX; i++) {
    int code = gsl_root_fsolver_iterate(solver);
    if (a->status != STATUS_OK || code != GSL_SUCCESS) {
      break;
    }
    double width = gsl_root_fsolver_x_upper(solver) - gsl_root_fsolver_x_lower(solver);
    double root = gsl_root_fsolver_root(solver);
    double left = miss(root, a);
    if (width <= tolerance * range || fabs(left) <= tolerance * fabs(c->target)) {
      return snap_set(a->spec, root, a->error);
    }
  }
  return a->status != STATUS_OK
             ? a->status
             : error_set(a->error, STATUS_DIVERGED, "/calibrate", "the calibration did not settle");
}

enum status calibrate(struct snap_spec *spec, const struct calibrate_options *options,
                      struct calibrate_result *result, struct error *error) {
  struct attempt attempt = {spec, options, result, STATUS_OK, error};
  result->count = 0;
  gsl_root_fsolver *solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
  if (!solver) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the calibration");
  }
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  enum status status = find_root(&attempt, solver);
  gsl_set_error_handler(handler);
  gsl_root_fsolver_free(solver);
  return status;
}
