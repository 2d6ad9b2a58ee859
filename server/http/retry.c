#include <stdlib.h>
#include <string.h>

#include "server/http/handlers.h"
#include "server/http/job_view.h"
#include "server/study/conductor.h"
#include "server/http/submission.h"
#include "solver/job/json.h"

enum { REASON_MAX = 500 };

/* The reason in the request's body, NULL when it has none; owned by *body, which the caller
 * releases. */
static enum status reason_read(const struct request *request, json_t **body, const char **reason,
                               struct error *error) {
  const char *key;
  json_t *value;
  *body = NULL;
  *reason = NULL;
  if (request->body_size == 0) {
    return STATUS_OK;
  }
  enum status status = json_text_read(request->body, request->body_size, body, error);
  if (status != STATUS_OK) {
    return status;
  }
  if (!json_is_object(*body)) {
    return error_set(error, STATUS_INVALID, "",
                     "the body is no object\nan object or no body\n{\"reason\": \"more memory\"}");
  }
  json_object_foreach(*body, key, value) {
    struct json_pointer pointer = {.length = 0};
    json_pointer_key(&pointer, key);
    if (strcmp(key, "reason") != 0) {
      status = error_set(error, STATUS_INVALID, pointer.text,
                         "the key \"%.60s\" is not known here\nreason\n{\"reason\": \"more "
                         "memory\"}",
                         key);
    } else if (!json_is_string(value) || json_string_length(value) > REASON_MAX) {
      status = error_set(error, STATUS_INVALID, pointer.text,
                         "the reason is no text, or too long\na text of at most %d bytes\n\"more "
                         "memory\"",
                         REASON_MAX);
    } else {
      *reason = json_string_value(value);
    }
  }
  return status;
}

/* Writes what was changed by hand since the submission over the document, so that the new job
 * begins as the old one ended. *text is replaced when there is a difference. */
static enum status document_update(const struct job_record *record, char **text,
                                   struct error *error) {
  json_t *root = NULL;
  enum status status = json_text_read(*text, strlen(*text), &root, error);
  if (status != STATUS_OK) {
    return status;
  }
  json_t *before = json_deep_copy(root);
  json_t *labels = json_object_get(root, "labels");
  const char *name = json_string_value(json_object_get(root, "name"));
  if (strcmp(name ? name : "", record->name) != 0) {
    json_object_set_new(root, "name", json_string(record->name));
  }
  if (record->name[0] == '\0') {
    json_object_del(root, "name");
  }
  if (labels || json_object_size(record->labels) > 0) {
    json_object_set(root, "labels", record->labels);
  }
  if ((int)json_number_value(json_object_get(root, "priority")) != record->priority) {
    json_object_set_new(root, "priority", json_integer(record->priority));
  }
  if (!json_equal(before, root)) {
    char *changed = json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(17));
    if (changed) {
      free(*text);
      *text = changed;
    } else {
      status = error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a job document.");
    }
  }
  json_decref(before);
  json_decref(root);
  return status;
}

/* The text of a finished job's document; malloc'd. */
static enum status finished_document(struct store *store, int64_t id, char **text,
                                     struct error *error) {
  struct job_record record;
  enum status status = store_job(store, id, &record, error);
  if (status != STATUS_OK) {
    return status;
  }
  if (!job_state_terminal(record.state)) {
    status = error_set(error, STATUS_CONFLICT, NULL,
                       "Job %lld is %s; only a finished job can be tried again.", (long long)id,
                       job_state_word(record.state));
  }
  if (status == STATUS_OK) {
    status = store_document(store, id, text, error);
  }
  if (status == STATUS_OK) {
    status = document_update(&record, text, error);
  }
  job_record_clear(&record);
  return status;
}

/* A terminal job is immutable, so to retry it is to submit its document again. It is solved even
 * where there is an answer: that is what was asked for. */
static enum status job_resubmit(const struct request *request, int64_t id, const char *reason,
                                int64_t *new_id, struct error *error) {
  struct job_document document = {.root = NULL};
  char *text = NULL;
  bool replayed;
  enum status status = finished_document(request->service->store, id, &text, error);
  if (status == STATUS_OK) { /* checked anew: the rules may have changed since */
    status = document_read(request, text, strlen(text), &document, error);
  }
  if (status == STATUS_OK) {
    document.submission.retry_of = id;
    document.submission.retry_reason = reason;
    document.submission.reuse = false;
    status = document_store(request, &document, new_id, &replayed, error);
    document_release(&document);
  }
  free(text);
  return status;
}

void job_retry(struct request *request, struct reply *reply) {
  struct error error;
  int64_t id, new_id;
  json_t *body;
  const char *reason;
  if (!request_id(request, reply, &id)) {
    return;
  }
  if (!submission_open(request, reply)) {
    return;
  }
  enum status status = reason_read(request, &body, &reason, &error);
  if (status == STATUS_OK) {
    status = job_resubmit(request, id, reason, &new_id, &error);
  }
  json_decref(body);
  if (status != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  executor_wake(request->service->executor);
  conductor_wake(request->service->conductor);
  job_view_reply_waiting(request, reply, 202, new_id, true);
}
