/* The description of one failure, filled where it is noticed and carried up unchanged. */
#ifndef PNEULAB_BASE_ERROR_H
#define PNEULAB_BASE_ERROR_H

#include <stddef.h>
#include "solver/base/status.h"

struct error {
  enum status status;
  char message[800]; /* what was wrong, what is allowed, with an example: plain sentences */
  char pointer[200]; /* JSON pointer (RFC 6901) into the job, or "" */
  int line, column;  /* 1-based place in the text, 0 when unknown */
  /* What the message says, in parts for programs; "" for a part that does not apply. */
  char found[200];   /* what is there */
  char allowed[400]; /* what may be there */
  char example[240]; /* JSON text of something right */
  char nearest[64];  /* the known word nearest to the one that was found */
};

/* Fills *error (which may be NULL: then nothing is stored) and returns `status`, so that a
 * caller can write `return error_set(error, STATUS_INVALID, "/load", "...")`.
 * pointer: JSON pointer or NULL. format: printf-like; the text is cut at the field's size. A line
 * feed in it parts what was found from what is allowed, and a second one that from an example in
 * JSON: "the bore of %g mm is too wide\nat most %g mm\n\"%g mm\"" becomes the message "the bore of
 * 9 mm is too wide: at most 3 mm; for example "3 mm"", and the parts found, allowed and example. */
enum status error_set(struct error *error, enum status status, const char *pointer,
                      const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Notes the known word that was probably meant (NULL: none) in an error that error_set has just
 * filled; `error` may be NULL. Returns `status`. */
enum status error_nearest(struct error *error, enum status status, const char *nearest);

/* Moves *error to another pointer and puts words, printf-like, before its message; the parts stay.
 */
void error_carry(struct error *error, const char *pointer, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Writes the place and the message, "/load/steps (line 3, column 14): ...", into `out`, cut at
 * `size`. Returns `out`. */
const char *error_describe(const struct error *error, char *out, size_t size);

/* Size of the longest text of error_describe with its end. */
enum { ERROR_TEXT_MAX = sizeof(struct error) };

#endif
