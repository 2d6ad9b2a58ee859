/* What the parts of the equilibrium solver share. */
#ifndef PNEULAB_FE_EQUILIBRIUM_INTERNAL_H
#define PNEULAB_FE_EQUILIBRIUM_INTERNAL_H

#include "solver/fe/equilibrium.h"

/* Newton's method with the multipliers held. stiffness_pressure: used in the load's tangent by the
 * first iteration. Returns as equilibrium_solve; *iterations grows by the factorisations. */
enum status equilibrium_newton(struct equilibrium *solver, struct fe_load *load,
                               double stiffness_pressure, struct fe_state *state, int *iterations);

struct polishing {
  double size;        /* of the last correction, rms, m; INFINITY when there was none */
  double contraction; /* by which the first step has to be smaller */
  bool roughly;       /* most of the unbalanced forces gone will do */
};

/* Simplified Newton steps with the last factor while they contract. The residual belongs to the
 * state on entry and on exit. Returns true once converged. */
bool equilibrium_polish(struct equilibrium *solver, struct fe_load *load, struct fe_state *state,
                        const struct polishing *polishing);

/* Whether there is anything that the body may touch. */
bool equilibrium_touches(const struct fe_model *model);

/* Raises the contact multipliers to the tractions until they settle; the factor stays frozen while
 * that contracts. Returns as equilibrium_solve. */
enum status equilibrium_augment(struct equilibrium *solver, struct fe_load *load,
                                struct fe_state *state, int *iterations);

/* Multipliers to start from: those of the state, carried on by `ratio` of the last change. */
void equilibrium_start_multipliers(struct equilibrium *solver, const struct fe_state *state,
                                   double ratio);

/* The state takes over the multipliers of the contact. */
void equilibrium_keep_multipliers(struct equilibrium *solver, struct fe_state *state);

#endif
