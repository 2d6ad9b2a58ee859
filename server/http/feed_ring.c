#include "server/http/feed_ring.h"

#include <stdlib.h>
#include <string.h>

#include "solver/job/json.h"

/* The last attempt whose reports the event makes obsolete. */
static int64_t report_end(const struct job_event *event) {
  enum job_state state;
  if (!job_state_parse(event->state, &state)) {
    return INT64_MAX; /* deleted */
  }
  return state == JOB_STATE_STARTING || state == JOB_STATE_RUNNING ? event->attempt - 1
                                                                   : event->attempt;
}

bool feed_entry_make(struct feed_entry *entry, const struct job_event *event) {
  char text[EVENT_TEXT_MAX];
  size_t size = event_text_state(event, text);
  *entry = (struct feed_entry){.id = event->id,
                               .job_id = event->job_id,
                               .report_end = report_end(event),
                               .text = size > 0 ? malloc(size) : NULL,
                               .size = size};
  if (!entry->text) {
    return false;
  }
  memcpy(entry->text, text, size);
  if (strcmp(event->labels, "{}") != 0 &&
      json_text_read(event->labels, strlen(event->labels), &entry->labels, NULL) ==
          STATUS_NO_MEMORY) {
    feed_entry_clear(entry); /* without its labels those who wait for them would miss it */
    return false;
  }
  return true;
}

void feed_entry_clear(struct feed_entry *entry) {
  json_decref(entry->labels);
  free(entry->text);
  *entry = (struct feed_entry){.id = 0};
}

static void report_drop(struct feed_ring *ring, size_t at) {
  json_decref(ring->reports[at].labels);
  free(ring->reports[at].text);
  ring->reports[at] = ring->reports[--ring->report_count];
}

void feed_ring_init(struct feed_ring *ring, int64_t last) {
  *ring = (struct feed_ring){.base = last, .last = last};
}

void feed_ring_clear(struct feed_ring *ring) {
  for (size_t i = 0; i < FEED_RING_EVENTS; i++) {
    feed_entry_clear(&ring->entries[i]);
  }
  while (ring->report_count > 0) {
    report_drop(ring, 0);
  }
}

void feed_ring_push(struct feed_ring *ring, struct feed_entry *entry) {
  size_t at = (ring->first + ring->count) % FEED_RING_EVENTS;
  if (ring->count == FEED_RING_EVENTS) {
    ring->base = ring->entries[at].id;
    feed_entry_clear(&ring->entries[at]);
    ring->first = (ring->first + 1) % FEED_RING_EVENTS;
    ring->count--;
  }
  ring->entries[at] = *entry;
  ring->count++;
  ring->last = entry->id;
  for (size_t i = ring->report_count; i > 0; i--) {
    const struct feed_report *report = &ring->reports[i - 1];
    if (report->job_id == entry->job_id && report->attempt <= entry->report_end) {
      report_drop(ring, i - 1);
    }
  }
}

void feed_ring_report(struct feed_ring *ring, int64_t job_id, int64_t attempt, json_t *labels,
                      const char *text, size_t size) {
  for (size_t i = ring->report_count; i > 0; i--) {
    if (ring->reports[i - 1].job_id == job_id) {
      report_drop(ring, i - 1);
    }
  }
  char *copy = size > 0 && ring->report_count < FEED_RING_REPORTS ? malloc(size) : NULL;
  if (!copy) {
    json_decref(labels);
    return;
  }
  memcpy(copy, text, size);
  ring->reports[ring->report_count++] = (struct feed_report){.job_id = job_id,
                                                             .attempt = attempt,
                                                             .sequence = ++ring->sequence,
                                                             .labels = labels,
                                                             .text = copy,
                                                             .size = size};
}

/* The first wanted event after the place, NULL when there is none; the place moves up to it. */
static const struct feed_entry *event_next(const struct feed_ring *ring,
                                           const struct event_filter *filter,
                                           struct feed_place *place) {
  size_t from = ring->count;
  while (from > 0 &&
         ring->entries[(ring->first + from - 1) % FEED_RING_EVENTS].id > place->event_id) {
    from--;
  }
  for (size_t i = from; i < ring->count; i++) {
    const struct feed_entry *entry = &ring->entries[(ring->first + i) % FEED_RING_EVENTS];
    if (event_filter_match(filter, entry->job_id, entry->labels)) {
      return entry;
    }
    place->event_id = entry->id;
  }
  return NULL;
}

/* The oldest wanted report after the place, NULL when there is none. */
static const struct feed_report *report_next(const struct feed_ring *ring,
                                             const struct event_filter *filter,
                                             const struct feed_place *place) {
  const struct feed_report *next = NULL;
  for (size_t i = 0; i < ring->report_count; i++) {
    const struct feed_report *report = &ring->reports[i];
    if (report->sequence > place->sequence && (!next || report->sequence < next->sequence) &&
        event_filter_match(filter, report->job_id, report->labels)) {
      next = report;
    }
  }
  return next;
}

bool feed_ring_behind(const struct feed_ring *ring, const struct feed_place *place) {
  return place->event_id < ring->base;
}

bool feed_ring_has(const struct feed_ring *ring, const struct event_filter *filter,
                   struct feed_place *place) {
  return feed_ring_behind(ring, place) || event_next(ring, filter, place) ||
         (place->sequence < ring->sequence && report_next(ring, filter, place));
}

size_t feed_ring_copy(const struct feed_ring *ring, const struct event_filter *filter,
                      struct feed_place *place, char *buffer, size_t room) {
  const struct feed_entry *entry;
  const struct feed_report *report;
  size_t used = 0;
  while ((entry = event_next(ring, filter, place)) && entry->size <= room - used) {
    memcpy(buffer + used, entry->text, entry->size);
    used += entry->size;
    place->event_id = entry->id;
  }
  while (!entry && (report = report_next(ring, filter, place)) && report->size <= room - used) {
    memcpy(buffer + used, report->text, report->size);
    used += report->size;
    place->sequence = report->sequence;
  }
  return used;
}
