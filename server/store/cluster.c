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
  void (*take)(sqlite3_stmt *statement, void *row);
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

static enum status take_row(sqlite3_stmt *statement, void *context, struct error *error) {
  struct rows *rows = context;
  void *row = rows_add(rows);
  if (!row) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the batches of a cluster.");
  }
  rows->take(statement, row);
  return STATUS_OK;
}

/* Hands the list over when it was read, else frees it. */
static enum status rows_end(struct rows *rows, enum status status, size_t *count) {
  if (status != STATUS_OK) {
    free(rows->list);
    *rows = (struct rows){0};
  }
  *count = rows->count;
  return status;
}

/* ---- batches ------------------------------------------------------------------------------ */

static enum status take_name(sqlite3_stmt *row, void *context, struct error *error) {
  struct cluster_batch *batch = context;
  (void)error;
  snprintf(batch->name, sizeof batch->name, "%s", sql_text(row, 0));
  return STATUS_OK;
}

static enum status batch_insert(sqlite3 *db, struct cluster_batch *batch, struct error *error) {
  enum status status = sql_run(db, error,
                               "INSERT INTO cluster_batch (name, partition, created_ms) "
                               "VALUES (lower(hex(randomblob(16))), ?, ?)",
                               "ti", batch->partition, batch->created_ms);
  if (status != STATUS_OK) {
    return status;
  }
  batch->id = sqlite3_last_insert_rowid(db);
  return sql_each(db, error, take_name, batch,
                  "UPDATE cluster_batch SET name = (SELECT name FROM cluster_identity) || "
                  "'-' || id || '-' || lower(hex(randomblob(4))) WHERE id = ? RETURNING name",
                  "i", batch->id);
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
  struct rows rows = {.size = sizeof **list, .take = take_batch};
  enum status status = store_each(
      store, error, take_row, &rows,
      "SELECT id, name, cluster_job, partition, created_ms, (SELECT count(*) FROM cluster_task "
      "WHERE batch_id = cluster_batch.id) FROM cluster_batch WHERE ended_ms IS NULL ORDER BY id",
      "");
  status = rows_end(&rows, status, count);
  *list = rows.list;
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
  struct rows rows = {.size = sizeof **list, .take = take_attempt};
  enum status status =
      store_each(store, error, take_row, &rows,
                 "SELECT job_id, number, task, place, job.timeout_s, job.memory_bytes, job.state "
                 "FROM attempt JOIN job ON job.id = job_id AND job.attempt = number "
                 "WHERE batch_id = ? AND outcome = '' ORDER BY task, place",
                 "i", id);
  status = rows_end(&rows, status, count);
  *list = rows.list;
  return status;
}

/* A text column into CLUSTER_WORD_SIZE characters. */
static enum status take_word(sqlite3_stmt *row, void *word, struct error *error) {
  (void)error;
  snprintf(word, CLUSTER_WORD_SIZE, "%s", sql_text(row, 0));
  return STATUS_OK;
}

enum status store_job_partition(struct store *store, int64_t id, char partition[CLUSTER_WORD_SIZE],
                                struct error *error) {
  partition[0] = '\0';
  return store_each(store, error, take_word, partition,
                    "SELECT value FROM job JOIN job_label ON job_label.name = 'partition' AND "
                    "job_label.job_id IN (job.id, job.study_id) WHERE job.id = ? "
                    "ORDER BY job_label.job_id DESC LIMIT 1",
                    "i", id);
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
