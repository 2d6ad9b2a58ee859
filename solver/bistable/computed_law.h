/* The law that a bistable job has computed. */
#ifndef PNEULAB_BISTABLE_COMPUTED_LAW_H
#define PNEULAB_BISTABLE_COMPUTED_LAW_H

#include <jansson.h>
#include <stdio.h>
#include "solver/job/bistable.h"
#include "solver/job/spec.h"

/* Solves the snap job within the bistable one and fills the table of its law. *result: the document
 * of the snap job, a new reference; NULL where the job has none, and after a failure.
 * STATUS_DIVERGED, TIMEOUT, CANCELLED, ... where it has no law to give, with its reason; otherwise
 * as result_snap and law_table_read. */
enum status computed_law(const struct job_spec *spec, FILE *events,
                         bool (*cancelled)(void *context), json_t **result, struct error *error);

#endif
