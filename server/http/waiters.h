/* Requests that wait for a job to end ("Prefer: wait=N"). They hold no thread: their connections
 * are suspended and resumed. */
#ifndef PNEULAB_HTTP_WAITERS_H
#define PNEULAB_HTTP_WAITERS_H

#include <stdbool.h>
#include <stdint.h>

#include "solver/base/error.h"

struct MHD_Connection;
struct waiters;

enum status waiters_create(struct waiters **waiters, struct error *error);
void waiters_destroy(struct waiters *waiters);

/* Notes a connection, already suspended, until the job is ended or wait_ms are over. False when
 * too many wait or there is no memory: then the caller resumes it. */
bool waiters_add(struct waiters *waiters, struct MHD_Connection *connection, int64_t job_id,
                 int64_t wait_ms);
/* Whether anybody waits for the job. */
bool waiters_want(struct waiters *waiters, int64_t job_id);
/* Resumes those who wait for the job. */
void waiters_job_ended(struct waiters *waiters, int64_t job_id);
/* Resumes those whose time is over; with `all`, everybody. */
void waiters_expire(struct waiters *waiters, bool all);

#endif
