/* Which jobs a request asks for. */
#ifndef PNEULAB_HTTP_JOBS_H
#define PNEULAB_HTTP_JOBS_H

#include "server/http/service.h"

/* The query parameters of a list of jobs: state, kind, study, label.NAME, sort, cursor and limit. The
 * texts are those of the request. Otherwise replies 400 and returns false. */
bool jobs_query(const struct request *request, struct reply *reply, struct list_query *query);

#endif
