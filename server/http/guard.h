/* What libmicrohttpd lets pass but a careful server refuses: requests that two parsers may read
 * differently, and requests that a web page of another origin makes a browser send. */
#ifndef PNEULAB_HTTP_GUARD_H
#define PNEULAB_HTTP_GUARD_H

#include <stdbool.h>

#include "server/http/service.h"

/* Checks the header of a request, its method and its url.authority; `method` and `version` are
 * libmicrohttpd's own texts, between which the first line lies. When it is refused: fills *reply
 * (closing the connection) and returns false. */
bool guard_check(const struct request *request, const char *method, const char *version,
                 struct reply *reply);

/* Whether an authority ("localhost:8080", "[::1]") names this machine's loopback. */
bool guard_host_is_loopback(const char *authority);

#endif
