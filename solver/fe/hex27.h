/* Shape functions and quadrature of the 27-node hexahedron and its 9-node faces.
 * Node order as in mesh/mesh.h; the parent coordinates run from -1 to 1. */
#ifndef PNEULAB_FE_HEX27_H
#define PNEULAB_FE_HEX27_H

#include "solver/mesh/mesh.h"

enum {
  HEX27_POINTS = 27, /* 3 x 3 x 3 Gauss points */
  HEX27_STRIDE =
      32, /* row length of arrays over nodes or points, padded with zeros for the vector units */
  QUAD9_POINTS = 9 /* 3 x 3 Gauss points */
};

struct hex27_tables {
  double point[HEX27_POINTS][3];
  double weight[HEX27_POINTS];
  double dn[HEX27_POINTS][3][HEX27_NODES]; /* d N_a / d xi_d at the Gauss points */
  /* The same, padded with zeros. */
  double by_point[HEX27_POINTS][3][HEX27_STRIDE]; /* point, direction, node */
  double by_node[HEX27_NODES][3][HEX27_STRIDE];   /* node, direction, point */
};

struct quad9_tables {
  double point[QUAD9_POINTS][2];
  double weight[QUAD9_POINTS];
  double n[QUAD9_POINTS][QUAD9_NODES];
  double dn[QUAD9_POINTS][2][QUAD9_NODES];
};

/* Triquadratic Lagrange functions n[a] and, unless dn is NULL, derivatives dn[d][a] at xi. */
void hex27_shape(const double xi[3], double n[HEX27_NODES], double dn[3][HEX27_NODES]);

/* Biquadratic functions n[m], first derivatives dn[2][m] and, unless NULL, second derivatives
 * d2n[0] = ss, d2n[1] = tt, d2n[2] = st at (s, t); m = 3 a + b, a along s. */
void quad9_shape(double s, double t, double n[QUAD9_NODES], double dn[2][QUAD9_NODES],
                 double d2n[3][QUAD9_NODES]);

void hex27_tables_fill(struct hex27_tables *tables);
void quad9_tables_fill(struct quad9_tables *tables);

#endif
