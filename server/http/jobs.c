#include <stdlib.h>
#include <string.h>

#include "server/base/log.h"
#include "server/http/handlers.h"
#include "server/http/job_view.h"
#include "server/http/jobs.h"
#include "server/http/submission.h"
#include "server/study/conductor.h"

enum { KEY_MAX = 200, LIST_LIMIT = 50, LIST_LIMIT_MAX = 500 };

/* Reads a job document; otherwise replies why not and returns false. */
static bool text_read(const struct request *request, struct reply *reply, const char *text,
                      size_t size, struct job_document *document) {
  struct error error = {.status = STATUS_OK};
  if (document_read(request, text, size, document, &error) == STATUS_OK) {
    return true;
  }
  reply_error(reply, &error);
  return false;
}

/* The request's idempotency key, NULL when it has none; false when it is malformed. */
static bool key_read(const struct request *request, struct reply *reply, const char **key) {
  *key = request_header(request, "Idempotency-Key");
  if (*key && (strlen(*key) == 0 || strlen(*key) > KEY_MAX)) {
    reply_problem(reply, 400, "invalid_header", "Idempotency-Key: expected 1 to %d characters.",
                  KEY_MAX);
    return false;
  }
  return true;
}

/* Whether the job was answered as soon as it was submitted. */
static bool job_answered(const struct service *service, int64_t id) {
  struct job_record record;
  if (store_job(service->store, id, &record, NULL) != STATUS_OK) {
    return false;
  }
  bool answered = record.reused_from != 0;
  job_record_clear(&record);
  return answered;
}

void submission_take(struct request *request, struct reply *reply, const char *text, size_t size) {
  struct service *service = request->service;
  struct job_document document;
  struct error error;
  const char *key;
  int64_t id;
  bool replayed;
  if (!submission_open(request, reply)) {
    return;
  }
  if (!key_read(request, reply, &key) || !text_read(request, reply, text, size, &document)) {
    return;
  }
  document.submission.idempotency_key = key;
  enum status status = document_store(request, &document, &id, &replayed, &error);
  bool answered =
      status == STATUS_OK && document.submission.reuse && !replayed && job_answered(service, id);
  document_release(&document);
  if (status == STATUS_CONFLICT && key) {
    reply_problem(reply, 422, "idempotency_key_reused", "%s", error.message);
    return;
  }
  if (status != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  if (!replayed) {
    log_event(LOG_LEVEL_INFO, "job submitted", LOG_NUMBER("job", id),
              LOG_TEXT("caller", request->caller.name), LOG_TEXT("request", request->id));
  }
  executor_wake(service->executor);
  conductor_wake(service->conductor);
  job_view_reply_waiting(request, reply, answered ? 200 : 202, id, true);
}

void jobs_submit(struct request *request, struct reply *reply) {
  submission_take(request, reply, request->body ? request->body : "", request->body_size);
}

void jobs_validate(struct request *request, struct reply *reply) {
  struct job_document document;
  if (text_read(request, reply, request->body ? request->body : "", request->body_size,
                &document)) {
    reply_json(reply, 200,
               json_pack("{s:b, s:s, s:s}", "valid", 1, "kind",
                         json_string_value(json_object_get(document.root, "kind")), "spec_hash",
                         document.spec.hash));
    document_release(&document);
  }
}

/* "state=queued,running" into the set of wanted states. */
static bool list_states(const struct request *request, struct reply *reply,
                        struct list_query *query) {
  const char *rest = url_query(&request->url, "state");
  while (rest && *rest) {
    char word[20];
    size_t length = strcspn(rest, ",");
    enum job_state state;
    if (length >= sizeof word) {
      length = sizeof word - 1;
    }
    memcpy(word, rest, length);
    word[length] = '\0';
    if (!job_state_parse(word, &state)) {
      reply_problem(reply, 400, "invalid_query",
                    "There is no state %s; known are queued, held, starting, running, cancelling, "
                    "retry_wait, succeeded, failed, timed_out, cancelled.",
                    word);
      return false;
    }
    query->states[state] = true;
    rest += length + (rest[length] == ',');
  }
  return true;
}

static bool list_labels(const struct request *request, struct reply *reply,
                        struct list_query *query) {
  for (size_t i = 0; i < request->url.query_count; i++) {
    const struct url_pair *pair = &request->url.query[i];
    if (strncmp(pair->name, "label.", 6) != 0) {
      continue;
    }
    if (query->label_count == STORE_LABELS_MAX) {
      reply_problem(reply, 400, "invalid_query", "At most %d labels can be filtered by.",
                    STORE_LABELS_MAX);
      return false;
    }
    query->labels[query->label_count].name = pair->name + 6;
    query->labels[query->label_count++].value = pair->value;
  }
  return true;
}

static bool list_sort(const struct request *request, struct reply *reply,
                      struct list_query *query) {
  static const char *const words[] = {[LIST_BY_ID] = "id",
                                      [LIST_BY_CREATED] = "created",
                                      [LIST_BY_FINISHED] = "finished",
                                      [LIST_BY_NAME] = "name",
                                      [LIST_BY_STATE] = "state"};
  const char *word = url_query(&request->url, "sort");
  word = word ? word : "-id";
  query->descending = word[0] == '-';
  for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
    if (strcmp(words[i], word + query->descending) == 0) {
      query->sort = i;
      return true;
    }
  }
  reply_problem(reply, 400, "invalid_query",
                "sort=%.40s: expected id, created, finished, name or state, with a leading minus "
                "for the largest first, for example sort=-id.",
                word);
  return false;
}

static json_t *list_view(const struct service *service, struct job_record *records, size_t count,
                         const char *next) {
  json_t *jobs = json_array();
  for (size_t i = 0; i < count; i++) {
    json_array_append_new(jobs, job_view(service, &records[i], false));
    job_record_clear(&records[i]);
  }
  free(records);
  return json_pack("{s:o, s:s?}", "jobs", jobs, "next", next);
}

/* "study=12" or "study=none". */
static bool list_study(const struct request *request, struct reply *reply,
                       struct list_query *query) {
  const char *word = url_query(&request->url, "study");
  if (word && strcmp(word, "none") == 0) {
    query->study = LIST_STUDY_NONE;
    return true;
  }
  if (word && (*word < '0' || *word > '9')) {
    reply_problem(reply, 400, "invalid_query",
                  "study=%.40s: expected the id of a study, or none for jobs that belong to none, "
                  "for example study=12.",
                  word);
    return false;
  }
  return request_query_integer(request, reply, "study", 1, INT64_MAX, LIST_STUDY_ANY,
                               &query->study);
}

bool jobs_query(const struct request *request, struct reply *reply, struct list_query *query) {
  int64_t limit;
  *query = (struct list_query){.kind = url_query(&request->url, "kind"),
                               .cursor = url_query(&request->url, "cursor")};
  if (!list_states(request, reply, query) || !list_study(request, reply, query) ||
      !list_labels(request, reply, query) || !list_sort(request, reply, query) ||
      !request_query_integer(request, reply, "limit", 1, LIST_LIMIT_MAX, LIST_LIMIT, &limit)) {
    return false;
  }
  query->limit = (int)limit;
  return true;
}

void jobs_list(struct request *request, struct reply *reply) {
  struct list_query query;
  struct job_record *records;
  struct error error = {.status = STATUS_OK};
  size_t count;
  char *next;
  if (!jobs_query(request, reply, &query)) {
    return;
  }
  enum status status = store_list(request->service->store, &query, &records, &count, &next, &error);
  if (status == STATUS_INVALID) {
    reply_problem(reply, 400, "invalid_query", "%s", error.message);
  } else if (status != STATUS_OK) {
    reply_error(reply, &error);
  } else {
    reply_json(reply, 200, list_view(request->service, records, count, next));
    free(next);
  }
}
