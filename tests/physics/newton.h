/* Textbook Newton iterations of the physics tests: full steps, plain addition. */
#ifndef PNEULAB_TESTS_PHYSICS_NEWTON_H
#define PNEULAB_TESTS_PHYSICS_NEWTON_H

#include "solver/fe/model.h"

enum { NEWTON_ITERATIONS = 40 };

struct newton_log {
  int count;
  double correction[NEWTON_ITERATIONS]; /* largest displacement correction, m */
};

/* Solves for equilibrium under `load` until the largest correction is below `tolerance` (m).
 * Returns STATUS_OK, INVERTED or DIVERGED. log may be NULL. */
enum status newton_solve(struct fe_model *model, const struct fe_load *load, struct fe_state *state,
                         double tolerance, struct newton_log *log);

/* Solves for the pressure at which the cavity encloses `volume`, so that a limit point of the
 * pressure is no obstacle. scale * model_volume() is the volume whose gradient is exact. */
enum status newton_inflate(struct fe_model *model, double volume, double scale,
                           struct fe_state *state, double *pressure, double tolerance);

#endif
