/* Shared by the files of the continuation. */
#ifndef PNEULAB_AXI_CONTINUATION_INTERNAL_H
#define PNEULAB_AXI_CONTINUATION_INTERNAL_H

#include "solver/axi/continuation.h"

/* Metric product of two displacements, without lambda. */
double continuation_product(const struct continuation_system *system, const double *a,
                            const double *b);

/* STATUS_TIMEOUT or STATUS_CANCELLED, when it is time to end. */
enum status continuation_interrupted(const struct continuation_options *options,
                                     struct error *error);

/* A failure that a shorter step may avoid. */
bool continuation_retry(enum status status);

/* A state of the path while it is being followed. */
struct path_state {
  double *x, *t; /* and its tangent */
  double lambda, rate, arc;
  int negative;
};

/* The step from `from` to its plane at the distance `step`, whose initial guess is in `to`. */
struct path_work {
  const struct continuation_system *system;
  const struct continuation_options *options;
  double *residual, *load; /* size; load becomes -dx/dlambda */
  int factorisations;
};

/* Newton's method in the plane: corrections (dx, dlambda) of `to` are normal to the tangent of
 * `from`. Finishes `to` but for arc. Returns STATUS_OK, DIVERGED, INVERTED or a reason to end. */
enum status path_correct(struct path_work *work, const struct path_state *from, double step,
                         struct path_state *to, struct error *error);

/* Tangent of `state` from the factor at hand and dR/dlambda in work->load, on the side of the
 * tangent of `behind`; behind NULL: that of rising lambda. */
void path_tangent(struct path_work *work, const struct path_state *behind,
                  struct path_state *state);

#endif
