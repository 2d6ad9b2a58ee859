/* The identification of a hybrid model from parted trials: what its parts share. */
#ifndef PNEULAB_IDENTIFY_IDENTIFICATION_H
#define PNEULAB_IDENTIFY_IDENTIFICATION_H

#include <stdio.h>

#include "solver/identify/point.h"

/* Change of chi-square from which a swing is in the data: swings of many frequencies are looked
 * for, and some fit noise by more than the quantiles of one test. */
#define IDENTIFY_SURE 25.0

/* How the damping of a point came out: estimated; at 0, the least that is allowed; or not to be
 * seen, and held at a value that the others do not depend on. */
enum damping { DAMPING_FREE, DAMPING_BOUND, DAMPING_UNSEEN };

/* What a point has come to. Numbers are in SI units and in the order of enum identify_coefficient.
 */
struct point_estimate {
  double value[IDENTIFY_COEFFICIENTS];
  double stderror[IDENTIFY_COEFFICIENTS]; /* infinite: not to be seen; NAN: no such
                                           * coefficient (beta at the set-point 0) */
  size_t place[IDENTIFY_COEFFICIENTS];    /* in the covariance of its group */
  enum damping damping;
  int visible;                            /* numbers in `singular` and directions */
  double singular[IDENTIFY_COEFFICIENTS]; /* of the Jacobian to logarithms, falling */
  double direction[IDENTIFY_COEFFICIENTS][IDENTIFY_COEFFICIENTS];
};

/* Points that are estimated together, since they share what is free. */
struct group {
  size_t first, count; /* points */
  int parameters;
  double *covariance; /* parameters x parameters, SI; of what is not determined: infinite on the
                       * diagonal, 0 beside it */
  double freedom;     /* residuals less what is estimated */
  double chi_square;
  int iterations;
  bool converged;
};

/* A number that points share. */
struct shared_estimate {
  bool free;
  double value, stderror;
};

struct identification {
  const struct identify_spec *spec;
  const struct trials *trials;
  const struct steps *steps;
  struct response *response;
  size_t point_count, group_count;
  struct point *point;
  struct point_estimate *estimate;
  struct group *group;
  struct shared_estimate rest[HLPV_MODES_MAX], mass, gamma;
  bool inertia;      /* whether the data show it, where mass or gamma is to be identified */
  double *sigma;     /* 2 for each trial: h in m, pressure in Pa */
  double deadline_s; /* clock_wall_s at which to stop, 0: none */
  bool (*cancelled)(void *context);
  FILE *events;    /* progress as JSON lines, or NULL */
  int round;       /* of fits with the noise of the one before */
  size_t fitting;  /* the group that is fitted */
  int iterations;  /* of all fits */
  double reported; /* fraction */
};

/* Parameters of a point as they stand. */
void identification_parameters(const struct identification *id, size_t point,
                               double parameter[POINT_PARAMETERS]);

#endif
