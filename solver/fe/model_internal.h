/* What the parts of the model share. */
#ifndef PNEULAB_FE_MODEL_INTERNAL_H
#define PNEULAB_FE_MODEL_INTERNAL_H

#include "solver/fe/model.h"

/* Index of entry (r, c), r <= c, in an upper triangle of order n packed by rows. */
size_t model_packed_index(int n, int r, int c);

/* Orders and analyses the tangent for the present pairs of the contact; makes room for their
 * cliques. */
enum status model_analyse(struct fe_model *model, struct error *error);

/* Adds contact to the residual and, with `tangent`, to the cliques, after the elements have been
 * evaluated. With `tangent` the partners are found anew first. STATUS_NO_MEMORY. */
enum status model_evaluate_contact(struct fe_model *model, const double *u, bool tangent);

#endif
