/* The view of a study: what people and programs that read the database compare its members by. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "server/store/connection.h"
#include "server/store/sql.h"
#include "server/store/study.h"
#include "server/store/study_row.h"

enum { NAME_SIZE = 100, COLUMNS_MAX = 500 };

/* A view in the making. */
struct view {
  sqlite3 *db;
  int64_t id;
  sqlite3_str *sql;
  size_t count;
  char (*name)[NAME_SIZE]; /* of its columns so far */
};

static bool name_taken(const struct view *view, const char *name) {
  static const char *const own[] = {"member", "job", "name", "state", "reason_code"};
  for (size_t i = 0; i < sizeof own / sizeof *own; i++) {
    if (strcasecmp(own[i], name) == 0) {
      return true;
    }
  }
  for (size_t i = 0; i < view->count; i++) {
    if (strcasecmp(view->name[i], name) == 0) {
      return true;
    }
  }
  return false;
}

/* Makes a name that needs no quotes, of letters, digits and underscores, out of "side wall" and
 * "mm"; one that is taken gets a number. */
static const char *column_name(struct view *view, const char *title, const char *unit) {
  char text[NAME_SIZE - 16], *name = view->name[view->count];
  snprintf(text, sizeof text, "%s%s%s", title, unit[0] ? "_" : "", unit);
  for (char *c = text; *c; c++) {
    *c = isalnum((unsigned char)*c) ? *c : '_';
  }
  const char *stem = text[0] ? text : "value";
  snprintf(name, NAME_SIZE, "%s%s", isdigit((unsigned char)stem[0]) ? "_" : "", stem);
  for (int i = 2; name_taken(view, name); i++) {
    snprintf(name, NAME_SIZE, "%.80s_%d", stem, i);
  }
  view->count++;
  return name;
}

/* Adds a column for each row of a query with the columns position or name, title, unit. */
static enum status columns_add(struct view *view, const char *query, const char *pattern,
                               struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status = sql_prepare(view->db, &statement, error, query, "i", view->id);
  while (status == STATUS_OK && view->count < COLUMNS_MAX &&
         (status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    const char *unit = strcmp(sql_text(statement, 2), "°") == 0 ? "deg" : sql_text(statement, 2);
    const char *name = column_name(view, sql_text(statement, 1), unit);
    sqlite3_str_appendall(view->sql, ",\n  ");
    sqlite3_str_appendf(view->sql, pattern, (long long)view->id, sql_text(statement, 0));
    sqlite3_str_appendf(view->sql, " AS \"%w\"", name);
  }
  sql_done(statement);
  return status;
}

static enum status view_compose(struct view *view, struct error *error) {
  sqlite3_str_appendf(view->sql,
                      "CREATE VIEW study_%lld AS\nSELECT job.member, job.id AS job, job.name, "
                      "job.state, job.reason_code",
                      (long long)view->id);
  enum status status =
      columns_add(view,
                  "SELECT position, name, unit FROM study_parameter WHERE study_id = ? "
                  "AND categorical = 0 ORDER BY position",
                  "(SELECT number FROM study_value WHERE study_id = %lld "
                  "AND study_value.member = job.member AND position = %s)",
                  error);
  if (status == STATUS_OK) {
    status = columns_add(view,
                         "SELECT position, name, unit FROM study_parameter WHERE study_id = ? "
                         "AND categorical = 1 ORDER BY position",
                         "(SELECT text FROM study_value WHERE study_id = %lld "
                         "AND study_value.member = job.member AND position = %s)",
                         error);
  }
  if (status == STATUS_OK) {
    status = columns_add(view,
                         "SELECT DISTINCT metric.name, metric.name, '' FROM job CROSS JOIN metric "
                         "ON metric.job_id = job.id WHERE job.study_id = ? ORDER BY metric.name",
                         "(SELECT value FROM metric WHERE %lld AND job_id = job.id "
                         "AND metric.name = '%q')",
                         error);
  }
  sqlite3_str_appendf(view->sql, "\nFROM job WHERE job.study_id = %lld", (long long)view->id);
  return status;
}

enum status study_view_drop(sqlite3 *db, int64_t id, struct error *error) {
  char sql[80];
  snprintf(sql, sizeof sql, "DROP VIEW IF EXISTS study_%lld", (long long)id);
  return sqlite3_exec(db, sql, NULL, NULL, NULL) == SQLITE_OK ? STATUS_OK : sql_fail(db, error);
}

/* Every connection reads the definition of every view: there are no more than a few. */
static enum status views_limit(sqlite3 *db, struct error *error) {
  sqlite3_stmt *statement;
  int64_t oldest = 0;
  int row = 0;
  enum status status = sql_prepare(db, &statement, error,
                                   "SELECT CAST(substr(name, 7) AS INTEGER) AS id "
                                   "FROM sqlite_schema WHERE type = 'view' "
                                   "AND name GLOB 'study_[0-9]*' ORDER BY id DESC LIMIT 1 OFFSET ?",
                                   "i", (int64_t)STUDY_VIEWS_MAX);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && row) {
    oldest = sqlite3_column_int64(statement, 0);
  }
  sql_done(statement);
  return status == STATUS_OK && oldest != 0 ? study_view_drop(db, oldest, error) : status;
}

enum status store_study_view(struct store *store, int64_t id, struct error *error) {
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct view view = {.db = store->writer, .id = id, .sql = sqlite3_str_new(store->writer)};
  view.name = calloc(COLUMNS_MAX + 1, sizeof *view.name);
  status = view.name ? study_view_drop(view.db, id, error)
                     : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a view.");
  if (status == STATUS_OK) {
    status = view_compose(&view, error);
  }
  char *sql = sqlite3_str_finish(view.sql);
  if (status == STATUS_OK && (!sql || sqlite3_exec(view.db, sql, NULL, NULL, NULL) != SQLITE_OK)) {
    status = sql_fail(view.db, error);
  }
  if (status == STATUS_OK) {
    status = views_limit(view.db, error);
  }
  sqlite3_free(sql);
  free(view.name);
  return store_write_end(store, status, error);
}
