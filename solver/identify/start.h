/* Starting values of an identification, from the data alone. */
#ifndef PNEULAB_IDENTIFY_START_H
#define PNEULAB_IDENTIFY_START_H

#include "solver/identify/identification.h"

/* Fills id->sigma: the job's, or from the second differences of evenly spaced rows (their median,
 * which steps do not move), at least a thousandth of the range over all trials. STATUS_NO_MEMORY.
 */
enum status start_noise(struct identification *id, struct error *error);

/* Fills the values of all points and what they share: alpha and beta by regression of the pressure
 * on its integral, stiffness and rest by regression of the elongation on the pressure, damping (and
 * mass or gamma) as the best of a few damping ratios (and frequencies). STATUS_OK, or the failures
 * of point_evaluate. */
enum status start_values(struct identification *id, struct error *error);

#endif
