/* The description of one failure, filled where it is noticed and carried up unchanged. */
#ifndef PNEULAB_BASE_ERROR_H
#define PNEULAB_BASE_ERROR_H

#include <stddef.h>
#include "solver/base/status.h"

struct error {
  enum status status;
  char message[400]; /* what was wrong, what is allowed, with an example: plain sentences */
  char pointer[200]; /* JSON pointer (RFC 6901) into the job, or "" */
  int line, column;  /* 1-based place in the text, 0 when unknown */
};

/* Fills *error (which may be NULL: then nothing is stored) and returns `status`, so that a
 * caller can write `return error_set(error, STATUS_INVALID, "/load", "...")`.
 * pointer: JSON pointer or NULL. format: printf-like; the text is cut at the field's size. */
enum status error_set(struct error *error, enum status status, const char *pointer,
                      const char *format, ...) __attribute__((format(printf, 4, 5)));

#endif
