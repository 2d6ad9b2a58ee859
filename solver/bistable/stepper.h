/* Integration of the motion by SUNDIALS CVODE (BDF, so that cells that have come to rest and stiff
 * valves do not bound the step), with the roots at which something happens. */
#ifndef PNEULAB_BISTABLE_STEPPER_H
#define PNEULAB_BISTABLE_STEPPER_H

#include "solver/bistable/system.h"

/* Functions of every cell whose passage through 0 downwards is an event, in this order, then that
 * of the load. */
enum cell_root { ROOT_LIMIT, ROOT_END, ROOT_STOP_FROM, ROOT_STOP_TO, ROOTS_PER_CELL };

/* Their values; 1 where there is nothing to happen. false where a pressure fails. */
bool stepper_roots(struct bistable_system *system, double time, const double x[], double root[]);

struct stepper;

/* size: of each state, by which the tolerance is multiplied to give the absolute one. The system
 * must outlive the stepper, which the caller owns. STATUS_NO_MEMORY. */
enum status stepper_create(struct bistable_system *system, const double size[],
                           struct stepper **stepper, struct error *error);
void stepper_destroy(struct stepper *stepper);

/* Starts anew from a state; no step goes beyond `stop` > time. STATUS_INTERNAL. */
enum status stepper_restart(struct stepper *stepper, double time, const double x[], double stop,
                            struct error *error);

/* One step, or the part of it up to a root or the stop: brings time and x up to its end. passed[i]:
 * whether root i was passed downwards. STATUS_OK, or STATUS_DIVERGED when no step meets the
 * tolerance. */
enum status stepper_step(struct stepper *stepper, double *time, double x[],
                         bool passed[SYSTEM_ROOTS_MAX], struct error *error);

/* The state at a time within the last step. */
void stepper_interpolate(struct stepper *stepper, double time, double x[]);

/* Adds the counts since the last restart. */
void stepper_count(struct stepper *stepper, struct hlpv_counts *counts);

#endif
