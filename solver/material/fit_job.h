/* A job of kind fit-material, from its curve to its result document. */
#ifndef PNEULAB_MATERIAL_FIT_JOB_H
#define PNEULAB_MATERIAL_FIT_JOB_H

#include <jansson.h>
#include <stdbool.h>
#include "solver/job/spec.h"

/* Runs the job. On success *document is a new reference and *ending tells how the fit ended: one
 * that did not settle gives a document too, without a material. STATUS_NO_MEMORY, or the failures
 * of tensile_read for a document that was not checked. */
enum status fit_job(const struct job_spec *spec, bool (*cancelled)(void *context),
                    json_t **document, enum status *ending, struct error *error);

#endif
