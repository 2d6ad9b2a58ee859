/* Suckers in the grid of a pneu-net: rings of cells below its bottom face, made round.
 *
 * Each sucker has a square frame of grid lines of about its circle's area: the ring is between its
 * outer and its inner lines. They are chosen among those that the body has, where some lie near,
 * and inserted elsewhere; across, suckers of about one size share them. The map then carries the
 * squares to circles. This displacement in the plane is whole below the bottom face and fades above
 * it: within the bottom layer, but over the channel's width below the channel. Beside the ring it
 * ends at `end` along the body and at the sides across it. */
#ifndef PNEULAB_MESH_PNEUNET_SUCKERS_H
#define PNEULAB_MESH_PNEUNET_SUCKERS_H

#include "solver/job/spec.h"
#include "solver/mesh/grid.h"

/* What is added to the tags of cells. Along the body: SUCKER_TAG (1 + 2 k) within the lines of the
 * ring of sucker k and SUCKER_TAG (2 + 2 k) inside them; across: SUCKER_TAG times the cell's
 * number. */
enum { SUCKER_TAG = 16 };

/* Along the body; pairs are the sides towards the base and the tip, grid coordinates in m. */
struct sucker_frame {
  double centre;
  double opening, outer;               /* radii, m */
  double depth;                        /* m */
  double inner_line[2], outer_line[2]; /* distance of the frame's lines from the centre */
  double end[2];                       /* distance where the displacement has faded */
  double inner_y, outer_y;             /* lateral lines, with their mirror images */
};

struct sucker_plan {
  int count;
  struct sucker_frame frame[SUCKERS_MAX];
  double depth; /* of all rings in the grid */
  int cells_across;
  double *middle_y; /* of the cells across, owned */
};

/* Chooses the lines by axial and lateral axes without splits, and inserts those that they lack.
 * STATUS_OK or NO_MEMORY; the caller releases *plan in either case. */
enum status suckers_plan(const struct pneunet_spec *p, struct grid_axis *axial,
                         struct grid_axis *lateral, struct sucker_plan *plan);

void suckers_release(struct sucker_plan *plan);

/* Inserts the plan's lines into axes that may be finer, and marks the tags of their cells.
 * STATUS_OK or NO_MEMORY. */
enum status suckers_mark(struct sucker_plan *plan, struct grid_axis *axial,
                         struct grid_axis *lateral);

/* Whether a cell below the bottom face with these tags belongs to a ring. */
bool suckers_solid(const struct sucker_plan *plan, int axial_tag, int lateral_tag);

/* The frame whose displacement reaches grid coordinate x, or NULL. */
const struct sucker_frame *suckers_frame(const struct sucker_plan *plan, double x);

/* Displacement (m) in the plane of a point of the grid that would be at (x, y) in the body's bottom
 * face, where the frame's lateral lines are at +-line[0], line[1] and the side at line[2]. */
void suckers_displace(const struct sucker_frame *frame, double x, double y, const double line[3],
                      double shift[2]);

#endif
