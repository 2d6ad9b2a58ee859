/* From the tensor grid of a pneu-net to its body. */
#ifndef PNEULAB_MESH_PNEUNET_MAP_H
#define PNEULAB_MESH_PNEUNET_MAP_H

#include "solver/mesh/pneunet_suckers.h"

/* The grid has the base section everywhere and rectangular gaps of chamber_gap; its x and z are
 * those of the body at rest, were it so. */
struct pneunet_map {
  const struct pneunet_spec *p;
  int gap_count;
  double gap[CHAMBERS_MAX]; /* middles of the gaps along x, ascending, m */
  struct sucker_plan suckers;
};

/* Width (m) of a gap at height z (m) above its root, both in the base section: from gap_root at
 * z = 0 to chamber_gap at the top (spec.h says how). */
double pneunet_gap_width(const struct pneunet_spec *p, double z);

/* Place (m) across the body at x of what is at y in the base section, without suckers. */
double pneunet_lateral(const struct pneunet_spec *p, double y, double x);

/* Place x (m) in the body of a point of the grid; context is a struct pneunet_map. Axial walls are
 * sheared so that the gaps get their shape and the cavities keep theirs, which fades in the bottom
 * layer; then come the tapers, and the suckers become round. */
void pneunet_map_point(const void *context, const double grid_point[3], double x[3]);

#endif
