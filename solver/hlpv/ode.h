/* Initial value problems with roots, by SUNDIALS CVODE: what the integrations of hybrid and of
 * bistable models have in common. */
#ifndef PNEULAB_HLPV_ODE_H
#define PNEULAB_HLPV_ODE_H

#include "solver/base/error.h"
#include "solver/hlpv/trajectory.h"

enum { ODE_ROOTS_MAX = 128 };

/* Callbacks return false where they have no value: CVODE then tries a shorter step (derivative,
 * jacobian), or the step fails (roots). */
struct ode_problem {
  int states;
  enum { ODE_ADAMS, ODE_BDF } method; /* Adams-Moulton up to order 12, or BDF up to 5 */
  double tolerance;                   /* relative */
  const double *size;   /* of each state; the tolerance times it is the absolute one */
  int root_count;       /* at most ODE_ROOTS_MAX */
  const int *direction; /* of each root that counts: 1 rising, -1 falling, 0 both */
  bool (*derivative)(void *context, double time, const double x[], double rate[]);
  /* column[j][i] = d rate[i] / d x[j], all to be set; `rate` belongs to x. */
  bool (*jacobian)(void *context, double time, const double x[], const double rate[],
                   double *const column[]);
  bool (*roots)(void *context, double time, const double x[], double root[]);
  void *context; /* of the callbacks; outlives the integration */
};

struct ode;

/* The caller owns *ode; the arrays of the problem are copied. STATUS_NO_MEMORY. */
enum status ode_create(const struct ode_problem *problem, struct ode **ode, struct error *error);
void ode_destroy(struct ode *ode);

/* Starts anew from x at `time`; no step goes beyond `stop` > time. STATUS_INTERNAL. */
enum status ode_restart(struct ode *ode, double time, const double x[], double stop,
                        struct error *error);

/* One step from *time and x, where the last one ended, or the part of it up to a root or the stop:
 * brings both up to its end. found[i], for each root: not 0 if it was passed in its direction.
 * STATUS_OK, or STATUS_DIVERGED when no step meets the tolerance. */
enum status ode_step(struct ode *ode, double *time, double x[], int found[], struct error *error);

/* The state at a time within the last step. */
void ode_interpolate(struct ode *ode, double time, double x[]);

/* Adds the counts since the last restart. */
void ode_count(struct ode *ode, struct hlpv_counts *counts);

#endif
