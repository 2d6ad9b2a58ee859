/* A job of kind material-curve: what a material does in the three simple deformations. */
#ifndef PNEULAB_MATERIAL_CURVE_JOB_H
#define PNEULAB_MATERIAL_CURVE_JOB_H

#include <jansson.h>
#include "solver/job/spec.h"

/* Runs the job. On success *document is a new reference. STATUS_NO_MEMORY. */
enum status curve_job(const struct job_spec *spec, json_t **document, struct error *error);

#endif
