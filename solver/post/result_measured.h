/* A simulated response against a measured one. */
#ifndef PNEULAB_POST_RESULT_MEASURED_H
#define PNEULAB_POST_RESULT_MEASURED_H

#include <jansson.h>
#include "solver/job/spec.h"

/* Adds to the result document of a job with a measured curve the array "measured" (pressure_kPa,
 * measured, simulated, error = simulated - measured, angles in degrees) and the metrics
 * measured_rmse_deg, measured_max_error_deg and measured_r_squared. Between the recorded pressures
 * the simulated curve is Steffen's monotone cubic (1990). Measured points beyond them are left out
 * with a warning. Does nothing for a job without a measured curve.
 * STATUS_OK, NO_MEMORY, or the failures of measured_read. */
enum status result_measured_store(const struct job_spec *spec, json_t *document,
                                  struct error *error);

#endif
