/* The box with rounded edges and corners: a smaller box with a margin around it. */
#ifndef PNEULAB_RIGID_BOX_H
#define PNEULAB_RIGID_BOX_H

#include "solver/rigid/shape.h"

struct rounded_box {
  double core[3]; /* half edges of the smaller box, m */
  double edge;    /* the margin: radius of edges and corners, m */
};

/* As rigid_shape_nearest. */
bool box_nearest(const struct rounded_box *box, const double x[3], double reach,
                 struct rigid_nearest *nearest);

/* Volume and inertia in closed form. */
void box_mass(const struct rounded_box *box, struct rigid_mass *mass);

#endif
