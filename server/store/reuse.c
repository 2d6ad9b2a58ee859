#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/store/connection.h"
#include "server/store/flatten.h"
#include "server/store/sql.h"
#include "solver/job/json.h"

/* A succeeded job with its result, and for whom. */
struct answer {
  int64_t job_id, solved_by; /* the second is where the result came from at first */
  int64_t asker, attempt;    /* the job that is answered, and the number of its attempt */
  char *directory;
  json_t *names; /* of its artifacts */
};

static void answer_clear(struct answer *answer) {
  free(answer->directory);
  json_decref(answer->names);
  *answer = (struct answer){0};
}

/* The newest job equal to job `id` that this version of the solver has solved; answer->job_id is 0
 * when there is none. */
static enum status answer_find(sqlite3 *db, int64_t id, struct answer *answer,
                               struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status =
      sql_prepare(db, &statement, error,
                  "SELECT job.id, coalesce(job.reused_from, job.id), result.directory, "
                  "(SELECT json_group_array(name) FROM artifact WHERE artifact.job_id = job.id), "
                  "asker.attempt + 1 FROM job AS asker JOIN job ON job.spec_hash = asker.spec_hash "
                  "JOIN result ON result.job_id = job.id "
                  "WHERE asker.id = ? AND job.state = 'succeeded' AND job.solver_version = ? "
                  "AND job.files_removed_ms IS NULL "
                  "ORDER BY job.id DESC LIMIT 1",
                  "it", id, PNEULAB_VERSION);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && row) {
    const char *names = sql_text(statement, 3);
    *answer = (struct answer){.job_id = sqlite3_column_int64(statement, 0),
                              .solved_by = sqlite3_column_int64(statement, 1),
                              .asker = id,
                              .attempt = sqlite3_column_int64(statement, 4),
                              .directory = sql_text_copy(statement, 2),
                              .names = json_read(names, strlen(names), 0, NULL)};
    if (!answer->directory || !answer->names) {
      status = error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a result.");
    }
  }
  sql_done(statement);
  return status;
}

/* Copies the rows of the result; the job gets an attempt without a worker to hang them on. */
static enum status answer_copy(struct store *store, const struct answer *answer,
                               const char *directory, struct error *error) {
  static const char *const copies[] = {
      "INSERT INTO metric SELECT ?2, name, value FROM metric WHERE job_id = ?1",
      "INSERT INTO sample SELECT ?2, step, name, value FROM sample WHERE job_id = ?1",
      "INSERT INTO artifact SELECT ?2, name, size FROM artifact WHERE job_id = ?1"};
  int64_t id = answer->asker, now = clock_unix_ms();
  sqlite3 *db = store->writer;
  enum status status =
      sql_run(db, error,
              "INSERT INTO attempt (job_id, number, outcome, message, created_ms, finished_ms) "
              "VALUES (?, ?, 'reused', 'Answered with the result of an equal job.', ?, ?)",
              "iiii", id, answer->attempt, now, now);
  if (status == STATUS_OK) {
    status = sql_run(db, error,
                     "INSERT INTO result (job_id, attempt, document, directory, created_ms) "
                     "SELECT ?, ?, document, ?, ? FROM result WHERE job_id = ?",
                     "iitii", id, answer->attempt, directory, now, answer->job_id);
  }
  for (size_t i = 0; i < sizeof copies / sizeof *copies && status == STATUS_OK; i++) {
    status = sql_run(db, error, copies[i], "ii", answer->job_id, id);
  }
  if (status == STATUS_OK) {
    status = sql_run(db, error,
                     "UPDATE job SET state = 'succeeded', reason_code = '', message = (SELECT "
                     "message FROM job WHERE id = ?), attempt = ?, started_ms = ?, "
                     "finished_ms = ?, reused_from = ?, solver_version = ? WHERE id = ?",
                     "iiiiiti", answer->job_id, answer->attempt, now, now, answer->solved_by,
                     PNEULAB_VERSION, id);
  }
  if (status == STATUS_OK) {
    status = flatten_store(db, id, store->units, error);
  }
  return status;
}

/* Makes the job wait for an equal one that runs or is about to run again; *waits tells whether
 * there is one. */
static enum status wait_for_equal(sqlite3 *db, int64_t id, bool *waits, struct error *error) {
  enum status status =
      sql_run(db, error,
              "UPDATE job SET waits_for = equal.id FROM (SELECT id FROM job WHERE spec_hash = "
              "(SELECT spec_hash FROM job WHERE id = ?1) AND state IN ('starting', 'running', "
              "'retry_wait') LIMIT 1) AS equal WHERE job.id = ?1",
              "i", id);
  *waits = status == STATUS_OK && sqlite3_changes(db) > 0;
  return status;
}

enum status reuse_try(struct store *store, int64_t id, enum reuse *reuse, struct error *error) {
  struct answer answer = {0};
  char directory[STORE_DIRECTORY_SIZE];
  bool answered = false, waits = false;
  *reuse = REUSE_NONE;
  if (!store->share) {
    return STATUS_OK;
  }
  enum status status = answer_find(store->writer, id, &answer, error);
  if (status == STATUS_OK && answer.job_id != 0) {
    answered = store->share(store->share_context, answer.directory, answer.names, id,
                            answer.attempt, directory, NULL) == STATUS_OK;
  }
  if (answered) {
    status = answer_copy(store, &answer, directory, error);
    *reuse = REUSE_ANSWERED;
  } else if (status == STATUS_OK) {
    status = wait_for_equal(store->writer, id, &waits, error);
    *reuse = waits ? REUSE_WAITS : REUSE_NONE;
  }
  answer_clear(&answer);
  return status;
}
