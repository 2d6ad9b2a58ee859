/* From a checked job document to what the store takes. */
#ifndef PNEULAB_HTTP_SUBMISSION_H
#define PNEULAB_HTTP_SUBMISSION_H

#include "server/http/service.h"
#include "solver/job/spec.h"

/* A job document that was read: all that *submission points to. */
struct job_document {
  struct job_spec spec;
  json_t *root;
  struct submission submission;
};

/* Reads and checks the document in `text`, of `size` bytes, which must outlive *document, and fills
 * in everything of its submission by `request` but idempotency key and retry. Beside the failures
 * of job_reader_read STATUS_INVALID at /memory for more than the daemon gives a worker. On success
 * the caller releases *document. */
enum status document_read(const struct request *request, const char *text, size_t size,
                          struct job_document *document, struct error *error);

void document_release(struct job_document *document);

/* Stores the submission of a document that was read, unless the disk is in trouble; otherwise as
 * store_submit. */
enum status document_store(const struct request *request, const struct job_document *document,
                           int64_t *id, bool *replayed, struct error *error);

/* Whether jobs are taken; otherwise replies that the server is shutting down. */
bool submission_open(const struct request *request, struct reply *reply);

/* Stores the job document in `text` for the request and replies as to a submission, also when it is
 * refused. */
void submission_take(struct request *request, struct reply *reply, const char *text, size_t size);

#endif
