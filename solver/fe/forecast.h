/* What the path of a design will be, as far as those of designs before it tell.
 *
 * Every design is a point whose coordinates are its numbers (dimensions, coefficients, loads), and
 * its states are a function of that point, interpolated by kriging: with one design before it is
 * that one's states, with more of them than there are coordinates it is right to second order.
 * States are seen from the sections (solver/fe/section_form.h), so that bodies which bend by
 * different angles can be mixed. */
#ifndef PNEULAB_FE_FORECAST_H
#define PNEULAB_FE_FORECAST_H

#include "solver/fe/warm.h"

struct forecast;

/* NULL when memory runs out. The caller owns the result. */
struct forecast *forecast_create(void);
void forecast_destroy(struct forecast *forecast);

/* Takes over a record, in either case. Of records with different bodies only those with the
 * topology of the last one are kept. STATUS_OK or STATUS_NO_MEMORY. */
enum status forecast_add(struct forecast *forecast, struct path_record *record);

/* The path of the model's body, at point place[DESIGN_NUMBERS], as if it had been recorded. *out is
 * the caller's, and NULL where nothing is known of bodies with its topology. STATUS_OK, or
 * STATUS_NO_MEMORY: nothing is known any more then. */
enum status forecast_make(struct forecast *forecast, const struct fe_model *model,
                          const double *place, struct path_record **out);

/* Weights of `count` known points (count x DESIGN_NUMBERS) at `place`; their sum is 1. Ordinary
 * kriging (Matheron 1963) with a Gaussian correlation over the coordinates in which the points
 * differ, scaled to their ranges. STATUS_OK or STATUS_NO_MEMORY. */
enum status forecast_weights(const double *known, int count, const double *place, double *weight);

#endif
