/* The numbers of a job that may vary: dimensions of the actuator, coefficients of the material. */
#ifndef PNEULAB_JOB_PARAMETER_H
#define PNEULAB_JOB_PARAMETER_H

#include "solver/job/spec.h"

enum { PNEUNET_DIMENSIONS = 23 };

/* Where a dimension stands in the actuator and in struct pneunet_given. */
struct pneunet_dimension {
  const char *group; /* member of the actuator that holds the key, or NULL */
  const char *key, *unit;
  size_t offset;
};

extern const struct pneunet_dimension pneunet_dimensions[PNEUNET_DIMENSIONS];

/* Fills the dimensions of a spec whose chambers are set, with the defaults of those that are not
 * given, and checks them. STATUS_OK, INVALID or GEOMETRY with the pointer to the dimension that
 * has to change. */
enum status pneunet_derive(const struct pneunet_given *given, struct pneunet_spec *spec,
                           struct error *error);

/* The parameters of a job: every dimension of a pneunet that it gives or that has a fixed default
 * and that has an effect on its body, then the coefficients of its material (of a built-in one as well). Where
 * both lengths are given, that of the chamber counts. Returns their number. */
int parameter_list(const struct job_spec *spec, struct job_parameter list[PARAMETERS_MAX]);

/* Value in SI. */
double parameter_value(const struct job_spec *spec, const struct job_parameter *parameter);

/* Sets the parameter to `value` (SI), everything else that the job gives being held, and derives
 * what follows from it, also half_model. On failure (as pneunet_derive) the spec is of no use. */
enum status parameter_set(struct job_spec *spec, const struct job_parameter *parameter,
                          double value, struct error *error);

#endif
