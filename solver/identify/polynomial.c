#include "solver/identify/polynomial.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_multifit.h>
#include <math.h>
#include <string.h>

#include "solver/identify/estimate.h"

/* Points with their covariance decomposed, L L^T. */
struct samples {
  size_t count;
  double u[STEP_POINTS_MAX];
  gsl_vector *y; /* L^-1 of the values */
  gsl_matrix *l;
};

static enum status no_memory(struct error *error) {
  return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a polynomial");
}

/* ---- the points --------------------------------------------------------------------------- */

static double covariance_of(const struct identification *id, size_t a, size_t b,
                            enum identify_coefficient coefficient) {
  const struct group *group = estimate_group(id, a);
  if (b < group->first || b >= group->first + group->count) {
    return 0.0;
  }
  return group->covariance[id->estimate[a].place[coefficient] * (size_t)group->parameters +
                           id->estimate[b].place[coefficient]];
}

static bool decompose(struct samples *s) {
  return gsl_linalg_cholesky_decomp1(s->l) == GSL_SUCCESS &&
         gsl_blas_dtrsv(CblasLower, CblasNoTrans, CblasNonUnit, s->l, s->y) == GSL_SUCCESS;
}

/* Gathers what can be used. A covariance that is not definite to the last digit loses what is
 * beside its diagonal. */
static enum status gather(const struct identification *id, int mode,
                          enum identify_coefficient coefficient, struct samples *s,
                          struct error *error) {
  size_t place[STEP_POINTS_MAX];
  for (size_t i = 0; i < id->point_count; i++) {
    if (id->point[i].mode == mode && isfinite(id->estimate[i].stderror[coefficient]) &&
        id->estimate[i].stderror[coefficient] > 0.0) {
      s->u[s->count] = id->point[i].set_point;
      place[s->count++] = i;
    }
  }
  if (s->count == 0) {
    return STATUS_OK;
  }
  s->y = gsl_vector_alloc(s->count);
  s->l = gsl_matrix_alloc(s->count, s->count);
  if (!s->y || !s->l) {
    return no_memory(error);
  }
  for (int whole = 1; whole >= 0; whole--) {
    for (size_t i = 0; i < s->count; i++) {
      gsl_vector_set(s->y, i, id->estimate[place[i]].value[coefficient]);
      for (size_t j = 0; j < s->count; j++) {
        double v = i == j || whole ? covariance_of(id, place[i], place[j], coefficient) : 0.0;
        gsl_matrix_set(s->l, i, j, v);
      }
    }
    if (decompose(s)) {
      break;
    }
  }
  return STATUS_OK;
}

/* ---- one degree --------------------------------------------------------------------------- */

static enum status fit_degree(const struct samples *s, int degree, struct polynomial_fit *fit,
                              struct error *error) {
  size_t n = s->count, terms = (size_t)degree + 1;
  gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(n, terms);
  gsl_matrix *x = gsl_matrix_alloc(n, terms), *covariance = gsl_matrix_alloc(terms, terms);
  gsl_vector *c = gsl_vector_alloc(terms), *one = gsl_vector_alloc(n);
  enum status status = STATUS_OK;
  if (!work || !x || !covariance || !c || !one) {
    status = no_memory(error);
    goto done;
  }
  gsl_vector_set_all(one, 1.0);
  for (size_t j = 0; j < terms; j++) {
    gsl_vector_view column = gsl_matrix_column(x, j);
    for (size_t i = 0; i < n; i++) {
      gsl_vector_set(&column.vector, i, gsl_pow_int(s->u[i] / fit->value.per, (int)j));
    }
    gsl_blas_dtrsv(CblasLower, CblasNoTrans, CblasNonUnit, s->l, &column.vector);
  }
  gsl_multifit_wlinear(x, one, s->y, c, covariance, &fit->chi_square, work);
  fit->value.count = (int)terms;
  for (size_t i = 0; i < terms; i++) {
    fit->value.c[i] = gsl_vector_get(c, i);
    for (size_t j = 0; j < terms; j++) {
      fit->covariance[i * HLPV_TERMS_MAX + j] = gsl_matrix_get(covariance, i, j);
    }
  }
  double left = (double)(n - terms);
  fit->chance = left > 0.0 ? gsl_cdf_chisq_Q(fit->chi_square, left) : 1.0;
done:
  gsl_multifit_linear_free(work);
  gsl_matrix_free(x);
  gsl_matrix_free(covariance);
  gsl_vector_free(c);
  gsl_vector_free(one);
  return status;
}

static double criterion(const struct polynomial_fit *fit, double points) {
  double k = fit->value.count, left = points - k - 1.0;
  return fit->chi_square + 2.0 * k + (left > 0.0 ? 2.0 * k * (k + 1.0) / left : INFINITY);
}

static enum status choose_degree(const struct samples *s, struct polynomial_fit *fit,
                                 struct error *error) {
  double least = INFINITY;
  int found = 0;
  for (int degree = 0; degree < HLPV_TERMS_MAX && (size_t)degree + 2 < s->count; degree++) {
    enum status status = fit_degree(s, degree, fit, error);
    double now = status == STATUS_OK ? criterion(fit, (double)s->count) : 0.0;
    if (status != STATUS_OK) {
      return status;
    }
    if (now < least) {
      least = now;
      found = degree;
    }
  }
  return fit_degree(s, found, fit, error);
}

enum status polynomial_fit_mode(const struct identification *id, int mode,
                                enum identify_coefficient coefficient, struct polynomial_fit *fit,
                                struct error *error) {
  int degree = id->spec->degree[coefficient];
  struct samples s = {.count = 0};
  *fit = (struct polynomial_fit){.value = {.per = id->spec->per}, .freedom = INFINITY};
  enum status status = gather(id, mode, coefficient, &s, error);
  fit->points = (int)s.count;
  for (size_t i = 0; i < id->point_count; i++) {
    if (id->point[i].mode == mode) {
      fit->freedom = fmin(fit->freedom, estimate_group(id, i)->freedom);
    }
  }
  if (status == STATUS_OK && s.count > 0) {
    degree = degree < fit->points ? degree : fit->points - 1;
    status = degree == IDENTIFY_DEGREE_AUTO ? choose_degree(&s, fit, error)
                                            : fit_degree(&s, degree, fit, error);
  }
  gsl_vector_free(s.y);
  gsl_matrix_free(s.l);
  return status;
}

double polynomial_stderror(const struct polynomial_fit *fit, double set_point) {
  double u = set_point / fit->value.per, variance = 0.0;
  for (int i = 0; i < fit->value.count; i++) {
    for (int j = 0; j < fit->value.count; j++) {
      variance += fit->covariance[i * HLPV_TERMS_MAX + j] * gsl_pow_int(u, i + j);
    }
  }
  return sqrt(fmax(variance, 0.0));
}
