/* Sobol' indices and correlations of functions and data whose values are published. */
#include <math.h>
#include <stdlib.h>

#include "solver/explore/importance.h"
#include "solver/explore/sequence.h"
#include "tests/unit/suite.h"

enum { POINTS = 1 << 14, INPUTS_MAX = 8 };

/* Ishigami and Homma (1990), x from -pi to pi, a = 7, b = 0.1. */
static double ishigami(const double *u) {
  double x[3];
  for (int i = 0; i < 3; i++) {
    x[i] = M_PI * (2 * u[i] - 1);
  }
  return sin(x[0]) + 7 * pow(sin(x[1]), 2) + 0.1 * pow(x[2], 4) * sin(x[0]);
}

/* Sobol' (1993): the product of (|4 x - 2| + a_i) / (1 + a_i). */
static const double g_constant[INPUTS_MAX] = {0, 1, 4.5, 9, 99, 99, 99, 99};

static double sobol_g(const double *u) {
  double product = 1;
  for (int i = 0; i < 8; i++) {
    product *= (fabs(4 * u[i] - 2) + g_constant[i]) / (1 + g_constant[i]);
  }
  return product;
}

static void evaluate(double (*function)(const double *), int parameters, uint64_t seed,
                     struct importance *importance) {
  struct sequence *s;
  struct error error;
  double *a = malloc(POINTS * sizeof *a), *b = malloc(POINTS * sizeof *b);
  double *mixed[INPUTS_MAX], x[2 * INPUTS_MAX];
  for (int i = 0; i < parameters; i++) {
    mixed[i] = malloc(POINTS * sizeof *mixed[i]);
  }
  ck_assert(sequence_create(SEQUENCE_SOBOL, 2 * parameters, true, seed, &s, &error) == STATUS_OK);
  for (int j = 0; j < POINTS; j++) {
    sequence_next(s, x);
    a[j] = function(x);
    b[j] = function(x + parameters);
    for (int i = 0; i < parameters; i++) {
      double kept = x[i];
      x[i] = x[parameters + i];
      mixed[i][j] = function(x);
      x[i] = kept;
    }
  }
  ck_assert(importance_sobol(a, b, (const double *const *)mixed, POINTS, parameters, seed,
                             importance, &error) == STATUS_OK);
  sequence_destroy(s);
  free(a);
  free(b);
  for (int i = 0; i < parameters; i++) {
    free(mixed[i]);
  }
}

/* Second-order indices, pair[parameters][parameters]. */
static void evaluate_pairs(double (*function)(const double *), int parameters, struct share *pair) {
  struct sequence *s;
  struct error error;
  double *a = malloc(POINTS * sizeof *a), *b = malloc(POINTS * sizeof *b);
  double *mixed[INPUTS_MAX], *back[INPUTS_MAX], x[2 * INPUTS_MAX];
  for (int i = 0; i < parameters; i++) {
    mixed[i] = malloc(POINTS * sizeof *mixed[i]);
    back[i] = malloc(POINTS * sizeof *back[i]);
  }
  ck_assert(sequence_create(SEQUENCE_SOBOL, 2 * parameters, true, 1, &s, &error) == STATUS_OK);
  for (int j = 0; j < POINTS; j++) {
    sequence_next(s, x);
    a[j] = function(x);
    b[j] = function(x + parameters);
    for (int i = 0; i < parameters; i++) {
      double first = x[i], second = x[parameters + i];
      x[i] = second;
      mixed[i][j] = function(x);
      x[i] = first;
      x[parameters + i] = first;
      back[i][j] = function(x + parameters);
      x[parameters + i] = second;
    }
  }
  ck_assert(importance_pairs(a, b, (const double *const *)mixed, (const double *const *)back,
                             POINTS, parameters, 1, pair, &error) == STATUS_OK);
  sequence_destroy(s);
  free(a);
  free(b);
  for (int i = 0; i < parameters; i++) {
    free(mixed[i]);
    free(back[i]);
  }
}

static void check_share(const struct share *share, double wanted) {
  ck_assert_double_eq_tol(share->value, wanted, 0.01);
  ck_assert(share->low <= share->value && share->value <= share->high);
  ck_assert_double_lt(share->high - share->low, 0.1);
}

START_TEST(indices_of_the_ishigami_function) {
  struct importance importance[3];
  double a = 7, b = 0.1, p4 = pow(M_PI, 4), p8 = p4 * p4;
  double one = 0.5 * pow(1 + b * p4 / 5, 2), two = a * a / 8,
         both = b * b * p8 * (1.0 / 18 - 1.0 / 50);
  double all = one + two + both;
  evaluate(ishigami, 3, (uint64_t)_i, importance);
  check_share(&importance[0].first, one / all);
  check_share(&importance[1].first, two / all);
  check_share(&importance[2].first, 0);
  check_share(&importance[0].total, (one + both) / all);
  check_share(&importance[1].total, two / all);
  check_share(&importance[2].total, both / all);
}
END_TEST

/* Of the Ishigami function only the first and the third interact. Of Sobol's G function those of a
 * pair have the product of their own variances. */
START_TEST(interactions_of_pairs) {
  struct share pair[INPUTS_MAX * INPUTS_MAX];
  double p4 = pow(M_PI, 4), both = 0.01 * p4 * p4 * (1.0 / 18 - 1.0 / 50);
  double all = 0.5 * pow(1 + 0.1 * p4 / 5, 2) + 49.0 / 8 + both, product = 1;
  evaluate_pairs(ishigami, 3, pair);
  check_share(&pair[0 * 3 + 2], both / all);
  check_share(&pair[2 * 3 + 0], both / all);
  check_share(&pair[0 * 3 + 1], 0);
  check_share(&pair[1 * 3 + 2], 0);
  ck_assert(pair[0].value == 0);
  evaluate_pairs(sobol_g, 8, pair);
  for (int i = 0; i < 8; i++) {
    product *= 1 + 1 / (3 * pow(1 + g_constant[i], 2));
  }
  for (int i = 0; i < 8; i++) {
    for (int k = 0; k < i; k++) {
      check_share(&pair[i * 8 + k], 1 / (3 * pow(1 + g_constant[i], 2)) /
                                        (3 * pow(1 + g_constant[k], 2)) / (product - 1));
    }
  }
}
END_TEST

START_TEST(indices_of_the_g_function) {
  struct importance importance[8];
  double all = 1;
  evaluate(sobol_g, 8, 1, importance);
  for (int i = 0; i < 8; i++) {
    all *= 1 + 1 / (3 * pow(1 + g_constant[i], 2));
  }
  for (int i = 0; i < 8; i++) {
    double own = 1 / (3 * pow(1 + g_constant[i], 2));
    check_share(&importance[i].first, own / (all - 1));
    check_share(&importance[i].total, own * all / (1 + own) / (all - 1));
  }
}
END_TEST

START_TEST(a_constant_has_no_importance) {
  static const double same[3] = {2, 2, 2};
  const double *mixed[1] = {same};
  struct importance importance;
  struct error error;
  ck_assert(importance_sobol(same, same, mixed, 3, 1, 1, &importance, &error) == STATUS_OK);
  ck_assert(importance.first.value == 0 && importance.total.high == 0);
}
END_TEST

/* Anscombe's (1973) first data set: 0.816. Ranks of equal values share their mean: by hand, 1 2.5
 * 2.5 4 against 1 3 2 4 correlate to 0.9487 = 4.5 / sqrt(4.5 x 5). */
START_TEST(correlations_are_as_published) {
  static const double x[11] = {10, 8, 13, 9, 11, 14, 6, 4, 12, 7, 5};
  static const double y[11] = {8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68};
  static const double tied[4] = {1, 2, 2, 30}, other[4] = {1, 7, 6, 8}, still[4] = {5, 5, 5, 5};
  double linear, rank;
  struct error error;
  ck_assert(importance_correlation(x, y, 11, &linear, &rank, &error) == STATUS_OK);
  ck_assert_double_eq_tol(linear, 0.8164, 5e-5);
  ck_assert(importance_correlation(tied, other, 4, &linear, &rank, &error) == STATUS_OK);
  ck_assert_double_eq_tol(rank, 4.5 / sqrt(4.5 * 5), 1e-12);
  ck_assert(importance_correlation(tied, still, 4, &linear, &rank, &error) == STATUS_OK);
  ck_assert(linear == 0 && rank == 0);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("explore: importance");
  TCase *tcase = tcase_create("all");
  tcase_add_loop_test(tcase, indices_of_the_ishigami_function, 0, 2);
  tcase_add_test(tcase, indices_of_the_g_function);
  tcase_add_test(tcase, interactions_of_pairs);
  tcase_add_test(tcase, a_constant_has_no_importance);
  tcase_add_test(tcase, correlations_are_as_published);
  tcase_set_timeout(tcase, 300);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
