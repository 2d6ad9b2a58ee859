#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/store/connection.h"
#include "server/store/sql.h"

/* Whether this is the job's latest attempt and it has not ended: the fence against writers that
 * come too late. Fills the job's state and the failures counted so far. */
static enum status attempt_check(sqlite3 *db, int64_t job_id, int64_t attempt,
                                 enum job_state *state, int64_t *failures, struct error *error) {
  sqlite3_stmt *statement;
  enum status status =
      sql_prepare(db, &statement, error,
                  "SELECT job.state, job.failures FROM job JOIN attempt ON attempt.job_id = job.id "
                  "AND attempt.number = job.attempt WHERE job.id = ? AND job.attempt = ? "
                  "AND attempt.outcome = '' AND job.state IN ('starting', 'running', 'cancelling')",
                  "ii", job_id, attempt);
  if (status != STATUS_OK) {
    return status;
  }
  int row = 0;
  status = sql_step(statement, &row, error);
  if (status == STATUS_OK && (!row || !job_state_parse(sql_text(statement, 0), state))) {
    status = error_set(error, STATUS_CONFLICT, NULL,
                       "Attempt %lld of job %lld is no longer the current one.", (long long)attempt,
                       (long long)job_id);
  } else if (status == STATUS_OK) {
    *failures = sqlite3_column_int64(statement, 1);
  }
  sql_done(statement);
  return status;
}

enum status store_attempt_running(struct store *store, int64_t job_id, int64_t attempt, int64_t pid,
                                  struct error *error) {
  enum job_state state = JOB_STATE_QUEUED;
  int64_t failures = 0;
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = attempt_check(store->writer, job_id, attempt, &state, &failures, error);
  if (status == STATUS_OK && state != JOB_STATE_STARTING) {
    status = error_set(error, STATUS_CONFLICT, NULL, "Job %lld is %s.", (long long)job_id,
                       job_state_word(state));
  }
  if (status == STATUS_OK) {
    status = sql_run(store->writer, error,
                     "UPDATE attempt SET pid = nullif(?, 0) WHERE job_id = ? AND number = ?", "iii",
                     pid, job_id, attempt);
  }
  if (status == STATUS_OK) {
    status =
        sql_run(store->writer, error, "UPDATE job SET state = 'running' WHERE id = ?", "i", job_id);
  }
  return store_write_end(store, status, error);
}

static enum status result_numbers(sqlite3 *db, int64_t job_id, const json_t *result,
                                  struct error *error) {
  const char *name;
  json_t *value;
  enum status status = STATUS_OK;
  json_object_foreach(json_object_get(result, "metrics"), name, value) {
    if (status == STATUS_OK && json_is_number(value)) {
      status = sql_run(db, error, "INSERT INTO metric VALUES (?, ?, ?)", "itd", job_id, name,
                       json_number_value(value));
    }
  }
  const json_t *samples = json_object_get(result, "samples");
  for (size_t step = 0; step < json_array_size(samples); step++) {
    json_object_foreach(json_array_get(samples, step), name, value) {
      if (status == STATUS_OK && json_is_number(value)) {
        status = sql_run(db, error, "INSERT INTO sample VALUES (?, ?, ?, ?)", "iitd", job_id,
                         (int64_t)step, name, json_number_value(value));
      }
    }
  }
  return status;
}

static enum status result_insert(sqlite3 *db, const struct attempt_outcome *outcome, int64_t now,
                                 struct error *error) {
  enum status status = sql_run(
      db, error,
      "INSERT INTO result (job_id, attempt, document, directory, created_ms) VALUES (?,?,?,?,?)",
      "iitti", outcome->job_id, outcome->attempt, outcome->result_text, outcome->directory, now);
  if (status == STATUS_OK) {
    status = result_numbers(db, outcome->job_id, outcome->result, error);
  }
  const char *name;
  json_t *size;
  json_object_foreach((json_t *)outcome->artifacts, name, size) {
    if (status == STATUS_OK) {
      status = sql_run(db, error, "INSERT INTO artifact VALUES (?, ?, ?)", "iti", outcome->job_id,
                       name, (int64_t)json_integer_value(size));
    }
  }
  return status;
}

/* The end as it counts for the job: a job being cancelled is cancelled however its worker ended,
 * and a worker lost once too often is a failure. */
static enum job_state end_state(enum attempt_end end, enum job_state before, int64_t failures) {
  if (before == JOB_STATE_CANCELLING) {
    return JOB_STATE_CANCELLED;
  }
  switch (end) {
  case ATTEMPT_SUCCEEDED:
    return JOB_STATE_SUCCEEDED;
  case ATTEMPT_TIMED_OUT:
    return JOB_STATE_TIMED_OUT;
  case ATTEMPT_REQUEUED:
    return JOB_STATE_QUEUED;
  case ATTEMPT_WORKER_LOST:
    return failures >= STORE_FAILURES_MAX ? JOB_STATE_FAILED : JOB_STATE_RETRY_WAIT;
  case ATTEMPT_CANCELLED: /* asked for by nobody that the database knows */
  case ATTEMPT_FAILED:
    break;
  }
  return JOB_STATE_FAILED;
}

static const char *end_word(enum attempt_end end, enum job_state after) {
  static const char *const words[] = {
      [ATTEMPT_SUCCEEDED] = "succeeded",     [ATTEMPT_FAILED] = "failed",
      [ATTEMPT_TIMED_OUT] = "timed_out",     [ATTEMPT_CANCELLED] = "cancelled",
      [ATTEMPT_WORKER_LOST] = "worker_lost", [ATTEMPT_REQUEUED] = "requeued"};
  return after == JOB_STATE_CANCELLED ? "cancelled" : words[end];
}

static enum status attempt_close(sqlite3 *db, const struct attempt_outcome *outcome,
                                 enum job_state state, int64_t now, struct error *error) {
  bool cancelled = state == JOB_STATE_CANCELLED;
  return sql_run(db, error,
                 "UPDATE attempt SET outcome = ?, reason_code = ?, message = ?, "
                 "exit_code = iif(? < 0, NULL, ?), signal = nullif(?, 0), finished_ms = ?, "
                 "cpu_s = ?, peak_memory_MB = ? WHERE job_id = ? AND number = ?",
                 "tttiiiiddii", end_word(outcome->end, state),
                 cancelled ? "cancel_requested" : outcome->reason_code, outcome->message,
                 (int64_t)outcome->exit_code, (int64_t)outcome->exit_code, (int64_t)outcome->signal,
                 now, outcome->cpu_s, outcome->peak_memory_MB, outcome->job_id, outcome->attempt);
}

/* The version of the solver that made the result, "" without one. */
static const char *solver_version(const struct attempt_outcome *outcome) {
  const json_t *provenance = json_object_get(outcome->result, "provenance");
  const char *version = json_string_value(json_object_get(provenance, "version"));
  return outcome->result_text && version ? version : "";
}

static enum status attempt_apply(sqlite3 *db, const struct attempt_outcome *outcome,
                                 enum job_state before, int64_t failures, enum job_state *state,
                                 struct error *error) {
  int64_t now = clock_unix_ms();
  *state = end_state(outcome->end, before, failures);
  bool cancelled = *state == JOB_STATE_CANCELLED;
  bool lost = outcome->end == ATTEMPT_WORKER_LOST;
  enum status status = attempt_close(db, outcome, *state, now, error);
  if (status == STATUS_OK) {
    status = queue_charge(db, outcome->job_id, outcome->attempt, now, error);
  }
  if (status == STATUS_OK && outcome->result_text && job_state_terminal(*state) && !cancelled) {
    status = result_insert(db, outcome, now, error);
  }
  /* A starting job that succeeds has run: its worker was quicker than the note of its start. */
  if (status == STATUS_OK && before == JOB_STATE_STARTING && job_state_terminal(*state)) {
    status =
        sql_run(db, error, "UPDATE job SET state = 'running' WHERE id = ?", "i", outcome->job_id);
  }
  if (status == STATUS_OK) {
    int64_t delay = outcome->retry_delay_ms << failures;
    status = sql_run(
        db, error,
        "UPDATE job SET state = ?, reason_code = ?, message = ?, "
        "failures = failures + ?, not_before_ms = ?, retry_due = 0, "
        "finished_ms = nullif(?, 0), solver_version = ? WHERE id = ?",
        "tttiiiti", job_state_word(*state), cancelled ? "cancel_requested" : outcome->reason_code,
        cancelled ? "Cancelled on request." : outcome->message, (int64_t)lost, now + delay,
        job_state_terminal(*state) ? now : (int64_t)0, solver_version(outcome), outcome->job_id);
  }
  return status;
}

enum status store_attempt_finish(struct store *store, const struct attempt_outcome *outcome,
                                 enum job_state *state, struct error *error) {
  return store_attempts_finish(store, &outcome, 1, state, error);
}

enum status store_attempts_finish(struct store *store,
                                  const struct attempt_outcome *const *outcomes, size_t count,
                                  enum job_state *states, struct error *error) {
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  for (size_t i = 0; i < count && status == STATUS_OK; i++) {
    const struct attempt_outcome *outcome = outcomes[i];
    enum job_state before = JOB_STATE_QUEUED;
    int64_t failures = 0;
    status =
        attempt_check(store->writer, outcome->job_id, outcome->attempt, &before, &failures, error);
    if (status == STATUS_OK) {
      status = attempt_apply(store->writer, outcome, before, failures, &states[i], error);
    }
  }
  return store_write_end(store, status, error);
}

/* Of jobs: no attempt is open. */
#define CLOSED                                                                                     \
  "AND NOT EXISTS (SELECT 1 FROM attempt WHERE attempt.job_id = job.id AND attempt.outcome = '')"

enum status store_recover(struct store *store, bool cluster, int64_t *count, struct error *error) {
  int64_t now = clock_unix_ms();
  *count = 0;
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  sqlite3 *db = store->writer;
  status = sql_run(db, error,
                   "UPDATE attempt SET outcome = 'lost', reason_code = 'daemon_stopped', "
                   "message = 'The daemon stopped while the worker ran.', finished_ms = ? "
                   "WHERE outcome = '' AND (batch_id IS NULL OR NOT ?)",
                   "ii", now, (int64_t)cluster);
  if (status == STATUS_OK) {
    status = sql_run(db, error,
                     "UPDATE job SET state = 'cancelled', message = 'Cancelled on request.', "
                     "finished_ms = ? WHERE state = 'cancelling' AND kind <> 'study' " CLOSED,
                     "i", now);
    *count += sqlite3_changes(db);
  }
  if (status == STATUS_OK) {
    status = sql_run(db, error,
                     "UPDATE job SET state = 'failed', reason_code = 'too_many_attempts', "
                     "message = 'Every attempt was lost.', finished_ms = ? "
                     "WHERE state IN ('starting', 'running') AND kind <> 'study' AND (SELECT "
                     "count(*) FROM attempt "
                     "WHERE job_id = job.id AND outcome = 'lost') >= ? " CLOSED,
                     "ii", now, (int64_t)STORE_ATTEMPTS_MAX);
    *count += sqlite3_changes(db);
  }
  if (status == STATUS_OK) {
    status = sql_run(db, error,
                     "UPDATE job SET state = 'queued', reason_code = 'daemon_stopped', "
                     "message = 'The daemon stopped while the job ran; it will run again.' "
                     "WHERE state IN ('starting', 'running') " CLOSED,
                     "");
    *count += sqlite3_changes(db);
  }
  return store_write_end(store, status, error);
}
