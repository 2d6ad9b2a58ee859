#include "solver/explore/covariance.h"

#include <math.h>

double covariance_correlation(const struct covariance *covariance, const double *x, const double *y,
                              int parameters, double *slope) {
  double squares = 0.0;
  for (int k = 0; k < parameters; k++) {
    double d = (x[k] - y[k]) / covariance->length[k];
    squares += d * d;
  }
  double a = sqrt(5.0 * squares), decay = exp(-a);
  if (slope) {
    *slope = 5.0 / 3.0 * (1.0 + a) * decay;
  }
  return (1.0 + a + a * a / 3.0) * decay;
}
