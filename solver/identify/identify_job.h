/* A job of kind identify, from its trials to its result document. */
#ifndef PNEULAB_IDENTIFY_IDENTIFY_JOB_H
#define PNEULAB_IDENTIFY_IDENTIFY_JOB_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#include "solver/job/spec.h"

/* Runs the job. events: for progress as JSON lines, or NULL. On success *document is a new
 * reference and *ending tells how the identification ended. STATUS_NO_MEMORY, or the failures of
 * trials_read and steps_part for a document that was not checked. */
enum status identify_job(const struct job_spec *spec, FILE *events,
                         bool (*cancelled)(void *context), json_t **document, enum status *ending,
                         struct error *error);

#endif
