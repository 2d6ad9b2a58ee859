/* Hyperelastic laws of incompressible bodies in homogeneous deformation: stress, and its
 * derivatives to the coefficients. */
#ifndef PNEULAB_MATERIAL_LAW_H
#define PNEULAB_MATERIAL_LAW_H

#include "solver/job/spec.h"

/* Principal stretches (stretch, stretch^a, 1 / their product), the last free of stress. */
enum deformation {
  DEFORMATION_UNIAXIAL,    /* a = -1/2: stretched in one direction, free in the others */
  DEFORMATION_EQUIBIAXIAL, /* a = 1: stretched alike in two directions */
  DEFORMATION_PLANAR,      /* a = 0: stretched in one direction, held in the second */
  DEFORMATION_COUNT
};

/* "uniaxial", "equibiaxial", "planar". Static storage. */
const char *deformation_word(enum deformation deformation);

/* The three principal stretches. */
void deformation_stretches(enum deformation deformation, double stretch, double lambda[3]);

/* Coefficients as fit_spec numbers them, into the form of a job's material and back. */
void law_set(struct material_spec *material, const double *coefficient);
void law_get(const struct material_spec *material, double *coefficient);
/* Number of coefficients: moduli and exponents. */
int law_count(const struct material_spec *material);

/* Engineering stress in Pa in the direction of the stretch of an incompressible body that is free
 * of stress in its third direction:
 *   P = (t1 - t3) / lambda1 with t_i = lambda_i dW/dlambda_i.
 * Where `gradient` is not NULL it gets the derivatives to the coefficients (law_count of them). */
double law_stress(const struct material_spec *material, enum deformation deformation,
                  double stretch, double *gradient);

/* Second derivatives of the energy (Pa) to the logarithms of the first two stretches of an
 * incompressible body, whose third stretch follows: H = {d11, d12, d22}. They are the tangent of
 * the Cauchy stresses to the logarithmic strains of a sheet; where they are positive definite the
 * law fulfils Drucker's condition, dsigma : depsilon > 0. */
void law_tangent(const struct material_spec *material, const double lambda[3], double h[3]);

#endif
