#include "solver/material/regression.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <math.h>
#include <string.h>

#include "solver/base/clock.h"

enum { ITERATIONS_MAX = 400, CHANGES_MAX = 60 };

/* The problem in scaled numbers: residuals and moduli in units of `scale`, so that tolerances mean
 * the same for gels and rubbers. */
struct problem {
  const struct fit_spec *fit;
  const struct tensile_curve *curve;
  const struct regression_control *control;
  struct error *error;
  double scale;                         /* Pa: largest stress of the curve */
  double x[FIT_COEFFICIENTS_MAX];       /* all coefficients, scaled */
  int hold[FIT_COEFFICIENTS_MAX];       /* -1: at its lower bound, 1: upper, 2: held, 0: free */
  int free_index[FIT_COEFFICIENTS_MAX]; /* of the coefficients that are being fitted */
  int free_count;
  int iterations;
};

static double scale_of(const struct problem *p, int index) {
  return fit_coefficient_is_exponent(p->fit, index) ? 1.0 : p->scale;
}

static double lower_of(const struct problem *p, int index) {
  return p->fit->lower[index] / scale_of(p, index);
}

static double upper_of(const struct problem *p, int index) {
  return p->fit->upper[index] / scale_of(p, index);
}

static void count_free(struct problem *p) {
  p->free_count = 0;
  for (int i = 0; i < p->fit->count; i++) {
    if (p->hold[i] == 0) {
      p->free_index[p->free_count++] = i;
    }
  }
}

/* The law with the coefficients x; those of `free_x` replace the free ones unless it is NULL. */
static struct material_spec law_at(const struct problem *p, const gsl_vector *free_x) {
  struct material_spec material = {.model = p->fit->model, .terms = p->fit->terms};
  double x[FIT_COEFFICIENTS_MAX];
  memcpy(x, p->x, sizeof x);
  for (int k = 0; free_x && k < p->free_count; k++) {
    x[p->free_index[k]] = gsl_vector_get(free_x, (size_t)k);
  }
  law_set(&material, x);
  return material;
}

/* ---- residual and Jacobian -------------------------------------------------------------- */

static int evaluate(const gsl_vector *free_x, void *context, gsl_vector *residual) {
  const struct problem *p = context;
  struct material_spec material = law_at(p, free_x);
  for (size_t i = 0; i < p->curve->count; i++) {
    double stress = law_stress(&material, DEFORMATION_UNIAXIAL, 1.0 + p->curve->strain[i], NULL);
    if (!isfinite(stress)) {
      return GSL_EDOM;
    }
    gsl_vector_set(residual, i, stress - p->curve->stress[i] / p->scale);
  }
  return GSL_SUCCESS;
}

static int differentiate(const gsl_vector *free_x, void *context, gsl_matrix *jacobian) {
  const struct problem *p = context;
  struct material_spec material = law_at(p, free_x);
  for (size_t i = 0; i < p->curve->count; i++) {
    double gradient[FIT_COEFFICIENTS_MAX];
    law_stress(&material, DEFORMATION_UNIAXIAL, 1.0 + p->curve->strain[i], gradient);
    for (int k = 0; k < p->free_count; k++) {
      if (!isfinite(gradient[p->free_index[k]])) {
        return GSL_EDOM;
      }
      gsl_matrix_set(jacobian, i, (size_t)k, gradient[p->free_index[k]]);
    }
  }
  return GSL_SUCCESS;
}

static double sum_of_squares(const struct problem *p) {
  struct material_spec material = law_at(p, NULL);
  double sum = 0.0;
  for (size_t i = 0; i < p->curve->count; i++) {
    double r = law_stress(&material, DEFORMATION_UNIAXIAL, 1.0 + p->curve->strain[i], NULL) -
               p->curve->stress[i] / p->scale;
    sum += r * r;
  }
  return sum;
}

/* Half the derivative of the sum of squares to one coefficient. */
static double slope_of(const struct problem *p, int index) {
  struct material_spec material = law_at(p, NULL);
  double sum = 0.0, gradient[FIT_COEFFICIENTS_MAX];
  for (size_t i = 0; i < p->curve->count; i++) {
    double r = law_stress(&material, DEFORMATION_UNIAXIAL, 1.0 + p->curve->strain[i], gradient) -
               p->curve->stress[i] / p->scale;
    sum += r * gradient[index];
  }
  return sum;
}

/* ---- the unconstrained problem ---------------------------------------------------------- */

static enum status check_limits(const struct problem *p) {
  if (p->control->cancelled && p->control->cancelled(NULL)) {
    return error_set(p->error, STATUS_CANCELLED, NULL, "the fit was cancelled");
  }
  if (p->control->deadline_s > 0.0 && clock_wall_s() > p->control->deadline_s) {
    return error_set(p->error, STATUS_TIMEOUT, NULL, "the fit took longer than its time limit");
  }
  return STATUS_OK;
}

static enum status iterate(struct problem *p, gsl_multifit_nlinear_workspace *work) {
  for (int i = 0; i < ITERATIONS_MAX; i++) {
    enum status status = check_limits(p);
    if (status != STATUS_OK) {
      return status;
    }
    int code = gsl_multifit_nlinear_iterate(work), info = 0;
    p->iterations++;
    int test = gsl_multifit_nlinear_test(1e-12, 1e-13, 0.0, &info, work);
    if (test == GSL_SUCCESS) {
      return STATUS_OK;
    }
    /* No step lowers the sum: at a minimum to round-off, or stuck. */
    if (code == GSL_ENOPROG) {
      test = gsl_multifit_nlinear_test(1e-7, 1e-8, 0.0, &info, work);
      return test == GSL_SUCCESS ? STATUS_OK : STATUS_DIVERGED;
    }
    if (code != GSL_SUCCESS) {
      return STATUS_DIVERGED;
    }
  }
  return STATUS_DIVERGED;
}

/* Fits the free coefficients from where they are, without regard to bounds, into `found` (all
 * coefficients, scaled). */
static enum status solve_free(struct problem *p, double *found) {
  size_t n = p->curve->count, k = (size_t)p->free_count;
  memcpy(found, p->x, sizeof p->x);
  if (k == 0) {
    return STATUS_OK;
  }
  gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
  gsl_multifit_nlinear_fdf fdf = {
      .f = evaluate, .df = differentiate, .fvv = NULL, .n = n, .p = k, .params = p};
  gsl_multifit_nlinear_workspace *work =
      gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, n, k);
  double start[FIT_COEFFICIENTS_MAX];
  if (!work) {
    return error_set(p->error, STATUS_NO_MEMORY, NULL, "no memory for a fit");
  }
  for (size_t i = 0; i < k; i++) {
    start[i] = p->x[p->free_index[i]];
  }
  gsl_vector_const_view view = gsl_vector_const_view_array(start, k);
  enum status status = gsl_multifit_nlinear_init(&view.vector, &fdf, work) == GSL_SUCCESS
                           ? iterate(p, work)
                           : STATUS_DIVERGED;
  for (size_t i = 0; i < k; i++) {
    double value = gsl_vector_get(work->x, i);
    found[p->free_index[i]] = isfinite(value) ? value : start[i];
  }
  gsl_multifit_nlinear_free(work);
  return status;
}

/* ---- bounds ----------------------------------------------------------------------------- */

/* Goes from x towards `found` as far as the bounds allow. Returns the coefficient that stopped it,
 * now held at its bound, or -1. */
static int advance(struct problem *p, const double *found) {
  double part = 1.0;
  int stop = -1;
  for (int k = 0; k < p->free_count; k++) {
    int i = p->free_index[k];
    double step = found[i] - p->x[i];
    double limit = step > 0.0 ? upper_of(p, i) : lower_of(p, i);
    bool beyond = step > 0.0 ? found[i] > limit : found[i] < limit;
    if (beyond && (limit - p->x[i]) / step < part) {
      part = (limit - p->x[i]) / step;
      stop = i;
    }
  }
  for (int k = 0; k < p->free_count; k++) {
    int i = p->free_index[k];
    p->x[i] += part * (found[i] - p->x[i]);
  }
  if (stop >= 0) {
    bool up = found[stop] > p->x[stop];
    p->hold[stop] = up ? 1 : -1;
    p->x[stop] = up ? upper_of(p, stop) : lower_of(p, stop);
  }
  return stop;
}

/* The coefficient held at a bound that the sum of squares would leave most eagerly, or -1. */
static int eager_one(const struct problem *p) {
  int best = -1;
  double most = 1e-12;
  for (int i = 0; i < p->fit->count; i++) {
    if (p->hold[i] == 1 || p->hold[i] == -1) {
      double inward = p->hold[i] * slope_of(p, i);
      if (inward > most) {
        most = inward;
        best = i;
      }
    }
  }
  return best;
}

/* Minimises within the bounds from x, which lies within them. */
static enum status solve_bounded(struct problem *p) {
  double found[FIT_COEFFICIENTS_MAX];
  for (int change = 0; change < CHANGES_MAX; change++) {
    count_free(p);
    enum status status = solve_free(p, found);
    if (status != STATUS_OK) {
      return status;
    }
    if (advance(p, found) >= 0) {
      continue;
    }
    int leaving = eager_one(p);
    if (leaving < 0) {
      return STATUS_OK;
    }
    p->hold[leaving] = 0;
  }
  return STATUS_DIVERGED;
}

/* ---- starts ----------------------------------------------------------------------------- */

/* Exponents that Ogden fits are started from: rubbers stiffen at two to ten, and a negative one
 * takes the part of I2. */
static const double ogden_starts[3][5][3] = {
    {{2.0}, {1.0}, {4.0}, {-2.0}, {8.0}},
    {{1.5, 5.0}, {2.0, -2.0}, {1.0, 3.0}, {2.0, 8.0}, {-1.0, 4.0}},
    {{1.3, 5.0, -2.0}, {1.0, 3.0, 7.0}, {2.0, 4.0, -2.0}, {1.5, 8.0, -1.0}, {2.0, 6.0, -4.0}},
};

static double clip(double value, double low, double high) {
  return fmin(fmax(value, low), high);
}

/* A start within the bounds; for an Ogden law the moduli that fit best with these exponents. */
static enum status set_start(struct problem *p, int number) {
  bool ogden = p->fit->model == MATERIAL_OGDEN;
  memset(p->hold, 0, sizeof p->hold);
  for (int i = 0; i < p->fit->count; i++) {
    bool exponent = fit_coefficient_is_exponent(p->fit, i);
    double value = exponent ? ogden_starts[p->fit->terms - 1][number][i - p->fit->terms]
                   : i == 0 ? 0.3
                            : 0.0;
    p->x[i] = clip(value, lower_of(p, i), upper_of(p, i));
    if (exponent && p->x[i] == 0.0) {
      p->x[i] = upper_of(p, i) > 0.0 ? fmin(1e-3, upper_of(p, i)) : fmax(-1e-3, lower_of(p, i));
    }
    p->hold[i] = exponent ? 2 : 0;
  }
  enum status status = ogden ? solve_bounded(p) : STATUS_OK;
  for (int i = 0; i < p->fit->count; i++) {
    p->hold[i] = p->hold[i] == 2 ? 0 : p->hold[i];
  }
  return status;
}

/* Keeps the best of several starts in x and hold. */
static enum status solve_starts(struct problem *p) {
  int starts = p->fit->model == MATERIAL_OGDEN ? 5 : 1;
  struct problem best = *p;
  double least = INFINITY;
  enum status ending = STATUS_DIVERGED;
  for (int s = 0; s < starts; s++) {
    enum status status = set_start(p, s);
    if (status == STATUS_OK) {
      status = solve_bounded(p);
    }
    double sum = sum_of_squares(p);
    bool better = isfinite(sum) && (status == STATUS_OK) >= (ending == STATUS_OK) &&
                  (sum < least || (status == STATUS_OK) > (ending == STATUS_OK));
    if (better) {
      best = *p;
      least = sum;
      ending = status;
    }
    if (status != STATUS_OK && status != STATUS_DIVERGED) {
      ending = status;
      break;
    }
  }
  best.iterations = p->iterations;
  *p = best;
  return ending;
}

/* ---- what the fit is worth -------------------------------------------------------------- */

/* Condition number of the Jacobian with columns of length 1; scales the columns. */
static double condition_of(gsl_matrix *jacobian) {
  size_t k = jacobian->size2;
  double v[FIT_COEFFICIENTS_MAX * FIT_COEFFICIENTS_MAX], s[FIT_COEFFICIENTS_MAX],
      w[FIT_COEFFICIENTS_MAX];
  gsl_matrix_view v_view = gsl_matrix_view_array(v, k, k);
  gsl_vector_view s_view = gsl_vector_view_array(s, k), w_view = gsl_vector_view_array(w, k);
  for (size_t j = 0; j < k; j++) {
    gsl_vector_view column = gsl_matrix_column(jacobian, j);
    double length = gsl_blas_dnrm2(&column.vector);
    if (!(length > 0.0)) {
      return INFINITY;
    }
    gsl_vector_scale(&column.vector, 1.0 / length);
  }
  gsl_linalg_SV_decomp(jacobian, &v_view.matrix, &s_view.vector, &w_view.vector);
  return s[k - 1] > 0.0 ? s[0] / s[k - 1] : INFINITY;
}

static enum status judge(const struct problem *p, struct regression *result) {
  size_t n = p->curve->count, k = (size_t)p->free_count;
  double sum = sum_of_squares(p), mean = 0.0, about = 0.0;
  for (size_t i = 0; i < n; i++) {
    mean += p->curve->stress[i] / (double)n;
  }
  for (size_t i = 0; i < n; i++) {
    about += pow((p->curve->stress[i] - mean) / p->scale, 2);
  }
  result->rmse = p->scale * sqrt(sum / (double)n);
  result->r_squared = about > 0.0 ? 1.0 - sum / about : NAN;
  result->student = gsl_cdf_tdist_Pinv(0.975, (double)(n - k));
  result->condition = 1.0;
  if (k == 0) {
    return STATUS_OK;
  }
  double inverse[FIT_COEFFICIENTS_MAX * FIT_COEFFICIENTS_MAX], x[FIT_COEFFICIENTS_MAX];
  gsl_matrix_view inverse_view = gsl_matrix_view_array(inverse, k, k);
  gsl_matrix *jacobian = gsl_matrix_alloc(n, k);
  if (!jacobian) {
    return error_set(p->error, STATUS_NO_MEMORY, NULL, "no memory for a fit");
  }
  for (size_t i = 0; i < k; i++) {
    x[i] = p->x[p->free_index[i]];
  }
  gsl_vector_const_view x_view = gsl_vector_const_view_array(x, k);
  if (differentiate(&x_view.vector, (void *)p, jacobian) == GSL_SUCCESS &&
      gsl_multifit_nlinear_covar(jacobian, 0.0, &inverse_view.matrix) == GSL_SUCCESS) {
    double variance = sum / (double)(n - k);
    for (size_t i = 0; i < k; i++) {
      for (size_t j = 0; j < k; j++) {
        int a = p->free_index[i], b = p->free_index[j];
        result->covariance[a * FIT_COEFFICIENTS_MAX + b] =
            variance * inverse[i * k + j] * scale_of(p, a) * scale_of(p, b);
      }
    }
    result->condition = condition_of(jacobian);
  }
  gsl_matrix_free(jacobian);
  return STATUS_OK;
}

enum status regression_fit(const struct fit_spec *fit, const struct tensile_curve *curve,
                           const struct regression_control *control, struct regression *result,
                           struct error *error) {
  struct problem p = {.fit = fit, .curve = curve, .control = control, .error = error};
  *result = (struct regression){.count = fit->count};
  for (size_t i = 0; i < curve->count; i++) {
    p.scale = fmax(p.scale, fabs(curve->stress[i]));
  }
  p.scale = p.scale > 0.0 ? p.scale : 1.0;
  /* The library's own handler would end the program. */
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  enum status status = solve_starts(&p);
  if (status == STATUS_DIVERGED) {
    error_set(error, status, NULL,
              "the fit does not settle: a law of %d coefficients may be too much for this curve; "
              "fewer terms, a wider range or bounds can help",
              fit->count);
  }
  for (int i = 0; i < fit->count; i++) {
    result->coefficient[i] = p.x[i] * scale_of(&p, i);
    result->at_bound[i] = p.hold[i] != 0;
  }
  result->material = (struct material_spec){.model = fit->model,
                                            .terms = fit->terms,
                                            .density_kg_m3 = fit->density_kg_m3,
                                            .bulk_ratio = fit->bulk_ratio};
  law_set(&result->material, result->coefficient);
  result->iterations = p.iterations;
  count_free(&p);
  enum status judged = judge(&p, result);
  gsl_set_error_handler(handler);
  double modulus = material_shear_modulus(&result->material);
  if (judged != STATUS_OK) {
    return judged;
  }
  if (status == STATUS_OK && !(modulus >= 1.0)) {
    status = error_set(error, STATUS_UNSTABLE, NULL,
                       "the fitted law has an initial shear modulus of %.4g MPa, which no material "
                       "can have: bounds or another range can help",
                       1e-6 * modulus);
  }
  return status;
}

double regression_half_width(const struct regression *result, int index) {
  return result->student * sqrt(result->covariance[index * FIT_COEFFICIENTS_MAX + index]);
}

double regression_band(const struct regression *result, double stretch) {
  double gradient[FIT_COEFFICIENTS_MAX], variance = 0.0;
  law_stress(&result->material, DEFORMATION_UNIAXIAL, stretch, gradient);
  for (int i = 0; i < result->count; i++) {
    for (int j = 0; j < result->count; j++) {
      variance += gradient[i] * result->covariance[i * FIT_COEFFICIENTS_MAX + j] * gradient[j];
    }
  }
  return result->student * sqrt(fmax(variance, 0.0));
}
