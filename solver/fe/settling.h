/* How the multipliers of rigid objects settle: the fixed point z = G(z), where G gives the
 * tractions of the equilibrium with the multipliers z, by Anderson's acceleration (1965) of z <-
 * G(z). What is minimised over the last updates is the difference of the nodal forces, which sees
 * of the tractions what the body feels. */
#ifndef PNEULAB_FE_SETTLING_H
#define PNEULAB_FE_SETTLING_H

#include "solver/fe/obstacle.h"

struct settling;

/* For a model whose objects have all been added. NULL when memory runs out. */
struct settling *settling_create(const struct fe_model *model);
void settling_destroy(struct settling *settling);

/* Forgets earlier updates: a new sequence begins. */
void settling_restart(struct settling *settling);

/* By how much the nodal forces of the objects change by the update that is due, and by how much
 * they are still to change in all, from how that has fallen since the last one; as parts of them.
 */
struct settling_change {
  double next, left;
};
struct settling_change settling_measure(struct settling *settling, const struct fe_model *model);

/* Renews the multipliers, after settling_measure. The model has to be evaluated anew. */
void settling_update(struct settling *settling, struct fe_model *model);

#endif
