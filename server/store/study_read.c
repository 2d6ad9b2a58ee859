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

/* A list of members that grows. */
struct members {
  struct study_member_job *list;
  size_t count, room;
};

static enum status take_member(sqlite3_stmt *row, void *context, struct error *error) {
  struct members *members = context;
  if (members->count == members->room) {
    size_t room = 2 * members->room + 64;
    struct study_member_job *grown = realloc(members->list, room * sizeof *grown);
    if (!grown) {
      return no_memory(error);
    }
    members->list = grown;
    members->room = room;
  }
  struct study_member_job *member = &members->list[members->count++];
  *member = (struct study_member_job){.member = sqlite3_column_int(row, 0),
                                      .job_id = sqlite3_column_int64(row, 1),
                                      .state = JOB_STATE_QUEUED,
                                      .reused = sqlite3_column_int(row, 5) != 0};
  job_state_parse(sql_text(row, 2), &member->state);
  snprintf(member->reason, sizeof member->reason, "%s", sql_text(row, 3));
  snprintf(member->message, sizeof member->message, "%s", sql_text(row, 4));
  return STATUS_OK;
}

enum status store_study_members(struct store *store, int64_t id, struct study_member_job **list,
                                size_t *count, struct error *error) {
  struct members members = {0};
  enum status status = store_each(store, error, take_member, &members,
                                  "SELECT member, id, state, reason_code, message, "
                                  "reused_from IS NOT NULL FROM job WHERE study_id = ? "
                                  "ORDER BY member",
                                  "i", id);
  if (status != STATUS_OK) {
    free(members.list);
    members = (struct members){0};
  }
  *list = members.list;
  *count = members.count;
  return status;
}

enum status store_study_counts(struct store *store, int64_t id, int64_t counts[JOB_STATE_COUNT],
                               struct error *error) {
  memset(counts, 0, JOB_STATE_COUNT * sizeof *counts);
  return store_each(store, error, store_take_count, counts,
                    "SELECT state, count(*) FROM job WHERE study_id = ? GROUP BY state", "i", id);
}

enum status store_study_cpu(struct store *store, int64_t id, double *cpu_s, struct error *error) {
  *cpu_s = 0;
  return store_each(store, error, sql_take_number, cpu_s,
                    "SELECT total(cpu_s) FROM job CROSS JOIN attempt ON attempt.job_id = job.id "
                    "WHERE job.study_id = ?",
                    "i", id);
}

struct ids {
  int64_t *list;
  size_t *count;
};

static enum status take_id(sqlite3_stmt *row, void *context, struct error *error) {
  struct ids *ids = context;
  (void)error;
  ids->list[(*ids->count)++] = sqlite3_column_int64(row, 0);
  return STATUS_OK;
}

enum status store_study_running(struct store *store, int64_t id, int64_t *ids, size_t room,
                                size_t *count, struct error *error) {
  struct ids list = {ids, count};
  *count = 0;
  return store_each(store, error, take_id, &list,
                    "SELECT id FROM job WHERE study_id = ? "
                    "AND state IN ('starting', 'running', 'cancelling') LIMIT ?",
                    "ii", id, (int64_t)room);
}

struct stamp_row {
  struct study_stamp *stamp;
  bool found;
};

static enum status take_stamp(sqlite3_stmt *row, void *context, struct error *error) {
  struct stamp_row *into = context;
  (void)error;
  *into->stamp = (struct study_stamp){.terminal = sqlite3_column_int(row, 0) != 0,
                                      .finished_ms = sqlite3_column_int64(row, 1),
                                      .members = sqlite3_column_int64(row, 2)};
  into->found = true;
  return STATUS_OK;
}

enum status store_study_stamp(struct store *store, int64_t id, struct study_stamp *stamp,
                              struct error *error) {
  struct stamp_row into = {.stamp = stamp};
  enum status status = store_each(store, error, take_stamp, &into,
                                  "SELECT finished_ms IS NOT NULL, coalesce(finished_ms, 0), "
                                  "(SELECT count(*) FROM job WHERE study_id = ?1) FROM job "
                                  "WHERE id = ?1 AND kind = 'study'",
                                  "i", id);
  return status == STATUS_OK && !into.found
             ? error_set(error, STATUS_NOT_FOUND, NULL, "There is no study %lld.", (long long)id)
             : status;
}

/* ---- one job and its study ---------------------------------------------------------------- */

enum status study_live(int64_t id, enum job_state state, struct error *error) {
  return error_set(error, STATUS_CONFLICT, NULL,
                   "Study %lld is %s; it and its members can be deleted once it has ended. Cancel "
                   "it first.",
                   (long long)id, job_state_word(state));
}

struct job_study {
  bool found, study;
  int64_t study_id;
  enum job_state state;
};

static enum status take_job_study(sqlite3_stmt *row, void *context, struct error *error) {
  struct job_study *job = context;
  (void)error;
  job->found = true;
  job->study = sqlite3_column_int(row, 0) != 0;
  job->study_id = sqlite3_column_int64(row, 1);
  job_state_parse(sql_text(row, 2), &job->state);
  return STATUS_OK;
}

enum status study_of(sqlite3 *db, int64_t id, bool *study, int64_t *study_id,
                     enum job_state *study_state, struct error *error) {
  struct job_study job = {.state = JOB_STATE_SUCCEEDED};
  enum status status =
      sql_each(db, error, take_job_study, &job,
               "SELECT job.kind = 'study', coalesce(job.study_id, 0), study.state FROM job "
               "LEFT JOIN job AS study ON study.id = job.study_id WHERE job.id = ?",
               "i", id);
  *study_state = job.state;
  if (status == STATUS_OK && !job.found) {
    status = store_no_job(id, error);
  } else if (status == STATUS_OK) {
    *study = job.study;
    *study_id = job.study_id;
  }
  return status;
}

enum status study_has_live(sqlite3 *db, int64_t id, bool *live, struct error *error) {
  int64_t found = 0;
  enum status status = sql_each(db, error, sql_take_integer, &found,
                                "SELECT 1 FROM job JOIN job_state USING (state) "
                                "WHERE study_id = ? AND terminal = 0 LIMIT 1",
                                "i", id);
  *live = found != 0;
  return status;
}
