/* Closest-point projection onto a master face; shared by the parts of the contact. */
#ifndef PNEULAB_FE_CONTACT_PROJECTION_H
#define PNEULAB_FE_CONTACT_PROJECTION_H

#include "solver/fe/hex27.h"

struct projection {
  double n[QUAD9_NODES], dn[2][QUAD9_NODES];
  double tangent[2][3];
  double distance[3];     /* slave point - master point */
  double curvature[3][3]; /* second derivatives of the master point: ss, tt, st */
  double c11, c12, c22;   /* Hessian of |distance|^2 / 2 in the parent coordinates */
};

/* Newton iteration for the point of a master face (node positions, m) closest to `slave`, started
 * at xi, which receives its parent coordinates. False when it does not converge, which happens
 * far from the face. */
bool projection_find(double master[QUAD9_NODES][3], const double slave[3], double xi[2],
                     struct projection *projection);

/* Unit normal out of the body at the projected point; side is that of the face. Returns the gap
 * along it, m. */
double projection_gap(const struct projection *projection, int side, double normal[3]);

#endif
