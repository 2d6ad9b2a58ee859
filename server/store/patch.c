#include "server/store/connection.h"
#include "server/store/sql.h"
#include "server/store/study_row.h"

static enum status patch_allowed(sqlite3 *db, int64_t id, enum job_state state, const json_t *patch,
                                 struct error *error) {
  bool waits =
      state == JOB_STATE_QUEUED || state == JOB_STATE_HELD || state == JOB_STATE_RETRY_WAIT;
  enum job_state study_state;
  int64_t study_id = 0;
  bool study = false;
  enum status status = study_of(db, id, &study, &study_id, &study_state, error);
  if (status != STATUS_OK) {
    return status;
  }
  if (json_object_size(patch) > 0 && job_state_terminal(state)) {
    return error_set(error, STATUS_CONFLICT, NULL,
                     "Job %lld is %s: a finished job is not changed any more.", (long long)id,
                     job_state_word(state));
  }
  if (json_object_get(patch, "priority") && study_id != 0 && !job_state_terminal(study_state)) {
    return error_set(error, STATUS_CONFLICT, "/priority",
                     "Job %lld is a member of study %lld and has its priority: change that one.",
                     (long long)id, (long long)study_id);
  }
  if (json_object_get(patch, "priority") && !waits && !(study && state == JOB_STATE_RUNNING)) {
    return error_set(error, STATUS_CONFLICT, "/priority",
                     "Job %lld is %s: the priority can be changed only while a job waits.",
                     (long long)id, job_state_word(state));
  }
  return STATUS_OK;
}

static enum status patch_label(sqlite3 *db, int64_t id, const char *name, const json_t *value,
                               struct error *error) {
  if (json_is_null(value)) {
    return sql_run(db, error, "DELETE FROM job_label WHERE job_id = ? AND name = ?", "it", id,
                   name);
  }
  return sql_run(db, error,
                 "INSERT INTO job_label (job_id, name, value, kind, state, finished_ms, job_name) "
                 "SELECT id, ?, ?, kind, state, finished_ms, name FROM job WHERE id = ? "
                 "ON CONFLICT DO UPDATE SET value = excluded.value",
                 "tti", name, json_string_value(value), id);
}

static enum status labels_count(sqlite3 *db, int64_t id, struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status = sql_prepare(db, &statement, error,
                                   "SELECT count(*) FROM job_label WHERE job_id = ?", "i", id);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && sqlite3_column_int(statement, 0) > STORE_LABELS_OWN_MAX) {
    status = error_set(error, STATUS_INVALID, "/labels",
                       "With these the job would have %d labels; at most %d are allowed. A label "
                       "is removed by null.",
                       sqlite3_column_int(statement, 0), STORE_LABELS_OWN_MAX);
  }
  sql_done(statement);
  return status;
}

static enum status patch_labels(sqlite3 *db, int64_t id, const json_t *labels,
                                struct error *error) {
  const char *name;
  json_t *value;
  if (!labels) {
    return STATUS_OK;
  }
  if (json_is_null(labels)) {
    return sql_run(db, error, "DELETE FROM job_label WHERE job_id = ?", "i", id);
  }
  json_object_foreach((json_t *)labels, name, value) {
    enum status status = patch_label(db, id, name, value, error);
    if (status != STATUS_OK) {
      return status;
    }
  }
  return labels_count(db, id, error);
}

/* The engine follows the label; that of a study counts for members that are stored from now on. */
static enum status patch_engine(sqlite3 *db, int64_t id, struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status =
      sql_prepare(db, &statement, error,
                  "SELECT value FROM job_label WHERE job_id = ? AND name = 'executor'", "i", id);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK) {
    int64_t engine = engine_of_label(row ? sql_text(statement, 0) : NULL);
    status = sql_run(db, error, "UPDATE job SET engine = ?1 WHERE id = ?2 AND engine <> ?1", "ii",
                     engine, id);
  }
  sql_done(statement);
  return status;
}

static enum status patch_apply(sqlite3 *db, int64_t id, const json_t *patch, struct error *error) {
  const json_t *name = json_object_get(patch, "name");
  const json_t *priority = json_object_get(patch, "priority");
  const json_t *labels = json_object_get(patch, "labels");
  enum status status = patch_labels(db, id, labels, error);
  if (status == STATUS_OK && labels) {
    status = patch_engine(db, id, error);
  }
  if (status == STATUS_OK && name) {
    status = sql_run(db, error, "UPDATE job SET name = ? WHERE id = ?", "ti",
                     json_is_null(name) ? "" : json_string_value(name), id);
  }
  if (status == STATUS_OK && priority) {
    status = sql_run(db, error, "UPDATE job SET priority = ? WHERE id = ?", "ii",
                     (int64_t)json_number_value(priority), id);
  }
  return status;
}

enum status store_patch(struct store *store, int64_t id, const json_t *patch, struct error *error) {
  enum job_state state = JOB_STATE_QUEUED;
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  if (json_object_get(patch, "priority")) { /* it counts in our queue */
    int withdrawn;
    status = cluster_withdraw(store->writer, id, WITHDRAW_JOB, 1, &withdrawn, error);
  }
  if (status == STATUS_OK) {
    status = store_state_of(store->writer, id, &state, error);
  }
  if (status == STATUS_OK) {
    status = patch_allowed(store->writer, id, state, patch, error);
  }
  if (status == STATUS_OK) {
    status = patch_apply(store->writer, id, patch, error);
  }
  return store_write_end(store, status, error);
}
