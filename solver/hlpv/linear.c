#include "solver/hlpv/linear.h"

#include <gsl/gsl_linalg.h>
#include <string.h>

enum { N = HLPV_STATES, ROWS = HLPV_STATES + 1 };

/* exp(matrix), row by row. */
static void exponential(double *matrix, double *result) {
  gsl_matrix_view from = gsl_matrix_view_array(matrix, ROWS, ROWS);
  gsl_matrix_view to = gsl_matrix_view_array(result, ROWS, ROWS);
  gsl_linalg_exponential_ss(&from.matrix, &to.matrix, GSL_PREC_DOUBLE);
}

/* The motion's matrix times the interval, with `last` in the place of what does not depend on the
 * state. */
static void fill(const struct hlpv_spec *spec, int mode, double set_point, double interval,
                 const double last[N], double matrix[ROWS * ROWS]) {
  const struct hlpv_mode *m = &spec->mode[mode];
  memset(matrix, 0, ROWS * ROWS * sizeof *matrix);
  matrix[HLPV_H * ROWS + HLPV_VELOCITY] = interval;
  double *row = matrix + HLPV_VELOCITY * ROWS;
  row[HLPV_H] = -interval * hlpv_polynomial_value(&m->stiffness, set_point) / spec->mass;
  row[HLPV_VELOCITY] = -interval * hlpv_polynomial_value(&m->damping, set_point) / spec->mass;
  row[HLPV_PRESSURE] = interval * spec->gamma / spec->mass;
  matrix[HLPV_PRESSURE * ROWS + HLPV_PRESSURE] =
      interval * hlpv_polynomial_value(&m->alpha, set_point);
  for (int i = 0; i < N; i++) {
    matrix[i * ROWS + N] = interval * last[i];
  }
}

void linear_step(const struct hlpv_spec *spec, int mode, double set_point, double interval,
                 double step[N][ROWS]) {
  const double nothing[N] = {0};
  double matrix[ROWS * ROWS], result[ROWS * ROWS], last[N];
  hlpv_derivative(spec, mode, set_point, nothing, last);
  fill(spec, mode, set_point, interval, last, matrix);
  exponential(matrix, result);
  memcpy(step, result, sizeof(double[N][ROWS]));
}

void linear_apply(double step[N][ROWS], const double x[N], double after[N]) {
  double sum[N];
  for (int i = 0; i < N; i++) {
    sum[i] = step[i][N];
    for (int k = 0; k < N; k++) {
      sum[i] += step[i][k] * x[k];
    }
  }
  memcpy(after, sum, sizeof sum);
}

bool linear_rest(const struct hlpv_spec *spec, int mode, double set_point, double x[N]) {
  const struct hlpv_mode *m = &spec->mode[mode];
  double k = hlpv_polynomial_value(&m->stiffness, set_point);
  double b = hlpv_polynomial_value(&m->damping, set_point);
  double alpha = hlpv_polynomial_value(&m->alpha, set_point);
  if (!(k > 0.0 && b >= 0.0 && alpha < 0.0)) {
    return false;
  }
  x[HLPV_PRESSURE] = -hlpv_polynomial_value(&m->beta, set_point) * set_point / alpha;
  x[HLPV_H] = m->rest + spec->gamma * x[HLPV_PRESSURE] / k;
  x[HLPV_VELOCITY] = 0.0;
  return true;
}

/* d/du of a polynomial. */
static double slope(const struct hlpv_polynomial *polynomial, double set_point) {
  double u = set_point / polynomial->per, value = 0.0;
  for (int i = polynomial->count - 1; i >= 1; i--) {
    value = value * u + i * polynomial->c[i];
  }
  return value / polynomial->per;
}

bool linear_sampled(const struct hlpv_spec *spec, int mode, double set_point, double interval,
                    double a[N][N], double b[N]) {
  const struct hlpv_mode *m = &spec->mode[mode];
  double x[N], matrix[ROWS * ROWS], result[ROWS * ROWS];
  if (!linear_rest(spec, mode, set_point, x)) {
    return false;
  }
  const double last[N] = {[HLPV_VELOCITY] =
                              -slope(&m->stiffness, set_point) * (x[HLPV_H] - m->rest) / spec->mass,
                          [HLPV_PRESSURE] = slope(&m->alpha, set_point) * x[HLPV_PRESSURE] +
                                            slope(&m->beta, set_point) * set_point +
                                            hlpv_polynomial_value(&m->beta, set_point)};
  fill(spec, mode, set_point, interval, last, matrix);
  exponential(matrix, result);
  for (int i = 0; i < N; i++) {
    memcpy(a[i], result + i * ROWS, sizeof a[i]);
    b[i] = result[i * ROWS + N];
  }
  return true;
}
