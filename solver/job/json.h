/* JSON text of a job: guarded reading, JSON pointers, and the way back from a pointer to a line. */
#ifndef PNEULAB_JOB_JSON_H
#define PNEULAB_JOB_JSON_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include "solver/base/error.h"

enum { JSON_TEXT_MAX = 1 << 20, JSON_DEPTH_MAX = 32 };

/* Reads `size` bytes of JSON into *root (a new reference, owned by the caller).
 * Refused: more than JSON_TEXT_MAX bytes (STATUS_TOO_LARGE); malformed text, duplicate keys, NaN,
 * numbers beyond double or 64-bit range, invalid UTF-8, NUL characters, nesting deeper than
 * JSON_DEPTH_MAX (STATUS_SYNTAX with line and column). */
enum status json_text_read(const char *text, size_t size, json_t **root, struct error *error);

/* Jansson's json_loadb for any text, which is safe where memory runs out: then NULL with errno
 * ENOMEM, and *problem (which may be NULL) says nothing. Otherwise errno is 0. */
json_t *json_read(const char *text, size_t size, size_t flags, json_error_t *problem);

/* Line and column (from 1, in characters) of the value that `pointer` names in `text`, which
 * json_text_read has accepted. Where the pointer leads beyond the text, the place of the last
 * value on its way. */
void json_text_locate(const char *text, size_t size, const char *pointer, int *line, int *column);

/* A JSON pointer (RFC 6901) that grows and shrinks on the way through a document. Parts that no
 * longer fit are left out, so that it then names an ancestor. */
struct json_pointer {
  char text[200];
  size_t length;
  int hidden; /* levels that did not fit */
};

/* Each appends one part and returns the mark to give to json_pointer_pop. */
size_t json_pointer_key(struct json_pointer *pointer, const char *key);
size_t json_pointer_index(struct json_pointer *pointer, size_t index);
void json_pointer_pop(struct json_pointer *pointer, size_t mark);

/* Stores a number under `key` of an object unless it is not finite. */
void json_set_finite(json_t *object, const char *key, double value);

/* Adds what is known of an error to the object of a problem: line and column, found, allowed,
 * nearest, and example as a value. Parts for which there is no memory are left out. */
void json_set_error(json_t *problem, const struct error *error);

/* `count` texts, each in `size` bytes, as an array of strings; a new reference. */
json_t *json_texts(const char *text, size_t size, int count);

#endif
