/* Runs one checked job from mesh to result document. */
#ifndef PNEULAB_RUN_H
#define PNEULAB_RUN_H

#include <jansson.h>
#include <stdio.h>
#include "solver/fe/model.h"

struct forecast;
struct path_record;

/* What one solve leaves to the next of a chain, in memory; all 0 at first. */
struct run_carry {
  struct path_record *path;    /* converged states of the last solve that reached its load */
  struct forecast *earlier;    /* those of solves before it */
  struct fe_analyses analyses; /* of their tangents */
};

/* Releases what is carried, and clears it. */
void run_carry_release(struct run_carry *carry);

struct run_options {
  const char *out_dir;   /* directory for artifacts, NULL: none are written */
  const char *deck_path; /* CalculiX deck to write instead of solving, NULL: solve */
  const char *path_in;   /* file of a neighbouring design's path to start from, NULL: none */
  const char *path_out;  /* file for the path, for such use, NULL: none */
  /* The solve starts from what is carried, where its mesh has the same topology, and leaves its own
   * there when it reaches its load. NULL: none. */
  struct run_carry *carry;
  FILE *events; /* progress as JSON lines, NULL: none */
  bool verbose; /* iterations on standard error */
  bool (*cancelled)(void *context);
};

/* Solves the job. On success *document is a new reference: a solve that stopped early also
 * gives one, with the reason inside, and the status of its end in *ending. Other failures
 * (geometry, memory, writing of files) leave *document NULL and fill *error. */
enum status run_job(const struct job_spec *spec, const struct run_options *options,
                    json_t **document, enum status *ending, struct error *error);

#endif
