/* The law that a bistable job has computed. */
#ifndef PNEULAB_BISTABLE_COMPUTED_LAW_H
#define PNEULAB_BISTABLE_COMPUTED_LAW_H

#include <jansson.h>
#include <stdio.h>
#include "solver/job/bistable.h"
#include "solver/job/spec.h"

/* Solves the snap jobs within the bistable one, one after the other, and fills the tables of their
 * laws. *results: their documents by the names of the laws, a new reference; NULL after a failure.
 * As computed_law_take and result_snap. */
enum status computed_law(const struct job_spec *spec, FILE *events,
                         bool (*cancelled)(void *context), json_t **results, struct error *error);

/* Fills *table, of the law at `pointer` in the job, which the caller releases, from the "law" in
 * the result of a snap job, without the paths that do not lead from one side to the other: a
 * warning of the result names each. STATUS_DIVERGED where fewer than two are left; otherwise as
 * law_table_read. */
enum status computed_law_take(json_t *result, const char *pointer, struct law_table *table,
                              struct error *error);

#endif
