/* A sampled controller of the position: what it knows, and what it does at each sample. */
#ifndef PNEULAB_HLPV_CONTROLLER_H
#define PNEULAB_HLPV_CONTROLLER_H

#include "solver/base/error.h"
#include "solver/hlpv/design.h"
#include "solver/hlpv/target.h"

struct controller;

/* What it decides at a sample. */
struct control_action {
  double set_point; /* Pa, held until the next sample */
  bool saturated;   /* it is at a limit: what is wanted lies beyond, or a guard is driven through */
  struct target target; /* what is aimed at */
};

/* Creates the controller of spec->control, owned by the caller; it knows the initial state. spec
 * must outlive it. STATUS_OK, or the failures of design_create. */
enum status controller_create(const struct hlpv_spec *spec, struct controller **controller,
                              struct error *error);
void controller_destroy(struct controller *controller);

/* The gains, borrowed. */
const struct design *controller_design(const struct controller *controller);

/* One sample, at `time`; samples follow each other by the control's interval. measured: h in m and
 * p in Pa, to which the controller adds the noise of the job.
 *   1. It predicts the state by its model and corrects it by what is measured. A guard that the
 *      measured state has passed changes its mode, and the predicted state as the reset says.
 *   2. It looks for the target of the reference (target_find). One in another mode is reached with
 *      the set-point at the limit that drives through the guard.
 *   3. Else u = u_rest - gain (state - state of rest, integral). The integral is that of the
 *      elongation missing to the plan, the motion that its model makes of the same feedback: a
 *      model that is right needs none, so that none overshoots; one that is wrong is corrected, for
 *      the plan ends at the target. It stands still while u is beyond a limit and would go further.
 */
void controller_sample(struct controller *controller, double time,
                       const double measured[DESIGN_OUTPUTS], struct control_action *action);

#endif
