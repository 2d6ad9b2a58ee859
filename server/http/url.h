/* Request targets: percent-decoding, path segments, query parameters. All in place, strict: what
 * could be read in two ways is refused. */
#ifndef PNEULAB_HTTP_URL_H
#define PNEULAB_HTTP_URL_H

#include <stdbool.h>
#include <stddef.h>

enum { URL_SEGMENTS_MAX = 8, URL_QUERY_MAX = 32 };

struct url_pair {
  const char *name, *value;
};

/* A decoded target. The texts point into the buffer given to url_parse. */
struct url {
  const char *authority;                  /* of an absolute-form target, or NULL */
  const char *segments[URL_SEGMENTS_MAX]; /* "/" has none */
  size_t segment_count;
  struct url_pair query[URL_QUERY_MAX];
  size_t query_count;
};

/* Decodes %XX (and + as a space when `plus` is set) in place. False for a malformed escape, for
 * bytes below 0x20 or 0x7f, decoded or not, and for invalid UTF-8. */
bool url_decode(char *text, bool plus);

/* Parses "/path?query" or "http://authority/path?query", changing `target`. On failure returns a
 * sentence that says what is wrong; NULL on success. Refused besides malformed escapes: encoded
 * slashes, "." and ".." segments, backslashes, fragments, more segments or parameters than the
 * limits. A trailing slash gives an empty last segment. */
const char *url_parse(char *target, struct url *url);

/* The value of a query parameter, NULL when it is absent. */
const char *url_query(const struct url *url, const char *name);

#endif
