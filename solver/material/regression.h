/* Least-squares fit of a hyperelastic law to a uniaxial curve, by GSL's trust region. */
#ifndef PNEULAB_MATERIAL_REGRESSION_H
#define PNEULAB_MATERIAL_REGRESSION_H

#include <stdbool.h>
#include "solver/job/tensile.h"
#include "solver/material/law.h"

/* When to stop. */
struct regression_control {
  double deadline_s; /* wall clock, 0: none */
  bool (*cancelled)(void *context);
};

struct regression {
  struct material_spec material;            /* the law with its coefficients */
  int count;                                /* coefficients */
  double coefficient[FIT_COEFFICIENTS_MAX]; /* as fit_spec numbers them */
  bool at_bound[FIT_COEFFICIENTS_MAX];      /* held at a bound of the job */
  /* Covariance of the coefficients, row by row: residual variance times the inverse of J^T J of the
   * free ones; 0 for those at a bound. */
  double covariance[FIT_COEFFICIENTS_MAX * FIT_COEFFICIENTS_MAX];
  double student;   /* 97.5 % quantile of Student's t with points - free coefficients degrees */
  double rmse;      /* Pa, over the points */
  double r_squared; /* 1 - sum of squares of the residuals / that about the mean */
  double condition; /* of J with its columns scaled to length 1; free coefficients only */
  int iterations;
};

/* Minimises the sum of the squares of engineering stress less the law's, within the bounds of
 * `fit`: an active set of bounds around the unconstrained method. Laws that are linear in their
 * coefficients have one minimum; Ogden laws are started from several sets of exponents and the best
 * result counts.
 * Returns STATUS_OK; STATUS_DIVERGED when no start converges, UNSTABLE when the initial shear
 * modulus of the best fit is not positive, TIMEOUT, CANCELLED: *error says why and *result holds
 * the best so far; or STATUS_NO_MEMORY. */
enum status regression_fit(const struct fit_spec *fit, const struct tensile_curve *curve,
                           const struct regression_control *control, struct regression *result,
                           struct error *error);

/* Half width of the 95 % confidence interval of a coefficient: student * standard error. */
double regression_half_width(const struct regression *result, int index);

/* Half width in Pa of the 95 % confidence band of the fitted engineering stress at a stretch. */
double regression_band(const struct regression *result, double stretch);

#endif
