/* One mode under a held set-point as a linear system, exactly sampled. */
#ifndef PNEULAB_HLPV_LINEAR_H
#define PNEULAB_HLPV_LINEAR_H

#include <stdbool.h>
#include "solver/job/hlpv.h"

/* The state after `interval` seconds of a held set-point is
 *   x_after[i] = step[i][0] h + step[i][1] v + step[i][2] p + step[i][3],
 * by the matrix exponential (GSL: Pade approximation, scaling and squaring). */
void linear_step(const struct hlpv_spec *spec, int mode, double set_point, double interval,
                 double step[HLPV_STATES][HLPV_STATES + 1]);

void linear_apply(double step[HLPV_STATES][HLPV_STATES + 1], const double x[HLPV_STATES],
                  double after[HLPV_STATES]);

/* The state at rest; false where the mode has none, or runs away from it. */
bool linear_rest(const struct hlpv_spec *spec, int mode, double set_point, double x[HLPV_STATES]);

/* Sampled motion near the state of rest at the set-point: deviations go over by a (states x
 * states), and those of the set-point, held for the interval, by b. The coefficients change with
 * the set-point, which b takes in. False as linear_rest. */
bool linear_sampled(const struct hlpv_spec *spec, int mode, double set_point, double interval,
                    double a[HLPV_STATES][HLPV_STATES], double b[HLPV_STATES]);

#endif
