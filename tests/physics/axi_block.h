/* Rectangular meshes of bodies of revolution for tests. */
#ifndef PNEULAB_TESTS_PHYSICS_AXI_BLOCK_H
#define PNEULAB_TESTS_PHYSICS_AXI_BLOCK_H

#include "solver/axi/mesh.h"

/* Rectangle of columns x rows elements; node (i, j), counted along r first, is number
 * (2 columns + 1) j + i. */
struct block {
  double r[2], z[2];
  int columns, rows;
  bool ring; /* 3 x 3 without the middle one, which is the cavity; else the pressure acts on the
              * outer side, which counts as the cavity's */
};

/* Nothing is held; the regions' materials are left to the caller. */
void block_mesh(const struct block *block, struct axi_mesh *mesh);

/* Neo-Hooke of Young's modulus and Poisson's ratio. */
struct material_spec block_elastic(double modulus, double poisson);

#endif
