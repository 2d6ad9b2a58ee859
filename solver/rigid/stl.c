#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "solver/rigid/stl_internal.h"

enum status stl_refuse_count(double count, struct error *error) {
  return error_set(error, STATUS_TOO_LARGE, NULL,
                   "the STL file has %.0f triangles or more\nat most %d: simplify the surface",
                   count, STL_TRIANGLES_MAX);
}

enum status stl_refuse_memory(struct error *error) {
  return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the triangles of an STL file");
}

void stl_release(struct stl *stl) {
  free(stl->corner);
  *stl = (struct stl){0};
}

static uint32_t read_word(const unsigned char *at) {
  return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static size_t binary_size(uint32_t count) {
  return STL_HEADER + (size_t)STL_RECORD * count;
}

/* What the beginning of a file of `size` bytes says it is. */
enum form { FORM_BINARY, FORM_TEXT, FORM_NONE };

static enum form form_of(const unsigned char *head, size_t size) {
  size_t at = 0, known = size < STL_HEADER ? size : STL_HEADER;
  if (size >= STL_HEADER && size == binary_size(read_word(head + STL_HEADER - 4))) {
    return FORM_BINARY;
  }
  while (at < known && isspace(head[at])) {
    at++;
  }
  bool solid = known - at >= 5 && strncasecmp((const char *)head + at, "solid", 5) == 0;
  return solid && !memchr(head, '\0', known) ? FORM_TEXT : FORM_NONE;
}

/* Checks size and count by the header alone, the first bytes of `size`. */
static enum status check_head(const unsigned char *head, size_t size, enum form *form,
                              struct error *error) {
  *form = form_of(head, size);
  if (*form == FORM_NONE && size < STL_HEADER) {
    return error_set(error, STATUS_INVALID, NULL,
                     "%zu bytes are no STL file\ntext that begins with \"solid\", or a binary "
                     "file of 84 bytes and 50 for each triangle",
                     size);
  }
  uint32_t count = size >= STL_HEADER ? read_word(head + STL_HEADER - 4) : 0;
  if (*form == FORM_NONE) {
    return error_set(error, STATUS_INVALID, NULL,
                     "the STL file is cut off, or none: as a binary one it has %lu triangles, "
                     "which take %zu bytes, but it has %zu\ntext that begins with \"solid\", or a "
                     "binary file of 84 bytes and 50 for each triangle",
                     (unsigned long)count, binary_size(count), size);
  }
  return *form == FORM_BINARY && count > STL_TRIANGLES_MAX ? stl_refuse_count(count, error)
                                                           : STATUS_OK;
}

static enum status read_binary(const unsigned char *data, struct stl *stl, struct error *error) {
  uint32_t count = read_word(data + STL_HEADER - 4);
  stl->corner = malloc(sizeof(double[9]) * ((size_t)count + 1));
  if (!stl->corner) {
    return stl_refuse_memory(error);
  }
  for (uint32_t t = 0; t < count; t++) {
    const unsigned char *record = data + binary_size(t) + 12;
    for (int i = 0; i < 9; i++) {
      uint32_t word = read_word(record + 4 * i);
      float value;
      memcpy(&value, &word, sizeof value);
      if (!isfinite(value)) {
        return error_set(error, STATUS_INVALID, NULL,
                         "corner %d of triangle %lu of the STL file has a coordinate that is no "
                         "finite number\nfinite numbers",
                         i / 3 + 1, (unsigned long)t + 1);
      }
      stl->corner[9 * (size_t)t + (size_t)i] = (double)value;
    }
  }
  stl->count = (int)count;
  return STATUS_OK;
}

enum status stl_read(const unsigned char *data, size_t size, struct stl *stl, struct error *error) {
  enum form form;
  *stl = (struct stl){0};
  enum status status = check_head(data, size, &form, error);
  if (status == STATUS_OK) {
    status =
        form == FORM_TEXT ? stl_read_text(data, size, stl, error) : read_binary(data, stl, error);
  }
  if (status == STATUS_OK && stl->count == 0) {
    status = error_set(error, STATUS_INVALID, NULL,
                       "the STL file has no triangle\na closed surface of at least 4");
  }
  if (status != STATUS_OK) {
    stl_release(stl);
  }
  return status;
}

/* ---- files ------------------------------------------------------------------------------ */

static enum status refuse_system(const char *what, struct error *error) {
  return error_set(error, STATUS_INVALID, NULL,
                   "the STL file cannot be %s (%s)\na file that can be read", what,
                   strerror(errno));
}

/* Reads the rest of a file whose header is known and fits its size. */
static enum status read_rest(FILE *file, const unsigned char *head, size_t known, size_t size,
                             struct stl *stl, struct error *error) {
  unsigned char *data = malloc(size + 1);
  if (!data) {
    return stl_refuse_memory(error);
  }
  memcpy(data, head, known);
  size_t length = known + fread(data + known, 1, size - known, file);
  enum status status = length == size
                           ? stl_read(data, size, stl, error)
                           : error_set(error, STATUS_INVALID, NULL,
                                       "of the %zu bytes of the STL file only %zu "
                                       "could be read\na file that can be read to its end",
                                       size, length);
  free(data);
  return status;
}

enum status stl_load(const char *path, struct stl *stl, struct error *error) {
  struct stat properties;
  unsigned char head[STL_HEADER];
  enum form form;
  *stl = (struct stl){0};
  /* Opening a pipe would wait for its writer. */
  if (stat(path, &properties) != 0) {
    return refuse_system("opened", error);
  }
  if (!S_ISREG(properties.st_mode)) {
    return error_set(error, STATUS_INVALID, NULL,
                     "the STL file is not a regular file\na file that can be read");
  }
  if (properties.st_size > STL_FILE_MAX) {
    return error_set(error, STATUS_TOO_LARGE, NULL,
                     "the STL file has %.0f MiB\nat most %d MiB: simplify the surface",
                     (double)properties.st_size / (1 << 20), STL_FILE_MAX >> 20);
  }
  FILE *file = fopen(path, "rb");
  if (!file) {
    return refuse_system("opened", error);
  }
  size_t size = (size_t)properties.st_size, known = fread(head, 1, sizeof head, file);
  enum status status = known == (size < sizeof head ? size : sizeof head)
                           ? check_head(head, size, &form, error)
                           : refuse_system("read", error);
  if (status == STATUS_OK) {
    status = read_rest(file, head, known, size, stl, error);
  }
  fclose(file);
  return status;
}

/* ---- writing ---------------------------------------------------------------------------- */

static void write_word(unsigned char *at, uint32_t word) {
  for (int i = 0; i < 4; i++) {
    at[i] = (unsigned char)(word >> 8 * i);
  }
}

unsigned char *stl_write(const struct stl *stl, size_t *size) {
  *size = binary_size((uint32_t)stl->count);
  unsigned char *data = calloc(*size, 1);
  if (!data) {
    return NULL;
  }
  write_word(data + STL_HEADER - 4, (uint32_t)stl->count);
  for (int t = 0; t < stl->count; t++) {
    unsigned char *record = data + binary_size((uint32_t)t) + 12;
    for (int i = 0; i < 9; i++) {
      float value = (float)stl->corner[9 * (size_t)t + (size_t)i];
      uint32_t word;
      memcpy(&word, &value, sizeof word);
      write_word(record + 4 * i, word);
    }
  }
  return data;
}
