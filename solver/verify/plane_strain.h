/* A second, independent program for plane strain: displacement elements with 9 nodes, neo-Hooke
 * with a choice of volumetric law, elimination within a band. It shares no code with the solver. */
#ifndef PNEULAB_VERIFY_PLANE_STRAIN_H
#define PNEULAB_VERIFY_PLANE_STRAIN_H

enum volumetric_law {
  LAW_SQUARE,   /* kappa/2 (J - 1)^2, that of the solver */
  LAW_LOGARITHM /* kappa/4 (J^2 - 1 - 2 ln J) */
};

/* Vertical displacement (mm) of the upper right corner of Cook's membrane, 48 x 44 x 16 mm, with
 * n x n elements; mu and kappa in MPa, a dead shear load of 1 N per mm of thickness. NaN when
 * memory runs out or the iteration does not converge. */
double plane_strain_cook(int n, double mu, double kappa, enum volumetric_law law);

#endif
