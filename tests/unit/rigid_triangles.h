/* Triangles of rigid shapes as an STL file would have them. */
#ifndef PNEULAB_TESTS_UNIT_RIGID_TRIANGLES_H
#define PNEULAB_TESTS_UNIT_RIGID_TRIANGLES_H

#include "solver/rigid/shape.h"
#include "solver/rigid/stl.h"

/* The skin of a shape to `tolerance` (m), in mm. Released with stl_release. */
struct stl triangles_of(const struct rigid_shape *shape, double tolerance);

/* The same of an icosahedron whose triangles are divided `levels` times into four, its vertices on
 * a ball about the origin: triangles of nearly equal sides. */
struct stl triangles_of_ball(double diameter, int levels);

/* Multiplies the coordinates so that they are rounded to single precision, as in a file. */
void triangles_round(struct stl *stl);

#endif
