/* The result document of a `bistable` job. */
#ifndef PNEULAB_BISTABLE_RESULT_H
#define PNEULAB_BISTABLE_RESULT_H

#include <jansson.h>
#include <stdio.h>
#include "solver/bistable/trajectory.h"
#include "solver/job/spec.h"

struct result_bistable_options {
  FILE *events; /* progress as JSON lines, or NULL */
  bool (*cancelled)(void *context);
};

/* Runs the job; a law that it wants computed is computed first. On success *document is a new
 * reference and *ending tells how the simulation ended: one that stopped early gives a document
 * too. STATUS_INVALID for tables that are no laws and where there is no state to start from; the
 * failures of computed_law; STATUS_NO_MEMORY, INTERNAL. */
enum status result_bistable(const struct job_spec *spec,
                            const struct result_bistable_options *options, json_t **document,
                            enum status *ending, struct error *error);

/* Samples, events, plateaus, final state and laws, as members of a new object. */
json_t *bistable_parts(const struct bistable_system *system, const struct bistable_trajectory *t);

/* The metrics, as a new reference. */
json_t *bistable_metrics(const struct bistable_system *system, const struct bistable_trajectory *t);

#endif
