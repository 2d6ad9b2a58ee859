/* The Riccati equation behind the gains of a control: closed forms, the limit of continuous time,
 * and its own residual for random systems. */
#include <math.h>

#include "solver/hlpv/riccati.h"
#include "tests/unit/suite.h"

START_TEST(scalar_equations_have_closed_forms) {
  const double one[] = {1.0}, two[] = {2.0}, zero[] = {0.0};
  double x, gain;
  /* x = 1 + x / (1 + x): the golden ratio. */
  struct riccati_problem golden = {1, 1, one, one, one, one};
  ck_assert_int_eq(riccati_solve(&golden, &x, &gain, NULL), STATUS_OK);
  ck_assert_double_eq_tol(x, 0.5 * (1.0 + sqrt(5.0)), 1e-14);
  ck_assert_double_eq_tol(gain, 2.0 / (1.0 + sqrt(5.0)), 1e-14);
  /* The least energy that stabilises x' = 2 x + u mirrors the eigenvalue: x = 3, 2 - gain = 1/2. */
  struct riccati_problem least = {1, 1, two, one, zero, one};
  ck_assert_int_eq(riccati_solve(&least, &x, &gain, NULL), STATUS_OK);
  ck_assert_double_eq_tol(x, 3.0, 1e-13);
  ck_assert_double_eq_tol(gain, 1.5, 1e-13);
  struct riccati_problem hopeless = {1, 1, two, zero, one, one};
  struct error error;
  ck_assert_int_eq(riccati_solve(&hopeless, &x, &gain, &error), STATUS_DIVERGED);
}
END_TEST

/* Gain of the double integrator, sampled: costs x^2 + v^2 + u^2 over the time. */
static void double_integrator(double interval, double gain[2]) {
  const double a[] = {1.0, interval, 0.0, 1.0}, b[] = {0.5 * interval * interval, interval};
  const double q[] = {interval, 0.0, 0.0, interval}, r[] = {interval};
  double x[4];
  struct riccati_problem problem = {2, 1, a, b, q, r};
  ck_assert_int_eq(riccati_solve(&problem, x, gain, NULL), STATUS_OK);
}

/* Ever faster sampling tends to continuous time, where the gain is [1, sqrt(3)]: Kwakernaak and
 * Sivan, Linear Optimal Control Systems, 1972. Errors of first and second order in the interval are
 * taken out by extrapolation. */
START_TEST(the_double_integrator_has_its_gain) {
  double t[3][2];
  for (int i = 0; i < 3; i++) {
    double_integrator(4e-3 / (1 << i), t[i]);
  }
  for (int k = 0; k < 2; k++) {
    double first = 2.0 * t[1][k] - t[0][k], second = 2.0 * t[2][k] - t[1][k];
    ck_assert_double_eq_tol((4.0 * second - first) / 3.0, k == 0 ? 1.0 : sqrt(3.0), 1e-8);
  }
}
END_TEST

static double uniform(unsigned *seed) {
  *seed = *seed * 1664525u + 1013904223u;
  return (*seed >> 8) / (double)(1u << 23) - 1.0;
}

enum { N = 4 };

/* (a' x (a - b gain) + q - x) of the largest number in x: x = a' x (a - b k) + q. */
static double residual(const double *a, const double *b, const double *q, const double *x,
                       const double *gain) {
  double worst = 0.0, size = 0.0;
  for (int i = 0; i < N; i++) {
    for (int j = 0; j < N; j++) {
      double sum = q[i * N + j] - x[i * N + j];
      for (int k = 0; k < N; k++) {
        for (int l = 0; l < N; l++) {
          sum += a[k * N + i] * x[k * N + l] * (a[l * N + j] - b[l] * gain[j]);
        }
      }
      worst = fmax(worst, fabs(sum));
      size = fmax(size, fabs(x[i * N + j]));
    }
  }
  return worst / size;
}

START_TEST(random_systems_meet_their_equation) {
  unsigned seed = 17u + (unsigned)_i;
  double a[N * N], b[N], q[N * N] = {0}, r = 0.1, x[N * N], gain[N], closed[N * N], value[N][2];
  for (int i = 0; i < N * N; i++) {
    a[i] = _i % 2 == 0 || i >= N ? 1.2 * uniform(&seed) : 0.0; /* every second one is singular */
  }
  for (int i = 0; i < N; i++) {
    b[i] = uniform(&seed);
    q[i * N + i] = 1.0 + uniform(&seed);
  }
  struct riccati_problem problem = {N, 1, a, b, q, &r};
  ck_assert_int_eq(riccati_solve(&problem, x, gain, NULL), STATUS_OK);
  ck_assert_double_lt(residual(a, b, q, x, gain), 1e-11);
  for (int i = 0; i < N; i++) {
    for (int k = 0; k < N; k++) {
      closed[i * N + k] = a[i * N + k] - b[i] * gain[k];
    }
  }
  ck_assert_int_eq(riccati_eigenvalues(N, closed, value, NULL), STATUS_OK);
  for (int i = 0; i < N; i++) {
    ck_assert_double_lt(hypot(value[i][0], value[i][1]), 1.0);
  }
}
END_TEST

int main(void) {
  Suite *suite = suite_create("physics: Riccati equation");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, scalar_equations_have_closed_forms);
  tcase_add_test(tcase, the_double_integrator_has_its_gain);
  tcase_add_loop_test(tcase, random_systems_meet_their_equation, 0, 20);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
