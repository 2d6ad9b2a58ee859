#include "server/http/feed.h"

#include <microhttpd.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/http/feed_ring.h"
#include "solver/job/json.h"

enum {
  RETRY_MS = 2000,       /* after which a client is to connect again */
  PUBLISH_GAP_MS = 50,   /* least time between two rounds: news in between go out together */
  COUNT_A_MS = 5,        /* as many subscribers make that a millisecond longer */
  FAILED_GAP_MS = 1000,  /* the same after the database could not be read */
  KEEP_ALIVE_MS = 15000, /* silence after which a comment is sent */
  LOOK_MS = 1000,        /* how often silence is looked for */
  READ_EVENTS = 256,     /* rows read at a time */
  CHUNK_MAX = 4096,      /* bytes given to a connection at a time; bounds what its buffer touches */
  REPORTS_MAX = 256      /* jobs that run at a time */
};

/* A report on its way into the ring. */
struct report {
  int64_t job_id, attempt;
  struct progress progress;
};

struct feed {
  struct store *store;
  pthread_t thread;
  pthread_mutex_t mutex; /* guards everything below; taken before libmicrohttpd's own */
  pthread_cond_t wake;
  bool news, closing, closed, started;
  struct report reports[REPORTS_MAX];
  size_t report_count;
  struct feed_ring ring;
  struct subscriber *first;
  unsigned count, limit;
  int64_t looked_ms; /* when silent and vanished clients were looked for */
};

struct subscriber {
  struct feed *feed;
  struct subscriber *next, *previous;
  struct MHD_Connection *connection;
  int socket;
  struct event_filter filter;
  struct feed_place place;
  int64_t sent_ms; /* when it was last given something */
  bool opened;     /* the first lines were sent */
  bool parked;     /* suspended: set and cleared together with the connection's state */
  bool quiet;      /* a comment is due */
  bool gone;       /* the client has closed its side */
};

/* ---- publishing -------------------------------------------------------------------------- */

/* After a commit, on the thread that wrote. */
static void feed_poke(void *context) {
  struct feed *feed = context;
  pthread_mutex_lock(&feed->mutex);
  feed->news = true;
  pthread_cond_signal(&feed->wake);
  pthread_mutex_unlock(&feed->mutex);
}

void feed_progress(struct feed *feed, int64_t job_id, int64_t attempt,
                   const struct progress *progress) {
  pthread_mutex_lock(&feed->mutex);
  size_t at = 0;
  while (at < feed->report_count && feed->reports[at].job_id != job_id) {
    at++;
  }
  if (at < REPORTS_MAX) {
    feed->reports[at] = (struct report){job_id, attempt, *progress};
    feed->report_count += at == feed->report_count;
    pthread_cond_signal(&feed->wake);
  }
  pthread_mutex_unlock(&feed->mutex);
}

/* Whether the client has closed the connection: libmicrohttpd does not watch a suspended one. */
static bool hung_up(int socket) {
  struct pollfd watched = {.fd = socket, .events = POLLRDHUP};
  return poll(&watched, 1, 0) > 0;
}

/* Resumes those for whom there is something; with `all`, everybody. Under the mutex. */
static void feed_resume(struct feed *feed, bool all) {
  int64_t now = clock_monotonic_ms();
  bool look = now - feed->looked_ms >= LOOK_MS;
  feed->looked_ms = look ? now : feed->looked_ms;
  for (struct subscriber *at = feed->first; at; at = at->next) {
    if (!at->parked) {
      continue;
    }
    at->quiet = now - at->sent_ms >= KEEP_ALIVE_MS;
    at->gone = look && hung_up(at->socket);
    if (all || at->quiet || at->gone || feed_ring_has(&feed->ring, &at->filter, &at->place)) {
      at->parked = false;
      MHD_resume_connection(at->connection);
    }
  }
}

/* A batch of rows on its way into the ring. */
struct reading {
  struct feed_entry entries[READ_EVENTS];
  int count;
  bool starved; /* there was no memory for the next one */
};

static bool reading_take(void *context, const struct job_event *event) {
  struct reading *reading = context;
  reading->starved = !feed_entry_make(&reading->entries[reading->count], event);
  reading->count += !reading->starved;
  return !reading->starved;
}

/* Reports that were taken before the table is read next: so nobody sees a job progress before it
 * runs. */
static void publish_reports(struct feed *feed, const struct report *reports, size_t count) {
  for (size_t i = 0; i < count; i++) {
    char text[EVENT_TEXT_MAX];
    const struct report *report = &reports[i];
    json_t *labels;
    size_t size = event_text_progress(report->job_id, report->attempt, &report->progress, text);
    if (store_labels(feed->store, report->job_id, &labels, NULL) == STATUS_OK) {
      pthread_mutex_lock(&feed->mutex);
      feed_ring_report(&feed->ring, report->job_id, report->attempt, labels, text, size);
      pthread_mutex_unlock(&feed->mutex);
    }
  }
}

/* Moves new events from the table into the ring, whose end only this thread moves. False when the
 * table could not be read to its end. */
static bool publish_events(struct feed *feed) {
  struct reading *reading = calloc(1, sizeof *reading);
  struct error error;
  int taken = READ_EVENTS;
  enum status status = reading ? STATUS_OK : STATUS_NO_MEMORY;
  while (status == STATUS_OK && taken == READ_EVENTS) {
    reading->count = 0;
    status = store_events(feed->store, feed->ring.last, READ_EVENTS, reading_take, reading, &taken,
                          &error);
    pthread_mutex_lock(&feed->mutex);
    for (int i = 0; i < reading->count; i++) {
      feed_ring_push(&feed->ring, &reading->entries[i]);
    }
    pthread_mutex_unlock(&feed->mutex);
    if (status != STATUS_OK) {
      log_line("cannot read events: %s", error.message);
    }
  }
  bool complete = status == STATUS_OK && !reading->starved;
  free(reading);
  return complete;
}

/* Waits for something to do. Under the mutex. */
static void feed_wait(struct feed *feed) {
  struct timespec until = clock_deadline(LOOK_MS);
  int code = 0;
  while (code == 0 && !feed->closing && !feed->news && feed->report_count == 0) {
    code = pthread_cond_timedwait(&feed->wake, &feed->mutex, &until);
  }
}

/* Lets a while pass, unless the feed is closing. Under the mutex. */
static void feed_pause(struct feed *feed, int64_t pause_ms) {
  struct timespec until = clock_deadline(pause_ms);
  int code = 0;
  while (code == 0 && !feed->closing) {
    code = pthread_cond_timedwait(&feed->wake, &feed->mutex, &until);
  }
}

static void *feed_main(void *context) {
  struct feed *feed = context;
  struct report reports[REPORTS_MAX];
  pthread_mutex_lock(&feed->mutex);
  while (!feed->closed) {
    feed_wait(feed);
    bool closing = feed->closing, news = feed->news || closing, complete = true;
    size_t report_count = feed->report_count;
    memcpy(reports, feed->reports, report_count * sizeof *reports);
    feed->report_count = 0;
    feed->news = false;
    if (news || report_count > 0) {
      pthread_mutex_unlock(&feed->mutex);
      publish_reports(feed, reports, report_count);
      complete = publish_events(feed);
      pthread_mutex_lock(&feed->mutex);
    }
    feed->news = feed->news || !complete;
    feed->closed = closing;
    feed_resume(feed, closing);
    feed_pause(feed, complete ? PUBLISH_GAP_MS + feed->count / COUNT_A_MS : FAILED_GAP_MS);
  }
  pthread_mutex_unlock(&feed->mutex);
  return NULL;
}

/* ---- following --------------------------------------------------------------------------- */

/* What a subscriber that has fallen behind the ring is given from the table. */
struct catching_up {
  struct subscriber *subscriber;
  char *buffer;
  size_t used, room;
};

static bool catch_up_take(void *context, const struct job_event *event) {
  struct catching_up *to = context;
  const struct event_filter *filter = &to->subscriber->filter;
  json_t *labels = NULL;
  if (filter->label_count > 0 &&
      json_text_read(event->labels, strlen(event->labels), &labels, NULL) == STATUS_NO_MEMORY) {
    return false; /* to be asked for again: without its labels it would be passed over */
  }
  bool wanted = event_filter_match(filter, event->job_id, labels);
  json_decref(labels);
  if (wanted) {
    char text[EVENT_TEXT_MAX];
    size_t size = event_text_state(event, text);
    if (size == 0 || size > to->room - to->used) {
      return false;
    }
    memcpy(to->buffer + to->used, text, size);
    to->used += size;
  }
  to->subscriber->place.event_id = event->id;
  return true;
}

/* Reads on from the table; called without the mutex, only the subscriber's own connection gets
 * here. Rows that are not wanted make a comment, so that the connection goes on. Returns 0 when
 * the table cannot be read. */
static size_t catch_up(struct subscriber *subscriber, char *buffer, size_t room) {
  struct catching_up to = {.subscriber = subscriber, .buffer = buffer, .room = room};
  int count;
  if (store_events(subscriber->feed->store, subscriber->place.event_id, READ_EVENTS, catch_up_take,
                   &to, &count, NULL) != STATUS_OK) {
    return 0;
  }
  if (to.used == 0 && room >= 2) {
    memcpy(buffer, ":\n", 2);
    to.used = 2;
  }
  return to.used;
}

/* An id without data tells the client where it is before the first event. */
static size_t read_opening(struct subscriber *subscriber, char *buffer, size_t room) {
  subscriber->opened = true;
  return (size_t)snprintf(buffer, room, "retry: %d\nid: %lld\n\n", RETRY_MS,
                          (long long)subscriber->place.event_id);
}

/* From the ring; a comment after a long silence. */
static size_t read_ring(struct subscriber *subscriber, char *buffer, size_t room) {
  static const char comment[] = ": keep-alive\n\n";
  const struct feed_ring *ring = &subscriber->feed->ring;
  size_t used = feed_ring_copy(ring, &subscriber->filter, &subscriber->place, buffer, room);
  if (used == 0 && subscriber->quiet) {
    memcpy(buffer, comment, sizeof comment - 1);
    used = sizeof comment - 1;
  }
  subscriber->quiet = false;
  return used;
}

ssize_t feed_read(void *context, uint64_t position, char *buffer, size_t room) {
  struct subscriber *subscriber = context;
  struct feed *feed = subscriber->feed;
  ssize_t result = 0;
  (void)position;
  if (room < EVENT_TEXT_MAX) { /* a header that left no memory for the answer */
    return MHD_CONTENT_READER_END_WITH_ERROR;
  }
  room = room < CHUNK_MAX ? room : CHUNK_MAX;
  pthread_mutex_lock(&feed->mutex);
  bool behind = subscriber->opened && feed_ring_behind(&feed->ring, &subscriber->place);
  if (!subscriber->opened) {
    result = (ssize_t)read_opening(subscriber, buffer, room);
  } else if (subscriber->gone) {
    behind = false;
    result = MHD_CONTENT_READER_END_WITH_ERROR;
  } else if (!behind) {
    result = (ssize_t)read_ring(subscriber, buffer, room);
    if (result == 0 && feed->closed) {
      result = MHD_CONTENT_READER_END_OF_STREAM;
    } else if (result == 0) {
      subscriber->parked = true;
      MHD_suspend_connection(subscriber->connection);
    }
  }
  subscriber->sent_ms = result == 0 ? subscriber->sent_ms : clock_monotonic_ms();
  pthread_mutex_unlock(&feed->mutex);
  if (behind) {
    size_t used = catch_up(subscriber, buffer, room);
    result = used > 0 ? (ssize_t)used : MHD_CONTENT_READER_END_WITH_ERROR;
  }
  return result;
}

enum status feed_subscribe(struct feed *feed, struct MHD_Connection *connection, int64_t after,
                           const struct event_filter *filter, struct subscriber **subscriber,
                           struct error *error) {
  struct subscriber *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a subscriber.");
  }
  pthread_mutex_lock(&feed->mutex);
  if (feed->closing || feed->count >= feed->limit) {
    bool closing = feed->closing;
    pthread_mutex_unlock(&feed->mutex);
    free(made);
    return closing ? error_set(error, STATUS_CONFLICT, NULL, "The server is shutting down.")
                   : error_set(error, STATUS_CONFLICT, NULL,
                               "%u clients follow the events already, which is the limit.",
                               feed->limit);
  }
  const union MHD_ConnectionInfo *info =
      MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
  *made = (struct subscriber){.feed = feed,
                              .next = feed->first,
                              .connection = connection,
                              .socket = info ? info->connect_fd : -1,
                              .filter = *filter,
                              .place = {.event_id = feed->ring.last},
                              .sent_ms = clock_monotonic_ms()};
  if (after >= 0 && after < feed->ring.last) {
    made->place.event_id = after;
  }
  if (made->next) {
    made->next->previous = made;
  }
  feed->first = made;
  feed->count++;
  pthread_mutex_unlock(&feed->mutex);
  *subscriber = made;
  return STATUS_OK;
}

void feed_unsubscribe(void *context) {
  struct subscriber *subscriber = context;
  struct feed *feed = subscriber->feed;
  pthread_mutex_lock(&feed->mutex);
  if (subscriber->previous) {
    subscriber->previous->next = subscriber->next;
  } else {
    feed->first = subscriber->next;
  }
  if (subscriber->next) {
    subscriber->next->previous = subscriber->previous;
  }
  feed->count--;
  pthread_mutex_unlock(&feed->mutex);
  event_filter_clear(&subscriber->filter);
  free(subscriber);
}

unsigned feed_subscribers(struct feed *feed) {
  pthread_mutex_lock(&feed->mutex);
  unsigned count = feed->count;
  pthread_mutex_unlock(&feed->mutex);
  return count;
}

/* ---- life -------------------------------------------------------------------------------- */

enum status feed_create(struct store *store, unsigned subscribers_max, struct feed **feed,
                        struct error *error) {
  int64_t last;
  enum status status = store_event_last(store, &last, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct feed *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the stream of events.");
  }
  made->store = store;
  made->limit = subscribers_max;
  feed_ring_init(&made->ring, last);
  pthread_mutex_init(&made->mutex, NULL);
  clock_condition_init(&made->wake);
  made->started = pthread_create(&made->thread, NULL, feed_main, made) == 0;
  if (!made->started) {
    feed_destroy(made);
    return error_set(error, STATUS_NO_MEMORY, NULL, "Cannot start a thread.");
  }
  store_watch_events(store, feed_poke, made);
  *feed = made;
  return STATUS_OK;
}

void feed_close(struct feed *feed) {
  if (!feed || !feed->started) {
    return;
  }
  pthread_mutex_lock(&feed->mutex);
  feed->closing = true;
  pthread_cond_signal(&feed->wake);
  pthread_mutex_unlock(&feed->mutex);
  pthread_join(feed->thread, NULL);
  feed->started = false;
}

void feed_destroy(struct feed *feed) {
  if (!feed) {
    return;
  }
  store_watch_events(feed->store, NULL, NULL);
  feed_close(feed);
  feed_ring_clear(&feed->ring);
  pthread_cond_destroy(&feed->wake);
  pthread_mutex_destroy(&feed->mutex);
  free(feed);
}
