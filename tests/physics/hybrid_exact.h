/* Exact motion of a hybrid model with constant coefficients in each mode, by the matrix exponential
 * of GSL: the states are joined by 1, u and the quadratures of a sinusoid, so that held, straight
 * and sinusoidal set-points are autonomous linear systems. */
#ifndef PNEULAB_TESTS_PHYSICS_HYBRID_EXACT_H
#define PNEULAB_TESTS_PHYSICS_HYBRID_EXACT_H

#include "solver/job/hlpv.h"

/* The state after `span` seconds in `mode` from x. The set-point starts as u with the slope, to
 * which amplitude sin(omega t + phase) is added, t from the start of the span; the coefficients
 * are those at u. */
struct exact_input {
  double u, slope, amplitude, omega, phase;
};

void exact_state(const struct hlpv_spec *spec, int mode, const struct exact_input *input,
                 const double x[HLPV_STATES], double span, double after[HLPV_STATES]);

/* Time in (0, span] at which the transition's guard is first passed, by steps of `look` and then
 * Brent's method, or infinity. */
double exact_passage(const struct hlpv_spec *spec, const struct hlpv_transition *transition,
                     const struct exact_input *input, const double x[HLPV_STATES], double span,
                     double look);

#endif
