/* The newest events, encoded once for all who follow, and the newest report of each running job.
 * Not locked: its owner does that. */
#ifndef PNEULAB_HTTP_FEED_RING_H
#define PNEULAB_HTTP_FEED_RING_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/http/event_text.h"

enum { FEED_RING_EVENTS = 1024, FEED_RING_REPORTS = 256 };

struct feed_entry {
  int64_t id, job_id;
  int64_t report_end; /* reports of the job's attempts up to this one are over */
  json_t *labels;     /* of the job, NULL for none */
  char *text;         /* owned, `size` bytes */
  size_t size;
};

struct feed_report {
  int64_t job_id, attempt;
  uint64_t sequence; /* grows with every report of any job */
  json_t *labels;
  char *text;
  size_t size;
};

struct feed_ring {
  struct feed_entry entries[FEED_RING_EVENTS];
  size_t first, count;
  int64_t base; /* id of the last event before the ring's first */
  int64_t last; /* id of the newest event */
  struct feed_report reports[FEED_RING_REPORTS];
  size_t report_count;
  uint64_t sequence; /* of the newest report */
};

/* How far somebody has come: up to which event, up to which report. */
struct feed_place {
  int64_t event_id;
  uint64_t sequence;
};

/* Encodes an event; false without memory. The caller owns what *entry points to. */
bool feed_entry_make(struct feed_entry *entry, const struct job_event *event);
void feed_entry_clear(struct feed_entry *entry);

/* An empty ring after the event `last`. */
void feed_ring_init(struct feed_ring *ring, int64_t last);
void feed_ring_clear(struct feed_ring *ring);

/* Takes over the next event, in the order of the ids; the oldest makes room. Reports that it ends
 * are dropped. */
void feed_ring_push(struct feed_ring *ring, struct feed_entry *entry);

/* Replaces the report of a job. labels are taken over. Without room or memory it is left out. */
void feed_ring_report(struct feed_ring *ring, int64_t job_id, int64_t attempt, json_t *labels,
                      const char *text, size_t size);

/* Whether the place is before the ring's first event. */
bool feed_ring_behind(const struct feed_ring *ring, const struct feed_place *place);

/* Whether there is something at or after the place; moves it over what is not wanted. */
bool feed_ring_has(const struct feed_ring *ring, const struct event_filter *filter,
                   struct feed_place *place);

/* Copies what fits, events first, and moves the place behind it; the place is not behind. */
size_t feed_ring_copy(const struct feed_ring *ring, const struct event_filter *filter,
                      struct feed_place *place, char *buffer, size_t room);

#endif
