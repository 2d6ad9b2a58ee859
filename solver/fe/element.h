/* The 27-node hexahedron with a discontinuous linear pressure field (Q2/P1).
 *
 * Potential of one element, with the isochoric energy W and p = sum_m p_m phi_m:
 *   Pi = int W(F) + p (J - 1) - p^2 / (2 kappa) dV
 * The pressures p_m are unknowns of their own; they are condensed from the linear system of
 * every Newton step and recovered linearly afterwards (Simo, Taylor, Pister 1985). */
#ifndef PNEULAB_FE_ELEMENT_H
#define PNEULAB_FE_ELEMENT_H

#include "solver/fe/hex27.h"
#include "solver/fe/hyperelastic.h"

enum {
  ELEMENT_DOFS = 3 * HEX27_NODES,                        /* 81, index 27 i + a */
  ELEMENT_PRESSURES = 4,                                 /* 1, x, y, z */
  ELEMENT_PACKED = ELEMENT_DOFS * (ELEMENT_DOFS + 1) / 2 /* upper triangle by rows */
};

/* Reference geometry at the Gauss points; rows over the points are padded with zeros. */
struct element_geometry {
  const struct hex27_tables *tables;                       /* those it was filled with */
  double weight[HEX27_STRIDE];                             /* m3 */
  double phi[ELEMENT_PRESSURES][HEX27_STRIDE];             /* pressure basis */
  double inverse[9][HEX27_STRIDE];                         /* d xi_d / d X_J, index 3 d + J, 1/m */
  double projection[ELEMENT_PRESSURES][ELEMENT_PRESSURES]; /* (int phi_m phi_n dV)^-1, 1/m3 */
};

/* What the recovery of the pressures needs from the last evaluation. */
struct element_internal {
  double coupling[ELEMENT_PRESSURES][ELEMENT_DOFS];     /* d r_m / d u */
  double inverse[ELEMENT_PRESSURES][ELEMENT_PRESSURES]; /* (d r_m / d p_n)^-1 */
  double residual[ELEMENT_PRESSURES];                   /* r_m */
};

/* Kelvin-Voigt damping: adds S = stiffness (C - history) to the second Piola-Kirchhoff stress, C =
 * F^T F. With the history an average of earlier C and the stiffness a viscosity over a time, that
 * is viscosity times dC/dt: no rigid motion, however far, changes C, and the potential stiffness/4
 * |C - history|^2 leaves the tangent symmetric. */
struct element_viscosity {
  double stiffness;                /* Pa */
  double history[6][HEX27_STRIDE]; /* 00 01 02 11 12 22, at the Gauss points, padded with zeros */
};

/* Fills the geometry from the nodes x[27][3] (m). Returns the volume in m3, or a value <= 0
 * when the map is not invertible at a Gauss point. The tables must outlive the geometry. */
double element_geometry_fill(const struct hex27_tables *tables, double x[HEX27_NODES][3],
                             struct element_geometry *geometry);

/* Residual (27 i + a, N) with the pressures condensed and, when packed is not NULL, the
 * condensed tangent (upper triangle by rows, N/m). u[3][HEX27_STRIDE] in m, padded with zeros;
 * p[4] in Pa. `internal` is renewed: all of it with the tangent, else only the residual part,
 * the rest being that of the last tangent, which the condensation then uses.
 * Returns false when det F <= 0.02 at a Gauss point: nothing is then valid. */
bool element_evaluate(const struct element_geometry *geometry, const struct material_spec *material,
                      double bulk_modulus, double u[3][HEX27_STRIDE],
                      const double p[ELEMENT_PRESSURES], double residual[ELEMENT_DOFS],
                      double *packed, struct element_internal *internal);

/* The same of a body with damping; viscosity may be NULL. */
bool element_evaluate_damped(const struct element_geometry *geometry,
                             const struct material_spec *material, double bulk_modulus,
                             const struct element_viscosity *viscosity, double u[3][HEX27_STRIDE],
                             const double p[ELEMENT_PRESSURES], double residual[ELEMENT_DOFS],
                             double *packed, struct element_internal *internal);

/* Change of the pressures that belongs to the displacement step du[81]:
 * dp = -(dr/dp)^-1 (r + dr/du du). `share` scales r (1 for a full Newton step). */
void element_recover(const struct element_internal *internal, const double du[ELEMENT_DOFS],
                     double share, double dp[ELEMENT_PRESSURES]);

/* Deformation gradient at Gauss point q. */
void element_gradient(const struct element_geometry *geometry, int q, double u[3][HEX27_STRIDE],
                      double f[9]);

#endif
