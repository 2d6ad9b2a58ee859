#include "server/store/failures.h"

#include <stdlib.h>

#include "server/store/connection.h"
#include "server/store/sql.h"

/* The newest failures, however many there are, in bounded time. */
static const char groups_sql[] =
    "SELECT reason_code, count(*), max(id) FROM ("
    "SELECT id, reason_code FROM (SELECT id, reason_code FROM job WHERE state = 'failed' "
    "ORDER BY id DESC LIMIT 1000) UNION ALL SELECT id, reason_code FROM (SELECT id, reason_code "
    "FROM job WHERE state = 'timed_out' ORDER BY id DESC LIMIT 1000)) "
    "GROUP BY reason_code ORDER BY 2 DESC, 3 DESC LIMIT ?";

static enum status group_take(sqlite3 *db, sqlite3_stmt *row, struct failure_group *group,
                              struct error *error) {
  struct job_record record;
  *group = (struct failure_group){0};
  enum status status = store_record_read(db, sqlite3_column_int64(row, 2), &record, error);
  if (status != STATUS_OK) {
    return status;
  }
  *group = (struct failure_group){.reason_code = sql_text_copy(row, 0),
                                  .count = sqlite3_column_int64(row, 1),
                                  .newest = record.id,
                                  .newest_name = record.name,
                                  .newest_message = record.message};
  record.name = NULL;
  record.message = NULL;
  job_record_clear(&record);
  return group->reason_code ? STATUS_OK
                            : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a failure.");
}

enum status store_failures(struct store *store, struct failure_group groups[FAILURE_GROUPS],
                           size_t *count, struct error *error) {
  sqlite3_stmt *statement = NULL;
  *count = 0;
  sqlite3 *db = store_read_begin(store, error);
  if (!db) {
    return error->status;
  }
  int row = 1;
  enum status status = sql_prepare(db, &statement, error, groups_sql, "i", (int64_t)FAILURE_GROUPS);
  while (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
    if (status != STATUS_OK || !row) {
      break;
    }
    status = group_take(db, statement, &groups[(*count)++], error);
  }
  sql_done(statement);
  store_read_end(store, db);
  if (status != STATUS_OK) {
    failures_clear(groups, *count);
    *count = 0;
  }
  return status;
}

void failures_clear(struct failure_group *groups, size_t count) {
  for (size_t i = 0; i < count; i++) {
    free(groups[i].reason_code);
    free(groups[i].newest_name);
    free(groups[i].newest_message);
    groups[i] = (struct failure_group){0};
  }
}
