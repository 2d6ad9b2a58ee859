/* The parameters of a group in one vector, its normal matrix, and the covariance that follows. */
#ifndef PNEULAB_IDENTIFY_COVARIANCE_H
#define PNEULAB_IDENTIFY_COVARIANCE_H

#include <gsl/gsl_matrix.h>

#include "solver/identify/identification.h"

/* Where each parameter of a group lives, and its scale in the solver. */
struct layout {
  int count;
  double **slot; /* in the identification */
  double *scale;
  double *sign;                    /* where not 0, slot * sign must stay positive */
  int (*column)[POINT_PARAMETERS]; /* for each point of the group, of its columns: -1 for none */
};

/* STATUS_NO_MEMORY. The caller releases it in any case. */
enum status layout_create(struct identification *id, const struct group *group,
                          struct layout *layout, struct error *error);
void layout_release(struct layout *layout);

/* v += J u, or J^T u, with the Jacobian of the residuals to the scaled parameters. */
void layout_multiply(const struct layout *layout, const struct identification *id,
                     const struct group *group, bool transposed, const double *u, double *v);

/* Adds the lower half of J^T J. */
void layout_normal(const struct layout *layout, const struct identification *id,
                   const struct group *group, gsl_matrix *normal);

/* Fills covariance, freedom and chi-square of a group, and standard errors and singular values of
 * its points, at its parameters as they stand. STATUS_OK, or the failures of point_evaluate. */
enum status covariance_fill(struct identification *id, struct group *group, struct error *error);

#endif
