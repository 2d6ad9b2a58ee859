/* The bellows of the snap tests. */
#ifndef PNEULAB_TESTS_SNAP_CASE_H
#define PNEULAB_TESTS_SNAP_CASE_H

#include "solver/job/snap.h"

/* Reads a job of a body of 40 mm, wall 2 mm, shells of 40 and 55 deg, PET of 0.25 mm, after its
 * parts: more members of the actuator (", \"pairs\": 2") and of the job, or "". */
enum status snap_case_read(const char *actuator, const char *job, struct job_spec *spec,
                           struct error *error);

/* The same, asserting that the job is valid. */
void snap_case_must_read(const char *actuator, const char *job, struct job_spec *spec);

#endif
