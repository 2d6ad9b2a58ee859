#include <stdlib.h>

#include "server/exec/janitor.h"
#include "server/http/cache.h"
#include "server/http/handlers.h"
#include "server/http/job_view.h"
#include "server/http/waiters.h"
#include "server/store/retention.h"
#include "server/study/conductor.h"
#include "solver/job/json.h"
#include "solver/job/spec.h"

void job_show(struct request *request, struct reply *reply) {
  int64_t id;
  if (request_id(request, reply, &id)) {
    job_view_reply_waiting(request, reply, 200, id, false);
  }
}

void job_document(struct request *request, struct reply *reply) {
  struct error error;
  int64_t id;
  char *text;
  if (!request_id(request, reply, &id)) {
    return;
  }
  if (store_document(request->service->store, id, &text, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  cache_reply_text(request, reply, "application/json", text);
}

/* Removes the files of a job that is deleted, unless others were answered with its result. */
static void files_remove(const struct service *service, int64_t id, int64_t attempts) {
  bool kept = true;
  if (store_files_kept(service->store, id, attempts, &kept, NULL) == STATUS_OK && !kept) {
    janitor_remove_files(service->data, id, attempts);
  }
}

void job_delete(struct request *request, struct reply *reply) {
  struct service *service = request->service;
  struct job_record record;
  struct error error;
  int64_t id;
  if (!request_id(request, reply, &id)) {
    return;
  }
  if (store_job(service->store, id, &record, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  int64_t attempts = record.attempt;
  job_record_clear(&record);
  if (store_delete(service->store, id, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  files_remove(service, id, attempts);
  conductor_wake(service->conductor);
  reply->status = 204;
}

void job_cancel(struct request *request, struct reply *reply) {
  struct service *service = request->service;
  enum job_state state;
  struct error error;
  int64_t id;
  if (!request_id(request, reply, &id)) {
    return;
  }
  if (store_cancel(service->store, id, &state, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  if (state == JOB_STATE_CANCELLING) {
    executor_cancel(service->executor, id);
  } else {
    waiters_job_ended(service->waiters, id);
  }
  conductor_wake(service->conductor);
  job_view_reply_waiting(request, reply, state == JOB_STATE_CANCELLED ? 200 : 202, id, false);
}

static void job_hold_set(struct request *request, struct reply *reply, bool hold) {
  struct error error;
  int64_t id;
  if (!request_id(request, reply, &id)) {
    return;
  }
  if (store_hold(request->service->store, id, hold, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  executor_recall(request->service->executor);
  executor_wake(request->service->executor);
  conductor_wake(request->service->conductor);
  job_view_reply(request, reply, 200, id, false);
}

void job_hold(struct request *request, struct reply *reply) {
  job_hold_set(request, reply, true);
}

void job_release(struct request *request, struct reply *reply) {
  job_hold_set(request, reply, false);
}
