#include <errno.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "server/http/feed.h"
#include "server/http/handlers.h"

enum { VANISHED_MS = 30000, BUSY_RETRY_S = 10 };

/* The labels that the query names, copied. False when a reply was made instead. */
static bool filter_labels(const struct request *request, struct reply *reply,
                          struct event_filter *filter) {
  for (size_t i = 0; i < request->url.query_count; i++) {
    const struct url_pair *pair = &request->url.query[i];
    if (strncmp(pair->name, "label.", 6) != 0) {
      continue;
    }
    if (filter->label_count == STORE_LABELS_MAX) {
      reply_problem(reply, 400, "invalid_query", "At most %d labels can be filtered by.",
                    STORE_LABELS_MAX);
      return false;
    }
    char *name = strdup(pair->name + 6), *value = strdup(pair->value);
    if (!name || !value) {
      free(name);
      free(value);
      reply_problem(reply, 503, "no_memory", "No memory for a filter.");
      return false;
    }
    filter->labels[filter->label_count].name = name;
    filter->labels[filter->label_count++].value = value;
  }
  return true;
}

/* Where to go on: after the event that a client that connects again has seen last, else after the
 * one that the query names, else (-1) from now on. */
static bool events_after(const struct request *request, struct reply *reply, int64_t *after) {
  const char *seen = request_header(request, "Last-Event-ID");
  if (!seen || *seen == '\0') {
    return request_query_integer(request, reply, "after", 0, INT64_MAX, -1, after);
  }
  char *end;
  errno = 0;
  long long id = strtoll(seen, &end, 10);
  if (*seen < '0' || *seen > '9' || *end != '\0' || errno != 0) {
    reply_problem(reply, 400, "invalid_header",
                  "Last-Event-ID: %.40s: expected the id of an event, for example 17.", seen);
    return false;
  }
  *after = id;
  return true;
}

/* The kernel gives up on a client that has vanished without a word. */
static void watch_socket(struct MHD_Connection *connection) {
  unsigned limit_ms = VANISHED_MS;
  const union MHD_ConnectionInfo *info =
      MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
  if (info) {
    setsockopt(info->connect_fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &limit_ms, sizeof limit_ms);
  }
}

static bool events_filter(const struct request *request, struct reply *reply,
                          struct event_filter *filter) {
  return (!url_query(&request->url, "job") ||
          request_query_jobs(request, reply, "job", EVENT_JOBS_MAX, filter->jobs,
                             &filter->job_count)) &&
         filter_labels(request, reply, filter);
}

void events_show(struct request *request, struct reply *reply) {
  struct event_filter filter = {.job_count = 0};
  struct reply_stream stream = {.read = feed_read, .done = feed_unsubscribe};
  struct subscriber *subscriber;
  struct error error;
  int64_t after;
  if (!events_filter(request, reply, &filter) || !events_after(request, reply, &after)) {
    event_filter_clear(&filter);
    return;
  }
  if (feed_subscribe(request->service->feed, request->connection, after, &filter, &subscriber,
                     &error) != STATUS_OK) {
    event_filter_clear(&filter);
    reply_problem(reply, 503, error.status == STATUS_CONFLICT ? "overloaded" : "no_memory", "%s",
                  error.message);
    reply_header(reply, "Retry-After", "%d", BUSY_RETRY_S);
    return;
  }
  watch_socket(request->connection);
  stream.context = subscriber;
  reply_stream(reply, "text/event-stream", &stream);
  reply_header(reply, "X-Accel-Buffering", "no"); /* or nginx would collect the events */
}
