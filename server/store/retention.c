#include "server/store/retention.h"

#include <stdio.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/store/connection.h"
#include "server/store/sql.h"

#define WITH_FILES "finished_ms IS NOT NULL AND files_removed_ms IS NULL AND attempt > 0"

/* Jobs and their files; a query is limited to the room. */
struct files_list {
  struct job_files *list;
  size_t *count;
};

static enum status take_files(sqlite3_stmt *row, void *context, struct error *error) {
  struct files_list *files = context;
  (void)error;
  files->list[(*files->count)++] = (struct job_files){.job_id = sqlite3_column_int64(row, 0),
                                                      .attempts = sqlite3_column_int64(row, 1),
                                                      .bytes = sqlite3_column_int64(row, 2)};
  return STATUS_OK;
}

enum status store_files_unmeasured(struct store *store, struct job_files *list, size_t room,
                                   size_t *count, struct error *error) {
  struct files_list files = {list, count};
  *count = 0;
  return store_each(store, error, take_files, &files,
                    "SELECT id, attempt, 0 FROM job INDEXED BY job_with_files "
                    "WHERE " WITH_FILES " AND files_bytes IS NULL LIMIT ?",
                    "i", (int64_t)room);
}

enum status store_files_measured(struct store *store, const struct job_files *list, size_t count,
                                 struct error *error) {
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  for (size_t i = 0; i < count && status == STATUS_OK; i++) {
    status = sql_run(store->writer, error, "UPDATE job SET files_bytes = ? WHERE id = ?", "ii",
                     list[i].bytes, list[i].job_id);
  }
  return store_write_end(store, status, error);
}

static enum status files_sum(sqlite3 *db, int64_t *bytes, struct error *error) {
  return sql_each(db, error, sql_take_integer, bytes,
                  "SELECT coalesce(sum(files_bytes), 0) FROM job INDEXED BY "
                  "job_with_files WHERE " WITH_FILES,
                  "");
}

/* The oldest jobs with files that ended before a moment (0: whenever). */
static enum status files_oldest(sqlite3 *db, int64_t before_ms, struct job_files *list, size_t room,
                                size_t *count, struct error *error) {
  struct files_list files = {list, count};
  *count = 0;
  return sql_each(db, error, take_files, &files,
                  "SELECT id, attempt, coalesce(files_bytes, 0) FROM job INDEXED BY job_with_files "
                  "WHERE " WITH_FILES " AND (? = 0 OR finished_ms < ?) "
                  "ORDER BY finished_ms, id LIMIT ?",
                  "iii", before_ms, before_ms, (int64_t)room);
}

/* Lists the jobs whose files are to go by one of the limits. */
static enum status files_due(sqlite3 *db, const struct retention *limits, int64_t now,
                             struct job_files *list, size_t room, size_t *count, const char **why,
                             struct error *error) {
  enum status status = STATUS_OK;
  *count = 0;
  *why = "age";
  if (limits->keep_ms > 0) {
    status = files_oldest(db, now - limits->keep_ms, list, room, count, error);
  }
  if (status == STATUS_OK && *count == 0 && limits->keep_bytes > 0) {
    int64_t bytes = 0;
    size_t listed = 0;
    *why = "size";
    status = files_sum(db, &bytes, error);
    if (status == STATUS_OK && bytes > limits->keep_bytes) {
      status = files_oldest(db, 0, list, room, &listed, error);
    }
    while (*count < listed && bytes > limits->keep_bytes) {
      bytes -= list[(*count)++].bytes;
    }
  }
  return status;
}

enum status store_files_expire(struct store *store, const struct retention *limits,
                               struct job_files *list, size_t room, size_t *count,
                               struct error *error) {
  int64_t now = clock_unix_ms();
  const char *why;
  struct error reason = {.status = STATUS_IO};
  *count = 0;
  sqlite3 *db = store_read_begin(store, &reason);
  if (!db) {
    return error_set(error, reason.status, NULL, "%s", reason.message);
  }
  enum status status = files_due(db, limits, now, list, room, count, &why, error);
  store_read_end(store, db);
  if (status != STATUS_OK || *count == 0) {
    return status;
  }
  status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  for (size_t i = 0; i < *count && status == STATUS_OK; i++) {
    status = sql_run(store->writer, error,
                     "UPDATE job SET files_removed_ms = ?, files_removed_why = ? "
                     "WHERE id = ? AND " WITH_FILES,
                     "iti", now, why, list[i].job_id);
  }
  return store_write_end(store, status, error);
}

enum status store_files_kept(struct store *store, int64_t job_id, int64_t attempt, bool *kept,
                             struct error *error) {
  int64_t found = 0;
  enum status status = store_each(
      store, error, sql_take_integer, &found,
      "SELECT 1 FROM job WHERE id = ? AND attempt >= ? AND files_removed_ms IS NULL UNION ALL "
      "SELECT 1 FROM job WHERE reused_from = ? AND files_removed_ms IS NULL AND NOT EXISTS "
      "(SELECT 1 FROM job WHERE id = ?) LIMIT 1",
      "iiii", job_id, attempt, job_id, job_id);
  *kept = found != 0;
  return status;
}

struct removal {
  int64_t ms;
  char why[8];
};

static enum status take_removal(sqlite3_stmt *row, void *context, struct error *error) {
  struct removal *removal = context;
  (void)error;
  removal->ms = sqlite3_column_int64(row, 0);
  snprintf(removal->why, sizeof removal->why, "%s", sql_text(row, 1));
  return STATUS_OK;
}

enum status store_files_removed(struct store *store, int64_t job_id, int64_t *removed_ms,
                                char why[8], struct error *error) {
  struct removal removal = {0};
  enum status status = store_each(
      store, error, take_removal, &removal,
      "SELECT coalesce(files_removed_ms, 0), files_removed_why FROM job WHERE id = ?", "i", job_id);
  *removed_ms = removal.ms;
  memcpy(why, removal.why, sizeof removal.why);
  return status;
}
