#include "server/store/cluster.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/store/connection.h"
#include "server/store/sql.h"

/* A list that is read row by row. */
struct rows {
  void *list;
  size_t count, room, size;
};

/* One more row, cleared; NULL without memory. */
static void *rows_add(struct rows *rows) {
  if (rows->count == rows->room) {
    size_t room = rows->room ? 2 * rows->room : 64;
    void *list = realloc(rows->list, room * rows->size);
    if (!list) {
      return NULL;
    }
    rows->list = list;
    rows->room = room;
  }
  void *row = (char *)rows->list + rows->size * rows->count++;
  memset(row, 0, rows->size);
  return row;
}

/* Reads a query with the parameter `id` (0: it has none) into a list. */
static enum status rows_read(struct store *store, const char *sql, int64_t id, struct rows *rows,
                             void (*take)(sqlite3_stmt *statement, void *row),
                             struct error *error) {
  sqlite3_stmt *statement = NULL;
  int row = 1;
  sqlite3 *db = store_read_begin(store, error);
  if (!db) {
    return STATUS_IO;
  }
  enum status status = id != 0 ? sql_prepare(db, &statement, error, sql, "i", id)
                               : sql_prepare(db, &statement, error, sql, "");
  while (status == STATUS_OK && (status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    void *next = rows_add(rows);
    if (!next) {
      status = error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the batches of a cluster.");
      break;
    }
    take(statement, next);
  }
  sql_done(statement);
  store_read_end(store, db);
  if (status != STATUS_OK) {
    free(rows->list);
    *rows = (struct rows){.size = rows->size};
  }
  return status;
}

/* ---- batches ------------------------------------------------------------------------------ */

static enum status batch_insert(sqlite3 *db, struct cluster_batch *batch, struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status = sql_run(db, error,
                               "INSERT INTO cluster_batch (name, partition, created_ms) "
                               "VALUES (lower(hex(randomblob(16))), ?, ?)",
                               "ti", batch->partition, batch->created_ms);
  if (status != STATUS_OK) {
    return status;
  }
  batch->id = sqlite3_last_insert_rowid(db);
  status = sql_prepare(db, &statement, error,
                       "UPDATE cluster_batch SET name = (SELECT name FROM cluster_identity) || "
                       "'-' || id || '-' || lower(hex(randomblob(4))) WHERE id = ? RETURNING name",
                       "i", batch->id);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && row) {
    snprintf(batch->name, sizeof batch->name, "%s", sql_text(statement, 0));
  }
  sql_done(statement);
  return status;
}

enum status store_batch_intend(struct store *store, struct cluster_batch *batch,
                               const struct cluster_attempt *attempts, size_t count,
                               struct error *error) {
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  sqlite3 *db = store->writer;
  batch->created_ms = clock_unix_ms();
  status = batch_insert(db, batch, error);
  for (size_t i = 0; i < batch->tasks && status == STATUS_OK; i++) {
    status = sql_run(db, error, "INSERT INTO cluster_task (batch_id, task) VALUES (?, ?)", "ii",
                     batch->id, (int64_t)i);
  }
  for (size_t i = 0; i < count && status == STATUS_OK; i++) {
    status = sql_run(db, error,
                     "UPDATE attempt SET batch_id = ?, task = ?, place = ? "
                     "WHERE job_id = ? AND number = ?",
                     "iiiii", batch->id, attempts[i].task, attempts[i].place, attempts[i].job_id,
                     attempts[i].attempt);
  }
  return store_write_end(store, status, error);
}

enum status store_batch_submitted(struct store *store, int64_t id, int64_t cluster_job,
                                  struct error *error) {
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = sql_run(store->writer, error,
                   "UPDATE cluster_batch SET cluster_job = ?, submitted_ms = ? WHERE id = ?", "iii",
                   cluster_job, clock_unix_ms(), id);
  if (status == STATUS_OK) {
    status = sql_run(store->writer, error,
                     "UPDATE cluster_task SET state = 'pending' "
                     "WHERE batch_id = ? AND state = 'waiting'",
                     "i", id);
  }
  return store_write_end(store, status, error);
}

enum status store_batch_ended(struct store *store, int64_t id, struct error *error) {
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = sql_run(store->writer, error, "UPDATE cluster_batch SET ended_ms = ? WHERE id = ?", "ii",
                   clock_unix_ms(), id);
  return store_write_end(store, status, error);
}

enum status store_tasks_note(struct store *store, const struct cluster_task_news *news,
                             size_t count, struct error *error) {
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  for (size_t i = 0; i < count && status == STATUS_OK; i++) {
    status = sql_run(store->writer, error,
                     "UPDATE cluster_task SET state = ?, reason = ?, node = coalesce(?, node) "
                     "WHERE batch_id = ? AND task = ?",
                     "tttii", news[i].state, news[i].reason, news[i].node, news[i].batch_id,
                     news[i].task);
  }
  return store_write_end(store, status, error);
}

static void take_batch(sqlite3_stmt *statement, void *row) {
  struct cluster_batch *batch = row;
  batch->id = sqlite3_column_int64(statement, 0);
  snprintf(batch->name, sizeof batch->name, "%s", sql_text(statement, 1));
  batch->cluster_job = sqlite3_column_int64(statement, 2);
  snprintf(batch->partition, sizeof batch->partition, "%s", sql_text(statement, 3));
  batch->created_ms = sqlite3_column_int64(statement, 4);
  batch->tasks = (size_t)sqlite3_column_int64(statement, 5);
}

enum status store_batches_open(struct store *store, struct cluster_batch **list, size_t *count,
                               struct error *error) {
  struct rows rows = {.size = sizeof **list};
  enum status status = rows_read(
      store,
      "SELECT id, name, cluster_job, partition, created_ms, (SELECT count(*) FROM cluster_task "
      "WHERE batch_id = cluster_batch.id) FROM cluster_batch WHERE ended_ms IS NULL ORDER BY id",
      0, &rows, take_batch, error);
  *list = rows.list;
  *count = rows.count;
  return status;
}

/* ---- attempts ----------------------------------------------------------------------------- */

static void take_attempt(sqlite3_stmt *statement, void *row) {
  struct cluster_attempt *attempt = row;
  attempt->job_id = sqlite3_column_int64(statement, 0);
  attempt->attempt = sqlite3_column_int64(statement, 1);
  attempt->task = sqlite3_column_int64(statement, 2);
  attempt->place = sqlite3_column_int64(statement, 3);
  attempt->timeout_s = sqlite3_column_double(statement, 4);
  attempt->memory_bytes = (uint64_t)sqlite3_column_int64(statement, 5);
  job_state_parse(sql_text(statement, 6), &attempt->state);
}

enum status store_batch_attempts(struct store *store, int64_t id, struct cluster_attempt **list,
                                 size_t *count, struct error *error) {
  struct rows rows = {.size = sizeof **list};
  enum status status =
      rows_read(store,
                "SELECT job_id, number, task, place, job.timeout_s, job.memory_bytes, job.state "
                "FROM attempt JOIN job ON job.id = job_id AND job.attempt = number "
                "WHERE batch_id = ? AND outcome = '' ORDER BY task, place",
                id, &rows, take_attempt, error);
  *list = rows.list;
  *count = rows.count;
  return status;
}

enum status store_job_partition(struct store *store, int64_t id, char partition[CLUSTER_WORD_SIZE],
                                struct error *error) {
  sqlite3_stmt *statement = NULL;
  int row = 0;
  sqlite3 *db = store_read_begin(store, error);
  partition[0] = '\0';
  if (!db) {
    return STATUS_IO;
  }
  enum status status =
      sql_prepare(db, &statement, error,
                  "SELECT value FROM job JOIN job_label ON job_label.name = 'partition' AND "
                  "job_label.job_id IN (job.id, job.study_id) WHERE job.id = ? "
                  "ORDER BY job_label.job_id DESC LIMIT 1",
                  "i", id);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && row) {
    snprintf(partition, CLUSTER_WORD_SIZE, "%s", sql_text(statement, 0));
  }
  sql_done(statement);
  store_read_end(store, db);
  return status;
}

/* The jobs of a withdrawal: ?1 is the job or study. */
#define OF_JOB "job.id = ?1"
#define OF_STUDY "job.study_id = ?1"
#define OF_PRIORITY                                                                                \
  OF_STUDY " AND job.priority <> (SELECT priority FROM job AS study WHERE study.id = ?1)"
#define CLOSE(JOBS)                                                                                \
  "UPDATE attempt SET outcome = 'requeued', reason_code = 'withdrawn', finished_ms = ?2, message " \
  "= 'Taken back from the queue of the cluster.' WHERE outcome = '' AND batch_id IS NOT NULL "     \
  "AND job_id IN (SELECT job.id FROM job WHERE " JOBS " AND state = 'starting' LIMIT ?3)"
#define QUEUE(JOBS)                                                                                \
  "UPDATE job SET state = 'queued', reason_code = '', message = '' WHERE " JOBS                    \
  " AND state = 'starting' AND NOT EXISTS (SELECT 1 FROM attempt WHERE attempt.job_id = job.id "   \
  "AND attempt.outcome = '')"

enum status cluster_withdraw(sqlite3 *db, int64_t id, enum withdrawal whose, int most, int *count,
                             struct error *error) {
  static const char *const texts[][2] = {
      [WITHDRAW_JOB] = {CLOSE(OF_JOB), QUEUE(OF_JOB)},
      [WITHDRAW_STUDY] = {CLOSE(OF_STUDY), QUEUE(OF_STUDY)},
      [WITHDRAW_PRIORITY] = {CLOSE(OF_PRIORITY), QUEUE(OF_PRIORITY)}};
  enum status status =
      sql_run(db, error, texts[whose][0], "iii", id, clock_unix_ms(), (int64_t)most);
  *count = status == STATUS_OK ? sqlite3_changes(db) : 0;
  return *count > 0 ? sql_run(db, error, texts[whose][1], "i", id) : status;
}
