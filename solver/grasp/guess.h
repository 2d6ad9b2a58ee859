/* Where a step in equilibrium starts from while the object is drawn along: the last state, carried
 * on by what the step before it did. A body that slides then is where it has to be but for what
 * changes in the sliding. */
#ifndef PNEULAB_GRASP_GUESS_H
#define PNEULAB_GRASP_GUESS_H

#include "solver/fe/model.h"

struct guess {
  struct fe_state before; /* the last step led from it to the present state */
  double step;            /* length of that step, > 0; 0: there was none */
};

/* Without a step. STATUS_NO_MEMORY. */
enum status guess_create(const struct fe_model *model, struct guess *guess);
void guess_release(struct guess *guess);

/* A step of this length leads on from the state. */
void guess_note(const struct fe_model *model, struct guess *guess, const struct fe_state *state,
                double step);

/* Carries displacements and pressures of the present state on by a step of this length; at most by
 * twice what the last step did. Leaves the state alone when there was no step. */
void guess_apply(const struct fe_model *model, const struct guess *guess, double step,
                 struct fe_state *state);

#endif
