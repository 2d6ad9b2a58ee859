/* Integration of one mode under a smooth set-point by SUNDIALS CVODE (Adams-Moulton of
 * variable order up to 12, with Newton's method so that stiff pneumatics do not bound the step),
 * and root finding on the guards of the mode. At equal tolerance it errs a quarter of what BDF
 * does. */
#ifndef PNEULAB_HLPV_INTEGRATOR_H
#define PNEULAB_HLPV_INTEGRATOR_H

#include "solver/base/error.h"
#include "solver/hlpv/trajectory.h"

/* The set-point between two of its corners: value + slope (t - start), or a sinusoid. */
struct set_point {
  const struct hlpv_input *input;
  double start, value, slope;
};

double set_point_at(const struct set_point *set_point, double time);

struct integrator;

/* size: of each state, by which the tolerance is multiplied to give the absolute one. The spec must
 * outlive the integrator, which the caller owns. STATUS_NO_MEMORY. */
enum status integrator_create(const struct hlpv_spec *spec, const double size[HLPV_STATES],
                              struct integrator **integrator, struct error *error);
void integrator_destroy(struct integrator *integrator);

/* Starts anew from a state at `time`; no step goes beyond `stop` > time. STATUS_INTERNAL. */
enum status integrator_restart(struct integrator *integrator, int mode,
                               const struct set_point *set_point, double time,
                               const double x[HLPV_STATES], double stop, struct error *error);

enum { ROOT_GUARD = 1, ROOT_EXTREMUM = 2 };

/* One step from *time and x, where the last one ended, or the part of it up to a root or the stop:
 * brings both up to its end.
 * root[i], for each transition of the model: bits of ROOT_GUARD (its guard is passed in its
 * direction) and ROOT_EXTREMUM (its quantity is extreme, nearest to the guard); all 0 without a
 * root. Only transitions from the present mode have roots. Between two extrema a quantity is
 * monotone, so that no pair of passages is overlooked within one step.
 * STATUS_OK, or STATUS_DIVERGED when no step meets the tolerance. */
enum status integrator_step(struct integrator *integrator, double *time, double x[HLPV_STATES],
                            int root[HLPV_TRANSITIONS_MAX], struct error *error);

/* The state at a time within the last step. */
void integrator_interpolate(struct integrator *integrator, double time, double x[HLPV_STATES]);

/* Adds the counts since the last restart. */
void integrator_count(struct integrator *integrator, struct hlpv_counts *counts);

#endif
