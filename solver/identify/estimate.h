/* Weighted least squares over whole trajectories by the Levenberg-Marquardt method of GSL
 * (gsl_multilarge_nlinear, which takes the normal matrix in blocks: points are coupled only by what
 * they share), and what follows for the uncertainty. */
#ifndef PNEULAB_IDENTIFY_ESTIMATE_H
#define PNEULAB_IDENTIFY_ESTIMATE_H

#include "solver/identify/identification.h"

/* Estimates all points from their starting values, with the noise of each trial from its residuals
 * unless the job gives it; fills estimates, groups, what is shared, and id->sigma.
 * STATUS_OK, also where a group did not converge (group.converged); DIVERGED, TIMEOUT, CANCELLED,
 * NO_MEMORY. */
enum status estimate_points(struct identification *id, struct error *error);

/* Least squares of one group from its values as they stand, with the noise as it stands; fills its
 * iterations and converged, and the residuals of its points. STATUS_OK, or as estimate_points. */
enum status estimate_fit(struct identification *id, struct group *group, struct error *error);

/* Half width of the 95 % confidence interval of a number with that standard error, by Student's
 * distribution. */
double estimate_half_width(double stderror, double freedom);

/* The group of a point. */
const struct group *estimate_group(const struct identification *id, size_t point);

#endif
