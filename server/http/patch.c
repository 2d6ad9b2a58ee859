#include <string.h>

#include "server/http/handlers.h"
#include "server/http/job_view.h"
#include "server/study/conductor.h"
#include "solver/job/json.h"
#include "solver/job/spec.h"

/* Whether only what may be changed is in the patch. */
static enum status patch_known(const json_t *patch, struct error *error) {
  const char *key;
  json_t *value;
  if (!json_is_object(patch)) {
    return error_set(error, STATUS_INVALID, "",
                     "the body is no object\nan object of name, labels and priority\n"
                     "{\"priority\": 10, \"labels\": {\"todo\": null}}");
  }
  json_object_foreach((json_t *)patch, key, value) {
    if (strcmp(key, "name") != 0 && strcmp(key, "labels") != 0 && strcmp(key, "priority") != 0) {
      struct json_pointer pointer = {.length = 0};
      json_pointer_key(&pointer, key);
      return error_set(error, STATUS_INVALID, pointer.text,
                       "\"%.60s\" of a job cannot be changed\nname, labels and priority\n"
                       "{\"priority\": 10}",
                       key);
    }
  }
  return STATUS_OK;
}

/* The labels of a patch that are not to be removed. */
static json_t *labels_kept(const json_t *labels) {
  json_t *kept = json_object(), *value;
  const char *name;
  if (!json_is_object(labels)) {
    json_decref(kept);
    return json_incref((json_t *)labels);
  }
  json_object_foreach((json_t *)labels, name, value) {
    if (!json_is_null(value)) {
      json_object_set(kept, name, value);
    }
  }
  return kept;
}

/* Checks the values by the rules of job documents: in the shortest job there is. */
static enum status patch_values(const struct job_reader *reader, const json_t *patch,
                                struct error *error) {
  struct job_spec spec;
  const char *key;
  json_t *value;
  json_t *job = json_pack("{s:s, s:s}", "kind", "verify", "case", "patch-test");
  json_object_foreach((json_t *)patch, key, value) {
    if (strcmp(key, "labels") == 0 && !json_is_null(value)) {
      json_object_set_new(job, key, labels_kept(value));
    } else if (!json_is_null(value)) {
      json_object_set(job, key, value);
    }
  }
  enum status status = job_reader_check(reader, job, &spec, error);
  job_spec_release(&spec);
  json_decref(job);
  return status;
}

static enum status patch_read(const struct request *request, json_t **patch, struct error *error) {
  const char *text = request->body ? request->body : "";
  enum status status = json_text_read(text, request->body_size, patch, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = patch_known(*patch, error);
  if (status == STATUS_OK) {
    status = patch_values(request->service->reader, *patch, error);
  }
  if (status != STATUS_OK) {
    json_text_locate(text, request->body_size, error->pointer, &error->line, &error->column);
  }
  return status;
}

void job_patch(struct request *request, struct reply *reply) {
  struct error error = {.status = STATUS_OK};
  json_t *patch = NULL;
  int64_t id;
  if (!request_id(request, reply, &id)) {
    return;
  }
  enum status status = patch_read(request, &patch, &error);
  if (status == STATUS_OK) {
    status = store_patch(request->service->store, id, patch, &error);
  }
  json_decref(patch);
  if (status != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  executor_recall(request->service->executor);
  executor_wake(request->service->executor);
  conductor_wake(request->service->conductor);
  job_view_reply(request, reply, 200, id, false);
}
