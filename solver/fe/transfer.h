/* Carries a state over to a finer mesh of the same body. */
#ifndef PNEULAB_FE_TRANSFER_H
#define PNEULAB_FE_TRANSFER_H

#include "solver/fe/model.h"

/* Fills `carried`, a state of model `to`, from `state` of model `from`. The cells of the mesh of
 * `to` must subdivide those of `from`: displacements and element pressures are then carried over
 * exactly; a contact point takes the multiplier of the point nearest to it.
 * STATUS_OK, STATUS_INTERNAL when the meshes are not nested, or STATUS_NO_MEMORY. */
enum status transfer_state(const struct fe_model *from, const struct fe_state *state,
                           const struct fe_model *to, struct fe_state *carried,
                           struct error *error);

#endif
