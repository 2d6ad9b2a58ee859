/* Nine-node quadrilateral of a body of revolution, Q2/P1: displacements (u_r, u_z) biquadratic in
 * the parent square, pressure linear in (r, z), discontinuous and condensed.
 *
 * Deformation gradient in the cylindrical basis, index 3 i + J with 0 = r, 1 = theta, 2 = z:
 *   F_rr = 1 + u_r,r   F_rz = u_r,z   F_zr = u_z,r   F_zz = 1 + u_z,z   F_tt = 1 + u_r / r
 * and F_rt = F_tr = F_zt = F_tz = 0. The energy is
 *   W(u) = sum_g w_g (W_iso(F_g) + k/2 (J_g - 1)^2) + (kappa - k)/2 b . M^-1 b,
 *   b_i = sum_g w_g psi_i (J_g - 1),   M_ij = sum_g w_g psi_i psi_j,   w_g = 2 pi r dA,
 *   psi = (1, (r - r_c)/l, (z - z_c)/l),
 * so that the pressure k (J - 1) + sum_i psi_i ((kappa - k) M^-1 b)_i holds the projection of J - 1
 * onto the linear functions (Sussman, Bathe 1987), and residual and tangent are exact derivatives.
 * The share k of the bulk modulus that acts on J at the points, AXI_LOCAL_BULK shear moduli, does
 * not lock, but keeps J near 1 everywhere in the folds of a surface, where with the projection
 * alone elements collapse. The Gauss points are inside: an element may have nodes on the axis r =
 * 0, whose u_r is held. */
#ifndef PNEULAB_AXI_ELEMENT_H
#define PNEULAB_AXI_ELEMENT_H

#include <stdbool.h>
#include "solver/axi/mesh.h"

enum {
  AXI_POINTS = 9,           /* 3 x 3 Gauss points */
  AXI_LOCAL_BULK = 30,      /* in shear moduli */
  AXI_DOFS = 2 * AXI_NODES, /* 2 a + i, i = 0 for u_r, 1 for u_z */
  AXI_PACKED = AXI_DOFS * (AXI_DOFS + 1) / 2,
  AXI_EDGE_DOFS = 2 * AXI_EDGE_NODES,
  AXI_EDGE_PACKED = AXI_EDGE_DOFS * (AXI_EDGE_DOFS + 1) / 2,
  AXI_EDGE_POINTS = 3 /* Gauss points of an edge */
};

/* What a Gauss point of the undeformed element is. */
struct axi_point {
  double radius, height;               /* r, z in m */
  double weight;                       /* 2 pi r dA, m3 */
  double n[AXI_NODES];                 /* N_a */
  double dr[AXI_NODES], dz[AXI_NODES]; /* N_a,r and N_a,z, 1/m */
  double psi[3];                       /* functions of the pressure */
};

struct axi_geometry {
  struct axi_point point[AXI_POINTS];
  double inverse[9]; /* M^-1, row-major, 1/m3 */
};

/* Biquadratic functions n[a] and derivatives d[0][a], d[1][a] at (xi, eta), -1 to 1, in the node
 * order of struct axi_element. */
void axi_shape(double xi, double eta, double n[AXI_NODES], double d[2][AXI_NODES]);

/* From the node positions x[a] = (r, z). False when the element is turned inside out or a Gauss
 * point is not at r > 0. */
bool axi_geometry_init(double x[AXI_NODES][2], struct axi_geometry *geometry);

/* Bulk modulus kappa = bulk_ratio x initial shear modulus, Pa. */
double axi_bulk_modulus(const struct material_spec *material);

/* Its two parts, Pa: k on J at the points, and kappa - k on the projection. */
struct axi_bulk {
  double local, projected;
};

struct axi_bulk axi_bulk_parts(const struct material_spec *material);

/* Energy *energy (J), residual[2 a + i] = dW/du (N) and, unless NULL, tangent = d2W/du2, the upper
 * triangle by rows (N/m), at the displacements u[2 a + i]. False when J <= 0 at a Gauss point:
 * nothing is then written. */
bool axi_element_evaluate(const struct axi_geometry *geometry, const struct material_spec *material,
                          const double u[AXI_DOFS], double *energy, double residual[AXI_DOFS],
                          double *tangent);

/* F at a Gauss point. Returns J. */
double axi_deformation(const struct axi_point *point, const double u[AXI_DOFS], double f[9]);

/* Parameters of the projected pressure, (kappa - k) M^-1 b in Pa (positive in tension): the
 * pressure at a point is k (J - 1) + sum psi_i pressure[i]. */
void axi_element_pressure(const struct axi_geometry *geometry, const struct material_spec *material,
                          const double u[AXI_DOFS], double pressure[3]);

/* Share of an edge in the volume of the cavity on its right: minus the integral of pi r^2 dz from
 * start to end, at the current node positions x[a] = (r, z); exact. gradient[2 a + i] = dV/dx in m2
 * and, unless NULL, second = d2V/dx2, the upper triangle by rows, in m. Returns m3. The sum over a
 * contour is a volume when it closes, or ends in planes z = const or on the axis. */
double axi_edge_volume(double x[AXI_EDGE_NODES][2], double gradient[AXI_EDGE_DOFS],
                       double second[AXI_EDGE_PACKED]);

#endif
