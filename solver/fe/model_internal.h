/* What the parts of the model share. */
#ifndef PNEULAB_FE_MODEL_INTERNAL_H
#define PNEULAB_FE_MODEL_INTERNAL_H

#include "solver/fe/model.h"

/* Index of entry (r, c), r <= c, in an upper triangle of order n packed by rows. */
size_t model_packed_index(int n, int r, int c);

/* Makes room for the tangents of the listed pairs. False when memory runs out. */
bool model_room_for_pairs(struct fe_model *model);

/* Hands the tangents of the pairs that touch to the cliques, after the pairs have been evaluated;
 * when one of them is not in the analysed pattern, or the list of pairs is another one, the tangent
 * is ordered and analysed anew. STATUS_NO_MEMORY. */
enum status model_renew_pattern(struct fe_model *model);

/* Puts the analysis in use to the spare ones, or without such destroys it. */
void model_park_analysis(struct fe_model *model);

/* Adds contact to the residual and, with `tangent`, to the cliques, after the elements have been
 * evaluated. With `tangent` the partners are found anew first. STATUS_NO_MEMORY. */
enum status model_evaluate_contact(struct fe_model *model, const double *u, bool tangent);

#endif
