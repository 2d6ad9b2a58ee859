#include <limits.h>
#include <stdio.h>

#include "server/exec/run.h"
#include "server/http/handlers.h"

void attempts_list(struct request *request, struct reply *reply) {
  struct error error;
  json_t *attempts;
  int64_t id;
  if (!request_id(request, reply, &id)) {
    return;
  }
  if (store_attempts(request->service->store, id, &attempts, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  size_t index;
  json_t *attempt;
  json_array_foreach(attempts, index, attempt) {
    json_object_set_new(
        attempt, "log",
        json_sprintf("/api/v1/jobs/%lld/log?attempt=%lld", (long long)id,
                     (long long)json_integer_value(json_object_get(attempt, "number"))));
  }
  reply_json(reply, 200, json_pack("{s:o}", "attempts", attempts));
}

void attempts_log(struct request *request, struct reply *reply) {
  char name[RUN_DIRECTORY_SIZE], path[PATH_MAX];
  struct job_record record;
  struct error error;
  int64_t id, attempt;
  if (!request_id(request, reply, &id)) {
    return;
  }
  if (store_job(request->service->store, id, &record, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  int64_t latest = record.attempt;
  job_record_clear(&record);
  if (latest == 0) {
    reply_problem(reply, 404, "no_log", "Job %lld has not started yet.", (long long)id);
    return;
  }
  if (!request_query_integer(request, reply, "attempt", 1, latest, latest, &attempt)) {
    return;
  }
  run_directory(id, attempt, name);
  int length = snprintf(path, sizeof path, "%s/log.txt", name);
  if (length > 0 && (size_t)length < sizeof path) {
    reply_job_file(request, reply, "text/plain; charset=utf-8", id, path);
  }
}
