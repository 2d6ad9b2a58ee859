/* Optimisation against published problems: W. Hock and K. Schittkowski, Test Examples for Nonlinear
 * Programming Codes (1981), numbers 1, 35, 43, 76 and 100; J. Moré, B. Garbow and K. Hillstrom,
 * Testing Unconstrained Optimization Software (1981); F. Branin (1972). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/explore/optimise.h"
#include "solver/explore/sequence.h"
#include "tests/unit/suite.h"

enum { N_MAX = 8, TRACE_MAX = 4000 };

/* A problem over low .. high, its functions by `functions` (limits last), derivatives by complex
 * steps being out of reach, by central differences: the functions are cheap. */
struct model {
  size_t n, residuals, limits, sides;
  double low, high;
  void (*functions)(const double *p, double *value);
  double (*side)(const double *p);
  bool (*absent)(const double *p); /* where evaluations fail, or NULL */
  size_t halt_at;                  /* evaluation that is not answered; 0: all are */
  size_t calls;
  double trace[TRACE_MAX][N_MAX]; /* points asked for */
};

static void place(const struct model *model, const double *x, double *p) {
  for (size_t k = 0; k < model->n; k++) {
    p[k] = model->low + x[k] * (model->high - model->low);
  }
}

static enum optimise_reply answer(void *context, const double *x, double *value, double *gradient) {
  struct model *model = context;
  size_t functions = (model->residuals > 0 ? model->residuals : 1) + model->limits;
  double p[N_MAX], shifted[N_MAX], above[32], below[32];
  for (size_t k = 0; k < model->n; k++) {
    ck_assert(x[k] >= 0 && x[k] <= 1);
  }
  if (model->calls < TRACE_MAX) {
    memcpy(model->trace[model->calls], x, model->n * sizeof *x);
  }
  model->calls++;
  if (model->calls == model->halt_at) {
    return OPTIMISE_HALT;
  }
  place(model, x, p);
  if (model->absent && model->absent(p)) {
    return OPTIMISE_FAILED;
  }
  model->functions(p, value);
  for (size_t k = 0; k < model->n; k++) {
    double h = 1e-6 * (model->high - model->low);
    memcpy(shifted, p, sizeof p);
    shifted[k] = p[k] + h;
    model->functions(shifted, above);
    shifted[k] = p[k] - h;
    model->functions(shifted, below);
    for (size_t i = 0; i < functions; i++) {
      gradient[i * model->n + k] = (above[i] - below[i]) / (2 * h) * (model->high - model->low);
    }
  }
  return OPTIMISE_SOLVED;
}

static double answer_side(void *context, size_t which, const double *x, double *gradient) {
  const struct model *model = context;
  double p[N_MAX], value;
  ck_assert_uint_eq(which, 0);
  place(model, x, p);
  value = model->side(p);
  for (size_t k = 0; gradient && k < model->n; k++) { /* linear ones only */
    double kept = p[k];
    p[k] += 1;
    gradient[k] = (model->side(p) - value) * (model->high - model->low);
    p[k] = kept;
  }
  return value;
}

static struct optimise_outcome run(struct model *model, enum optimise_method method, size_t budget,
                                   double tolerance, const double *start) {
  struct optimise_problem problem = {.method = method,
                                     .parameters = model->n,
                                     .residuals = model->residuals,
                                     .limits = model->limits,
                                     .sides = model->sides,
                                     .budget = budget,
                                     .tolerance = tolerance,
                                     .target = 0,
                                     .evaluate = answer,
                                     .side = answer_side,
                                     .context = model};
  struct optimise_outcome outcome;
  struct error error = {0};
  double x[N_MAX];
  for (size_t k = 0; k < model->n; k++) {
    x[k] = (start[k] - model->low) / (model->high - model->low);
  }
  model->calls = 0;
  ck_assert(optimise_run(&problem, x, &outcome, &error) == STATUS_OK);
  ck_assert_uint_le(outcome.evaluations, budget);
  return outcome;
}

static void check_point(const struct model *model, const struct optimise_outcome *outcome,
                        const double *wanted, double tolerance) {
  double p[N_MAX];
  place(model, outcome->x, p);
  for (size_t k = 0; k < model->n; k++) {
    ck_assert_double_eq_tol(p[k], wanted[k], tolerance);
  }
}

/* ---- one function ------------------------------------------------------------------------- */

static void rosenbrock(const double *p, double *f) {
  f[0] = 100 * pow(p[1] - p[0] * p[0], 2) + pow(1 - p[0], 2);
}

static void hs35(const double *p, double *f) {
  f[0] = 9 - 8 * p[0] - 6 * p[1] - 4 * p[2] + 2 * p[0] * p[0] + 2 * p[1] * p[1] + p[2] * p[2] +
         2 * p[0] * p[1] + 2 * p[0] * p[2];
  f[1] = p[0] + p[1] + 2 * p[2] - 3;
}

static void hs43(const double *p, double *f) {
  double a = p[0] * p[0], b = p[1] * p[1], c = p[2] * p[2], d = p[3] * p[3];
  f[0] = a + b + 2 * c + d - 5 * p[0] - 5 * p[1] - 21 * p[2] + 7 * p[3];
  f[1] = a + b + c + d + p[0] - p[1] + p[2] - p[3] - 8;
  f[2] = a + 2 * b + c + 2 * d - p[0] - p[3] - 10;
  f[3] = 2 * a + b + c + 2 * p[0] - p[1] - p[3] - 5;
}

static void hs76(const double *p, double *f) {
  f[0] = p[0] * p[0] + 0.5 * p[1] * p[1] + p[2] * p[2] + 0.5 * p[3] * p[3] - p[0] * p[2] +
         p[2] * p[3] - p[0] - 3 * p[1] + p[2] - p[3];
  f[1] = p[0] + 2 * p[1] + p[2] + p[3] - 5;
  f[2] = 3 * p[0] + p[1] + 2 * p[2] - p[3] - 4;
  f[3] = 1.5 - p[1] - 4 * p[2];
}

static void hs100(const double *p, double *f) {
  f[0] = pow(p[0] - 10, 2) + 5 * pow(p[1] - 12, 2) + pow(p[2], 4) + 3 * pow(p[3] - 11, 2) +
         10 * pow(p[4], 6) + 7 * p[5] * p[5] + pow(p[6], 4) - 4 * p[5] * p[6] - 10 * p[5] -
         8 * p[6];
  f[1] = (2 * p[0] * p[0] + 3 * pow(p[1], 4) + p[2] + 4 * p[3] * p[3] + 5 * p[4] - 127) / 127;
  f[2] = (7 * p[0] + 3 * p[1] + 10 * p[2] * p[2] + p[3] - p[4] - 282) / 282;
  f[3] = (23 * p[0] + p[1] * p[1] + 6 * p[5] * p[5] - 8 * p[6] - 196) / 196;
  f[4] = 4 * p[0] * p[0] + p[1] * p[1] - 3 * p[0] * p[1] + 2 * p[2] * p[2] + 5 * p[5] - 11 * p[6];
}

static const struct case_of_limits {
  struct model model;
  double start[N_MAX], best[N_MAX], value;
  size_t budget;
} limited[] = {
    {{.n = 2, .low = -2, .high = 2, .functions = rosenbrock}, {-2, 1}, {1, 1}, 0, 80},
    {{.n = 3, .limits = 1, .low = 0, .high = 3, .functions = hs35},
     {0.5, 0.5, 0.5},
     {4. / 3, 7. / 9, 4. / 9},
     1. / 9,
     30},
    {{.n = 4, .limits = 3, .low = -3, .high = 3, .functions = hs43},
     {0, 0, 0, 0},
     {0, 1, 2, -1},
     -44,
     40},
    {{.n = 4, .limits = 3, .low = 0, .high = 5, .functions = hs76},
     {0.5, 0.5, 0.5, 0.5},
     {0.2727273, 2.090909, 0, 0.5454545},
     -4.681818181,
     30},
    {{.n = 7, .limits = 4, .low = -5, .high = 5, .functions = hs100},
     {1, 2, 0, 4, 0, 1, 1},
     {2.330499, 1.951372, -0.4775414, 4.365726, -0.6244870, 1.038131, 1.594227},
     680.6300573,
     100},
};

START_TEST(limits_of_hock_and_schittkowski) {
  const struct case_of_limits *it = &limited[_i];
  struct model *model = malloc(sizeof *model);
  ck_assert_ptr_nonnull(model);
  *model = it->model;
  struct optimise_outcome outcome = run(model, OPTIMISE_SLSQP, it->budget, 1e-7, it->start);
  ck_assert_int_eq(outcome.ending, OPTIMISE_CONVERGED);
  ck_assert_double_le(outcome.violation, 1e-7);
  ck_assert_double_eq_tol(outcome.objective, it->value, 1e-5 * fmax(1, fabs(it->value)));
  check_point(model, &outcome, it->best, 3e-3);
  free(model);
}
END_TEST

START_TEST(moving_asymptotes_and_no_derivatives) {
  static const enum optimise_method methods[] = {OPTIMISE_MMA, OPTIMISE_COBYLA};
  struct model *model = malloc(sizeof *model);
  ck_assert_ptr_nonnull(model);
  *model = limited[2].model;
  struct optimise_outcome outcome = run(model, methods[_i], 400, 1e-6, limited[2].start);
  ck_assert_double_le(outcome.violation, 1e-6);
  ck_assert_double_eq_tol(outcome.objective, -44, 1e-3);
  free(model);
}
END_TEST

/* ---- Branin ------------------------------------------------------------------------------- */

/* x in -5 .. 10, y in 0 .. 15, given as p in 0 .. 15. */
static void branin(const double *p, double *f) {
  double x = p[0] - 5, y = p[1];
  f[0] = pow(y - 5.1 / (4 * M_PI * M_PI) * x * x + 5 / M_PI * x - 6, 2) +
         10 * (1 - 1 / (8 * M_PI)) * cos(x) + 10;
}

START_TEST(several_starts_find_the_three_minima_of_branin) {
  static const double minima[3][2] = {{5 - M_PI, 12.275}, {5 + M_PI, 2.275}, {5 + 9.42478, 2.475}};
  struct model *model = calloc(1, sizeof *model);
  struct sequence *sequence = NULL;
  struct error error;
  bool found[3] = {false};
  ck_assert_ptr_nonnull(model);
  *model = (struct model){.n = 2, .low = 0, .high = 15, .functions = branin};
  ck_assert(sequence_create(SEQUENCE_SOBOL, 2, true, 0, &sequence, &error) == STATUS_OK);
  for (int start = 0; start < 8; start++) {
    double x[2], p[2];
    sequence_next(sequence, x);
    place(model, x, p);
    struct optimise_outcome outcome = run(model, OPTIMISE_SLSQP, 60, 1e-6, p);
    place(model, outcome.x, p);
    for (int m = 0; m < 3; m++) {
      found[m] = found[m] || hypot(p[0] - minima[m][0], p[1] - minima[m][1]) < 2e-3;
    }
  }
  ck_assert(found[0] && found[1] && found[2]);
  sequence_destroy(sequence);
  free(model);
}
END_TEST

/* ---- sums of squares ---------------------------------------------------------------------- */

static void rosenbrock_residuals(const double *p, double *r) {
  r[0] = 10 * (p[1] - p[0] * p[0]);
  r[1] = 1 - p[0];
}

static void bard(const double *p, double *r) {
  static const double y[] = {0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39,
                             0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39};
  for (int i = 1; i <= 15; i++) {
    double u = i, v = 16 - i, w = fmin(u, v);
    r[i - 1] = y[i - 1] - (p[0] + u / (v * p[1] + w * p[2]));
  }
}

static void kowalik_osborne(const double *p, double *r) {
  static const double y[] = {0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627,
                             0.0456, 0.0342, 0.0323, 0.0235, 0.0246};
  static const double u[] = {4, 2, 1, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625};
  for (int i = 0; i < 11; i++) {
    r[i] = y[i] - p[0] * (u[i] * u[i] + u[i] * p[1]) / (u[i] * u[i] + u[i] * p[2] + p[3]);
  }
}

static const struct case_of_squares {
  struct model model;
  double start[N_MAX], sum; /* sum of squares at the best point */
  size_t budget;
} squares[] = {
    {{.n = 2, .residuals = 2, .low = -2, .high = 2, .functions = rosenbrock_residuals},
     {-1.2, 1},
     0,
     30},
    {{.n = 3, .residuals = 15, .low = 0, .high = 3, .functions = bard}, {1, 1, 1}, 8.21487e-3, 15},
    {{.n = 4, .residuals = 11, .low = 0, .high = 0.5, .functions = kowalik_osborne},
     {0.25, 0.39, 0.415, 0.39},
     3.07505e-4,
     30},
};

START_TEST(squares_of_more_garbow_and_hillstrom) {
  const struct case_of_squares *it = &squares[_i];
  struct model *model = malloc(sizeof *model);
  ck_assert_ptr_nonnull(model);
  *model = it->model;
  struct optimise_outcome outcome = run(model, OPTIMISE_GAUSS_NEWTON, it->budget, 1e-6, it->start);
  ck_assert_int_ne(outcome.ending, OPTIMISE_SPENT);
  ck_assert_double_eq_tol(2 * outcome.objective, it->sum, 1e-5 * it->sum + 1e-12);
  size_t needed = outcome.evaluations;
  outcome = run(model, OPTIMISE_SLSQP, 500, 1e-6, it->start);
  ck_assert_double_eq_tol(2 * outcome.objective, it->sum, 1e-2 * it->sum + 1e-7);
  printf("%zu residuals, %zu parameters: Gauss-Newton %zu evaluations, SLSQP %zu\n",
         model->residuals, model->n, needed, outcome.evaluations);
  free(model);
}
END_TEST

static double below_diagonal(const double *p) {
  return p[0] + p[1] - 1;
}

/* On p0 + p1 = 1 the residuals of Rosenbrock are least where
 * 200 (1 - x - x^2)(-1 - 2x) = 2 (1 - x), near x = 0.6188. */
START_TEST(side_conditions_bound_least_squares) {
  struct model *model = malloc(sizeof *model);
  double p[2];
  ck_assert_ptr_nonnull(model);
  *model = squares[0].model;
  model->sides = 1;
  model->side = below_diagonal;
  struct optimise_outcome outcome =
      run(model, OPTIMISE_GAUSS_NEWTON, 40, 1e-7, (double[]){-1.2, 1});
  place(model, outcome.x, p);
  double x = p[0], slope = 200 * (1 - x - x * x) * (-1 - 2 * x) - 2 * (1 - x);
  ck_assert_double_eq_tol(p[0] + p[1], 1, 1e-6);
  ck_assert_double_eq_tol(slope, 0, 1e-3);
  free(model);
}
END_TEST

/* ---- failures, and answers that are not there yet ----------------------------------------- */

/* A wall across the valley's outside, and a hole on the straight way to the minimum. */
static bool absent(const double *p) {
  return p[1] > 1.5 || hypot(p[0] - 0.2, p[1] - 0.9) < 0.4;
}

/* COBYLA's linear models creep along this curved valley: called directly, with nothing in its way,
 * NLopt comes to 0.8 to 1.6e-3 in 3000 evaluations, depending on the first step (0.05 to 0.4 of the
 * range). With the hole it must come as far. */
START_TEST(searches_go_round_designs_that_fail) {
  static const double it_must_reach[] = {1e-12, 1e-12, 1e-4, 2e-3};
  static const enum optimise_method methods[] = {OPTIMISE_GAUSS_NEWTON, OPTIMISE_SLSQP,
                                                 OPTIMISE_MMA, OPTIMISE_COBYLA};
  struct model *model = malloc(sizeof *model);
  ck_assert_ptr_nonnull(model);
  *model = squares[0].model;
  model->absent = absent;
  struct optimise_outcome outcome = run(model, methods[_i], 3000, 1e-7, (double[]){-1.2, 1.4});
  ck_assert_double_le(outcome.objective, it_must_reach[_i]);
  free(model);
}
END_TEST

static bool nowhere(const double *p) {
  return p[0] < INFINITY;
}

START_TEST(a_start_that_fails_ends_the_search) {
  struct model *model = malloc(sizeof *model);
  ck_assert_ptr_nonnull(model);
  *model = squares[0].model;
  model->absent = nowhere;
  struct optimise_outcome outcome =
      run(model, _i ? OPTIMISE_SLSQP : OPTIMISE_GAUSS_NEWTON, 50, 1e-6, (double[]){0, 0});
  ck_assert_int_eq(outcome.ending, OPTIMISE_LOST);
  ck_assert_uint_eq(outcome.evaluations, 1);
  ck_assert(isnan(outcome.objective));
  free(model);
}
END_TEST

/* Asking again from the start with one answer more each time puts the same questions. */
START_TEST(a_halted_search_is_taken_up_by_repetition) {
  static const enum optimise_method methods[] = {OPTIMISE_GAUSS_NEWTON, OPTIMISE_SLSQP,
                                                 OPTIMISE_MMA, OPTIMISE_COBYLA};
  struct model *whole = malloc(sizeof *whole), *part = malloc(sizeof *part);
  ck_assert(whole && part);
  *whole = squares[0].model;
  run(whole, methods[_i], 40, 1e-6, (double[]){-1.2, 1});
  for (size_t halt = 1; halt <= whole->calls && halt <= 40; halt++) {
    *part = squares[0].model;
    part->halt_at = halt;
    struct optimise_outcome outcome = run(part, methods[_i], 40, 1e-6, (double[]){-1.2, 1});
    ck_assert_int_eq(outcome.ending, OPTIMISE_HALTED);
    ck_assert_uint_eq(part->calls, halt);
    ck_assert_mem_eq(part->trace, whole->trace, halt * sizeof *part->trace);
  }
  free(whole);
  free(part);
}
END_TEST

START_TEST(the_budget_is_kept) {
  struct model *model = malloc(sizeof *model);
  ck_assert_ptr_nonnull(model);
  *model = squares[0].model;
  struct optimise_outcome outcome =
      run(model, (enum optimise_method)_i, 3, 1e-9, (double[]){-1.2, 1});
  ck_assert_int_eq(outcome.ending, OPTIMISE_SPENT);
  ck_assert_uint_eq(model->calls, 3);
  free(model);
}
END_TEST

START_TEST(problems_out_of_range_are_refused) {
  struct optimise_problem problem = {.parameters = 0, .budget = 1, .tolerance = 1e-3};
  struct optimise_outcome outcome;
  struct error error;
  double x[1] = {0.5};
  ck_assert(optimise_run(&problem, x, &outcome, &error) == STATUS_INVALID);
  problem.parameters = OPTIMISE_PARAMETERS_MAX + 1;
  ck_assert(optimise_run(&problem, x, &outcome, &error) == STATUS_INVALID);
  problem = (struct optimise_problem){.parameters = 1, .budget = 0, .tolerance = 1e-3};
  ck_assert(optimise_run(&problem, x, &outcome, &error) == STATUS_INVALID);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("explore: optimisation");
  TCase *tests = tcase_create("all");
  tcase_add_loop_test(tests, limits_of_hock_and_schittkowski, 0, 5);
  tcase_add_loop_test(tests, moving_asymptotes_and_no_derivatives, 0, 2);
  tcase_add_test(tests, several_starts_find_the_three_minima_of_branin);
  tcase_add_loop_test(tests, squares_of_more_garbow_and_hillstrom, 0, 3);
  tcase_add_test(tests, side_conditions_bound_least_squares);
  tcase_add_loop_test(tests, searches_go_round_designs_that_fail, 0, 4);
  tcase_add_loop_test(tests, a_start_that_fails_ends_the_search, 0, 2);
  tcase_add_loop_test(tests, a_halted_search_is_taken_up_by_repetition, 0, 4);
  tcase_add_loop_test(tests, the_budget_is_kept, 0, 4);
  tcase_add_test(tests, problems_out_of_range_are_refused);
  suite_add_tcase(suite, tests);
  return suite_run(suite);
}
