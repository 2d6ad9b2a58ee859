/* News of jobs as Server-Sent Events, and who wants which of them. */
#ifndef PNEULAB_HTTP_EVENT_TEXT_H
#define PNEULAB_HTTP_EVENT_TEXT_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/exec/progress.h"
#include "server/store/store.h"

enum { EVENT_TEXT_MAX = 1024, EVENT_JOBS_MAX = 50 };

/* Which events are wanted: those of the named jobs, of jobs that have all the labels. */
struct event_filter {
  int64_t jobs[EVENT_JOBS_MAX];
  size_t job_count; /* 0: of all jobs */
  struct {
    char *name, *value; /* owned */
  } labels[STORE_LABELS_MAX];
  size_t label_count;
};

void event_filter_clear(struct event_filter *filter);

/* Whether news of a job with these labels (an object, or NULL for none) is wanted. */
bool event_filter_match(const struct event_filter *filter, int64_t job_id, const json_t *labels);

/* Writes the change of state with its id ("id: 7\nevent: state\ndata: {...}\n\n") into text, not
 * terminated. Returns its size, 0 when there is no memory. */
size_t event_text_state(const struct job_event *event, char text[EVENT_TEXT_MAX]);

/* The same for what a running job has reported, without an id. */
size_t event_text_progress(int64_t job_id, int64_t attempt, const struct progress *progress,
                           char text[EVENT_TEXT_MAX]);

/* The members of a report: fraction, pressure_kPa, step, steps, iteration, eta_s; null for what is
 * not known. NULL without memory. */
json_t *progress_json(const struct progress *progress);

#endif
