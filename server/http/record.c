#include "server/http/record.h"

#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/meter.h"
#include "server/http/route.h"

enum { ID_GIVEN_MAX = 36 };

static const struct meter_bounds latency_bounds = {
    .count = 13,
    .upper = {5e-4, 1e-3, 2.5e-3, 5e-3, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 10}};

/* Requests of one route; statuses by their first digit. */
struct route_meter {
  atomic_uint_fast64_t answers[6];
  struct histogram latency;
};

struct http_meter {
  uint64_t start; /* random: ids of different runs differ */
  atomic_uint_fast64_t requests, aborted, bytes;
  struct route_meter routes[ROUTES_MAX];
};

enum status http_meter_create(struct http_meter **meter, struct error *error) {
  *meter = calloc(1, sizeof **meter);
  if (!*meter) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the counts of requests.");
  }
  if (getrandom(&(*meter)->start, sizeof(*meter)->start, 0) != sizeof(*meter)->start) {
    (*meter)->start = (uint64_t)clock_unix_ms();
  }
  return STATUS_OK;
}

void http_meter_destroy(struct http_meter *meter) {
  free(meter);
}

void record_target(struct record *record, const char *target) {
  if (log_wants(LOG_LEVEL_REQUEST)) {
    record->path = strndup(target, strcspn(target, "?"));
  }
}

static bool id_is_plain(const char *id) {
  static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
  size_t length = strlen(id);
  return length > 0 && length <= ID_GIVEN_MAX && strspn(id, plain) == length;
}

void record_begin(struct record *record, const struct request *request, const char *method) {
  struct http_meter *meter = request->service->meter;
  uint64_t number = 1 + atomic_fetch_add_explicit(&meter->requests, 1, memory_order_relaxed);
  const char *given = request_header(request, "X-Request-Id");
  record->begun_us = clock_monotonic_us();
  snprintf(record->method, sizeof record->method, "%s", method);
  if (given && id_is_plain(given)) {
    strcpy(record->id, given);
  } else {
    snprintf(record->id, sizeof record->id, "%08llx-%llu",
             (unsigned long long)(meter->start & 0xffffffff), (unsigned long long)number);
  }
}

void record_answer(struct record *record, const struct reply *reply) {
  record->answered_us = clock_monotonic_us();
  record->status = reply->status;
  record->size = reply->size;
  record->waits = record->waits || reply->stream.read;
}

static void record_count(const struct record *record, const struct request *request) {
  struct http_meter *meter = request->service->meter;
  struct route_meter *route = &meter->routes[request->route < ROUTES_MAX ? request->route : 0];
  if (record->status == 0) {
    atomic_fetch_add_explicit(&meter->aborted, 1, memory_order_relaxed);
    return;
  }
  atomic_fetch_add_explicit(&route->answers[record->status / 100 % 6], 1, memory_order_relaxed);
  atomic_fetch_add_explicit(&meter->bytes, record->size, memory_order_relaxed);
  if (!record->waits) {
    histogram_add(&route->latency, &latency_bounds,
                  1e-6 * (double)(record->answered_us - record->begun_us));
  }
}

void record_end(struct record *record, const struct request *request) {
  if (record->begun_us == 0) { /* the header never came to its end */
    free(record->path);
    return;
  }
  record_count(record, request);
  if (log_wants(LOG_LEVEL_REQUEST)) {
    log_event(
        LOG_LEVEL_REQUEST, "request", LOG_TEXT("method", record->method),
        LOG_TEXT("path", record->path ? record->path : ""), LOG_NUMBER("status", record->status),
        LOG_NUMBER("duration_ms",
                   record->status ? 1e-3 * (double)(record->answered_us - record->begun_us) : 0),
        LOG_NUMBER("bytes", record->size), LOG_TEXT("caller", request->caller.name),
        LOG_TEXT("request", record->id));
  }
  free(record->path);
  record->path = NULL;
}

/* Patterns of the table have no slash in front. */
static const char *route_slash(unsigned route) {
  return route >= ROUTE_FIRST ? "/" : "";
}

static void answers_write(const struct http_meter *meter, FILE *out) {
  meter_head(out, "pneulab_http_requests_total", "counter",
             "Requests answered, by method, route and class of status.");
  for (unsigned i = 0; i < ROUTES_MAX; i++) {
    const char *method, *pattern;
    for (unsigned class = 1; class < 6 && route_name(i, &method, &pattern); class ++) {
      uint64_t count = atomic_load(&meter->routes[i].answers[class]);
      if (count > 0) {
        fprintf(out,
                "pneulab_http_requests_total{method=\"%s\",route=\"%s%s\",status=\"%uxx\"} %llu\n",
                method, route_slash(i), pattern, class, (unsigned long long)count);
      }
    }
  }
}

static void latencies_write(const struct http_meter *meter, FILE *out) {
  meter_head(out, "pneulab_http_request_seconds", "histogram",
             "Time from a complete header to the answer; without requests that wait for a job or "
             "follow the events.");
  for (unsigned i = 0; i < ROUTES_MAX; i++) {
    const char *method, *pattern;
    char labels[160];
    uint64_t count = 0;
    for (unsigned class = 1; class < 6; class ++) {
      count += atomic_load(&meter->routes[i].answers[class]);
    }
    if (count > 0 && route_name(i, &method, &pattern)) {
      snprintf(labels, sizeof labels, "method=\"%s\",route=\"%s%s\"", method, route_slash(i),
               pattern);
      meter_histogram(out, "pneulab_http_request_seconds", labels, &meter->routes[i].latency,
                      &latency_bounds);
    }
  }
}

void http_meter_write(const struct http_meter *meter, FILE *out) {
  answers_write(meter, out);
  latencies_write(meter, out);
  meter_head(out, "pneulab_http_requests_aborted_total", "counter",
             "Requests whose connection ended before there was an answer.");
  fprintf(out, "pneulab_http_requests_aborted_total %llu\n",
          (unsigned long long)atomic_load(&meter->aborted));
  meter_head(out, "pneulab_http_response_bytes_total", "counter",
             "Bytes of the bodies of answers, without those of event streams.");
  fprintf(out, "pneulab_http_response_bytes_total %llu\n",
          (unsigned long long)atomic_load(&meter->bytes));
}
