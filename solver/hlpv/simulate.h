/* Simulation of a hybrid model.
 *
 * The integration starts anew at every corner of the set-point and after every switch. A guard is
 * passed where its quantity crosses the level in its direction; of several at the same time, and of
 * those that lie behind the state after a reset, the first in the model's list is made. A reset
 * that lands beyond a guard of its mode, or on it and moving that way, passes it at once. A switch
 * at the time of a corner (but for 1e-11 of it) is made first, with the set-point before it. */
#ifndef PNEULAB_HLPV_SIMULATE_H
#define PNEULAB_HLPV_SIMULATE_H

#include <stdio.h>
#include "solver/hlpv/trajectory.h"

struct hlpv_options {
  double deadline_s; /* clock_wall_s at which to stop, 0: none */
  bool (*cancelled)(void *context);
  FILE *events;    /* progress as JSON lines, or NULL */
  bool no_samples; /* record none */
};

/* Fills *trajectory, which the caller releases in any case. What ends early keeps everything until
 * then: STATUS_TIMEOUT, CANCELLED; DIVERGED (the state grows without bound, or no step meets the
 * tolerance); CHATTERING, ZENO and EVENTS as accumulation_check. STATUS_NO_MEMORY. */
enum status hlpv_simulate(const struct hlpv_spec *spec, const struct hlpv_options *options,
                          struct hlpv_trajectory *trajectory, struct error *error);

#endif
