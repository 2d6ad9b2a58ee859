/* A surrogate at points that are spread over its design space, as variance-based indices need it.
 */
#ifndef PNEULAB_STUDY_SPREAD_H
#define PNEULAB_STUDY_SPREAD_H

#include "server/study/model.h"

/* Values at two independent sets of points, and at those of either set with one parameter from the
 * other. */
struct spread {
  int count;
  size_t parameters;
  double *a, *b;
  double *mixed[SURROGATE_PARAMETERS_MAX]; /* at a, the parameter from b */
  double *back[SURROGATE_PARAMETERS_MAX];  /* at b, the parameter from a; NULL unless asked for */
  double *room;                            /* of all */
};

/* Evaluates the surrogate at 2^8 to 2^12 points of a scrambled Sobol' sequence (pseudo-random ones
 * in more than 20 parameters), as many as take about a second. STATUS_OK or STATUS_NO_MEMORY; the
 * caller clears *spread in either case. */
enum status spread_make(const struct model *model, bool back, struct spread *spread,
                        struct error *error);
void spread_clear(struct spread *spread);

#endif
