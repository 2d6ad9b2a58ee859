/* Reading what a study's members have come to, and the view of a study. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/store/connection.h"
#include "server/store/sql.h"
#include "server/store/study.h"
#include "server/store/study_row.h"

static enum status no_memory(struct error *error) {
  return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a study.");
}

static void member_read(sqlite3_stmt *row, struct study_member_job *member) {
  *member = (struct study_member_job){.member = sqlite3_column_int(row, 0),
                                      .job_id = sqlite3_column_int64(row, 1),
                                      .state = JOB_STATE_QUEUED,
                                      .reused = sqlite3_column_int(row, 5) != 0};
  job_state_parse(sql_text(row, 2), &member->state);
  snprintf(member->reason, sizeof member->reason, "%s", sql_text(row, 3));
  snprintf(member->message, sizeof member->message, "%s", sql_text(row, 4));
}

enum status store_study_members(struct store *store, int64_t id, struct study_member_job **list,
                                size_t *count, struct error *error) {
  sqlite3_stmt *statement = NULL;
  size_t room = 0;
  int row = 0;
  *list = NULL;
  *count = 0;
  sqlite3 *db = store_read_begin(store, error);
  if (!db) {
    return STATUS_IO;
  }
  enum status status = sql_prepare(db, &statement, error,
                                   "SELECT member, id, state, reason_code, message, "
                                   "reused_from IS NOT NULL FROM job WHERE study_id = ? "
                                   "ORDER BY member",
                                   "i", id);
  while (status == STATUS_OK && (status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    if (*count == room) {
      room = 2 * room + 64;
      struct study_member_job *grown = realloc(*list, room * sizeof *grown);
      if (!grown) {
        status = no_memory(error);
        break;
      }
      *list = grown;
    }
    member_read(statement, &(*list)[(*count)++]);
  }
  sql_done(statement);
  store_read_end(store, db);
  if (status != STATUS_OK) {
    free(*list);
    *list = NULL;
    *count = 0;
  }
  return status;
}

enum status store_study_counts(struct store *store, int64_t id, int64_t counts[JOB_STATE_COUNT],
                               struct error *error) {
  sqlite3_stmt *statement = NULL;
  enum job_state state;
  int row = 0;
  memset(counts, 0, JOB_STATE_COUNT * sizeof *counts);
  sqlite3 *db = store_read_begin(store, error);
  if (!db) {
    return STATUS_IO;
  }
  enum status status =
      sql_prepare(db, &statement, error,
                  "SELECT state, count(*) FROM job WHERE study_id = ? GROUP BY state", "i", id);
  while (status == STATUS_OK && (status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    if (job_state_parse(sql_text(statement, 0), &state)) {
      counts[state] = sqlite3_column_int64(statement, 1);
    }
  }
  sql_done(statement);
  store_read_end(store, db);
  return status;
}

enum status store_study_cpu(struct store *store, int64_t id, double *cpu_s, struct error *error) {
  sqlite3_stmt *statement = NULL;
  int row = 0;
  *cpu_s = 0;
  sqlite3 *db = store_read_begin(store, error);
  if (!db) {
    return STATUS_IO;
  }
  enum status status =
      sql_prepare(db, &statement, error,
                  "SELECT total(cpu_s) FROM job CROSS JOIN attempt ON attempt.job_id = job.id "
                  "WHERE job.study_id = ?",
                  "i", id);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && row) {
    *cpu_s = sqlite3_column_double(statement, 0);
  }
  sql_done(statement);
  store_read_end(store, db);
  return status;
}

enum status store_study_running(struct store *store, int64_t id, int64_t *ids, size_t room,
                                size_t *count, struct error *error) {
  sqlite3_stmt *statement = NULL;
  int row = 0;
  *count = 0;
  sqlite3 *db = store_read_begin(store, error);
  if (!db) {
    return STATUS_IO;
  }
  enum status status = sql_prepare(db, &statement, error,
                                   "SELECT id FROM job WHERE study_id = ? "
                                   "AND state IN ('starting', 'running', 'cancelling') LIMIT ?",
                                   "ii", id, (int64_t)room);
  while (status == STATUS_OK && (status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    ids[(*count)++] = sqlite3_column_int64(statement, 0);
  }
  sql_done(statement);
  store_read_end(store, db);
  return status;
}

enum status store_study_stamp(struct store *store, int64_t id, struct study_stamp *stamp,
                              struct error *error) {
  sqlite3_stmt *statement = NULL;
  int row = 0;
  sqlite3 *db = store_read_begin(store, error);
  if (!db) {
    return STATUS_IO;
  }
  enum status status = sql_prepare(db, &statement, error,
                                   "SELECT finished_ms IS NOT NULL, coalesce(finished_ms, 0), "
                                   "(SELECT count(*) FROM job WHERE study_id = ?1) FROM job "
                                   "WHERE id = ?1 AND kind = 'study'",
                                   "i", id);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && row) {
    *stamp = (struct study_stamp){.terminal = sqlite3_column_int(statement, 0) != 0,
                                  .finished_ms = sqlite3_column_int64(statement, 1),
                                  .members = sqlite3_column_int64(statement, 2)};
  } else if (status == STATUS_OK) {
    status = error_set(error, STATUS_NOT_FOUND, NULL, "There is no study %lld.", (long long)id);
  }
  sql_done(statement);
  store_read_end(store, db);
  return status;
}

/* ---- one job and its study ---------------------------------------------------------------- */

enum status study_live(int64_t id, enum job_state state, struct error *error) {
  return error_set(error, STATUS_CONFLICT, NULL,
                   "Study %lld is %s; it and its members can be deleted once it has ended. Cancel "
                   "it first.",
                   (long long)id, job_state_word(state));
}

enum status study_of(sqlite3 *db, int64_t id, bool *study, int64_t *study_id,
                     enum job_state *study_state, struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  *study_state = JOB_STATE_SUCCEEDED;
  enum status status =
      sql_prepare(db, &statement, error,
                  "SELECT job.kind = 'study', coalesce(job.study_id, 0), study.state FROM job "
                  "LEFT JOIN job AS study ON study.id = job.study_id WHERE job.id = ?",
                  "i", id);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && !row) {
    status = store_no_job(id, error);
  } else if (status == STATUS_OK) {
    *study = sqlite3_column_int(statement, 0) != 0;
    *study_id = sqlite3_column_int64(statement, 1);
    job_state_parse(sql_text(statement, 2), study_state);
  }
  sql_done(statement);
  return status;
}

enum status study_has_live(sqlite3 *db, int64_t id, bool *live, struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status = sql_prepare(db, &statement, error,
                                   "SELECT 1 FROM job JOIN job_state USING (state) "
                                   "WHERE study_id = ? AND terminal = 0 LIMIT 1",
                                   "i", id);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  sql_done(statement);
  *live = row;
  return status;
}
