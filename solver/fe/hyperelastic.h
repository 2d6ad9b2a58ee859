/* Isochoric part of the hyperelastic laws: stress and tangent in terms of the deformation
 * gradient F. Second-order tensors are 3 x 3 row-major, index 3 i + J; the tangent is 9 x 9. */
#ifndef PNEULAB_FE_HYPERELASTIC_H
#define PNEULAB_FE_HYPERELASTIC_H

#include "solver/job/spec.h"

/* Kinematics shared by the volumetric and the isochoric part. */
struct kinematics {
  double f[9];
  double cofactor[9]; /* F^-T, index 3 i + J */
  double j;           /* det F */
};

/* Fills F^-T and J from kinematics->f; returns J. */
double kinematics_complete(struct kinematics *k);

/* First Piola-Kirchhoff stress stress[9] = dW_iso/dF and, unless NULL, tangent[81] =
 * d2W_iso/dF2, both in Pa. Returns the energy density W_iso in J/m3. Needs k->j > 0.
 * Invariant-based laws: Yeoh (1993); Mooney (1940); Ogden (1972) in principal axes. */
double hyperelastic_isochoric(const struct material_spec *material, const struct kinematics *k,
                              double stress[9], double *tangent);

/* Eigenvalues (descending) and eigenvectors (columns of v, row-major) of a symmetric 3 x 3
 * matrix c by cyclic Jacobi rotations. */
void symmetric3_eigen(const double c[9], double value[3], double v[9]);

/* The largest eigenvalue alone, in closed form (Smith 1961): right to 1e-8 of the spread of the
 * three. */
double symmetric3_largest(const double c[9]);

#endif
