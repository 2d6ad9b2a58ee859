/* Mesh of two rows of oblique chambers, mirrored about y = 0. */
#ifndef PNEULAB_MESH_OBLIQUE_H
#define PNEULAB_MESH_OBLIQUE_H

#include "solver/job/spec.h"
#include "solver/mesh/grid.h"

/* Cells through each feature of the body; those that it does not have are left unused. */
struct oblique_cells {
  /* along the body; the solid ends at base and tip mirror each other */
  struct grid_division end, gap_wall, cavity, gap;
  /* from the middle to a side face: half the centre wall, a row's cavity in front of, over and
   * behind the channel (without one: `row`), side wall */
  struct grid_division centre, inner, channel, outer, row, side_wall;
  /* from the bottom face to the top, without a channel: bottom; else below, duct, cover */
  struct grid_division bottom, below, duct, cover, height, top;
};

/* Cells as chosen by the job (equal ones) or, where it is silent, by its accuracy tier. */
struct oblique_cells oblique_resolution(const struct job_spec *spec);

/* Splits the cells of a job for a finer mesh that tells the error of the one they make. */
void oblique_refine(struct oblique_cells *cells);

/* Builds the mesh of spec->oblique: half of it (y >= 0) when spec->half_model. The grid is sheared
 * like a herringbone, x = xi + tan(angle) |y|, and straightened within the solid ends, so that the
 * sections between them are V-shaped. The left row (y > 0) is cavity 0, the right one cavity 1. The
 * frame of each section is carried by the nodes of the bottom layer; the stations are the base, the
 * starts of the chambers but the first on the bottom centreline, and the tip.
 * Returns STATUS_OK, STATUS_TOO_LARGE or STATUS_NO_MEMORY; on success the caller releases
 * *mesh. */
enum status oblique_mesh(const struct job_spec *spec, const struct oblique_cells *cells,
                         struct mesh *mesh, struct error *error);

#endif
