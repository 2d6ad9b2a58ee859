#include "solver/explore/likelihood.h"

#include <gsl/gsl_cblas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multimin.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/explore/random.h"

enum { STARTS = 4, ITERATIONS_MAX = 80, REFINEMENTS_MAX = 20 };

static const double length_low = 0.02, length_high = 50.0, noise_low = 1e-5, noise_high = 1.0;

/* ---- one covariance ----------------------------------------------------------------------- */

/* Lower triangle of the covariance of the points, by rows. */
static void assemble(const struct covariance *c, const double *x, int count, int parameters,
                     double *matrix) {
  double variance = c->deviation * c->deviation, noise = c->noise * c->noise;
  for (int j = 0; j < count; j++) {
    for (int i = j; i < count; i++) {
      matrix[(size_t)i * (size_t)count + (size_t)j] =
          variance * covariance_correlation(c, x + (size_t)i * (size_t)parameters,
                                            x + (size_t)j * (size_t)parameters, parameters, NULL);
    }
    matrix[(size_t)j * (size_t)count + (size_t)j] += noise;
  }
}

bool likelihood_solve(const struct covariance *covariance, const double *x, const double *y,
                      int count, int parameters, double *factor, double *weights, double *mean,
                      double *log_likelihood) {
  double all = 0.0, of_y = 0.0, misfit = 0.0, logarithm = 0.0;
  double *ones = malloc((size_t)count * sizeof *ones);
  assemble(covariance, x, count, parameters, factor);
  gsl_matrix_view matrix = gsl_matrix_view_array(factor, (size_t)count, (size_t)count);
  if (!ones || gsl_linalg_cholesky_decomp1(&matrix.matrix) != GSL_SUCCESS) {
    free(ones);
    return false;
  }
  gsl_vector_view one = gsl_vector_view_array(ones, (size_t)count);
  gsl_vector_view solved = gsl_vector_view_array(weights, (size_t)count);
  gsl_vector_set_all(&one.vector, 1.0);
  memcpy(weights, y, (size_t)count * sizeof *weights);
  gsl_linalg_cholesky_svx(&matrix.matrix, &one.vector);
  gsl_linalg_cholesky_svx(&matrix.matrix, &solved.vector);
  for (int i = 0; i < count; i++) {
    all += ones[i];
    of_y += weights[i];
    logarithm += log(factor[(size_t)i * (size_t)count + (size_t)i]);
  }
  *mean = of_y / all;
  for (int i = 0; i < count; i++) {
    weights[i] -= *mean * ones[i];
    misfit += (y[i] - *mean) * weights[i];
  }
  *log_likelihood = -0.5 * misfit - logarithm - 0.5 * count * log(2.0 * M_PI);
  free(ones);
  return isfinite(*log_likelihood);
}

double likelihood_predict(const struct covariance *covariance, const double *x, int count,
                          int parameters, const double *factor, const double *weights,
                          const double *point, double *variance) {
  double own = covariance->deviation * covariance->deviation, value = 0.0;
  double *cross = variance ? malloc((size_t)count * sizeof *cross) : NULL;
  if (!variance) {
    for (int i = 0; i < count; i++) {
      value += weights[i] * covariance_correlation(covariance, x + (size_t)i * (size_t)parameters,
                                                   point, parameters, NULL);
    }
    return own * value;
  }
  if (!cross) {
    *variance = NAN;
    return NAN;
  }
  for (int i = 0; i < count; i++) {
    cross[i] = own * covariance_correlation(covariance, x + (size_t)i * (size_t)parameters, point,
                                            parameters, NULL);
    value += cross[i] * weights[i];
  }
  cblas_dtrsv(CblasRowMajor, CblasLower, CblasNoTrans, CblasNonUnit, count, factor, count, cross,
              1);
  *variance = own - cblas_ddot(count, cross, 1, cross, 1);
  free(cross);
  return value;
}

void likelihood_inverse_diagonal(const double *factor, int count, double *diagonal) {
  /* Column j of the inverse of the factor has its squares in diagonal entry j of the product. */
  size_t n = (size_t)count;
  double *inverse = malloc(n * n * sizeof *inverse);
  for (int j = 0; j < count; j++) {
    diagonal[j] = NAN;
  }
  if (inverse) {
    memcpy(inverse, factor, n * n * sizeof *inverse);
    gsl_matrix_view matrix = gsl_matrix_view_array(inverse, n, n);
    gsl_linalg_tri_invert(CblasLower, CblasNonUnit, &matrix.matrix);
    for (int j = 0; j < count; j++) {
      const double *column = inverse + (size_t)j * n + (size_t)j;
      diagonal[j] = cblas_ddot(count - j, column, count, column, count);
    }
  }
  free(inverse);
}

/* ---- the search --------------------------------------------------------------------------- */

/* Unknowns: logarithms of the lengths, then that of noise over deviation. */
struct search {
  const double *x, *y;
  int count, parameters;
  double *matrix, *weights; /* room for the covariance and its solution */
};

static struct covariance unpack(const struct search *s, const gsl_vector *at) {
  struct covariance c = {.deviation = 1.0};
  for (int k = 0; k < s->parameters; k++) {
    c.length[k] = exp(gsl_vector_get(at, (size_t)k));
  }
  c.noise = exp(gsl_vector_get(at, (size_t)s->parameters));
  return c;
}

/* Grows with the square of the distance from the allowed range; *slope is added to. */
static double penalty(double value, double low, double high, double *slope) {
  double beyond = value < low ? value - low : value > high ? value - high : 0.0;
  *slope += 200.0 * beyond;
  return 100.0 * beyond * beyond;
}

static double add_penalties(const struct search *s, const gsl_vector *at, gsl_vector *slope) {
  double sum = 0.0;
  for (int k = 0; k <= s->parameters; k++) {
    bool noise = k == s->parameters;
    double own = 0.0;
    sum += penalty(gsl_vector_get(at, (size_t)k), log(noise ? noise_low : length_low),
                   log(noise ? noise_high : length_high), &own);
    if (slope) {
      gsl_vector_set(slope, (size_t)k, gsl_vector_get(slope, (size_t)k) + own);
    }
  }
  return sum;
}

/* Minus the logarithm of the likelihood with the best mean and deviation; *variance of the latter.
 * Leaves the factor and the weights of unit deviation. GSL_NAN where there is none. */
static double profile(const struct search *s, const gsl_vector *at, double *variance) {
  struct covariance c = unpack(s, at);
  double mean, ignored;
  for (int k = 0; k <= s->parameters; k++) {
    if (fabs(gsl_vector_get(at, (size_t)k)) > 30.0) {
      return GSL_NAN;
    }
  }
  if (!likelihood_solve(&c, s->x, s->y, s->count, s->parameters, s->matrix, s->weights, &mean,
                        &ignored)) {
    return GSL_NAN;
  }
  double misfit = 0.0, logarithm = 0.0;
  for (int i = 0; i < s->count; i++) {
    misfit += (s->y[i] - mean) * s->weights[i];
    logarithm += log(s->matrix[(size_t)i * (size_t)s->count + (size_t)i]);
  }
  *variance = fmax(misfit / s->count, 1e-30);
  return 0.5 * s->count * log(*variance) + logarithm;
}

static double value_at(const gsl_vector *at, void *context) {
  const struct search *s = context;
  double variance;
  return profile(s, at, &variance) + add_penalties(s, at, NULL);
}

/* d/d theta = 1/2 trace(C^-1 dC) - 1/2 w' dC w / variance (eq. 5.9). */
static void value_and_slope(const gsl_vector *at, void *context, double *value, gsl_vector *slope) {
  const struct search *s = context;
  struct covariance c = unpack(s, at);
  double variance, sum[SURROGATE_PARAMETERS_MAX + 1] = {0.0};
  size_t n = (size_t)s->count;
  *value = profile(s, at, &variance) + add_penalties(s, at, NULL);
  gsl_vector_set_zero(slope);
  if (!isfinite(*value)) {
    return;
  }
  gsl_matrix_view matrix = gsl_matrix_view_array(s->matrix, n, n);
  gsl_linalg_cholesky_invert(&matrix.matrix);
  for (size_t j = 0; j < n; j++) {
    for (size_t i = j; i < n; i++) {
      const double *x = s->x + i * (size_t)s->parameters, *y = s->x + j * (size_t)s->parameters;
      double twice = i == j ? 1.0 : 2.0, rate;
      double part = 0.5 * twice * (s->matrix[i * n + j] - s->weights[i] * s->weights[j] / variance);
      covariance_correlation(&c, x, y, s->parameters, &rate);
      for (int k = 0; k < s->parameters; k++) {
        double d = (x[k] - y[k]) / c.length[k];
        sum[k] += part * rate * d * d;
      }
      sum[s->parameters] += i == j ? part * 2.0 * c.noise * c.noise : 0.0;
    }
  }
  for (int k = 0; k <= s->parameters; k++) {
    gsl_vector_set(slope, (size_t)k, sum[k]);
  }
  add_penalties(s, at, slope);
}

static void slope_at(const gsl_vector *at, void *context, gsl_vector *slope) {
  double value;
  value_and_slope(at, context, &value, slope);
}

/* One search; `at` is where it starts and where it ends. Returns its value there. */
static double descend(struct search *s, gsl_vector *at, int iterations) {
  gsl_multimin_function_fdf function = {
      .f = value_at, .df = slope_at, .fdf = value_and_slope, .n = at->size, .params = s};
  gsl_multimin_fdfminimizer *minimizer =
      gsl_multimin_fdfminimizer_alloc(gsl_multimin_fdfminimizer_vector_bfgs2, at->size);
  double value = value_at(at, s);
  if (!minimizer || !isfinite(value)) {
    gsl_multimin_fdfminimizer_free(minimizer);
    return GSL_POSINF;
  }
  gsl_multimin_fdfminimizer_set(minimizer, &function, at, 0.3, 0.1);
  for (int i = 0; i < iterations; i++) {
    if (gsl_multimin_fdfminimizer_iterate(minimizer) != GSL_SUCCESS ||
        gsl_multimin_test_gradient(minimizer->gradient, 1e-3) == GSL_SUCCESS) {
      break;
    }
  }
  if (isfinite(minimizer->f) && minimizer->f <= value) {
    value = minimizer->f;
    gsl_vector_memcpy(at, minimizer->x);
  }
  gsl_multimin_fdfminimizer_free(minimizer);
  return value;
}

static bool open_search(struct search *s, gsl_vector **at) {
  size_t n = (size_t)s->count;
  *at = gsl_vector_alloc((size_t)s->parameters + 1);
  s->matrix = malloc(n * n * sizeof *s->matrix);
  s->weights = malloc(n * sizeof *s->weights);
  return *at && s->matrix && s->weights;
}

static void close_search(struct search *s, gsl_vector *at) {
  gsl_vector_free(at);
  free(s->matrix);
  free(s->weights);
}

/* The covariance at a place of the search, if there is one. */
static bool take_covariance(struct search *s, const gsl_vector *at, struct covariance *covariance) {
  double variance = 1.0;
  if (!isfinite(profile(s, at, &variance))) {
    return false;
  }
  *covariance = unpack(s, at);
  covariance->deviation = sqrt(variance);
  covariance->noise *= covariance->deviation;
  return true;
}

enum status likelihood_maximise(const double *x, const double *y, int count, int parameters,
                                uint64_t random, struct covariance *covariance,
                                struct error *error) {
  struct search s = {.x = x, .y = y, .count = count, .parameters = parameters};
  gsl_vector *at;
  double least = GSL_POSINF;
  if (!open_search(&s, &at)) {
    close_search(&s, at);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a surrogate");
  }
  for (int start = 0; start < STARTS; start++) {
    for (int k = 0; k < parameters; k++) {
      gsl_vector_set(at, (size_t)k, log(start == 0 ? 1.0 : 0.2 + 3.0 * random_uniform(&random)));
    }
    gsl_vector_set(at, (size_t)parameters, log(start % 2 == 0 ? 1e-3 : 1e-1));
    double value = descend(&s, at, ITERATIONS_MAX);
    if (value < least && take_covariance(&s, at, covariance)) {
      least = value;
    }
  }
  close_search(&s, at);
  return isfinite(least) ? STATUS_OK
                         : error_set(error, STATUS_DIVERGED, NULL,
                                     "no lengths give a covariance that can be factored");
}

enum status likelihood_refine(const double *x, const double *y, int count, int parameters,
                              struct covariance *covariance, struct error *error) {
  struct search s = {.x = x, .y = y, .count = count, .parameters = parameters};
  gsl_vector *at;
  if (!open_search(&s, &at)) {
    close_search(&s, at);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a surrogate");
  }
  for (int k = 0; k < parameters; k++) {
    gsl_vector_set(at, (size_t)k, log(covariance->length[k]));
  }
  gsl_vector_set(at, (size_t)parameters, log(covariance->noise / covariance->deviation));
  bool found = isfinite(descend(&s, at, REFINEMENTS_MAX)) && take_covariance(&s, at, covariance);
  close_search(&s, at);
  return found ? STATUS_OK
               : error_set(error, STATUS_DIVERGED, NULL,
                           "these lengths give a covariance that cannot be factored");
}
