/* Designs that no other one beats, and how much of the space of objectives they dominate. */
#ifndef PNEULAB_EXPLORE_PARETO_H
#define PNEULAB_EXPLORE_PARETO_H

#include <stdbool.h>
#include <stddef.h>
#include "solver/base/error.h"

enum { PARETO_OBJECTIVES_MAX = 10 };

/* Numbers the fronts of `count` designs with `objectives` values each, y[count][objectives], all to
 * be minimised (negate what is to be maximised): front[i] is 1 for a design that no other one
 * dominates, 2 for one that only those of front 1 dominate, and so on (Deb et al. 2002); 0 for one
 * with a value that is not finite. Equal designs share a front. Time count^2 objectives.
 * STATUS_NO_MEMORY. */
enum status pareto_fronts(const double *y, size_t count, int objectives, int front[],
                          struct error *error);

/* The volume that the designs dominate within the box up to `reference` (Zitzler and Thiele 1998),
 * exactly, by slicing into exclusive contributions (While, Bradstreet and Barone 2012). Designs
 * that are not better than the reference in every objective add nothing. STATUS_NO_MEMORY. */
enum status pareto_hypervolume(const double *y, size_t count, int objectives,
                               const double reference[], double *volume, struct error *error);

#endif
