#include "server/http/submission.h"

#include <math.h>

#include "solver/job/json.h"

static enum status memory_check(const struct service *service, const struct job_spec *spec,
                                struct error *error) {
  double most = (double)service->memory_limit_bytes;
  if (most == 0 || spec->memory_bytes <= most) {
    return STATUS_OK;
  }
  return error_set(error, STATUS_INVALID, "/memory",
                   "%.6g MB is more than this daemon gives a worker\nat most %.0f MB\n\"%.0f MB\"",
                   spec->memory_bytes / 1e6, floor(most / 1e6), floor(most / 1e6));
}

enum status document_read(const struct request *request, const char *text, size_t size,
                          struct job_document *document, struct error *error) {
  const struct service *service = request->service;
  const struct job_spec *spec = &document->spec;
  *document = (struct job_document){.root = NULL};
  enum status status = job_reader_read(service->reader, text, size, &document->spec, error);
  if (status == STATUS_OK) {
    status = memory_check(service, spec, error);
    if (status != STATUS_OK) {
      json_text_locate(text, size, error->pointer, &error->line, &error->column);
    }
  }
  if (status == STATUS_OK) {
    status = json_text_read(text, size, &document->root, error);
  }
  if (status != STATUS_OK) {
    document_release(document);
    return status;
  }
  document->submission =
      (struct submission){.document = text,
                          .root = document->root,
                          .spec_hash = spec->hash,
                          .timeout_s = spec->timeout_s,
                          .memory_bytes = (uint64_t)spec->memory_bytes,
                          .priority = spec->priority,
                          .reuse = spec->reuse,
                          .submitter = request->caller.name[0] ? request->caller.name : NULL};
  return STATUS_OK;
}

void document_release(struct job_document *document) {
  job_spec_release(&document->spec);
  json_decref(document->root);
  document->root = NULL;
}

enum status document_store(const struct request *request, const struct job_document *document,
                           int64_t *id, bool *replayed, struct error *error) {
  enum status status = disk_check(request->service->disk, error);
  return status == STATUS_OK
             ? store_submit(request->service->store, &document->submission, id, replayed, error)
             : status;
}

bool submission_open(const struct request *request, struct reply *reply) {
  bool open = !atomic_load(&request->service->draining);
  if (!open) {
    reply_shutting_down(reply);
  }
  return open;
}
