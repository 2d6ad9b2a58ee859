/* Paths of solutions x(s), lambda(s) of R(x, lambda) = 0 with a symmetric dR/dx, of any
 * discretisation: Newton's method at a fixed lambda, and arc-length continuation through limit
 * points of lambda and of anything else.
 *
 * Metric: |(dx, dlambda)|^2 = sum_i weight_i dx_i^2 + (lambda_scale dlambda)^2, so that with
 * weights of sum 1 lengths are root mean square changes of x, in the unit of x. A step goes along
 * the tangent of the path and is corrected normal to it (Riks 1979; Ramm 1981; Crisfield 1981): the
 * bordered system is solved with the factor of dR/dx and two right-hand sides. */
#ifndef PNEULAB_AXI_CONTINUATION_H
#define PNEULAB_AXI_CONTINUATION_H

#include <stdbool.h>
#include "solver/base/error.h"

/* The equations. */
struct continuation_system {
  int size;             /* of x */
  void *context;        /* handed to the functions */
  const double *weight; /* size: of the metric, >= 0, sum 1 is recommended */
  /* residual[size] = R and, unless NULL, load[size] = dR/dlambda. With `tangent` also what `factor`
   * needs is kept. Returns STATUS_OK, or STATUS_INVERTED where R does not exist (the step is then
   * shortened); anything else ends the continuation. */
  enum status (*evaluate)(void *context, const double *x, double lambda, bool tangent,
                          double *residual, double *load, struct error *error);
  /* Factorises dR/dx of the last evaluation with `tangent`; *negative receives the number of
   * negative pivots. Returns STATUS_OK, DIVERGED when singular, or a reason to end. */
  enum status (*factor)(void *context, int *negative, struct error *error);
  /* x = (dR/dx)^-1 b with the last factor; b and x may be the same. */
  void (*solve)(void *context, const double *b, double *x);
};

/* What made a state be handed to the visitor; a state may be several at once. */
enum continuation_event {
  CONTINUATION_STEP = 0,
  CONTINUATION_START = 1,
  CONTINUATION_LIMIT = 2,       /* dlambda/ds = 0: located */
  CONTINUATION_TARGET = 4,      /* lambda is a requested value: exactly; `index` is its number */
  CONTINUATION_WATCH = 8,       /* a watched quantity is 0: located; `index` is its number */
  CONTINUATION_BIFURCATION = 16 /* since the last state the number of negative pivots changed, and
                                 * limit points do not explain it */
};

/* A converged state. Arrays belong to the continuation and live during the visit. */
struct continuation_point {
  const double *x;
  const double *tangent; /* dx/ds; |(dx/ds, dlambda/ds)| = 1. Zero after continuation_correct */
  double lambda;
  double lambda_rate; /* dlambda/ds */
  double arc;         /* s */
  int negative;       /* negative pivots of dR/dx here */
  int change;         /* of a BIFURCATION: how many more became negative */
  unsigned events;    /* of enum continuation_event */
  int index;          /* of a TARGET or WATCH */
  int iterations;     /* factorisations since the last visit */
};

struct continuation_options {
  double step;     /* first length, in the metric */
  double step_min; /* below it the path ends with STATUS_STEP_MINIMUM */
  double step_max;
  double lambda_scale;    /* of the metric; 0: cylindrical */
  double lambda_step_max; /* largest |dlambda| of a predictor; 0: none */
  double tolerance;       /* metric of the last correction */
  double swing;           /* corrections that swing to and fro within that many tolerances are let
                           * pass, where a point of contact has two partners to choose from, between
                           * which the potential has a step; 1: none */
  double angle_max;       /* rad, largest angle between the tangents of successive states; larger
                           * ones are taken for a jump to another branch */
  double increment_max;   /* largest |dx_i| of one correction; 0: none */
  double event_tolerance; /* fraction of a step within which events are located */
  int iterations_max;     /* Newton corrections of one step */
  int iterations_wanted;  /* the step aims at them */
  int steps_max;
  int target_count;
  const double *target; /* requested values of lambda */
  int watch_count;      /* at most CONTINUATION_WATCHES */
  /* Fills values[watch_count]: their zeros are located as the path passes them. May be NULL. */
  void (*watch)(void *context, const struct continuation_point *point, double *values);
  void *watch_context;
  double deadline_s;                /* on clock_wall_s; 0: none */
  bool (*cancelled)(void *context); /* may be NULL */
  void *cancel_context;
  int verbose; /* 1: a line a step on standard error, 2: a line an iteration */
};

enum { CONTINUATION_WATCHES = 8 };

/* Sees every converged state in the order of the path, the first one included. Returns false to
 * end the path there. */
typedef bool continuation_visit(void *context, const struct continuation_point *point);

/* Options for a problem of this size (a length in the unit of x): steps from size/1000, at most
 * size/20, tolerance 1e-8 size, angle 0.5 rad. */
struct continuation_options continuation_defaults(double size);

/* Newton's method with line search at a fixed lambda, from x, which receives the solution.
 * *negative (may be NULL) receives the negative pivots there, *iterations (may be NULL) the number
 * of factorisations. Judged by the last full correction. Returns STATUS_OK, DIVERGED, INVERTED,
 * TIMEOUT, CANCELLED, NO_MEMORY or what the system returned; x is then that of before. */
enum status continuation_correct(const struct continuation_system *system,
                                 const struct continuation_options *options, double lambda,
                                 double *x, int *negative, int *iterations, struct error *error);

/* Follows the path from a solution (x, *lambda), which it corrects first, in the direction in which
 * lambda rises (direction = 1) or falls (-1); with `along` (size, may be NULL) in the one that
 * makes the scalar product of dx/ds with it positive. Ends with STATUS_OK when the visitor says so
 * or after steps_max; else with STEP_MINIMUM, TIMEOUT, CANCELLED, NO_MEMORY or what the system
 * returned. x and *lambda receive the last converged state. */
enum status continuation_follow(const struct continuation_system *system,
                                const struct continuation_options *options, int direction,
                                const double *along, continuation_visit *visit, void *visit_context,
                                double *x, double *lambda, struct error *error);

#endif
