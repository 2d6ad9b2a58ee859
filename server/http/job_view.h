/* Jobs as the API shows them. */
#ifndef PNEULAB_HTTP_JOB_VIEW_H
#define PNEULAB_HTTP_JOB_VIEW_H

#include <jansson.h>

#include "server/http/service.h"

/* The JSON of a job: a new reference, NULL without memory. whole: with links to all plots
 * of its result; else to those that every job of its kind has. */
json_t *job_view(const struct service *service, const struct job_record *record, bool whole);

/* Replies with the job: `status`, its JSON, its Location when `location` is set. */
void job_view_reply(struct request *request, struct reply *reply, unsigned status, int64_t id,
                    bool location);

/* Replies like job_view_reply, but first waits as long as "Prefer: wait=N" asks for the job to end:
 * the status is then 200 when it has ended, else `status`. */
void job_view_reply_waiting(struct request *request, struct reply *reply, unsigned status,
                            int64_t id, bool location);

/* Where a job is on the cluster that solves it, or why it waits: the member "cluster" of its view.
 * A new reference; NULL when there is nothing to tell. */
json_t *job_place(const struct service *service, const struct job_record *record);

#endif
