/* Motion of one mode under a held set-point from unit initial states, with its derivatives to the
 * coefficients, by SUNDIALS CVODES (BDF, or Adams-Moulton for what swings, with Newton's method;
 * forward sensitivities, simultaneous corrector: Hindmarsh et al., ACM Trans. Math. Softw. 31,
 * 2005).
 *
 * Between steps of the set-point a mode is linear with constant coefficients, so that every motion
 * in it is its state of rest and a sum of three solutions of
 *   h' = v,   m v' = gamma p - k h - b v,   p' = alpha p.
 * They serve all trials at one set-point. */
#ifndef PNEULAB_IDENTIFY_RESPONSE_H
#define PNEULAB_IDENTIFY_RESPONSE_H

#include <stdbool.h>
#include <stddef.h>
#include "solver/base/error.h"

/* One mode at one set-point, in SI units. */
struct response_system {
  double stiffness, damping, alpha, mass, gamma;
};

/* Functions of time: h from a unit of h, of v and of p; p from a unit of p. */
enum { RESPONSE_HH, RESPONSE_HV, RESPONSE_HP, RESPONSE_PP, RESPONSE_FUNCTIONS };

/* What they are differentiated by. */
enum {
  RESPONSE_BY_STIFFNESS,
  RESPONSE_BY_DAMPING,
  RESPONSE_BY_ALPHA,
  RESPONSE_BY_MASS,
  RESPONSE_BY_GAMMA,
  RESPONSE_PARAMETERS
};

struct response;

/* tolerance: of each step, relative to the size of each state. parameters: how many of the list
 * above are differentiated by, RESPONSE_BY_MASS (the first three) or RESPONSE_PARAMETERS; slopes of
 * the others are 0. STATUS_NO_MEMORY. */
enum status response_create(double tolerance, int parameters, struct response **response,
                            struct error *error);
void response_destroy(struct response *response);

/* Values at `count` rising times >= 0: value[i * RESPONSE_FUNCTIONS + f], and unless slope is NULL
 * slope[(i * RESPONSE_PARAMETERS + j) * RESPONSE_FUNCTIONS + f]. STATUS_OK, or STATUS_DIVERGED when
 * no step meets the tolerance. */
enum status response_evaluate(struct response *response, const struct response_system *system,
                              const double *time, size_t count, double *value, double *slope,
                              struct error *error);

/* Steps of the integration so far. */
long response_steps(const struct response *response);

#endif
