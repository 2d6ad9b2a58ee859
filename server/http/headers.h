/* The headers that every answer carries. */
#ifndef PNEULAB_HTTP_HEADERS_H
#define PNEULAB_HTTP_HEADERS_H

#include <microhttpd.h>

#include "server/http/service.h"

/* Adds to `response` the reply's own headers and those that tell browsers and caches how to treat
 * it: nothing is kept unless the handler says so, nothing is guessed, nothing runs but the scripts
 * of our own pages, and no page of another origin may load or frame it. */
void headers_add(struct MHD_Response *response, const struct reply *reply);

#endif
