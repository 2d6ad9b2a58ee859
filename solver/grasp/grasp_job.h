/* A grasp from its job to its result document. */
#ifndef PNEULAB_GRASP_GRASP_JOB_H
#define PNEULAB_GRASP_GRASP_JOB_H

#include <jansson.h>
#include <stdio.h>
#include "solver/job/spec.h"

struct grasp_options {
  const char *out_dir; /* for files, NULL: none are written */
  FILE *events;        /* progress as JSON lines, NULL: none */
  bool verbose;        /* iterations on standard error */
  bool (*cancelled)(void *context);
};

/* Solves the grasp: each finger that sees the object in its own way, then all together. On success
 * *document is a new reference; a course that stopped early also gives one, with the status of its
 * end in *ending. Other failures leave *document NULL and fill *error. */
enum status grasp_job(const struct job_spec *spec, const struct grasp_options *options,
                      json_t **document, enum status *ending, struct error *error);

#endif
