/* The steps to one set-point in one mode against the motion that coefficients give: weighted
 * residuals and their derivatives. */
#ifndef PNEULAB_IDENTIFY_POINT_H
#define PNEULAB_IDENTIFY_POINT_H

#include "solver/identify/response.h"
#include "solver/job/steps.h"

/* Columns of the Jacobian: the coefficients of the point, and what it shares with others. */
enum {
  POINT_STIFFNESS,
  POINT_DAMPING,
  POINT_ALPHA,
  POINT_BETA,
  POINT_REST,
  POINT_MASS,
  POINT_GAMMA,
  POINT_PARAMETERS
};

/* State at the start of a step, [h, v, p], with the covariance that follows from unit weights. */
struct point_start {
  double x[HLPV_STATES], covariance[HLPV_STATES * HLPV_STATES];
};

struct point {
  int mode;
  double set_point;
  size_t step_count;
  const struct step **step;
  struct point_start *start; /* of each step, as estimated by the last evaluation */
  size_t samples;            /* in all steps */
  size_t rows;               /* of residuals */
  size_t starts;             /* numbers estimated for the states at the start */
  double *residual;          /* rows */
  double *jacobian;          /* rows x POINT_PARAMETERS */
  size_t time_count;
  double *time;          /* since the start of a step, rising, those of all steps */
  size_t *place;         /* of each sample among them */
  double *value, *slope; /* of the response at the times */
};

/* The steps of (mode, set_point): those that count (step.point >= 0 and not held out), or all of at
 * least two rows. STATUS_NO_MEMORY. */
enum status point_create(const struct trials *trials, const struct steps *steps, int mode,
                         double set_point, bool all, struct point *point, struct error *error);
void point_release(struct point *point);

/* Residuals (measured - simulated) / sigma at parameters in SI units, h then pressure of each step,
 * then its state before it. sigma[2 * trial]: standard deviations of h and pressure.
 * The states at the start are those of least squares; the derivatives are those of what is left
 * then (variable projection; Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973, in the form of
 * Kaufman, BIT 15, 1975). jacobian: whether point->jacobian is filled, -d residual.
 * STATUS_DIVERGED. */
enum status point_evaluate(struct point *point, const struct trials *trials, const double *sigma,
                           const double parameter[POINT_PARAMETERS], bool jacobian,
                           struct response *response, struct error *error);

/* h and pressure of one sample of a step as simulated by the last evaluation. sample: of the point,
 * counted over its steps. */
void point_simulated(const struct point *point, const double parameter[POINT_PARAMETERS],
                     size_t step, size_t sample, double *h, double *pressure);

#endif
