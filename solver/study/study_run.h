/* Runs a study: its members by processes of this program, several at once, and their results as one
 * document. */
#ifndef PNEULAB_STUDY_STUDY_RUN_H
#define PNEULAB_STUDY_STUDY_RUN_H

#include <jansson.h>
#include <stdio.h>
#include "solver/job/spec.h"

enum { STUDY_JOBS_MAX = 256 };

struct study_options {
  const char *out_dir; /* its folder "members" keeps the members; NULL: a temporary one */
  FILE *events;        /* progress as JSON lines, NULL: none */
  int jobs;            /* processes at a time, 0: as many as there are cores */
  int threads;         /* of each */
  bool verbose;        /* one line a member on standard error */
  bool (*cancelled)(void *context);
};

/* Solves what out_dir does not have yet. Files of a member in out_dir/members, HASH being that of
 * its job: HASH.job.json, the job; HASH.json, its result, under this name only when it is
 * complete; HASH.log, what a member without result has said. A result of this version of the solver
 * is not computed again; equal members and mirror images are computed once. Members that fail are
 * part of the result.
 * On success *document is a new reference, and *ending tells whether the study was completed:
 * STATUS_OK, TIMEOUT, CANCELLED, or DIVERGED when not a single member could be solved.
 * Other failures: STATUS_IO, STATUS_NO_MEMORY. */
enum status study_run(const struct job_spec *spec, const struct study_options *options,
                      json_t **document, enum status *ending, struct error *error);

#endif
