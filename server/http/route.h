/* The static table of everything that can be asked for. */
#ifndef PNEULAB_HTTP_ROUTE_H
#define PNEULAB_HTTP_ROUTE_H

#include "server/http/service.h"

/* The handler for the request's path and method, with request->parameters and
 * least_role and the route's number filled. Otherwise replies 404 or 405 (with Allow) and returns
 * NULL. */
handler *route_find(struct request *request, struct reply *reply);

/* Numbers of routes, for the metrics. */
enum {
  ROUTE_NONE,  /* refused before a route was found */
  ROUTE_PAGES, /* files of the program itself */
  ROUTE_FIRST, /* of the table */
  ROUTES_MAX = 64
};

/* Method and pattern of a route, static; false beyond the last. */
bool route_name(unsigned number, const char **method, const char **pattern);

#endif
