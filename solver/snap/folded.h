/* The compressed state of a bellows, from nothing.
 *
 * Nearly incompressible silicone creases in the hinges long before the shells turn inside out, and
 * the path from the natural state is lost in creases. So a body of foam with soft PET is pushed
 * until the shells are inside out; at that length the PET gets its modulus back, and the body is
 * let go. Under a pressure that keeps the hinges open the foam is then made stiffer against changes
 * of volume step by step, until it is the silicone of the job; at last the pressure is taken away.
 */
#ifndef PNEULAB_SNAP_FOLDED_H
#define PNEULAB_SNAP_FOLDED_H

#include "solver/axi/model.h"
#include "solver/snap/bellows.h"

/* When to stop. */
struct folded_limits {
  double deadline_s; /* on clock_wall_s; 0: none */
  bool (*cancelled)(void *context);
};

/* Equilibrium without load with all snapping shells inside out. The model is that of the bellows,
 * whose silicone is foam on the way and its own again at the end. STATUS_OK; STATUS_UNSTABLE_PATH
 * when shells do not stay inside out; or as axi_follow and axi_equilibrium. */
enum status folded_state(const struct snap_spec *spec, struct bellows *bellows,
                         struct axi_model *model, const struct folded_limits *limits,
                         struct axi_state *state, struct error *error);

/* The same for a row of pairs or a finer mesh, from the compressed state of one pair of an endless
 * row in its own mesh (solver/snap/carry.h): Newton's method from there, without load or under a
 * pressure that is taken away again. Returns as folded_state, or STATUS_NO_MEMORY. */
enum status folded_from_pair(const struct snap_spec *spec, struct bellows *bellows,
                             struct axi_model *model, const struct bellows *pair,
                             const struct axi_state *pair_state, const struct folded_limits *limits,
                             struct axi_state *state, struct error *error);

#endif
