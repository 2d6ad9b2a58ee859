#include <string.h>

#include "server/base/clock.h"
#include "server/store/connection.h"
#include "server/store/flatten.h"
#include "server/store/sql.h"
#include "server/store/study_row.h"

static const char *submission_text(const struct submission *submission, const char *key) {
  const char *text = json_string_value(json_object_get(submission->root, key));
  return text ? text : "";
}

static const char *submission_submitter(const struct submission *submission) {
  const json_t *labels = json_object_get(submission->root, "labels");
  const char *user = json_string_value(json_object_get(labels, "user"));
  return submission->submitter ? submission->submitter : user ? user : "";
}

/* Looks for an earlier job with the same idempotency key. *id is 0 when there is none. */
static enum status submission_find(sqlite3 *db, const struct submission *submission, int64_t *id,
                                   struct error *error) {
  sqlite3_stmt *statement;
  *id = 0;
  if (!submission->idempotency_key) {
    return STATUS_OK;
  }
  enum status status =
      sql_prepare(db, &statement, error, "SELECT id, document FROM job WHERE idempotency_key = ?",
                  "t", submission->idempotency_key);
  if (status != STATUS_OK) {
    return status;
  }
  int row = 0;
  status = sql_step(statement, &row, error);
  if (status == STATUS_OK && row) {
    *id = sqlite3_column_int64(statement, 0);
    if (strcmp(sql_text(statement, 1), submission->document) != 0) {
      status = error_set(error, STATUS_CONFLICT, NULL,
                         "This Idempotency-Key was used for job %lld with another document. Use a "
                         "new key for a new job.",
                         (long long)*id);
    }
  }
  sql_done(statement);
  return status;
}

static enum status submission_labels(sqlite3 *db, int64_t id, const json_t *labels,
                                     struct error *error) {
  const char *name;
  json_t *value;
  json_object_foreach((json_t *)labels, name, value) {
    const char *text = json_string_value(value);
    if (!text) {
      continue;
    }
    enum status status =
        sql_run(db, error,
                "INSERT INTO job_label (job_id, name, value, kind, state, finished_ms, job_name) "
                "SELECT id, ?, ?, kind, state, finished_ms, name FROM job WHERE id = ?",
                "tti", name, text, id);
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

/* The engine that the label "executor" asks for. */
static int64_t submission_engine(const struct submission *submission) {
  const json_t *labels = json_object_get(submission->root, "labels");
  return engine_of_label(json_string_value(json_object_get(labels, "executor")));
}

static enum status submission_insert(struct store *store, const struct submission *submission,
                                     int64_t *id, struct error *error) {
  sqlite3 *db = store->writer;
  int64_t member = submission->study_id != 0, chain = member && submission->chain >= 0;
  /* No job is younger than the one before, also when the clock is set back. */
  enum status status = sql_run(
      db, error,
      "INSERT INTO job (kind, name, document, spec_hash, timeout_s, retry_of, idempotency_key, "
      "created_ms, submitter, priority, memory_bytes, reuse, retry_reason, extends, study_id, "
      "member, chain, chain_position, engine) SELECT ?, ?, ?, ?, ?, nullif(?, 0), ?, "
      "max(?, coalesce((SELECT created_ms FROM job ORDER BY id DESC LIMIT 1), 0)), ?, ?, ?, ?, ?, "
      "nullif(?, 0), nullif(?, 0), iif(?, ?, NULL), iif(?, ?, NULL), iif(?, ?, NULL), "
      "coalesce(nullif(?, 0), (SELECT engine FROM job WHERE id = ?), 0)",
      "ttttdititiiitiiiiiiiiii", submission_text(submission, "kind"),
      submission_text(submission, "name"), submission->document, submission->spec_hash,
      submission->timeout_s, submission->retry_of, submission->idempotency_key, clock_unix_ms(),
      submission_submitter(submission), (int64_t)submission->priority,
      (int64_t)submission->memory_bytes, (int64_t)submission->reuse,
      submission->retry_reason ? submission->retry_reason : "", submission->extends,
      submission->study_id, member, submission->member, chain, submission->chain, chain,
      submission->chain_position, submission_engine(submission), submission->study_id);
  if (status != STATUS_OK) {
    return status;
  }
  *id = sqlite3_last_insert_rowid(db);
  status = submission_labels(db, *id, json_object_get(submission->root, "labels"), error);
  /* Of a study the members are answered. */
  if (status == STATUS_OK && submission->reuse &&
      strcmp(submission_text(submission, "kind"), "study") != 0) {
    enum reuse reuse;
    status = reuse_try(store, *id, &reuse, error);
  }
  return status;
}

enum status submission_write(struct store *store, const struct submission *submission, int64_t *id,
                             bool *replayed, struct error *error) {
  *replayed = false;
  enum status status = submission_find(store->writer, submission, id, error);
  if (status == STATUS_OK && *id != 0) {
    *replayed = true;
  } else if (status == STATUS_OK) {
    status = submission_insert(store, submission, id, error);
  }
  return status;
}

enum status job_rows_delete(sqlite3 *db, int64_t id, struct error *error) {
  enum status status = sql_run(db, error, "DELETE FROM result WHERE job_id = ?", "i", id);
  return status == STATUS_OK ? sql_run(db, error, "DELETE FROM job WHERE id = ?", "i", id) : status;
}

/* Whether the job may go: it has ended, and so has its study. */
static enum status delete_allowed(sqlite3 *db, int64_t id, struct error *error) {
  enum job_state state = JOB_STATE_QUEUED, study_state;
  int64_t study_id = 0;
  bool study = false;
  enum status status = store_state_of(db, id, &state, error);
  if (status == STATUS_OK && !job_state_terminal(state)) {
    status = error_set(error, STATUS_CONFLICT, NULL,
                       "Job %lld is %s; only a finished job can be deleted. Cancel it first.",
                       (long long)id, job_state_word(state));
  }
  if (status == STATUS_OK) {
    status = study_of(db, id, &study, &study_id, &study_state, error);
  }
  if (status == STATUS_OK && study_id != 0 && !job_state_terminal(study_state)) {
    status = study_live(study_id, study_state, error);
  }
  return status;
}

enum status store_delete(struct store *store, int64_t id, struct error *error) {
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = delete_allowed(store->writer, id, error);
  if (status == STATUS_OK) {
    status = job_rows_delete(store->writer, id, error);
  }
  return store_write_end(store, status, error);
}

/* Whether a job that waits has to be ended in steps: a study with members. */
static enum status ends_in_steps(sqlite3 *db, int64_t id, bool *steps, struct error *error) {
  enum job_state study_state;
  int64_t study_id;
  bool study = false;
  *steps = false;
  enum status status = study_of(db, id, &study, &study_id, &study_state, error);
  return status == STATUS_OK && study ? study_has_live(db, id, steps, error) : status;
}

enum status store_cancel(struct store *store, int64_t id, enum job_state *state,
                         struct error *error) {
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  bool steps = false;
  status = store_state_of(store->writer, id, state, error);
  if (status == STATUS_OK) {
    status = ends_in_steps(store->writer, id, &steps, error);
  }
  if (status != STATUS_OK) {
    return store_write_end(store, status, error);
  }
  if (job_state_terminal(*state)) {
    status =
        error_set(error, STATUS_CONFLICT, NULL, "Job %lld is already %s and cannot be cancelled.",
                  (long long)id, job_state_word(*state));
  } else if (*state == JOB_STATE_STARTING || *state == JOB_STATE_RUNNING ||
             (steps && *state != JOB_STATE_CANCELLING)) {
    *state = JOB_STATE_CANCELLING;
    status = sql_run(store->writer, error,
                     "UPDATE job SET state = 'cancelling', reason_code = 'cancel_requested' "
                     "WHERE id = ?",
                     "i", id);
  } else if (*state != JOB_STATE_CANCELLING) {
    *state = JOB_STATE_CANCELLED;
    status = sql_run(store->writer, error,
                     "UPDATE job SET state = 'cancelled', reason_code = 'cancel_requested', "
                     "message = 'Cancelled before it started.', finished_ms = ? WHERE id = ?",
                     "ii", clock_unix_ms(), id);
    if (status == STATUS_OK) {
      status = flatten_store(store->writer, id, store->units, error);
    }
  }
  return store_write_end(store, status, error);
}

/* Closes the attempt of a study that runs: it is held between two of them. */
static enum status study_pause(sqlite3 *db, int64_t id, struct error *error) {
  return sql_run(db, error,
                 "UPDATE attempt SET outcome = 'requeued', reason_code = 'held', "
                 "message = 'Held on request.', finished_ms = ? WHERE job_id = ? AND outcome = ''",
                 "ii", clock_unix_ms(), id);
}

/* Whether the job is in a state from which it can be held (released). */
static enum status hold_allowed(sqlite3 *db, int64_t id, bool hold, bool *runs,
                                struct error *error) {
  enum job_state state = JOB_STATE_QUEUED, study_state;
  int64_t study_id = 0;
  bool study = false;
  enum status status = store_state_of(db, id, &state, error);
  if (status == STATUS_OK) {
    status = study_of(db, id, &study, &study_id, &study_state, error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  *runs = study && hold && state == JOB_STATE_RUNNING;
  if (study_id != 0 && !job_state_terminal(study_state)) {
    return error_set(error, STATUS_CONFLICT, NULL,
                     "Job %lld is a member of study %lld, which is %s as a whole.", (long long)id,
                     (long long)study_id, hold ? "held" : "released");
  }
  return *runs || state == (hold ? JOB_STATE_QUEUED : JOB_STATE_HELD)
             ? STATUS_OK
             : error_set(error, STATUS_CONFLICT, NULL,
                         "Job %lld is %s; only a job that is %s can %s.", (long long)id,
                         job_state_word(state), hold ? "queued" : "held",
                         hold ? "be held" : "be released");
}

enum status store_hold(struct store *store, int64_t id, bool hold, struct error *error) {
  bool runs = false;
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  int withdrawn;
  status =
      hold ? cluster_withdraw(store->writer, id, WITHDRAW_JOB, 1, &withdrawn, error) : STATUS_OK;
  if (status == STATUS_OK) {
    status = hold_allowed(store->writer, id, hold, &runs, error); /* or all is undone */
  }
  if (status == STATUS_OK && runs) {
    status = study_pause(store->writer, id, error);
  }
  if (status == STATUS_OK) {
    status = sql_run(store->writer, error, "UPDATE job SET state = ? WHERE id = ?", "ti",
                     hold ? "held" : "queued", id);
  }
  return store_write_end(store, status, error);
}
