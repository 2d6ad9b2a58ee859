/* Forces of a state, summed without the solver's own summaries. */
#ifndef PNEULAB_TESTS_PHYSICS_FORCES_H
#define PNEULAB_TESTS_PHYSICS_FORCES_H

#include "solver/fe/model.h"

struct forces {
  double force[3];  /* N */
  double moment[3]; /* about the origin, N m */
  double size;      /* sum of the absolute nodal forces, N */
};

/* What the pairs of the contact put on the nodes: all of it cancels. */
struct forces forces_of_pairs(struct fe_model *model, const struct fe_state *state);

/* What the support has to add at the held nodes of the base (x = 0 at rest): stresses, pressure
 * and contact there, in equilibrium with `pressure`. */
struct forces forces_at_base(struct fe_model *model, const struct fe_state *state, double pressure);

#endif
