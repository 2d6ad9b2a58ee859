/* Requests that take up to seconds of processor time. They are handled one after the other on a
 * thread of their own, so that they stop no other request; their connections are suspended
 * meanwhile. */
#ifndef PNEULAB_HTTP_ANALYST_H
#define PNEULAB_HTTP_ANALYST_H

#include "server/http/service.h"

struct analyst;

/* done is called on the thread with the number that waiters know a request by, each time that one
 * has been handled. The caller owns *analyst. */
enum status analyst_create(void (*done)(void *context, int64_t waited), void *context,
                           struct analyst **analyst, struct error *error);

/* Finishes the request under way and refuses those that wait or come; then the requests may be
 * freed. NULL is fine. */
void analyst_stop(struct analyst *analyst);
void analyst_destroy(struct analyst *analyst); /* stops it; NULL is fine */

/* Lets `handle` handle the request, which must live until it is answered, on that thread; *reply
 * waits for it. */
void analyst_defer(struct request *request, struct reply *reply, handler *handle);

/* Whether the number is one of its own, which are far below those of copies, and the request has
 * been handled. */
bool analyst_done(struct analyst *analyst, int64_t waited);

#endif
