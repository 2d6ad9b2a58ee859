#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/store/connection.h"
#include "server/store/flatten.h"
#include "server/store/sql.h"

void job_record_clear(struct job_record *record) {
  free(record->reason_code);
  free(record->message);
  free(record->kind);
  free(record->name);
  free(record->spec_hash);
  free(record->retry_reason);
  free(record->submitter);
  json_decref(record->labels);
  json_decref(record->metrics);
  json_decref(record->artifacts);
  *record = (struct job_record){0};
}

/* A JSON value that rows are added to. */
struct gathering {
  json_t *into;
  void (*take)(json_t *into, sqlite3_stmt *row);
};

static enum status gather(sqlite3_stmt *row, void *context, struct error *error) {
  const struct gathering *gathering = context;
  (void)error;
  gathering->take(gathering->into, row);
  return STATUS_OK;
}

/* Reads a query of one job into a JSON value: take() adds one row to it. */
static enum status rows_read(sqlite3 *db, const char *sql, int64_t id, json_t *into,
                             void (*take)(json_t *into, sqlite3_stmt *row), struct error *error) {
  struct gathering gathering = {into, take};
  return sql_each(db, error, gather, &gathering, sql, "i", id);
}

static void take_text(json_t *into, sqlite3_stmt *row) {
  json_object_set_new(into, sql_text(row, 0), json_string(sql_text(row, 1)));
}

static void take_number(json_t *into, sqlite3_stmt *row) {
  json_object_set_new(into, sql_text(row, 0), json_real(sqlite3_column_double(row, 1)));
}

static void take_name(json_t *into, sqlite3_stmt *row) {
  json_array_append_new(into, json_string(sql_text(row, 0)));
}

static void parameter_add(json_t *into, const struct parameter *parameter) {
  json_t *value = parameter->has_value ? json_real(parameter->value) : json_null();
  json_object_set_new(into, parameter->pointer,
                      json_pack("{s:o, s:s, s:s}", "value", value, "text", parameter->text, "unit",
                                parameter->unit));
}

static void take_parameter(json_t *into, sqlite3_stmt *row) {
  struct parameter parameter = {.pointer = sql_text(row, 0),
                                .has_value = sqlite3_column_type(row, 1) != SQLITE_NULL,
                                .value = sqlite3_column_double(row, 1),
                                .text = sql_text(row, 2),
                                .unit = sql_text(row, 3)};
  parameter_add(into, &parameter);
}

static enum status take_leaf(void *context, const struct parameter *parameter,
                             struct error *error) {
  (void)error;
  parameter_add(context, parameter);
  return STATUS_OK;
}

static json_t *optional_integer(sqlite3_stmt *row, int column) {
  return sqlite3_column_type(row, column) == SQLITE_NULL
             ? json_null()
             : json_integer(sqlite3_column_int64(row, column));
}

static json_t *optional_number(sqlite3_stmt *row, int column) {
  return sqlite3_column_type(row, column) == SQLITE_NULL
             ? json_null()
             : json_real(sqlite3_column_double(row, column));
}

static json_t *optional_time(sqlite3_stmt *row, int column) {
  char text[CLOCK_TEXT_SIZE];
  if (sqlite3_column_type(row, column) == SQLITE_NULL) {
    return json_null();
  }
  clock_format(sqlite3_column_int64(row, column), text);
  return json_string(text);
}

static void take_attempt(json_t *into, sqlite3_stmt *row) {
  json_array_append_new(
      into, json_pack("{s:I, s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "number",
                      (json_int_t)sqlite3_column_int64(row, 0), "outcome", sql_text(row, 1),
                      "reason_code", sql_text(row, 2), "message", sql_text(row, 10), "pid",
                      optional_integer(row, 3), "exit_code", optional_integer(row, 4), "signal",
                      optional_integer(row, 5), "started", optional_time(row, 6), "finished",
                      optional_time(row, 7), "cpu_s", optional_number(row, 8), "peak_memory_MB",
                      optional_number(row, 9)));
}

#define JOB_COLUMNS                                                                                \
  "job.id, job.state, job.reason_code, job.message, job.kind, job.name, job.spec_hash, "           \
  "job.attempt, coalesce(job.retry_of, 0), job.created_ms, coalesce(job.started_ms, 0), "          \
  "coalesce(job.finished_ms, 0), EXISTS (SELECT 1 FROM result WHERE result.job_id = job.id), "     \
  "job.retry_reason, job.submitter, job.priority, coalesce(job.reused_from, 0), "                  \
  "coalesce(job.waits_for, 0), coalesce(job.study_id, 0), coalesce(job.member, 0), "               \
  "coalesce(job.extends, 0), job.engine"

/* Fills *record from a row of JOB_COLUMNS and reads labels, metrics, artifacts. */
static enum status row_read(sqlite3 *db, sqlite3_stmt *row, struct job_record *record,
                            struct error *error) {
  *record = (struct job_record){.id = sqlite3_column_int64(row, 0),
                                .reason_code = sql_text_copy(row, 2),
                                .message = sql_text_copy(row, 3),
                                .kind = sql_text_copy(row, 4),
                                .name = sql_text_copy(row, 5),
                                .spec_hash = sql_text_copy(row, 6),
                                .attempt = sqlite3_column_int64(row, 7),
                                .retry_of = sqlite3_column_int64(row, 8),
                                .created_ms = sqlite3_column_int64(row, 9),
                                .started_ms = sqlite3_column_int64(row, 10),
                                .finished_ms = sqlite3_column_int64(row, 11),
                                .has_result = sqlite3_column_int(row, 12) != 0,
                                .retry_reason = sql_text_copy(row, 13),
                                .submitter = sql_text_copy(row, 14),
                                .priority = sqlite3_column_int(row, 15),
                                .reused_from = sqlite3_column_int64(row, 16),
                                .waits_for = sqlite3_column_int64(row, 17),
                                .study_id = sqlite3_column_int64(row, 18),
                                .member = sqlite3_column_int64(row, 19),
                                .extends = sqlite3_column_int64(row, 20),
                                .engine = (enum store_engine)sqlite3_column_int(row, 21),
                                .labels = json_object(),
                                .metrics = json_object(),
                                .artifacts = json_array()};
  enum status status = STATUS_OK;
  if (!record->reason_code || !record->message || !record->kind || !record->name ||
      !record->spec_hash || !record->retry_reason || !record->submitter || !record->labels ||
      !record->metrics || !record->artifacts) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a job.");
  } else if (!job_state_parse(sql_text(row, 1), &record->state)) {
    status = error_set(error, STATUS_INTERNAL, NULL, "Job %lld has an unknown state.",
                       (long long)record->id);
  }
  if (status == STATUS_OK) {
    status = rows_read(db, "SELECT name, value FROM job_label WHERE job_id = ?", record->id,
                       record->labels, take_text, error);
  }
  if (status == STATUS_OK && record->has_result) {
    status = rows_read(db, "SELECT name, value FROM metric WHERE job_id = ?", record->id,
                       record->metrics, take_number, error);
  }
  if (status == STATUS_OK && record->has_result) {
    status = rows_read(db, "SELECT name FROM artifact WHERE job_id = ?", record->id,
                       record->artifacts, take_name, error);
  }
  if (status != STATUS_OK) {
    job_record_clear(record);
  }
  return status;
}

enum status store_record_read(sqlite3 *db, int64_t id, struct job_record *record,
                              struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status = sql_prepare(db, &statement, error,
                                   "SELECT " JOB_COLUMNS " FROM job WHERE job.id = ?", "i", id);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK) {
    status = row ? row_read(db, statement, record, error) : store_no_job(id, error);
  }
  sql_done(statement);
  return status;
}

enum status store_job(struct store *store, int64_t id, struct job_record *record,
                      struct error *error) {
  sqlite3 *db = store_read_begin(store, error);
  if (!db) {
    return STATUS_IO;
  }
  enum status status = store_record_read(db, id, record, error);
  store_read_end(store, db);
  return status;
}

/* Up to two texts of a row. */
struct texts {
  char **first, **second; /* the latter may be NULL */
  bool found;
};

static enum status take_texts(sqlite3_stmt *row, void *context, struct error *error) {
  struct texts *texts = context;
  char *one = sql_text_copy(row, 0);
  char *two = texts->second ? sql_text_copy(row, 1) : NULL;
  if (!one || (texts->second && !two)) {
    free(one);
    free(two);
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a document.");
  }
  *texts->first = one;
  if (texts->second) {
    *texts->second = two;
  }
  texts->found = true;
  return STATUS_OK;
}

/* Reads up to two texts of one row. STATUS_NOT_FOUND with `missing` when there is no row. */
static enum status texts_read(struct store *store, const char *sql, int64_t id, char **first,
                              char **second, const char *missing, struct error *error) {
  struct texts texts = {.first = first, .second = second};
  enum status status = store_each(store, error, take_texts, &texts, sql, "i", id);
  return status == STATUS_OK && !texts.found
             ? error_set(error, STATUS_NOT_FOUND, NULL, "There is no %s %lld.", missing,
                         (long long)id)
             : status;
}

enum status store_document(struct store *store, int64_t id, char **text, struct error *error) {
  return texts_read(store, "SELECT document FROM job WHERE id = ?", id, text, NULL, "job", error);
}

enum status store_result(struct store *store, int64_t id, char **text, char **directory,
                         struct error *error) {
  return texts_read(store, "SELECT document, directory FROM result WHERE job_id = ?", id, text,
                    directory, "result of job", error);
}

enum status store_artifact(struct store *store, int64_t id, const char *name, struct error *error) {
  int64_t found = 0;
  enum status status =
      store_each(store, error, sql_take_integer, &found,
                 "SELECT 1 FROM artifact WHERE job_id = ? AND name = ?", "it", id, name);
  return status == STATUS_OK && !found
             ? error_set(error, STATUS_NOT_FOUND, NULL, "Job %lld has no artifact %.100s.",
                         (long long)id, name)
             : status;
}

/* Reads rows of a job that must exist into *into, which becomes the caller's. */
static enum status job_rows_read(struct store *store, const char *sql, int64_t id, json_t *fresh,
                                 void (*take)(json_t *, sqlite3_stmt *), json_t **into,
                                 struct error *error) {
  enum job_state state;
  sqlite3 *db = fresh ? store_read_begin(store, error) : NULL;
  enum status status = db ? store_state_of(db, id, &state, error) : STATUS_IO;
  if (status == STATUS_OK) {
    status = rows_read(db, sql, id, fresh, take, error);
  }
  if (db) {
    store_read_end(store, db);
  }
  if (status != STATUS_OK) {
    json_decref(fresh);
    fresh = NULL;
  }
  *into = fresh;
  return status;
}

enum status store_attempts(struct store *store, int64_t id, json_t **attempts,
                           struct error *error) {
  return job_rows_read(store,
                       "SELECT number, outcome, reason_code, pid, exit_code, signal, created_ms, "
                       "finished_ms, cpu_s, peak_memory_MB, message FROM attempt WHERE job_id = ? "
                       "ORDER BY number",
                       id, json_array(), take_attempt, attempts, error);
}

/* Those of a job that has not started yet, from its document. */
static enum status parameters_of_document(struct store *store, int64_t id, json_t *into,
                                          struct error *error) {
  char *document = NULL;
  enum status status = store_document(store, id, &document, error);
  if (status == STATUS_OK) {
    status = flatten_each(document, store->units, take_leaf, into, error);
    free(document);
  }
  return status;
}

enum status store_parameters(struct store *store, int64_t id, json_t **parameters,
                             struct error *error) {
  enum status status = job_rows_read(
      store, "SELECT pointer, value, text, unit FROM design_parameter WHERE job_id = ?", id,
      json_object(), take_parameter, parameters, error);
  if (status == STATUS_OK && json_object_size(*parameters) == 0) {
    status = parameters_of_document(store, id, *parameters, error);
    if (status != STATUS_OK) {
      json_decref(*parameters);
      *parameters = NULL;
    }
  }
  return status;
}
