/* Gains of a position controller, for each mode and for set-points across the saturation. */
#ifndef PNEULAB_HLPV_DESIGN_H
#define PNEULAB_HLPV_DESIGN_H

#include "solver/base/error.h"
#include "solver/job/hlpv_control.h"

enum { DESIGN_STATES = HLPV_STATES + 1, DESIGN_OUTPUTS = 2 };

/* Gains near the state of rest of one mode at one set-point. Deviations from that state in SI. */
struct design_region {
  double set_point; /* Pa */
  bool valid;       /* the mode has a state of rest there, and gains that stabilise it */
  double rest[HLPV_STATES];
  /* The set-point's deviation is -sum of gain[i] x (h, v, p, integral of the missing elongation in
   * m s). */
  double gain[DESIGN_STATES];
  /* Part of the measured deviations of h and p by which the predicted state is corrected. */
  double observer[HLPV_STATES][DESIGN_OUTPUTS];
  double eigenvalue[DESIGN_STATES][2]; /* of the sampled closed loop: real, imaginary */
};

struct design {
  struct hlpv_spec model; /* as the controller sees it; borrows from the job's */
  int regions;
  struct design_region region[HLPV_MODES_MAX][CONTROL_REGIONS_MAX];
};

/* Computes the gains of spec->control, for the sampled motion that linear_sampled gives.
 * Regulator: the cost (h / weight_h)^2 + (integral / (weight_h integral_time))^2 + (u /
 * weight_set_point)^2 of deviations. Filter: the set-point disturbed by weight_set_point, and the
 * noise of the job, at least a thousandth of the weights. Both by riccati_solve. *design is owned
 * by the caller, who releases it with free. STATUS_OK, NO_MEMORY, or DIVERGED when no mode has a
 * valid region. */
enum status design_create(const struct hlpv_spec *spec, struct design **design,
                          struct error *error);

/* Gains at a set-point: interpolated between the regions of the mode, or those of the nearest
 * valid one; none, all 0, in a mode without. */
void design_at(const struct design *design, int mode, double set_point,
               struct design_region *region);

#endif
