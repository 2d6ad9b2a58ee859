/* Error estimate: the same load on a finer mesh. */
#ifndef PNEULAB_ESTIMATE_H
#define PNEULAB_ESTIMATE_H

#include "solver/post/sample.h"
#include "solver/solve.h"

/* Carries the converged state coarse->state to a nested mesh (actuator_mesh_finer), brings it into
 * equilibrium with the same load there and measures it. Time limit and cancellation are those of
 * the coarse solver. `coarse` is only read.
 * STATUS_OK, or why there is no finer solution, with *error: memory, DIVERGED, INVERTED, TIMEOUT
 * or CANCELLED. */
enum status estimate_finer(const struct job_spec *spec, const struct solve *coarse, double pressure,
                           struct sample *finer, struct error *error);

#endif
