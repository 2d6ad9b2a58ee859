#include "solver/post/output.h"

#include <errno.h>
#include <stdbool.h>
#include <string.h>

enum status output_open(struct output *output, const char *directory, const char *name,
                        struct error *error) {
  int path = snprintf(output->path, sizeof output->path, "%s/%s", directory, name);
  int temporary =
      snprintf(output->temporary, sizeof output->temporary, "%s/.%s.part", directory, name);
  output->file = NULL;
  if (path < 0 || temporary < 0 || (size_t)temporary >= sizeof output->temporary) {
    return error_set(error, STATUS_IO, NULL, "the path of %s is too long", name);
  }
  output->file = fopen(output->temporary, "wb");
  if (!output->file) {
    return error_set(error, STATUS_IO, NULL, "cannot write %.300s: %s", output->path,
                     strerror(errno));
  }
  return STATUS_OK;
}

enum status output_close(struct output *output, enum status status, struct error *error) {
  bool failed = ferror(output->file) != 0;
  int cause = errno;
  if (fclose(output->file) != 0 && !failed) {
    failed = true;
    cause = errno;
  }
  output->file = NULL;
  if (status == STATUS_OK && !failed && rename(output->temporary, output->path) != 0) {
    failed = true;
    cause = errno;
  }
  if (status == STATUS_OK && failed) {
    status = error_set(error, STATUS_IO, NULL, "writing %.300s failed: %s", output->path,
                       strerror(cause));
  }
  if (status != STATUS_OK) {
    remove(output->temporary);
  }
  return status;
}
