/* Surrogates of functions that are known: what is predicted, with which error bars, and refusals.
 */
#include <math.h>
#include <stdlib.h>

#include "solver/explore/latin.h"
#include "solver/explore/random.h"
#include "solver/explore/surrogate.h"
#include "tests/unit/suite.h"

/* Branin (1972) over x from -5 to 10 and y from 0 to 15. */
static double branin(const double *x) {
  double a = x[1] - 5.1 / (4 * M_PI * M_PI) * x[0] * x[0] + 5 / M_PI * x[0] - 6;
  return a * a + 10 * (1 - 1 / (8 * M_PI)) * cos(x[0]) + 10;
}

static struct surrogate *must_create(const double *x, const double *y, int count, int parameters) {
  struct surrogate *made;
  struct error error;
  ck_assert_msg(surrogate_create(x, y, count, parameters, 1, &made, &error) == STATUS_OK, "%s",
                error.message);
  return made;
}

/* 60 points give a function with three minima to about 1 % of its spread (51.3), everywhere; the
 * third parameter does nothing, and its length says so. */
START_TEST(a_known_function_is_recovered) {
  enum { COUNT = 60 };
  double x[3 * COUNT], y[COUNT], value, deviation, squares = 0;
  struct error error;
  ck_assert(latin_hypercube(COUNT, 3, 1, x, &error) == STATUS_OK);
  for (int i = 0; i < COUNT; i++) {
    x[3 * i] = -5 + 15 * x[3 * i];
    x[3 * i + 1] *= 15;
    y[i] = branin(x + 3 * i);
  }
  struct surrogate *s = must_create(x, y, COUNT, 3);
  const struct surrogate_fit *fit = surrogate_fit(s);
  printf("lengths %.3g %.3g %.3g, noise %.2g, left out R2 %.5f, within %.2f\n", fit->length[0],
         fit->length[1], fit->length[2], fit->noise, fit->left_out_r2, fit->left_out_within);
  ck_assert_double_gt(fit->left_out_r2, 0.98);
  ck_assert_double_gt(fit->length[2], 3 * fmax(fit->length[0], fit->length[1]));
  int within = 0, tests = 0;
  for (int i = 0; i <= 20; i++) {
    for (int j = 0; j <= 20; j++, tests++) {
      double at[3] = {-5 + 0.75 * i, 0.75 * j, 0.3};
      surrogate_predict(s, at, &value, &deviation);
      squares += pow(value - branin(at), 2);
      within += fabs(value - branin(at)) <= 2 * deviation;
    }
  }
  ck_assert_double_lt(sqrt(squares / tests) / 51.3, 0.05);
  ck_assert_int_gt(within, tests * 85 / 100);
  for (int i = 0; i < COUNT; i++) {
    surrogate_predict(s, x + 3 * i, &value, &deviation);
    ck_assert_double_eq_tol(value, y[i], 0.05);
    ck_assert_double_lt(deviation, 0.5);
  }
  surrogate_destroy(s);
}
END_TEST

/* A sine with noise of 0.1: the noise is found, and 95 % intervals of points left out hold as
 * often as they say. Units of x and y do not matter. */
START_TEST(noise_is_found_and_intervals_hold) {
  enum { COUNT = 200 };
  double x[COUNT], y[COUNT], value, deviation, far;
  double scale = _i ? 1e-3 : 1, offset = _i ? 50 : 0;
  uint64_t random = 7;
  for (int i = 0; i < COUNT; i++) {
    double u = random_uniform(&random);
    double noise =
        sqrt(-2 * log(1 - random_uniform(&random))) * cos(2 * M_PI * random_uniform(&random));
    x[i] = scale * u;
    y[i] = offset + 1e3 * (sin(2 * M_PI * u) + 0.1 * noise);
  }
  struct surrogate *s = must_create(x, y, COUNT, 1);
  const struct surrogate_fit *fit = surrogate_fit(s);
  ck_assert_double_eq_tol(fit->noise, 100, 20);
  ck_assert_double_eq_tol(fit->left_out_within, 0.95, 0.05);
  ck_assert_double_gt(fit->left_out_r2, 0.95);
  double middle = 0.25 * scale, outside = 1.5 * scale;
  surrogate_predict(s, &middle, &value, &deviation);
  ck_assert_double_eq_tol(value, offset + 1e3, 100);
  surrogate_predict(s, &outside, &value, &far);
  ck_assert_double_gt(far, 3 * deviation);
  surrogate_destroy(s);
}
END_TEST

/* Leaving a point out by its formula is the same as fitting the others, as long as lengths and
 * mean hardly depend on one of many points. */
START_TEST(points_left_out_are_predicted_by_the_others) {
  enum { COUNT = 60, OUT = 17 };
  double x[2 * COUNT], y[COUNT], value[COUNT], deviation[COUNT], refitted, bar;
  struct error error;
  ck_assert(latin_hypercube(COUNT, 2, 3, x, &error) == STATUS_OK);
  for (int i = 0; i < COUNT; i++) {
    y[i] = sin(5 * x[2 * i]) * cos(3 * x[2 * i + 1]);
  }
  struct surrogate *all = must_create(x, y, COUNT, 2);
  surrogate_leave_one_out(all, value, deviation);
  double point[2] = {x[2 * OUT], x[2 * OUT + 1]};
  x[2 * OUT] = x[2 * COUNT - 2];
  x[2 * OUT + 1] = x[2 * COUNT - 1];
  y[OUT] = y[COUNT - 1];
  struct surrogate *rest = must_create(x, y, COUNT - 1, 2);
  surrogate_predict(rest, point, &refitted, &bar);
  ck_assert_double_eq_tol(refitted, value[OUT], 0.5 * deviation[OUT]);
  ck_assert_double_gt(bar, 0.3 * deviation[OUT]);
  ck_assert_double_lt(bar, 3 * deviation[OUT]);
  surrogate_destroy(all);
  surrogate_destroy(rest);
}
END_TEST

START_TEST(odd_data_are_survived) {
  double x[8] = {1, 2, 3, 4, 5, 6, 7, 8}, same[8] = {3, 3, 3, 3, 3, 3, 3, 3}, value, deviation;
  double at = 2.5;
  struct surrogate *s = must_create(x, same, 8, 1); /* no variance */
  surrogate_predict(s, &at, &value, &deviation);
  ck_assert_double_eq_tol(value, 3, 1e-9);
  surrogate_destroy(s);
  double repeated[8] = {1, 1, 1, 1, 2, 2, 2, 2}, y[8] = {0, 1, 0, 1, 4, 5, 4, 5};
  s = must_create(repeated, y, 8, 1); /* equal designs, different values: noise */
  at = 1;
  surrogate_predict(s, &at, &value, &deviation);
  ck_assert_double_eq_tol(value, 0.5, 0.6);
  surrogate_destroy(s);
  struct error error;
  y[3] = NAN;
  ck_assert(surrogate_create(x, y, 8, 1, 1, &s, &error) == STATUS_INVALID);
  ck_assert(surrogate_create(x, y, 3, 1, 1, &s, &error) == STATUS_INVALID);
  ck_assert(surrogate_create(x, y, 8, 33, 1, &s, &error) == STATUS_TOO_LARGE);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("explore: surrogate");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, a_known_function_is_recovered);
  tcase_add_loop_test(tcase, noise_is_found_and_intervals_hold, 0, 2);
  tcase_add_test(tcase, points_left_out_are_predicted_by_the_others);
  tcase_add_test(tcase, odd_data_are_survived);
  tcase_set_timeout(tcase, 300);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
