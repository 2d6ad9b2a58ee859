/* What a run of the program reads and says: job texts, documents, exit codes. */
#ifndef PNEULAB_ANSWER_H
#define PNEULAB_ANSWER_H

#include <jansson.h>
#include <stdio.h>
#include "solver/base/error.h"

enum exit_code {
  EXIT_SUCCEEDED = 0,
  EXIT_INVALID_JOB = 2,
  EXIT_STOPPED_EARLY = 3,
  EXIT_INTERNAL = 4,
  EXIT_CANCELLED = 5
};

/* Reads a job's text, "-" from standard input. One byte more than a job may have is read, so that
 * an oversized one is recognised, not cut. The caller frees the result; NULL with the reason in
 * *error. */
char *answer_read_job(const char *path, size_t *size, struct error *error);

/* Prints a document: a study's, which is long, without spaces; others people read. */
void answer_write(const json_t *document, FILE *file);

/* What is printed instead of a result, a new reference; NULL when memory runs out. */
json_t *answer_of_error(const struct error *error);
enum exit_code answer_exit_of_error(const struct error *error);

/* The exit code of a run with a result that ended so. */
enum exit_code answer_exit_of_ending(enum status ending);

#endif
