/* Middle line of the wall of a bellows, in parts of constant curvature. */
#ifndef PNEULAB_SNAP_MERIDIAN_H
#define PNEULAB_SNAP_MERIDIAN_H

#include "solver/job/snap.h"

/* Between two outer crests: four parts for the hinges and shells, one more where PET ends within a
 * shell; at the ends of the row up to four more. */
enum { MERIDIAN_PARTS_MAX = 5 * SNAP_PAIRS_MAX + 6 };

/* A straight part, or an arc. */
struct meridian_part {
  double direction; /* of its start to the r axis, rad */
  double turn;      /* by which the direction changes up to its end, anticlockwise */
  double length;
  double core[2];     /* thickness of the middle layer at its start and end */
  double in_hinge[2]; /* where start and end lie in their hinge, 0 to 1; equal in a shell */
  int pair;           /* of a shell: -1 for the one for mounting */
  bool pet, snapping;
  bool edge[2]; /* whether PET ends at its start and at its end */
  double r, z;  /* of its start */
};

struct meridian {
  int count;
  struct meridian_part part[MERIDIAN_PARTS_MAX];
  double length; /* along the axis */
};

/* The middle line of a derived spec; z is 0 at its start. */
void meridian_build(const struct snap_spec *spec, struct meridian *meridian);

/* Point at the distance s from the start of the part along the line, and unit normal, which points
 * away from the cavity. */
void meridian_point(const struct meridian_part *part, double s, double point[2], double normal[2]);

/* Thickness of the wall and of its middle layer there. */
double meridian_wall(const struct snap_spec *spec, const struct meridian_part *part, double s);
double meridian_core(const struct meridian_part *part, double s);

#endif
