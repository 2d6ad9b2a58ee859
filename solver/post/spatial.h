/* How the actuator lies in space when it bends and twists: angles from the rotations of its
 * sections.
 *
 * Between two stations the section turns by the rotation vector w, seen from the first station: w_x
 * is twist, w_y bending towards -z, w_z bending towards +y. Their sums along the body are the
 * integrals of the curvature vector of a rod (Antman 1995, ch. 8): they pass 180 and 360 degrees,
 * and a plane circle has no twist. The sum of |(w_y, w_z)| is the turn: bending in whatever plane.
 * The rotation of the end section alone is split into a twist about the body's axis followed by a
 * swing of that axis (swing-twist decomposition). */
#ifndef PNEULAB_POST_SPATIAL_H
#define PNEULAB_POST_SPATIAL_H

#include "solver/mesh/mesh.h"

struct spatial {
  double bending, side_bending, twist; /* rad, accumulated along the body */
  double turn;        /* rad, accumulated: bending in whatever plane, the total curvature */
  double end_bending; /* rad, 0 to pi: angle between the axes of base and end section */
  double end_twist;   /* rad: twist of the end section, plus the whole turns nearest to `twist` */
  double reach;       /* distance from the base to the tip, bottom centreline, m */
  double contraction; /* 1 - reach / that of the undeformed body */
};

/* Measures displacements u (node_count x 3, m) of a mesh with sections. In a half model twist and
 * side bending are zero. STATUS_OK or STATUS_NO_MEMORY. */
enum status spatial_measure(const struct mesh *mesh, const double *u, struct spatial *spatial);

#endif
