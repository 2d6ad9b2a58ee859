#include "server/http/study_table.h"

#include <math.h>
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

/* The value of a parameter from the text of a query: a word of it, or a number. */
static enum status read_value(const struct study_column *column, const char *text, double *value,
                              struct error *error) {
  char *end;
  for (size_t i = 0; i < column->word_count; i++) {
    if (strcmp(column->words[i], text) == 0) {
      *value = (double)i;
      return STATUS_OK;
    }
  }
  *value = strtod(text, &end);
  if (column->categorical || end == text || *end != '\0' || !isfinite(*value)) {
    return error_set(error, STATUS_INVALID, NULL, "%.40s is no value of %.100s\n%s", text,
                     column->key,
                     column->categorical ? "one of its words, as the study gives them"
                                         : "a number, in the unit in which it is shown");
  }
  return STATUS_OK;
}

enum status study_fixed_read(const struct request *request, const struct study_table *table,
                             double at[SURROGATE_PARAMETERS_MAX], struct error *error) {
  enum status status = STATUS_OK;
  for (size_t k = 0; k < SURROGATE_PARAMETERS_MAX; k++) {
    at[k] = NAN;
  }
  for (size_t i = 0; i < request->url.query_count && status == STATUS_OK; i++) {
    const struct url_pair *pair = &request->url.query[i];
    size_t column;
    if (strncmp(pair->name, "at.", 3) != 0) {
      continue;
    }
    status = criteria_parameter(table, pair->name + 3, &column, error);
    if (status == STATUS_OK && column < SURROGATE_PARAMETERS_MAX) {
      status = read_value(&table->parameter[column], pair->value, &at[column], error);
    }
  }
  return status;
}
