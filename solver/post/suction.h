/* What the suckers of a body hold. */
#ifndef PNEULAB_POST_SUCTION_H
#define PNEULAB_POST_SUCTION_H

#include <jansson.h>
#include "solver/job/spec.h"

/* Force (N) of one sucker on what it closes on: suction times the area of its opening. */
double suction_force(const struct job_spec *spec, int sucker);

/* The suckers in the order of the job, each with position_mm, diameter_mm and suction_force_N;
 * NULL for a body without them or without memory. A new reference. */
json_t *suction_list(const struct job_spec *spec);

#endif
