/* What the data do not show, and what else deserves a warning, in words. */
#ifndef PNEULAB_IDENTIFY_REMARKS_H
#define PNEULAB_IDENTIFY_REMARKS_H

#include <jansson.h>
#include "solver/identify/outcome.h"

/* A new object: "visible" (the combinations that the data show whatever they are), "remarks"
 * (sentences on coefficients and combinations that cannot be seen), and "points" with the singular
 * values of the Jacobian of each to the logarithms of its coefficients, in units of the noise: 1
 * over the least is the relative error of the combination that is seen worst. */
json_t *remarks_identifiability(const struct identification *id);

/* Appends sentences to the array: on the noise model, the polynomials, gamma, gaps of the data,
 * groups that did not converge, set-points out of which a mode only jumps. */
void remarks_warn(const struct identification *id, const struct outcome *outcome, json_t *warnings);

#endif
