/* Quasi-static load path: gravity first, then the pressure, recorded at chosen values. */
#ifndef PNEULAB_FE_PATH_H
#define PNEULAB_FE_PATH_H

#include "solver/fe/equilibrium.h"

/* A converged state on the path; recorded is false for steps in between. */
struct path_point {
  double pressure; /* Pa */
  double dead;     /* factor of the dead load */
  int iterations;  /* factorisations since the last recorded state */
  bool recorded;
  bool arc; /* reached by arc length, where a rising load found no equilibrium */
  const struct fe_state *state;
};

struct path_options {
  double pressure_to; /* Pa */
  int steps;          /* recorded at k/steps pressure_to, k = 0 .. steps */
  bool dead_load;     /* ramp the dead load to 1 before the pressure */
  /* Called for every converged state in order; a status other than OK ends the path. */
  enum status (*visit)(void *context, const struct path_point *point);
  void *context;
};

/* Follows the path from the undeformed state in `state` (all zero). Load steps adapt: shorter
 * after a failure, longer after easy ones, landing exactly on the recorded pressures. When they get
 * too short the path is followed by arc length, over which the load may fall: either it comes back
 * to the load that was wanted, or it is a limit point, and the path is followed some way beyond.
 * Returns STATUS_OK when the last pressure was reached; else the reason, with *error saying how
 * far it came, and `state` the last converged state on the way up: LIMIT_POINT, INVERTED,
 * CONTACT, STEP_MINIMUM, TIMEOUT, CANCELLED, NO_MEMORY. */
enum status path_follow(struct equilibrium *solver, const struct path_options *options,
                        struct fe_state *state, struct error *error);

#endif
