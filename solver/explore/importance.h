/* How much of the variance of a quantity each parameter is responsible for. */
#ifndef PNEULAB_EXPLORE_IMPORTANCE_H
#define PNEULAB_EXPLORE_IMPORTANCE_H

#include <stdint.h>
#include "solver/base/error.h"

/* A share of the variance with its 95 % interval (bootstrap percentiles: Efron 1979). */
struct share {
  double value, low, high;
};

struct importance {
  struct share first; /* of the parameter alone */
  struct share total; /* with all its interactions */
};

/* Values of a function at two independent sets of `count` points, a[count] and b[count], and at
 * `parameters` mixed ones: mixed[i][count] at the points of the first set whose parameter i comes
 * from the second. Fills importance[parameters]: first-order indices by the estimator of Saltelli
 * et al. (2010, table 2, b), total ones by that of Jansen (1999). All 0 for a function that does
 * not vary. The intervals depend on `seed` alone. STATUS_NO_MEMORY. */
enum status importance_sobol(const double *a, const double *b, const double *const mixed[],
                             int count, int parameters, uint64_t seed,
                             struct importance importance[], struct error *error);

/* The share of the variance that is of each pair of parameters together and of neither alone, by
 * the estimator of Saltelli (2002, theorem 2): as importance_sobol, with back[i][count] at the
 * points of the second set whose parameter i comes from the first. Fills
 * pair[parameters][parameters], symmetric, its diagonal 0. All 0 for a function that does not vary.
 * The estimates scatter around 0 for pairs that do not interact. STATUS_NO_MEMORY. */
enum status importance_pairs(const double *a, const double *b, const double *const mixed[],
                             const double *const back[], int count, int parameters, uint64_t seed,
                             struct share pair[], struct error *error);

/* Correlation of x[count] and y[count] by value (Pearson) and by rank (Spearman 1904; equal values
 * share their mean rank); 0 where one of them does not vary. STATUS_NO_MEMORY. */
enum status importance_correlation(const double *x, const double *y, int count, double *linear,
                                   double *rank, struct error *error);

#endif
