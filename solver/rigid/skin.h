/* Shapes as triangles, for pictures and files. */
#ifndef PNEULAB_RIGID_SKIN_H
#define PNEULAB_RIGID_SKIN_H

#include "solver/rigid/shape.h"

struct rigid_skin {
  int vertex_count, triangle_count;
  double *vertex; /* 3 numbers each, m, in the shape's frame; owned */
  int *triangle;  /* 3 vertices each, counter-clockwise seen from outside; owned */
};

/* Triangles of the shape, their vertices on the surface; a closed surface but for a plane, of which
 * they are the square from -extent to extent (m) about the origin. tolerance: how far, in m, they
 * may be from the surface, as long as no circle takes more than 360 parts or fewer than 12; a
 * surface of triangles gives its own, whatever the tolerance. The caller releases *skin.
 * STATUS_NO_MEMORY. */
enum status rigid_shape_skin(const struct rigid_shape *shape, double tolerance, double extent,
                             struct rigid_skin *skin, struct error *error);
void rigid_skin_release(struct rigid_skin *skin);

#endif
