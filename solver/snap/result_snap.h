/* The result document of a `snap` job. */
#ifndef PNEULAB_SNAP_RESULT_SNAP_H
#define PNEULAB_SNAP_RESULT_SNAP_H

#include <jansson.h>
#include <stdio.h>
#include "solver/job/spec.h"

struct result_snap_options {
  FILE *events; /* progress as JSON lines, or NULL */
  bool (*cancelled)(void *context);
};

/* Runs the job. On success *document is a new reference and *ending tells how the computation
 * ended: one that stopped early gives a document too. STATUS_NO_MEMORY, GEOMETRY, INTERNAL. */
enum status result_snap(const struct job_spec *spec, const struct result_snap_options *options,
                        json_t **document, enum status *ending, struct error *error);

#endif
