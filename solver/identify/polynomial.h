/* Polynomials of the set-point through the estimates of points, by generalised least squares (GSL)
 * with the covariance of the estimates. */
#ifndef PNEULAB_IDENTIFY_POLYNOMIAL_H
#define PNEULAB_IDENTIFY_POLYNOMIAL_H

#include "solver/identify/identification.h"

struct polynomial_fit {
  int points; /* 0: none of the mode's points shows the coefficient */
  struct hlpv_polynomial value;
  double covariance[HLPV_TERMS_MAX * HLPV_TERMS_MAX]; /* of its coefficients */
  double freedom;    /* of the residuals behind the points, for Student's distribution */
  double chi_square; /* of the points about it, with points - count degrees of freedom */
  double chance;     /* of a larger chi-square if the degree is right; 1 without freedom */
};

/* Through the points of a mode that show the coefficient. The degree is the job's, or less where
 * points are few, or that with the least corrected Akaike information criterion (Hurvich and Tsai,
 * Biometrika 76, 1989). STATUS_NO_MEMORY. */
enum status polynomial_fit_mode(const struct identification *id, int mode,
                                enum identify_coefficient coefficient, struct polynomial_fit *fit,
                                struct error *error);

/* Standard error of the polynomial's value at a set-point. */
double polynomial_stderror(const struct polynomial_fit *fit, double set_point);

#endif
