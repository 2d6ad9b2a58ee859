#include "server/plot/artifact.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "server/base/file.h"

enum { FILE_LIMIT = 64 << 20 };

enum status artifact_read(const char *directory, const char *name, const char *what, char **data,
                          size_t *size, struct error *error) {
  size_t length = 0;
  int fd = directory ? file_open_below(directory, name, &length) : -1;
  FILE *file = fd >= 0 ? fdopen(fd, "rb") : NULL;
  *data = NULL;
  *size = 0;
  if (fd >= 0 && !file) {
    close(fd);
  }
  if (!file) {
    return error_set(error, STATUS_NOT_FOUND, NULL, "the job left no %s to draw %s from", name,
                     what);
  }
  enum status status = STATUS_OK;
  if (length > FILE_LIMIT) {
    status = error_set(error, STATUS_TOO_LARGE, NULL, "%s has %zu bytes; up to %d are drawn", name,
                       length, FILE_LIMIT);
  } else if (!(*data = malloc(length + 1))) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %s", name);
  } else {
    *size = fread(*data, 1, length, file);
    (*data)[*size] = '\0';
  }
  fclose(file);
  return status;
}
