/* Whether what the least squares found is in the data at all, by the ratio of likelihoods against
 * something simpler: the curvature at one of several minima tells little of the others, and of the
 * swings of all frequencies and phases some fit noise. */
#ifndef PNEULAB_IDENTIFY_DOUBT_H
#define PNEULAB_IDENTIFY_DOUBT_H

#include "solver/identify/identification.h"

/* Points that were found to swing (damping ratio below 0.2), and that do as well with a damping
 * ratio of 0.7, keep that and are marked: their damping is not seen. So are points whose damping
 * went to its bound 0 in vain; others stay there. STATUS_OK, or the failures of estimate_fit. */
enum status doubt_swings(struct identification *id, struct error *error);

/* Fills id->inertia: whether an actuator of a hundredth of the mass would not do as well. Leaves
 * everything else as it was. */
enum status doubt_inertia(struct identification *id, struct error *error);

#endif
