/* Stretches of a grid axis: features of a body, one after another. */
#ifndef PNEULAB_MESH_STRETCH_H
#define PNEULAB_MESH_STRETCH_H

#include "solver/mesh/grid.h"

struct stretch {
  double end; /* coordinate where it ends; it starts where the one before it ends */
  const struct grid_division *division;
  int tag;
};

/* Appends stretches in order, leaving out those of no extent. The axis must have its start.
 * STATUS_OK or STATUS_NO_MEMORY. */
enum status stretch_extend(struct grid_axis *axis, const struct stretch *list, int count);

/* Starts an empty axis with the mirror image about 0 of stretches that start at 0: from -end of the
 * last one up to 0. STATUS_OK or STATUS_NO_MEMORY. */
enum status stretch_mirror(struct grid_axis *axis, const struct stretch *list, int count);

#endif
