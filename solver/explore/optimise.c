#include "solver/explore/optimise.h"

#include <math.h>
#include <nlopt.h>
#include <stdlib.h>
#include <string.h>

#include "solver/explore/optimise_internal.h"

/* The first step of a method with derivatives changes a parameter by about this much of its range;
 * so does COBYLA's first simplex. */
static const double first_step = 0.2;

/* The objective counts as settled when it changes by this much of the tolerance. */
static const double settled_share = 1e-2;

size_t optimise_functions(const struct optimise_problem *problem) {
  return (problem->residuals > 0 ? problem->residuals : 1) + problem->limits;
}

/* ---- NLopt -------------------------------------------------------------------------------- */

struct drive {
  struct optimise_search *search;
  nlopt_opt opt;
  double scale; /* of the objective, so that its first gradient is about one first step */
};

/* The record of x; NULL, and NLopt is told to stop, when there is none or no need of one. */
static const struct optimise_record *ask(struct drive *drive, const double *x) {
  const struct optimise_record *record = optimise_look(drive->search, x);
  if (!record || drive->search->reached) {
    nlopt_force_stop(drive->opt);
  }
  return record;
}

static double call_objective(unsigned n, const double *x, double *gradient, void *data) {
  struct drive *drive = data;
  const struct optimise_record *record = ask(drive, x);
  if (!record) {
    if (gradient) {
      memset(gradient, 0, n * sizeof *gradient);
    }
    return HUGE_VAL;
  }
  double value = optimise_objective(drive->search, record, gradient);
  for (unsigned k = 0; gradient && k < n; k++) {
    gradient[k] *= drive->scale;
  }
  return drive->scale * value;
}

static void call_limits(unsigned count, double *value, unsigned n, const double *x,
                        double *gradient, void *data) {
  struct drive *drive = data;
  const struct optimise_search *search = drive->search;
  const struct optimise_record *record = ask(drive, x);
  size_t first = search->functions - count;
  for (unsigned i = 0; i < count; i++) {
    value[i] = record ? record->value[first + i] : 0.0;
  }
  if (gradient && record) {
    memcpy(gradient, record->gradient + first * n, count * n * sizeof *gradient);
  } else if (gradient) {
    memset(gradient, 0, count * n * sizeof *gradient);
  }
}

static void call_sides(unsigned count, double *value, unsigned n, const double *x, double *gradient,
                       void *data) {
  const struct drive *drive = data;
  const struct optimise_problem *problem = drive->search->problem;
  for (unsigned i = 0; i < count; i++) {
    value[i] = problem->side(problem->context, i, x, gradient ? gradient + i * n : NULL);
  }
}

static nlopt_algorithm algorithm(enum optimise_method method) {
  return method == OPTIMISE_COBYLA ? NLOPT_LN_COBYLA
         : method == OPTIMISE_MMA  ? NLOPT_LD_MMA
                                   : NLOPT_LD_SLSQP;
}

/* Whether all settings were taken. `tolerance` has one entry a limit and side condition. */
static bool set_up(struct drive *drive, const double *tolerance) {
  const struct optimise_problem *problem = drive->search->problem;
  nlopt_opt opt = drive->opt;
  bool good = nlopt_set_min_objective(opt, call_objective, drive) > 0 &&
              nlopt_set_lower_bounds1(opt, 0.0) > 0 && nlopt_set_upper_bounds1(opt, 1.0) > 0 &&
              nlopt_set_xtol_abs1(opt, problem->tolerance) > 0 &&
              nlopt_set_ftol_rel(opt, settled_share * problem->tolerance) > 0;
  if (good && problem->limits > 0) {
    good = nlopt_add_inequality_mconstraint(opt, (unsigned)problem->limits, call_limits, drive,
                                            tolerance) > 0;
  }
  if (good && problem->sides > 0) {
    good = nlopt_add_inequality_mconstraint(opt, (unsigned)problem->sides, call_sides, drive,
                                            tolerance) > 0;
  }
  if (good && problem->method == OPTIMISE_COBYLA) {
    good = nlopt_set_initial_step1(opt, first_step) > 0;
  }
  return good;
}

static double first_scale(const struct optimise_search *search,
                          const struct optimise_record *first) {
  double gradient[OPTIMISE_PARAMETERS_MAX], most = 0;
  optimise_objective(search, first, gradient);
  for (size_t k = 0; k < search->n; k++) {
    most = fmax(most, fabs(gradient[k]));
  }
  return most > 0 && isfinite(most) ? first_step / most : 1.0;
}

static enum status run_nlopt(struct optimise_search *search, const struct optimise_record *first,
                             struct error *error) {
  const struct optimise_problem *problem = search->problem;
  size_t conditions = problem->limits + problem->sides;
  double x[OPTIMISE_PARAMETERS_MAX], value;
  double *tolerance = calloc(conditions + 1, sizeof *tolerance);
  struct drive drive = {search, nlopt_create(algorithm(problem->method), (unsigned)search->n), 1.0};
  for (size_t i = 0; tolerance && i < conditions; i++) {
    tolerance[i] = problem->tolerance;
  }
  if (problem->method != OPTIMISE_COBYLA) {
    drive.scale = first_scale(search, first);
  }
  memcpy(x, first->x, search->n * sizeof *x);
  enum status status = STATUS_OK;
  if (!tolerance || !drive.opt || !set_up(&drive, tolerance) ||
      nlopt_optimize(drive.opt, x, &value) == NLOPT_OUT_OF_MEMORY) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the optimisation");
  }
  nlopt_destroy(drive.opt);
  free(tolerance);
  return status;
}

/* ---- a search ----------------------------------------------------------------------------- */

static enum status check(const struct optimise_problem *problem, struct error *error) {
  bool good = problem->parameters >= 1 && problem->parameters <= OPTIMISE_PARAMETERS_MAX &&
              problem->budget >= 1 && problem->budget <= OPTIMISE_BUDGET_MAX &&
              problem->tolerance > 0 && (problem->sides == 0 || problem->side);
  return good ? STATUS_OK
              : error_set(error, STATUS_INVALID, NULL,
                          "an optimisation of %zu parameters with %zu evaluations\n1 to %d "
                          "parameters, 1 to %d evaluations, and a tolerance above 0",
                          problem->parameters, problem->budget, OPTIMISE_PARAMETERS_MAX,
                          OPTIMISE_BUDGET_MAX);
}

static enum optimise_ending ending_of(const struct optimise_search *search) {
  return search->reached                      ? OPTIMISE_REACHED
         : search->end == OPTIMISE_END_HALTED ? OPTIMISE_HALTED
         : search->end == OPTIMISE_END_SPENT  ? OPTIMISE_SPENT
         : search->best == OPTIMISE_NONE      ? OPTIMISE_LOST
                                              : OPTIMISE_CONVERGED;
}

static void report(const struct optimise_search *search, const double *start,
                   struct optimise_outcome *outcome) {
  size_t bytes = search->n * sizeof *start;
  *outcome = (struct optimise_outcome){
      .ending = ending_of(search), .evaluations = search->count, .objective = NAN};
  if (search->best == OPTIMISE_NONE) {
    memcpy(outcome->x, start, bytes);
    return;
  }
  const struct optimise_record *best = &search->record[search->best];
  outcome->best = search->best;
  outcome->objective = optimise_objective(search, best, NULL);
  outcome->violation = optimise_violation(search, best);
  memcpy(outcome->x, best->x, bytes);
}

enum status optimise_run(const struct optimise_problem *problem, const double *start,
                         struct optimise_outcome *outcome, struct error *error) {
  struct optimise_search search = {.problem = problem,
                                   .n = problem->parameters,
                                   .functions = optimise_functions(problem),
                                   .best = OPTIMISE_NONE};
  enum status status = check(problem, error);
  if (status != STATUS_OK) {
    return status;
  }
  search.record = calloc(problem->budget, sizeof *search.record);
  if (!search.record) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the optimisation");
  }
  const struct optimise_record *first = optimise_look(&search, start);
  bool squares =
      problem->method == OPTIMISE_GAUSS_NEWTON && problem->residuals > 0 && problem->limits == 0;
  if (first && !search.reached) {
    status =
        squares ? optimise_gauss_newton(&search, first, error) : run_nlopt(&search, first, error);
  }
  if (status == STATUS_OK && search.end == OPTIMISE_END_MEMORY) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the optimisation");
  }
  if (status == STATUS_OK) {
    report(&search, start, outcome);
  }
  for (size_t i = 0; i < search.count; i++) {
    free(search.record[i].x);
  }
  free(search.record);
  return status;
}
