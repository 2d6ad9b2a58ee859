#include "solver/explore/surrogate.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/explore/covariance.h"
#include "solver/explore/likelihood.h"
#include "solver/explore/random.h"

struct surrogate {
  int count, parameters;
  double low[SURROGATE_PARAMETERS_MAX], range[SURROGATE_PARAMETERS_MAX];
  double middle, spread; /* of y: all below is of (y - middle) / spread */
  struct covariance covariance;
  double *x;       /* count x parameters, each in its range as 0 to 1 */
  double *y;       /* count */
  double *factor;  /* Cholesky factor of the covariance of the points, lower, by rows */
  double *weights; /* its solution for y - mean */
  double mean;     /* of the scaled y */
  struct surrogate_fit fit;
};

/* ---- preparation -------------------------------------------------------------------------- */

static enum status check_input(const double *x, const double *y, int count, int parameters,
                               struct error *error) {
  if (parameters < 1 || parameters > SURROGATE_PARAMETERS_MAX || count > SURROGATE_POINTS_MAX) {
    return error_set(error, STATUS_TOO_LARGE, NULL,
                     "a surrogate takes up to %d parameters and %d points, not %d and %d",
                     SURROGATE_PARAMETERS_MAX, SURROGATE_POINTS_MAX, parameters, count);
  }
  if (count < 4) {
    return error_set(error, STATUS_INVALID, NULL, "a surrogate takes at least 4 points, not %d",
                     count);
  }
  for (int i = 0; i < count; i++) {
    bool finite = isfinite(y[i]);
    for (int k = 0; k < parameters; k++) {
      finite = finite && isfinite(x[i * parameters + k]);
    }
    if (!finite) {
      return error_set(error, STATUS_INVALID, NULL, "point %d has a value that is not finite", i);
    }
  }
  return STATUS_OK;
}

static void scale_points(struct surrogate *s, const double *x) {
  for (int k = 0; k < s->parameters; k++) {
    double low = x[k], high = x[k];
    for (int i = 1; i < s->count; i++) {
      low = fmin(low, x[i * s->parameters + k]);
      high = fmax(high, x[i * s->parameters + k]);
    }
    s->low[k] = low;
    s->range[k] = high > low ? high - low : 1.0;
    for (int i = 0; i < s->count; i++) {
      s->x[i * s->parameters + k] = (x[i * s->parameters + k] - low) / s->range[k];
    }
  }
}

static void scale_values(struct surrogate *s, const double *y) {
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < s->count; i++) {
    sum += y[i];
  }
  s->middle = sum / s->count;
  for (int i = 0; i < s->count; i++) {
    squares += (y[i] - s->middle) * (y[i] - s->middle);
  }
  s->spread = sqrt(squares / s->count);
  s->spread = s->spread > 0.0 ? s->spread : 1.0;
  for (int i = 0; i < s->count; i++) {
    s->y[i] = (y[i] - s->middle) / s->spread;
  }
}

/* ---- fitting ------------------------------------------------------------------------------ */

/* The lengths: where to search is found from SURROGATE_START_MAX points, the rest from
 * SURROGATE_FIT_MAX at most, all drawn at random. */
static enum status find_covariance(struct surrogate *s, uint64_t seed, struct error *error) {
  int used = s->count < SURROGATE_FIT_MAX ? s->count : SURROGATE_FIT_MAX;
  size_t width = (size_t)s->parameters;
  uint64_t random = random_mix(seed);
  int *order = malloc((size_t)s->count * sizeof *order);
  double *x = malloc((size_t)used * width * sizeof *x), *y = malloc((size_t)used * sizeof *y);
  enum status status = STATUS_OK;
  if (!order || !x || !y) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a surrogate");
    goto done;
  }
  random_permutation(&random, s->count, order);
  for (int i = 0; i < used; i++) {
    int from = s->count > SURROGATE_START_MAX ? order[i] : i;
    memcpy(x + (size_t)i * width, s->x + (size_t)from * width, width * sizeof *x);
    y[i] = s->y[from];
  }
  int first = used < SURROGATE_START_MAX ? used : SURROGATE_START_MAX;
  status = likelihood_maximise(x, y, first, s->parameters, random, &s->covariance, error);
  if (status == STATUS_OK && first < used) {
    status = likelihood_refine(x, y, used, s->parameters, &s->covariance, error);
  }
done:
  free(order);
  free(x);
  free(y);
  return status;
}

static void measure_fit(struct surrogate *s, const double *value, const double *deviation) {
  struct surrogate_fit *fit = &s->fit;
  double missed = 0.0, varied = 0.0;
  int within = 0;
  for (int i = 0; i < s->count; i++) {
    double y = s->middle + s->spread * s->y[i];
    missed += (y - value[i]) * (y - value[i]);
    varied += s->spread * s->spread * s->y[i] * s->y[i];
    within += fabs(y - value[i]) <= 1.96 * deviation[i];
  }
  fit->mean = s->middle + s->spread * s->mean;
  fit->deviation = s->spread * s->covariance.deviation;
  fit->noise = s->spread * s->covariance.noise;
  memcpy(fit->length, s->covariance.length, sizeof fit->length);
  fit->left_out_r2 = varied > 0.0 ? 1.0 - missed / varied : 0.0;
  fit->left_out_within = (double)within / s->count;
}

static enum status fit_all(struct surrogate *s, uint64_t seed, struct error *error) {
  enum status status = find_covariance(s, seed, error);
  if (status == STATUS_OK &&
      !likelihood_solve(&s->covariance, s->x, s->y, s->count, s->parameters, s->factor, s->weights,
                        &s->mean, &s->fit.log_likelihood)) {
    status =
        error_set(error, STATUS_DIVERGED, NULL, "the covariance of the points cannot be factored");
  }
  double *value = malloc(2 * (size_t)s->count * sizeof *value);
  if (status == STATUS_OK && !value) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a surrogate");
  }
  if (status == STATUS_OK) {
    surrogate_leave_one_out(s, value, value + s->count);
    measure_fit(s, value, value + s->count);
  }
  free(value);
  return status;
}

enum status surrogate_create(const double *x, const double *y, int count, int parameters,
                             uint64_t seed, struct surrogate **surrogate, struct error *error) {
  *surrogate = NULL;
  enum status status = check_input(x, y, count, parameters, error);
  struct surrogate *s = status == STATUS_OK ? calloc(1, sizeof *s) : NULL;
  if (status != STATUS_OK) {
    return status;
  }
  size_t n = (size_t)count;
  if (s) {
    s->count = count;
    s->parameters = parameters;
    s->x = malloc(n * (size_t)parameters * sizeof *s->x);
    s->y = malloc(n * sizeof *s->y);
    s->factor = malloc(n * n * sizeof *s->factor);
    s->weights = malloc(n * sizeof *s->weights);
  }
  if (!s || !s->x || !s->y || !s->factor || !s->weights) {
    surrogate_destroy(s);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a surrogate");
  }
  scale_points(s, x);
  scale_values(s, y);
  gsl_error_handler_t *handler = gsl_set_error_handler_off(); /* failures come back as codes */
  status = fit_all(s, seed, error);
  gsl_set_error_handler(handler);
  if (status != STATUS_OK) {
    surrogate_destroy(s);
    return status;
  }
  *surrogate = s;
  return STATUS_OK;
}

void surrogate_destroy(struct surrogate *surrogate) {
  if (surrogate) {
    free(surrogate->x);
    free(surrogate->y);
    free(surrogate->factor);
    free(surrogate->weights);
    free(surrogate);
  }
}

/* ---- use ---------------------------------------------------------------------------------- */

const struct surrogate_fit *surrogate_fit(const struct surrogate *surrogate) {
  return &surrogate->fit;
}

void surrogate_predict(const struct surrogate *s, const double x[], double *value,
                       double *deviation) {
  double scaled[SURROGATE_PARAMETERS_MAX], variance = 0.0;
  for (int k = 0; k < s->parameters; k++) {
    scaled[k] = (x[k] - s->low[k]) / s->range[k];
  }
  double known = likelihood_predict(&s->covariance, s->x, s->count, s->parameters, s->factor,
                                    s->weights, scaled, deviation ? &variance : NULL);
  *value = s->middle + s->spread * (s->mean + known);
  if (deviation) {
    *deviation = s->spread * sqrt(fmax(variance, 0.0));
  }
}

void surrogate_leave_one_out(const struct surrogate *s, double value[], double deviation[]) {
  likelihood_inverse_diagonal(s->factor, s->count, deviation);
  for (int i = 0; i < s->count; i++) {
    double own = deviation[i];
    value[i] = s->middle + s->spread * (s->y[i] - s->weights[i] / own);
    deviation[i] = s->spread / sqrt(own);
  }
}
