/* The files of schema/ as part of the program: migrations, JSON Schemas, the API description. */
#ifndef PNEULAB_SCHEMA_EMBEDDED_H
#define PNEULAB_SCHEMA_EMBEDDED_H

#include <stddef.h>

struct embedded_file {
  const char *name;          /* "0001-jobs.sql" */
  const unsigned char *data; /* `size` bytes, then a NUL that is not counted */
  size_t size;
};

extern const struct embedded_file embedded_files[];
extern const size_t embedded_file_count;

#endif
