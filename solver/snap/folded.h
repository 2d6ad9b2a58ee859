/* A first guess of the compressed state. */
#ifndef PNEULAB_SNAP_FOLDED_H
#define PNEULAB_SNAP_FOLDED_H

#include "solver/snap/bellows.h"

/* Displacements u (2 node + i) that turn the snapping shells of the pairs `from` to `to` - 1 inside
 * out: each is mirrored about a plane across the axis, so that no circle on it changes, the other
 * shells are moved along the axis as they are, and the hinges are bent between them (cubic curves
 * with the shells' directions), thinned where they would fold. */
void folded_guess(const struct snap_spec *spec, const struct bellows *bellows, int from, int to,
                  double *u);

#endif
