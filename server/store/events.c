#include <string.h>

#include "server/store/connection.h"
#include "server/store/sql.h"
#include "solver/job/json.h"

/* Called by SQLite for every row that the writer changes, under the writer's mutex. */
static void event_written(void *context, int operation, const char *database, const char *table,
                          sqlite3_int64 row) {
  struct store *store = context;
  (void)database;
  (void)row;
  store->event_written =
      store->event_written || (operation == SQLITE_INSERT && strcmp(table, "event") == 0);
}

void store_watch_events(struct store *store, void (*committed)(void *context), void *context) {
  pthread_mutex_lock(&store->writer_mutex);
  store->event_committed = committed;
  store->event_context = context;
  sqlite3_update_hook(store->writer, committed ? event_written : NULL, store);
  pthread_mutex_unlock(&store->writer_mutex);
}

enum status store_event_last(struct store *store, int64_t *id, struct error *error) {
  *id = 0;
  return store_each(store, error, sql_take_integer, id, "SELECT coalesce(max(id), 0) FROM event",
                    "");
}

enum status store_events(struct store *store, int64_t after, int limit,
                         bool (*take)(void *context, const struct job_event *event), void *context,
                         int *count, struct error *error) {
  *count = 0;
  sqlite3 *db = store_read_begin(store, error);
  if (!db) {
    return STATUS_IO;
  }
  sqlite3_stmt *statement;
  int row = 0;
  enum status status = sql_prepare(
      db, &statement, error,
      "SELECT id, at_ms, job_id, state, reason_code, attempt, (SELECT "
      "json_group_object(name, value) FROM job_label WHERE job_label.job_id = event.job_id) "
      "FROM event WHERE id > ? ORDER BY id LIMIT ?",
      "ii", after, (int64_t)limit);
  while (status == STATUS_OK && (status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    struct job_event event = {.id = sqlite3_column_int64(statement, 0),
                              .at_ms = sqlite3_column_int64(statement, 1),
                              .job_id = sqlite3_column_int64(statement, 2),
                              .state = sql_text(statement, 3),
                              .reason_code = sql_text(statement, 4),
                              .attempt = sqlite3_column_int64(statement, 5),
                              .labels = sql_text(statement, 6)};
    if (!take(context, &event)) {
      break;
    }
    ++*count;
  }
  sql_done(statement);
  store_read_end(store, db);
  return status;
}

static enum status take_labels(sqlite3_stmt *row, void *labels, struct error *error) {
  const char *text = sql_text(row, 0);
  return json_text_read(text, strlen(text), labels, error);
}

enum status store_labels(struct store *store, int64_t id, json_t **labels, struct error *error) {
  *labels = NULL;
  return store_each(store, error, take_labels, labels,
                    "SELECT json_group_object(name, value) FROM job_label WHERE job_id = ?", "i",
                    id);
}
