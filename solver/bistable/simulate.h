/* Simulation of bistable actuators.
 *
 * The integration starts anew at every corner of a set-point and at every event: a cell that comes
 * to the end of its side (it jumps to the other one, see solver/bistable/law.h), a stop, contact
 * and separation of the load. Impacts of the load follow Newton's law with the coefficient of
 * restitution; below CONTACT_SPEED the two stay together. All energies are followed: what supplies
 * give, dashpots take, and jumps and impacts lose is weighed against the sum of the rest. */
#ifndef PNEULAB_BISTABLE_SIMULATE_H
#define PNEULAB_BISTABLE_SIMULATE_H

#include <stdio.h>
#include "solver/bistable/trajectory.h"

struct bistable_options {
  double deadline_s; /* clock_wall_s at which to stop, 0: none */
  bool (*cancelled)(void *context);
  FILE *events; /* progress as JSON lines, or NULL */
};

/* Simulates the system, which was just opened. Fills *trajectory, which the caller releases in any
 * case. What ends early keeps everything until then: STATUS_TIMEOUT, CANCELLED; DIVERGED (the state
 * grows without bound, or no step meets the tolerance); EVENTS (too many). STATUS_INVALID without a
 * state to start from; STATUS_NO_MEMORY. */
enum status bistable_simulate(struct bistable_system *system,
                              const struct bistable_options *options,
                              struct bistable_trajectory *trajectory, struct error *error);

#endif
