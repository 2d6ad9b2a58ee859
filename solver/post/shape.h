/* How the deformed actuator lies in space: angles, tip, midline, stretches. */
#ifndef PNEULAB_POST_SHAPE_H
#define PNEULAB_POST_SHAPE_H

#include "solver/fe/model.h"

struct shape {
  double bending_angle;  /* rad: turn of the bottom centreline from base to last chamber */
  double chord_angle;    /* rad: turn of the line from base to tip */
  double end_face_angle; /* rad: turn of the bottom layer's end face about y */
  double tip[3];         /* end of the bottom centreline, m */
};

/* Measures a state of a mesh with sections. Angles are positive towards -z and accumulate along
 * the body, so they pass 180 and 360 degrees; tapers of the undeformed body do not count. */
void shape_measure(const struct mesh *mesh, const double *u, struct shape *shape);

/* Bottom centreline: section_count points (m) into out[3 s + i]; u is NULL for the body at rest. */
void shape_midline(const struct mesh *mesh, const double *u, double *out);

/* Largest principal stretch of every node (mean over its elements of the value at the nearest
 * Gauss point) into node_stretch[node_count] unless NULL. Returns the largest over all Gauss
 * points, or a negative number when memory runs out. */
double shape_stretch(const struct fe_model *model, const double *u, double *node_stretch);

#endif
