/* What the handlers of a study's analysis begin with. */
#ifndef PNEULAB_HTTP_STUDY_TABLE_H
#define PNEULAB_HTTP_STUDY_TABLE_H

#include "server/http/service.h"
#include "server/study/analysis.h"

/* The study that the request names; otherwise replies 404 or why it cannot be read and returns
 * NULL. The caller ends with study_table_close. */
const struct study_table *study_table_open(const struct request *request, struct reply *reply);
void study_table_close(const struct request *request, const struct study_table *table);

/* Replies with an answer, whose reference is taken over, or with the failure: STATUS_INVALID is a
 * query that cannot be answered, 400. */
void study_reply(struct reply *reply, enum status status, json_t *answer,
                 const struct error *error);

/* The document of a study as it was submitted. STATUS_OK, or a failure of the database; the caller
 * owns *document. */
enum status study_document_read(const struct request *request, int64_t study_id, json_t **document,
                                struct error *error);

/* The values at which a slice holds its other parameters: at.POINTER=VALUE of the query, NaN for
 * those that it does not name. STATUS_INVALID for a pointer or a value that is none. */
enum status study_fixed_read(const struct request *request, const struct study_table *table,
                             double at[SURROGATE_PARAMETERS_MAX], struct error *error);

/* Members that have ended without success, by their reason, with a few of each: a new list of
 * {"reason_code", "count", "jobs"}. */
json_t *study_failures(const struct study_table *table);

#endif
