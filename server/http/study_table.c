#include "server/http/study_table.h"

#include <stdlib.h>
#include <string.h>

#include "server/study/tables.h"
#include "solver/job/json.h"

const struct study_table *study_table_open(const struct request *request, struct reply *reply) {
  const struct study_table *table;
  struct error error = {.status = STATUS_OK};
  int64_t id;
  if (!request_id(request, reply, &id)) {
    return NULL;
  }
  if (tables_use(request->service->tables, id, &table, NULL, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return NULL;
  }
  return table;
}

void study_table_close(const struct request *request, const struct study_table *table) {
  tables_release(request->service->tables, table);
}

void study_reply(struct reply *reply, enum status status, json_t *answer,
                 const struct error *error) {
  if (status == STATUS_OK) {
    reply_json(reply, 200, answer);
    return;
  }
  json_decref(answer);
  if (status == STATUS_INVALID || status == STATUS_TOO_LARGE) {
    reply_problem(reply, 400, "invalid_query", "%s", error->message);
  } else {
    reply_error(reply, error);
  }
}

enum status study_document_read(const struct request *request, int64_t study_id, json_t **document,
                                struct error *error) {
  char *text = NULL;
  *document = NULL;
  enum status status = store_document(request->service->store, study_id, &text, error);
  if (status == STATUS_OK) {
    status = json_text_read(text, strlen(text), document, error);
  }
  free(text);
  return status;
}
