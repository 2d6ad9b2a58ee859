/* The measured curve of a response job: pressures and angles from the text of a table. */
#ifndef PNEULAB_JOB_MEASURED_H
#define PNEULAB_JOB_MEASURED_H

#include "solver/job/spec.h"

struct measured_curve {
  size_t count;
  double *pressure; /* Pa */
  double *angle;    /* rad */
};

/* Reads the curve from "measured" of the job's document; the caller releases it.
 * STATUS_INVALID with the pointer: what table_read refuses; names of columns that say the opposite
 * of what they are used for; no pressure between 0 and that of the load. STATUS_TOO_LARGE,
 * NO_MEMORY. */
enum status measured_read(const json_t *document, const struct job_spec *spec,
                          struct measured_curve *curve, struct error *error);
void measured_release(struct measured_curve *curve);

#endif
