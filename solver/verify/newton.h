/* Textbook Newton iterations: full steps, plain addition. */
#ifndef PNEULAB_VERIFY_NEWTON_H
#define PNEULAB_VERIFY_NEWTON_H

#include "solver/fe/model.h"

enum { NEWTON_ITERATIONS = 40 };

struct newton_log {
  int count;
  double correction[NEWTON_ITERATIONS]; /* largest displacement correction, m */
};

struct newton_control {
  double tolerance;                 /* of the largest displacement correction, m */
  double deadline_s;                /* on clock_wall_s; 0: none */
  bool (*cancelled)(void *context); /* may be NULL */
  void *cancel_context;
  struct newton_log *log; /* may be NULL */
};

/* STATUS_OK, or CANCELLED or TIMEOUT when it is time to stop. */
enum status newton_check_limits(const struct newton_control *control);

/* Each brings the state into equilibrium. STATUS_OK, or INVERTED, DIVERGED, TIMEOUT, CANCELLED or
 * NO_MEMORY; the state is then the last iterate. */

/* Under `load`. */
enum status newton_solve(struct fe_model *model, const struct fe_load *load, struct fe_state *state,
                         const struct newton_control *control);

/* At the pressure at which the cavity encloses `volume`, so that a limit point of the pressure is
 * no obstacle. scale * model_volume() is the volume whose gradient is exact. */
enum status newton_inflate(struct fe_model *model, double volume, double scale,
                           struct fe_state *state, double *pressure,
                           const struct newton_control *control);

/* At the factor of the dead load at which the displacement of an unknown (0 .. dof_count - 1) is
 * `target`. */
enum status newton_reach(struct fe_model *model, int equation, double target,
                         struct fe_state *state, double *dead,
                         const struct newton_control *control);

#endif
