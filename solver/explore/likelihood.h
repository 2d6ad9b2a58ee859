/* Inside of the surrogate: the likelihood of a covariance, and what follows from its factor. */
#ifndef PNEULAB_EXPLORE_LIKELIHOOD_H
#define PNEULAB_EXPLORE_LIKELIHOOD_H

#include <stdbool.h>
#include "solver/explore/covariance.h"

/* The covariance that makes y[count] at x[count][parameters] most likely, mean and deviation
 * eliminated (Rasmussen and Williams 2006, eq. 2.30 and 5.9), by BFGS from several starts drawn
 * from `random`. Lengths are held near 0.02 to 50, noise near 1e-5 to 1 of the deviation.
 * STATUS_DIVERGED, STATUS_NO_MEMORY. */
enum status likelihood_maximise(const double *x, const double *y, int count, int parameters,
                                uint64_t random, struct covariance *covariance,
                                struct error *error);

/* The same by one search of a few steps that starts from *covariance, as it was found from fewer
 * points. STATUS_DIVERGED where no covariance can be factored there, STATUS_NO_MEMORY; then
 * *covariance is as it was. */
enum status likelihood_refine(const double *x, const double *y, int count, int parameters,
                              struct covariance *covariance, struct error *error);

/* Factors the covariance of the points: factor[count][count], its Cholesky factor, lower, by
 * rows; weights[count] = covariance^-1 (y - mean); *mean by generalised least squares; the
 * logarithm of the likelihood. false where it is not positive definite. */
bool likelihood_solve(const struct covariance *covariance, const double *x, const double *y,
                      int count, int parameters, double *factor, double *weights, double *mean,
                      double *log_likelihood);

/* What is expected above the mean at point[parameters], and, unless NULL, its variance. NAN without
 * memory. */
double likelihood_predict(const struct covariance *covariance, const double *x, int count,
                          int parameters, const double *factor, const double *weights,
                          const double *point, double *variance);

/* Diagonal of the inverse of the covariance from its factor. */
void likelihood_inverse_diagonal(const double *factor, int count, double *diagonal);

#endif
