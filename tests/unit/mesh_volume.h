/* Volumes of meshes, for tests against geometry by hand. */
#ifndef PNEULAB_TESTS_UNIT_MESH_VOLUME_H
#define PNEULAB_TESTS_UNIT_MESH_VOLUME_H

#include "solver/mesh/mesh.h"

/* Volume inside the cavity faces, m3. */
double mesh_cavity_volume(const struct mesh *mesh);

/* Volume of all elements, m3. Fails the test when one is not invertible at a Gauss point. */
double mesh_solid_volume(const struct mesh *mesh);

#endif
