/* Files that appear whole or not at all. */
#ifndef PNEULAB_POST_OUTPUT_H
#define PNEULAB_POST_OUTPUT_H

#include <stdio.h>
#include "solver/base/error.h"

enum { OUTPUT_PATH = 4096 };

/* A file being written under a temporary name beside its final one. */
struct output {
  FILE *file;
  char path[OUTPUT_PATH], temporary[OUTPUT_PATH];
};

/* Opens `name` in `directory` for writing. On success output_close has to follow. STATUS_IO with
 * the reason when that fails. */
enum status output_open(struct output *output, const char *directory, const char *name,
                        struct error *error);

/* Closes the file. With `status` OK and every write done it gets its final name, replacing an
 * older file; otherwise it is removed. Returns `status`, or STATUS_IO with the reason. */
enum status output_close(struct output *output, enum status status, struct error *error);

#endif
