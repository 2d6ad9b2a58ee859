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
  } else if (disk_check(request->service->disk, &error) != STATUS_OK ||
             store_counts(request->service->store, counts, &error) != STATUS_OK) {
    reply_problem(reply, 503, status_word(error.status), "%s", error.message);
  } else if (executor_check(request->service->executor, &error) != STATUS_OK) {
    reply_problem(reply, 503, "workers", "%s", error.message);
  } else {
    reply_json(reply, 200, json_pack("{s:s}", "status", "ready"));
  }
}
