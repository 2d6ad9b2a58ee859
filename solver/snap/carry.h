/* Displacements of one pair of an endless row as a guess for a longer bellows or a finer mesh. */
#ifndef PNEULAB_SNAP_CARRY_H
#define PNEULAB_SNAP_CARRY_H

#include "solver/snap/bellows.h"

/* Fills u (2 node + i of `to`, m) from the displacements `from_u` of the mesh `from`, one pair of
 * an endless row elongated by from_elongation, and *elongation with what the other body's upper end
 * then moves. Points correspond by their place along the wall, counted from the outer hinge of
 * their pair, and through its layers; each pair stands on the one below, as if the row went on
 * beyond the ends. STATUS_NO_MEMORY. */
enum status carry_pair(const struct bellows *from, const double *from_u, double from_elongation,
                       const struct bellows *to, double *u, double *elongation,
                       struct error *error);

#endif
