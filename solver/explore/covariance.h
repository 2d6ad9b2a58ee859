/* Covariance of a Gaussian process of Matern's class with nu = 5/2 (Rasmussen and Williams 2006,
 * eq. 4.17), with a length for each parameter. */
#ifndef PNEULAB_EXPLORE_COVARIANCE_H
#define PNEULAB_EXPLORE_COVARIANCE_H

#include "solver/explore/surrogate.h"

struct covariance {
  double deviation; /* of the process */
  double length[SURROGATE_PARAMETERS_MAX];
  double noise; /* standard deviation of what is added to each value */
};

/* Correlation (1 + a + a^2/3) exp(-a), a^2 = 5 sum ((x_k - y_k) / length_k)^2. *slope, unless NULL:
 * 5/3 (1 + a) exp(-a), which times ((x_k - y_k) / length_k)^2 is its derivative to the logarithm
 * of length_k. */
double covariance_correlation(const struct covariance *covariance, const double *x, const double *y,
                              int parameters, double *slope);

#endif
