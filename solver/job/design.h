/* A design as a point: the numbers of a job that its body and its load follow from. */
#ifndef PNEULAB_JOB_DESIGN_H
#define PNEULAB_JOB_DESIGN_H

#include "solver/job/spec.h"

enum { DESIGN_NUMBERS = 60 };

/* Fills number[DESIGN_NUMBERS] with the dimensions of the actuator, the coefficients of its
 * material, pressure and gravity in SI, each at the same place in every job of a family; 0 where a
 * job has none. Of a response job. */
void design_numbers(const struct job_spec *spec, double number[DESIGN_NUMBERS]);

#endif
