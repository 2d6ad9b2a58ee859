#include "server/http/job_view.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/http/answers.h"
#include "server/http/event_text.h"
#include "server/plot/plot.h"
#include "server/study/conductor.h"
#include "solver/job/json.h"

enum { KEPT_SIZE_MAX = 16384 };

static json_t *time_view(int64_t unix_ms) {
  char text[CLOCK_TEXT_SIZE];
  if (unix_ms == 0) {
    return json_null();
  }
  clock_format(unix_ms, text);
  return json_string(text);
}

/* Adds "progress", a number, and "progress_detail", what a running job has reported. */
static void progress_set(const struct service *service, const struct job_record *record,
                         json_t *view) {
  struct progress progress = progress_none();
  bool terminal = job_state_terminal(record->state);
  bool reported = !terminal && (executor_progress(service->executor, record->id, &progress) ||
                                conductor_progress(service->conductor, record->id, &progress));
  json_t *fraction = json_real(reported ? progress.fraction : 0);
  if (terminal) {
    json_decref(fraction);
    fraction = record->state == JOB_STATE_SUCCEEDED ? json_real(1) : json_null();
  }
  json_object_set_new(view, "progress", fraction);
  json_object_set_new(view, "progress_detail", reported ? progress_json(&progress) : json_null());
}

json_t *job_place(const struct service *service, const struct job_record *record) {
  bool waits = record->state == JOB_STATE_QUEUED || record->state == JOB_STATE_RETRY_WAIT;
  bool none = job_state_terminal(record->state) || record->state == JOB_STATE_HELD ||
              strcmp(record->kind, "study") == 0;
  return none ? NULL : executor_place(service->executor, record->id, record->engine, waits);
}

static void link_set(json_t *links, const char *name, int64_t id, const char *rest) {
  char path[200];
  snprintf(path, sizeof path, "/api/v1/jobs/%lld%s", (long long)id, rest);
  json_object_set_new(links, name, json_string(path));
}

/* The job's result document, a new reference; NULL when there is none or it cannot be read. */
static json_t *result_read(const struct service *service, const struct job_record *record) {
  char *text = NULL, *directory = NULL;
  json_t *result = NULL;
  if (record->has_result &&
      store_result(service->store, record->id, &text, &directory, NULL) == STATUS_OK) {
    result = json_read(text, strlen(text), 0, NULL);
  }
  free(text);
  free(directory);
  return result;
}

/* The names of the plots of this very result; false when it cannot be read. A result may be long
 * and never changes: it is looked at once. */
static bool plots_of_result(const struct service *service, const struct job_record *record,
                            const char *names[PLOT_NAMES]) {
  if (answers_plots(service->answers, record->id, names)) {
    return true;
  }
  json_t *result = result_read(service, record);
  if (result) {
    plot_names_for(record->kind, result, names);
    answers_keep_plots(service->answers, record->id, names);
  }
  json_decref(result);
  return result != NULL;
}

/* Links to the plots: those that every job of this kind has, or those of this very result. */
static json_t *plots_view(const struct service *service, const struct job_record *record,
                          bool whole) {
  json_t *plots = json_array();
  const char *own[PLOT_NAMES] = {NULL};
  const char *const *names = plot_names(record->kind);
  char path[200];
  if (whole && plots_of_result(service, record, own)) {
    names = own;
  }
  for (size_t i = 0; names[i]; i++) {
    snprintf(path, sizeof path, "/api/v1/jobs/%lld/plots/%s.png", (long long)record->id, names[i]);
    json_array_append_new(plots, json_string(path));
  }
  return plots;
}

/* Links to what the job has; those of a result only once there is one. */
static json_t *links_view(const struct service *service, const struct job_record *record,
                          bool whole) {
  json_t *links = json_object(), *plots = json_array(), *artifacts = json_array();
  char path[200];
  link_set(links, "self", record->id, "");
  link_set(links, "document", record->id, "/document");
  link_set(links, "attempts", record->id, "/attempts");
  link_set(links, "log", record->id, "/log");
  bool study = strcmp(record->kind, "study") == 0;
  if (study || record->study_id != 0) {
    snprintf(path, sizeof path, "/api/v1/studies/%lld",
             (long long)(study ? record->id : record->study_id));
    json_object_set_new(links, "study", json_string(path));
  }
  if (record->has_result) {
    link_set(links, "result", record->id, "/result");
    link_set(links, "metrics", record->id, "/metrics");
    link_set(links, "samples", record->id, "/samples.csv");
    json_decref(plots);
    plots = plots_view(service, record, whole);
  }
  for (size_t i = 0; i < json_array_size(record->artifacts); i++) {
    snprintf(path, sizeof path, "/api/v1/jobs/%lld/artifacts/%s", (long long)record->id,
             json_string_value(json_array_get(record->artifacts, i)));
    json_array_append_new(artifacts, json_string(path));
  }
  json_object_set_new(links, "plots", plots);
  json_object_set_new(links, "artifacts", artifacts);
  return links;
}

json_t *job_view(const struct service *service, const struct job_record *record, bool whole) {
  json_t *view =
      json_pack("{s:I, s:s, s:s, s:s, s:s, s:s, s:O, s:i, s:s, s:I, s:s, s:o, s:o, s:o}", "id",
                (json_int_t)record->id, "state", job_state_word(record->state), "reason_code",
                record->reason_code, "message", record->message, "kind", record->kind, "name",
                record->name, "labels", record->labels, "priority", record->priority, "submitter",
                record->submitter, "attempt", (json_int_t)record->attempt, "spec_hash",
                record->spec_hash, "created", time_view(record->created_ms), "started",
                time_view(record->started_ms), "finished", time_view(record->finished_ms));
  if (view) {
    progress_set(service, record, view);
    json_t *place = job_place(service, record);
    if (place) {
      json_object_set_new(view, "cluster", place);
    }
  }
  if (view && record->retry_of != 0) {
    json_object_set_new(view, "retry_of", json_integer(record->retry_of));
  }
  if (view && record->retry_reason[0] != '\0') {
    json_object_set_new(view, "retry_reason", json_string(record->retry_reason));
  }
  if (view && record->reused_from != 0) {
    json_object_set_new(view, "reused_from", json_integer(record->reused_from));
  }
  if (view && record->waits_for != 0) {
    json_object_set_new(view, "waits_for", json_integer(record->waits_for));
  }
  if (view && record->study_id != 0) {
    json_object_set_new(view, "study", json_integer(record->study_id));
    json_object_set_new(view, "member", json_integer(record->member));
  }
  if (view && record->extends != 0) {
    json_object_set_new(view, "extends", json_integer(record->extends));
  }
  if (view && record->has_result) {
    json_object_set(view, "metrics", record->metrics);
  }
  if (view) {
    json_object_set_new(view, "links", links_view(service, record, whole));
  }
  return view;
}

static void location_set(struct reply *reply, int64_t id) {
  reply_header(reply, "Location", "/api/v1/jobs/%lld", (long long)id);
}

/* Whether the view of a job in this state changes only with the database. */
static bool state_rests(enum job_state state) {
  return state != JOB_STATE_STARTING && state != JOB_STATE_RUNNING && state != JOB_STATE_CANCELLING;
}

void job_view_reply(struct request *request, struct reply *reply, unsigned status, int64_t id,
                    bool location) {
  struct service *service = request->service;
  struct job_record record;
  struct error error;
  bool plain = request->method == HTTP_GET && status == 200 && !location;
  struct answer *kept = plain ? answers_find(service->answers, id) : NULL;
  if (kept) {
    reply_kept(reply, "application/json", kept);
    return;
  }
  uint64_t version = store_version(service->store);
  if (store_job(service->store, id, &record, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  json_t *view = job_view(service, &record, true);
  bool told = json_is_object(json_object_get(view, "cluster")); /* it may change by itself */
  reply_json(reply, status, view);
  if (plain && state_rests(record.state) && !told && reply->body && reply->size <= KEPT_SIZE_MAX) {
    answers_keep(service->answers, id, version, reply->body, reply->size);
  }
  job_record_clear(&record);
  if (location) {
    location_set(reply, id);
  }
}

static void job_waited(struct request *request, struct reply *reply) {
  struct job_record record;
  struct error error;
  if (store_job(request->service->store, request->job_id, &record, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  bool ended = job_state_terminal(record.state);
  reply_json(reply, ended || request->method == HTTP_GET ? 200 : 202,
             job_view(request->service, &record, true));
  job_record_clear(&record);
  reply_header(reply, "Preference-Applied", "wait=%lld", (long long)request_wait_s(request));
  if (request->job_is_new) {
    location_set(reply, request->job_id);
  }
}

void job_view_reply_waiting(struct request *request, struct reply *reply, unsigned status,
                            int64_t id, bool location) {
  int64_t wait_s = request_wait_s(request);
  if (wait_s == 0) {
    job_view_reply(request, reply, status, id, location);
    return;
  }
  request->job_id = id;
  request->job_is_new = location;
  reply->wait_job_id = id;
  reply->wait_ms = 1000 * wait_s;
  reply->then = job_waited;
}
