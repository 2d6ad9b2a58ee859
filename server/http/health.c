#include <stdio.h>

#include "server/base/clock.h"
#include "server/http/handlers.h"

void health_live(struct request *request, struct reply *reply) {
  (void)request;
  reply_json(reply, 200, json_pack("{s:s}", "status", "ok"));
}

void health_ready(struct request *request, struct reply *reply) {
  int64_t counts[JOB_STATE_COUNT];
  struct error error;
  if (atomic_load(&request->service->draining)) {
    reply_problem(reply, 503, "shutting_down", "The server is shutting down.");
  } else if (store_counts(request->service->store, counts, &error) != STATUS_OK) {
    reply_problem(reply, 503, "database", "%s", error.message);
  } else {
    reply_json(reply, 200, json_pack("{s:s}", "status", "ready"));
  }
}

static void metrics_jobs(FILE *out, const int64_t counts[JOB_STATE_COUNT]) {
  fputs("# HELP pneulab_jobs Jobs in the store by state.\n# TYPE pneulab_jobs gauge\n", out);
  for (int i = 0; i < JOB_STATE_COUNT; i++) {
    fprintf(out, "pneulab_jobs{state=\"%s\"} %lld\n", job_state_word((enum job_state)i),
            (long long)counts[i]);
  }
}

static void metrics_pool(FILE *out, const struct pool_statistics *pool) {
  static const char *const ends[] = {
      [ATTEMPT_SUCCEEDED] = "succeeded",     [ATTEMPT_FAILED] = "failed",
      [ATTEMPT_TIMED_OUT] = "timed_out",     [ATTEMPT_CANCELLED] = "cancelled",
      [ATTEMPT_WORKER_LOST] = "worker_lost", [ATTEMPT_REQUEUED] = "requeued"};
  fprintf(out,
          "# HELP pneulab_workers Worker processes that may run at a time.\n"
          "# TYPE pneulab_workers gauge\npneulab_workers %u\n"
          "# HELP pneulab_workers_busy Worker processes that run.\n"
          "# TYPE pneulab_workers_busy gauge\npneulab_workers_busy %u\n"
          "# HELP pneulab_attempts_started_total Attempts started.\n"
          "# TYPE pneulab_attempts_started_total counter\npneulab_attempts_started_total %llu\n"
          "# HELP pneulab_worker_cpu_seconds_total Processor time of ended workers.\n"
          "# TYPE pneulab_worker_cpu_seconds_total counter\n"
          "pneulab_worker_cpu_seconds_total %.3f\n"
          "# HELP pneulab_attempts_ended_total Attempts ended, by outcome.\n"
          "# TYPE pneulab_attempts_ended_total counter\n",
          pool->workers, pool->busy, (unsigned long long)pool->attempts_started, pool->cpu_s);
  for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
    fprintf(out, "pneulab_attempts_ended_total{outcome=\"%s\"} %llu\n", ends[i],
            (unsigned long long)pool->attempts_ended[i]);
  }
}

static void metrics_http(FILE *out, struct service *service) {
  fputs("# HELP pneulab_http_requests_total Requests answered, by class of status.\n"
        "# TYPE pneulab_http_requests_total counter\n",
        out);
  for (int class = 2; class <= 5; class ++) {
    fprintf(out, "pneulab_http_requests_total{status=\"%dxx\"} %llu\n", class,
            atomic_load(&service->requests[class]));
  }
  fprintf(out,
          "# HELP pneulab_uptime_seconds Time since the start.\n"
          "# TYPE pneulab_uptime_seconds gauge\npneulab_uptime_seconds %.3f\n",
          (double)(clock_monotonic_ms() - service->started_ms) / 1000);
}

void health_metrics(struct request *request, struct reply *reply) {
  int64_t counts[JOB_STATE_COUNT];
  struct pool_statistics pool;
  struct error error;
  char *text = NULL;
  size_t size = 0;
  if (store_counts(request->service->store, counts, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  pool_statistics(request->service->pool, &pool);
  FILE *out = open_memstream(&text, &size);
  if (out) {
    metrics_jobs(out, counts);
    metrics_pool(out, &pool);
    metrics_http(out, request->service);
    if (fclose(out) != 0) {
      size = 0;
    }
  }
  reply_text(reply, "text/plain; version=0.0.4; charset=utf-8", text, size);
}
