/* Gauss-Newton within a box about the best point. */
#include <math.h>
#include <nlopt.h>
#include <string.h>

#include "solver/explore/optimise_internal.h"

/* Half the side of the first box, and of the largest one, as a share of the ranges. */
static const double first_radius = 0.25;
static const double largest_radius = 1.0;

/* The prediction is good or bad when it is met to these parts; a step that meets it to less than
 * `accepted` is not taken (Nocedal and Wright 2006, algorithm 4.1). */
static const double good = 0.75, bad = 0.25, accepted = 1e-4;

/* Accuracy of a step; a model costs microseconds, so it is found to all digits that matter. */
static const double step_tolerance = 1e-10;
enum { STEP_EVALUATIONS = 2000 };

/* The linearised residuals about a record, in steps z from it: -1 .. 1 is the box. */
struct model {
  const struct optimise_search *search;
  const struct optimise_record *at;
  double radius;
  double scale; /* of its values, so that the largest derivative at z = 0 is 1 */
};

static void place(const struct model *model, const double *z, double *x) {
  for (size_t k = 0; k < model->search->n; k++) {
    x[k] = model->at->x[k] + model->radius * z[k];
  }
}

/* Half the sum of squares of r + J radius z, scaled, and its gradient. */
static double model_value(unsigned n, const double *z, double *gradient, void *data) {
  const struct model *model = data;
  const struct optimise_record *at = model->at;
  double sum = 0;
  if (gradient) {
    memset(gradient, 0, n * sizeof *gradient);
  }
  for (size_t i = 0; i < model->search->problem->residuals; i++) {
    const double *row = at->gradient + i * n;
    double residual = at->value[i];
    for (unsigned k = 0; k < n; k++) {
      residual += row[k] * model->radius * z[k];
    }
    sum += 0.5 * model->scale * residual * residual;
    for (unsigned k = 0; gradient && k < n; k++) {
      gradient[k] += model->scale * residual * row[k] * model->radius;
    }
  }
  return sum;
}

static void model_sides(unsigned count, double *value, unsigned n, const double *z,
                        double *gradient, void *data) {
  const struct model *model = data;
  const struct optimise_problem *problem = model->search->problem;
  double x[OPTIMISE_PARAMETERS_MAX];
  place(model, z, x);
  for (unsigned i = 0; i < count; i++) {
    value[i] = problem->side(problem->context, i, x, gradient ? gradient + i * n : NULL);
    for (unsigned k = 0; gradient && k < n; k++) {
      gradient[i * n + k] *= model->radius;
    }
  }
}

static void set_scale(struct model *model) {
  double gradient[OPTIMISE_PARAMETERS_MAX], most = 0;
  optimise_objective(model->search, model->at, gradient);
  for (size_t k = 0; k < model->search->n; k++) {
    most = fmax(most, model->radius * fabs(gradient[k]));
  }
  model->scale = most > 0 && isfinite(1 / most) ? 1 / most : 1;
}

/* The best point of the model within its box, into x[n], and its value into *predicted. */
static enum status step(struct model *model, double *x, double *predicted, struct error *error) {
  const struct optimise_problem *problem = model->search->problem;
  unsigned n = (unsigned)model->search->n;
  double low[OPTIMISE_PARAMETERS_MAX], high[OPTIMISE_PARAMETERS_MAX];
  double z[OPTIMISE_PARAMETERS_MAX] = {0};
  nlopt_opt opt = nlopt_create(NLOPT_LD_SLSQP, n);
  for (unsigned k = 0; k < n; k++) {
    low[k] = fmax(-1.0, -model->at->x[k] / model->radius);
    high[k] = fmin(1.0, (1.0 - model->at->x[k]) / model->radius);
  }
  set_scale(model);
  bool set = opt && nlopt_set_min_objective(opt, model_value, model) > 0 &&
             nlopt_set_lower_bounds(opt, low) > 0 && nlopt_set_upper_bounds(opt, high) > 0 &&
             nlopt_set_xtol_abs1(opt, step_tolerance) > 0 &&
             nlopt_set_maxeval(opt, STEP_EVALUATIONS) > 0;
  if (set && problem->sides > 0) {
    set = nlopt_add_inequality_mconstraint(opt, (unsigned)problem->sides, model_sides, model,
                                           NULL) > 0;
  }
  nlopt_result result = set ? nlopt_optimize(opt, z, predicted) : NLOPT_OUT_OF_MEMORY;
  nlopt_destroy(opt);
  place(model, z, x);
  *predicted /= model->scale;
  return result != NLOPT_OUT_OF_MEMORY
             ? STATUS_OK
             : error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the optimisation");
}

static double distance(size_t n, const double *a, const double *b) {
  double most = 0;
  for (size_t k = 0; k < n; k++) {
    most = fmax(most, fabs(a[k] - b[k]));
  }
  return most;
}

enum status optimise_gauss_newton(struct optimise_search *search,
                                  const struct optimise_record *first, struct error *error) {
  const struct optimise_problem *problem = search->problem;
  struct model model = {.search = search, .at = first, .radius = first_radius};
  double x[OPTIMISE_PARAMETERS_MAX], predicted;
  while (!search->reached) {
    double now = optimise_objective(search, model.at, NULL);
    double out = optimise_violation(search, model.at);
    enum status status = step(&model, x, &predicted, error);
    double length = distance(search->n, x, model.at->x);
    bool inside =
        out <= problem->tolerance; /* else the side conditions come before the residuals */
    if (status != STATUS_OK || length == 0 || (inside && length < problem->tolerance) ||
        (inside && !(now - predicted > 0))) {
      return status;
    }
    const struct optimise_record *trial = optimise_look(search, x);
    if (!trial) {
      return STATUS_OK;
    }
    double gain = trial->solved ? now - optimise_objective(search, trial, NULL) : -HUGE_VAL;
    double quality = inside ? gain / (now - predicted) : trial->solved ? 1.0 : -HUGE_VAL;
    if (quality < bad) {
      model.radius = bad * length;
    } else if (quality > good && length > 0.99 * model.radius) {
      model.radius = fmin(2 * model.radius, largest_radius);
    }
    if (quality > accepted) {
      model.at = trial;
    } else if (model.radius < problem->tolerance) {
      return STATUS_OK;
    }
  }
  return STATUS_OK;
}
