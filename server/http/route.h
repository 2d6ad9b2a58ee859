/* The static table of everything that can be asked for. */
#ifndef PNEULAB_HTTP_ROUTE_H
#define PNEULAB_HTTP_ROUTE_H

#include "server/http/service.h"

/* The handler for the request's path and method, with request->parameters and
 * least_role filled. Otherwise replies 404 or 405 (with Allow) and returns NULL. */
handler *route_find(struct request *request, struct reply *reply);

#endif
