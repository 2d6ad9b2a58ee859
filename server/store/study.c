#include "server/store/study.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/store/connection.h"
#include "server/store/flatten.h"
#include "server/store/sql.h"
#include "server/store/study_row.h"

/* A transaction that stores members ends after this time: other writers wait for it. */
enum { ADD_MS = 40 };

static enum status no_memory(struct error *error) {
  return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a study.");
}

enum status store_studies_live(struct store *store, struct study_job **list, size_t *count,
                               struct error *error) {
  sqlite3_stmt *statement = NULL;
  int row = 0;
  *count = 0;
  *list = calloc(STUDIES_LIVE_MAX, sizeof **list);
  sqlite3 *db = *list ? store_read_begin(store, error) : NULL;
  enum status status = *list ? db ? STATUS_OK : STATUS_IO : no_memory(error);
  if (db) {
    status = sql_prepare(db, &statement, error,
                         "SELECT id, attempt, state, priority, coalesce(stored, 0) FROM job "
                         "LEFT JOIN study ON study.study_id = job.id WHERE kind = 'study' "
                         "AND state IN ('held', 'starting', 'running', 'cancelling') "
                         "ORDER BY id LIMIT ?",
                         "i", (int64_t)STUDIES_LIVE_MAX);
  }
  while (status == STATUS_OK && (status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    struct study_job *job = &(*list)[*count];
    *job = (struct study_job){.id = sqlite3_column_int64(statement, 0),
                              .attempt = sqlite3_column_int64(statement, 1),
                              .priority = sqlite3_column_int(statement, 3),
                              .stored = sqlite3_column_int(statement, 4) != 0};
    *count += job_state_parse(sql_text(statement, 2), &job->state);
  }
  sql_done(statement);
  if (db) {
    store_read_end(store, db);
  }
  if (status != STATUS_OK) {
    free(*list);
    *list = NULL;
    *count = 0;
  }
  return status;
}

/* ---- taking a study ----------------------------------------------------------------------- */

void study_claim_clear(struct study_claim *claim) {
  free(claim->document);
  free(claim->submitter);
  *claim = (struct study_claim){0};
}

/* Reads the next study into *claim; its id stays 0 when none may start. */
static enum status claim_find(sqlite3 *db, int most, struct study_claim *claim,
                              struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status = sql_prepare(
      db, &statement, error,
      "SELECT id, attempt + 1, document, submitter, priority, memory_bytes, "
      "(SELECT coalesce(sum(finished_ms - created_ms), 0) / 1000.0 FROM attempt "
      "WHERE job_id = job.id) FROM job WHERE kind = 'study' AND state = 'queued' AND ? > "
      "(SELECT count(*) FROM job AS other WHERE other.kind = 'study' AND other.state = 'running' "
      "AND other.submitter = job.submitter AND other.priority >= job.priority) "
      "ORDER BY priority DESC, id LIMIT 1",
      "i", (int64_t)most);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && row) {
    *claim = (struct study_claim){.id = sqlite3_column_int64(statement, 0),
                                  .attempt = sqlite3_column_int64(statement, 1),
                                  .document = sql_text_copy(statement, 2),
                                  .submitter = sql_text_copy(statement, 3),
                                  .priority = sqlite3_column_int(statement, 4),
                                  .memory_bytes = (uint64_t)sqlite3_column_int64(statement, 5),
                                  .elapsed_s = sqlite3_column_double(statement, 6)};
    status = claim->document && claim->submitter ? STATUS_OK : no_memory(error);
  }
  sql_done(statement);
  return status;
}

/* No job runs that has not been starting. */
static enum status claim_take(struct store *store, const struct study_claim *claim,
                              struct error *error) {
  sqlite3 *db = store->writer;
  int64_t now = clock_unix_ms();
  enum status status = sql_run(db, error,
                               "UPDATE job SET state = 'starting', attempt = ?, started_ms = ?, "
                               "reason_code = '', message = '' WHERE id = ?",
                               "iii", claim->attempt, now, claim->id);
  if (status == STATUS_OK) {
    status = sql_run(db, error, "INSERT INTO attempt (job_id, number, created_ms) VALUES (?, ?, ?)",
                     "iii", claim->id, claim->attempt, now);
  }
  if (status == STATUS_OK) {
    status = sql_run(db, error, "UPDATE job SET state = 'running' WHERE id = ?", "i", claim->id);
  }
  if (status == STATUS_OK && claim->attempt == 1) {
    status = flatten_store(db, claim->id, store->units, error);
  }
  return status;
}

enum status store_study_claim(struct store *store, int most, struct study_claim *claim,
                              bool *claimed, struct error *error) {
  *claim = (struct study_claim){0};
  enum status status = store_write_begin(store, error);
  if (status == STATUS_OK) {
    status = claim_find(store->writer, most, claim, error);
    if (status == STATUS_OK && claim->id != 0) {
      status = claim_take(store, claim, error);
    }
    status = store_write_end(store, status, error);
  }
  *claimed = status == STATUS_OK && claim->id != 0;
  if (!*claimed) {
    study_claim_clear(claim);
  }
  return status;
}

/* ---- members ------------------------------------------------------------------------------ */

/* The fence: whether the study runs under this attempt. */
static enum status attempt_check(sqlite3 *db, int64_t id, int64_t attempt, struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status = sql_prepare(
      db, &statement, error,
      "SELECT 1 FROM job WHERE id = ? AND attempt = ? AND kind = 'study' AND state = 'running'",
      "ii", id, attempt);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  sql_done(statement);
  return status == STATUS_OK && !row ? error_set(error, STATUS_CONFLICT, NULL,
                                                 "Study %lld does not run under attempt %lld.",
                                                 (long long)id, (long long)attempt)
                                     : status;
}

/* Opens a transaction of the study's current attempt; on failure nothing is open. */
static enum status study_write_begin(struct store *store, int64_t id, int64_t attempt,
                                     struct error *error) {
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = attempt_check(store->writer, id, attempt, error);
  return status == STATUS_OK ? status : store_write_end(store, status, error);
}

enum status store_study_begin(struct store *store, int64_t id, int64_t attempt,
                              const char *sampling, size_t members, bool light,
                              const struct study_parameter_row *parameters, size_t count,
                              struct error *error) {
  enum status status = study_write_begin(store, id, attempt, error);
  if (status != STATUS_OK) {
    return status;
  }
  sqlite3 *db = store->writer;
  status = sql_run(db, error,
                   "INSERT INTO study (study_id, sampling, members, light) VALUES (?, ?, ?, ?) "
                   "ON CONFLICT DO NOTHING",
                   "itii", id, sampling, (int64_t)members, (int64_t)light);
  for (size_t i = 0; i < count && status == STATUS_OK; i++) {
    const struct study_parameter_row *p = &parameters[i];
    status = sql_run(db, error,
                     "INSERT INTO study_parameter (study_id, position, pointer, name, unit, "
                     "categorical, logarithmic, low, high) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?) "
                     "ON CONFLICT DO NOTHING",
                     "iitttiidd", id, (int64_t)i, p->pointer, p->name, p->unit,
                     (int64_t)p->categorical, (int64_t)p->logarithmic, p->low, p->high);
  }
  return store_write_end(store, status, error);
}

static enum status member_exists(sqlite3 *db, const struct submission *submission, bool *exists,
                                 struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status =
      sql_prepare(db, &statement, error, "SELECT 1 FROM job WHERE study_id = ? AND member = ?",
                  "ii", submission->study_id, submission->member);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  sql_done(statement);
  *exists = row;
  return status;
}

static enum status member_insert(struct store *store, const struct study_member_row *member,
                                 size_t parameters, struct error *error) {
  const struct submission *submission = &member->submission;
  int64_t job_id;
  bool replayed, exists = false;
  enum status status = member_exists(store->writer, submission, &exists, error);
  if (status != STATUS_OK || exists) {
    return status;
  }
  status = submission_write(store, submission, &job_id, &replayed, error);
  for (size_t k = 0; k < parameters && status == STATUS_OK; k++) {
    if (member->value[k].text) {
      status = sql_run(store->writer, error,
                       "INSERT INTO study_value (study_id, member, position, number, text) "
                       "VALUES (?, ?, ?, ?, ?) ON CONFLICT DO NOTHING",
                       "iiidt", submission->study_id, submission->member, (int64_t)k,
                       member->value[k].number, member->value[k].text);
    }
  }
  return status;
}

enum status store_study_add(struct store *store, int64_t id, int64_t attempt,
                            const struct study_member_row *members, size_t count, size_t parameters,
                            size_t *stored, struct error *error) {
  int64_t until = clock_monotonic_ms() + ADD_MS;
  size_t done = 0;
  *stored = 0;
  enum status status = study_write_begin(store, id, attempt, error);
  if (status != STATUS_OK) {
    return status;
  }
  do {
    status = member_insert(store, &members[done], parameters, error);
    done += status == STATUS_OK;
  } while (status == STATUS_OK && done < count &&
           (members[done].submission.chain_position > 0 || clock_monotonic_ms() < until));
  status = store_write_end(store, status, error);
  *stored = status == STATUS_OK ? done : 0;
  return status;
}

enum status store_study_stored(struct store *store, int64_t id, int64_t attempt, size_t members,
                               struct error *error) {
  enum status status = study_write_begin(store, id, attempt, error);
  if (status != STATUS_OK) {
    return status;
  }
  status =
      sql_run(store->writer, error, "UPDATE study SET stored = 1, members = ? WHERE study_id = ?",
              "ii", (int64_t)members, id);
  return store_write_end(store, status, error);
}

/* ---- the whole ---------------------------------------------------------------------------- */

enum status store_study_follow(struct store *store, int64_t id, enum study_order order, int most,
                               int *changed, struct error *error) {
  static const char *const texts[] = {
      [STUDY_HOLD] = "UPDATE job SET state = 'held' WHERE id IN (SELECT id FROM job "
                     "WHERE study_id = ?1 AND state = 'queued' LIMIT ?2)",
      [STUDY_RELEASE] = "UPDATE job SET state = 'queued' WHERE id IN (SELECT id FROM job "
                        "WHERE study_id = ?1 AND state = 'held' LIMIT ?2)",
      [STUDY_CANCEL] = "UPDATE job SET state = 'cancelled', reason_code = 'study_ended', "
                       "message = 'Its study ended before it started.', finished_ms = ?3 "
                       "WHERE id IN (SELECT id FROM job WHERE study_id = ?1 "
                       "AND state IN ('queued', 'held', 'retry_wait') LIMIT ?2)",
      [STUDY_PRIORITY] = "UPDATE job SET priority = (SELECT priority FROM job WHERE id = ?1) "
                         "WHERE id IN (SELECT id FROM job WHERE study_id = ?1 "
                         "AND state IN ('queued', 'held', 'retry_wait') "
                         "AND priority <> (SELECT priority FROM job WHERE id = ?1) LIMIT ?2)"};
  *changed = 0;
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  int withdrawn = 0;
  if (order == STUDY_HOLD || order == STUDY_PRIORITY) {
    status = cluster_withdraw(store->writer, id,
                              order == STUDY_HOLD ? WITHDRAW_STUDY : WITHDRAW_PRIORITY, most,
                              &withdrawn, error);
  }
  if (status != STATUS_OK) {
    return store_write_end(store, status, error);
  }
  if (order == STUDY_CANCEL) {
    status = sql_run(store->writer, error, texts[order], "iii", id, (int64_t)most, clock_unix_ms());
  } else {
    status = sql_run(store->writer, error, texts[order], "ii", id, (int64_t)most);
  }
  int count = status == STATUS_OK ? sqlite3_changes(store->writer) : 0;
  status = store_write_end(store, status, error);
  *changed = status == STATUS_OK ? count : 0;
  return status;
}

enum status store_study_cancelled(struct store *store, int64_t id, struct error *error) {
  int64_t now = clock_unix_ms();
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  sqlite3 *db = store->writer;
  status =
      sql_run(db, error,
              "UPDATE job SET state = 'cancelled', reason_code = 'cancel_requested', "
              "message = 'Cancelled on request.', finished_ms = ? WHERE id = ? AND kind = 'study' "
              "AND state = 'cancelling' AND NOT EXISTS (SELECT 1 FROM job AS member "
              "JOIN job_state ON job_state.state = member.state "
              "WHERE member.study_id = job.id AND job_state.terminal = 0)",
              "ii", now, id);
  if (status == STATUS_OK && sqlite3_changes(db) == 0) {
    status =
        error_set(error, STATUS_CONFLICT, NULL, "Study %lld still has members.", (long long)id);
  }
  if (status == STATUS_OK) {
    status = sql_run(db, error,
                     "UPDATE attempt SET outcome = 'cancelled', reason_code = 'cancel_requested', "
                     "message = 'Cancelled on request.', finished_ms = ? "
                     "WHERE job_id = ? AND outcome = ''",
                     "ii", now, id);
  }
  return store_write_end(store, status, error);
}

/* The study whose members go next, 0 for none. */
static enum status deleted_find(sqlite3 *db, int64_t *id, struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status =
      sql_prepare(db, &statement, error, "SELECT study_id FROM study_deleted LIMIT 1", "");
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  *id = status == STATUS_OK && row ? sqlite3_column_int64(statement, 0) : 0;
  sql_done(statement);
  return status;
}

/* Lists members of a deleted study; without any it is forgotten, with its view. */
static enum status deleted_members(sqlite3 *db, int64_t id, struct job_files *files, size_t room,
                                   size_t *count, struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status =
      sql_prepare(db, &statement, error, "SELECT id, attempt FROM job WHERE study_id = ? LIMIT ?",
                  "ii", id, (int64_t)room);
  while (status == STATUS_OK && (status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    files[(*count)++] = (struct job_files){.job_id = sqlite3_column_int64(statement, 0),
                                           .attempts = sqlite3_column_int64(statement, 1)};
  }
  sql_done(statement);
  if (status == STATUS_OK && *count == 0) {
    status = study_view_drop(db, id, error);
  }
  return status == STATUS_OK && *count == 0
             ? sql_run(db, error, "DELETE FROM study_deleted WHERE study_id = ?", "i", id)
             : status;
}

enum status store_study_delete(struct store *store, struct job_files *files, size_t room,
                               size_t *count, struct error *error) {
  int64_t id = 0;
  *count = 0;
  sqlite3 *reader = store_read_begin(store, error);
  if (!reader) {
    return STATUS_IO;
  }
  enum status status = deleted_find(reader, &id, error);
  store_read_end(store, reader);
  if (status != STATUS_OK || id == 0) {
    return status;
  }
  status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = deleted_members(store->writer, id, files, room, count, error);
  for (size_t i = 0; i < *count && status == STATUS_OK; i++) {
    status = job_rows_delete(store->writer, files[i].job_id, error);
  }
  return store_write_end(store, status, error);
}
