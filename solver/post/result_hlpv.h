/* The result document of an `hlpv` job. */
#ifndef PNEULAB_POST_RESULT_HLPV_H
#define PNEULAB_POST_RESULT_HLPV_H

#include <jansson.h>
#include <stdio.h>
#include "solver/hlpv/trajectory.h"
#include "solver/job/spec.h"

struct result_hlpv_options {
  FILE *events; /* progress as JSON lines, or NULL */
  bool (*cancelled)(void *context);
  bool brief; /* status, metrics, warnings and statistics only */
};

/* Runs the job. On success *document is a new reference and *ending tells how the simulation ended:
 * one that stopped early gives a document too. STATUS_NO_MEMORY, INTERNAL. */
enum status result_hlpv(const struct job_spec *spec, const struct result_hlpv_options *options,
                        json_t **document, enum status *ending, struct error *error);

/* The "statistics" of an integration that took wall_s and cpu_s seconds, a new reference. */
json_t *result_hlpv_statistics(const struct hlpv_counts *counts, double wall_s, double cpu_s);

#endif
