/* Several jobs side by side. */
#ifndef PNEULAB_HTTP_COMPARE_H
#define PNEULAB_HTTP_COMPARE_H

#include <jansson.h>

#include "server/http/service.h"

enum { COMPARE_MAX = 50 };

/* Compares up to COMPARE_MAX jobs: an object of "jobs", "parameters" in which they differ,
 * "metrics" and, with `all`, "same", the parameters that all have alike. The caller owns *view,
 * which is NULL without memory. STATUS_NOT_FOUND. */
enum status compare_read(struct store *store, const int64_t *ids, size_t count, bool all,
                         json_t **view, struct error *error);

#endif
