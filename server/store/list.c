#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/store/connection.h"
#include "server/store/sql.h"

/* The values of a job by which it is sorted; every one is unique together with the id. */
static const char *const sort_expressions[] = {
    [LIST_BY_ID] = "job.id",
    [LIST_BY_CREATED] = "job.created_ms",
    [LIST_BY_FINISHED] = "coalesce(job.finished_ms, 0)",
    [LIST_BY_NAME] = "job.name",
    [LIST_BY_STATE] = "job.state",
};

/* The text of the query: filters with ? for their values, the cursor, the order. */
static char *list_sql(const struct list_query *query) {
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  if (!out) {
    return NULL;
  }
  const char *key = sort_expressions[query->sort];
  fprintf(out, "SELECT " JOB_COLUMNS " FROM job WHERE 1");
  const char *between = " AND job.state IN (";
  for (int i = 0; i < JOB_STATE_COUNT; i++) {
    if (query->states[i]) {
      fprintf(out, "%s'%s'", between, job_state_word((enum job_state)i));
      between = ", ";
    }
  }
  if (between[0] == ',') {
    fprintf(out, ")");
  }
  if (query->kind) {
    fprintf(out, " AND job.kind = ?");
  }
  for (size_t i = 0; i < query->label_count; i++) {
    fprintf(out, " AND EXISTS (SELECT 1 FROM job_label AS l WHERE l.job_id = job.id AND "
                 "l.name = ? AND l.value = ?)");
  }
  if (query->cursor != 0 && query->sort == LIST_BY_ID) {
    fprintf(out, " AND job.id %s ?", query->descending ? "<" : ">");
  } else if (query->cursor != 0) {
    fprintf(out, " AND (%s, job.id) %s (SELECT %s, job.id FROM job WHERE id = ?)", key,
            query->descending ? "<" : ">", key);
  }
  const char *direction = query->descending ? "DESC" : "ASC";
  fprintf(out, " ORDER BY %s %s, job.id %s LIMIT ?", key, direction, direction);
  if (fclose(out) != 0) {
    free(text);
    return NULL;
  }
  return text;
}

static enum status list_prepare(sqlite3 *db, const struct list_query *query,
                                sqlite3_stmt **statement, struct error *error) {
  char *sql = list_sql(query);
  if (!sql) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a query.");
  }
  enum status status = sql_prepare(db, statement, error, sql, "");
  free(sql);
  if (status != STATUS_OK) {
    return status;
  }
  int parameter = 1;
  if (query->kind) {
    sqlite3_bind_text(*statement, parameter++, query->kind, -1, SQLITE_STATIC);
  }
  for (size_t i = 0; i < query->label_count; i++) {
    sqlite3_bind_text(*statement, parameter++, query->labels[i].name, -1, SQLITE_STATIC);
    sqlite3_bind_text(*statement, parameter++, query->labels[i].value, -1, SQLITE_STATIC);
  }
  if (query->cursor != 0) {
    sqlite3_bind_int64(*statement, parameter++, query->cursor);
  }
  sqlite3_bind_int(*statement, parameter, query->limit + 1);
  return STATUS_OK;
}

/* Reads up to limit records; one row more tells that there is another page. */
static enum status list_read(sqlite3 *db, sqlite3_stmt *statement, const struct list_query *query,
                             struct job_record *records, size_t *count, int64_t *next,
                             struct error *error) {
  enum status status = STATUS_OK;
  int row = 0;
  while ((status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    if (*count == (size_t)query->limit) {
      *next = records[*count - 1].id;
      break;
    }
    status = store_record_read(db, statement, &records[*count], error);
    if (status != STATUS_OK) {
      break;
    }
    ++*count;
  }
  return status;
}

enum status store_list(struct store *store, const struct list_query *query,
                       struct job_record **records, size_t *count, int64_t *next,
                       struct error *error) {
  sqlite3_stmt *statement = NULL;
  enum status status = STATUS_OK;
  *count = 0;
  *next = 0;
  *records = calloc((size_t)query->limit, sizeof **records);
  sqlite3 *db = *records ? store_read_begin(store, error) : NULL;
  if (!db) {
    status = STATUS_IO;
    goto done;
  }
  if (query->cursor != 0 && query->sort != LIST_BY_ID) {
    enum job_state state;
    status = store_state_of(db, query->cursor, &state, error);
  }
  if (status == STATUS_OK) {
    status = list_prepare(db, query, &statement, error);
  }
  if (status == STATUS_OK) {
    status = list_read(db, statement, query, *records, count, next, error);
  }
done:
  sqlite3_finalize(statement);
  if (db) {
    store_read_end(store, db);
  }
  if (status != STATUS_OK) {
    for (size_t i = 0; i < *count; i++) {
      job_record_clear(&(*records)[i]);
    }
    free(*records);
    *records = NULL;
    *count = 0;
  }
  return status;
}

enum status store_counts(struct store *store, int64_t counts[JOB_STATE_COUNT],
                         struct error *error) {
  memset(counts, 0, JOB_STATE_COUNT * sizeof *counts);
  sqlite3 *db = store_read_begin(store, error);
  if (!db) {
    return STATUS_IO;
  }
  sqlite3_stmt *statement;
  int row = 0;
  enum status status = sql_prepare(db, &statement, error, "SELECT state, jobs FROM job_count", "");
  while (status == STATUS_OK && (status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    enum job_state state;
    if (job_state_parse(sql_text(statement, 0), &state)) {
      counts[state] = sqlite3_column_int64(statement, 1);
    }
  }
  sqlite3_finalize(statement);
  store_read_end(store, db);
  return status;
}
