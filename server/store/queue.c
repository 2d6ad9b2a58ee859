#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/store/connection.h"
#include "server/store/flatten.h"
#include "server/store/sql.h"

/* See the table submitter in schema/0003-queue.sql. */
#define HALF_LIFE_MS 600000.0
#define CHARGE_NEW (-3.3219)

enum { SET_ASIDE_MAX = 100, FORGET_MAX = 8, SECONDS_LEAST_MS = 1 };

/* log2(2^a + 2^b) */
static double log2_sum(double a, double b) {
  double high = fmax(a, b), low = fmin(a, b);
  return high + log2(1 + exp2(low - high));
}

enum status queue_charge(sqlite3 *db, int64_t job_id, int64_t attempt, int64_t now,
                         struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status =
      sql_prepare(db, &statement, error,
                  "SELECT submitter.name, submitter.charge, attempt.created_ms FROM job "
                  "JOIN submitter ON submitter.name = job.submitter "
                  "JOIN attempt ON attempt.job_id = job.id AND attempt.number = ? WHERE job.id = ? "
                  "AND job.kind <> 'study'",
                  "ii", attempt, job_id);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && row) {
    int64_t ms = now - sqlite3_column_int64(statement, 2);
    double seconds = (double)(ms > SECONDS_LEAST_MS ? ms : SECONDS_LEAST_MS) / 1000;
    double charge =
        log2_sum(sqlite3_column_double(statement, 1), log2(seconds) + (double)now / HALF_LIFE_MS);
    status = sql_run(db, error, "UPDATE submitter SET charge = ? WHERE name = ?", "dt", charge,
                     sql_text(statement, 0));
  }
  sql_done(statement);
  if (status == STATUS_OK) {
    status = sql_run(db, error,
                     "DELETE FROM submitter WHERE name IN (SELECT name FROM submitter "
                     "WHERE ready = 0 AND running = 0 AND charge < ? ORDER BY charge LIMIT ?)",
                     "di", (double)now / HALF_LIFE_MS + CHARGE_NEW, (int64_t)FORGET_MAX);
  }
  return status;
}

enum store_engine engine_of_label(const char *value) {
  if (value && strcmp(value, "local") == 0) {
    return ENGINE_LOCAL;
  }
  return value && strcmp(value, "slurm") == 0 ? ENGINE_SLURM : ENGINE_NONE;
}

/* The first of the jobs of an engine, by the index of the queue. */
#define NEXT_OF(ENGINE)                                                                            \
  "SELECT * FROM (SELECT priority, running, charge, job_id FROM submitter_queue WHERE engine "     \
  "= " ENGINE " ORDER BY priority DESC, running, charge, job_id LIMIT 1)"

/* Reads the next job into *claim; job_id is 0 when none may start. */
static enum status claim_find(sqlite3 *db, struct store_taste taste, struct claim *claim,
                              bool *reuse, struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  bool all = taste.engine == ENGINE_NONE;
  enum status status = sql_prepare(
      db, &statement, error,
      "SELECT id, attempt + 1, timeout_s, memory_bytes, document, reuse AND state = 'queued' "
      "FROM job WHERE id = (SELECT job_id FROM (" NEXT_OF("?1") " UNION ALL " NEXT_OF(
          "?2") " UNION ALL " NEXT_OF("?3") ") ORDER BY priority DESC, running, charge, job_id "
                                            "LIMIT 1)",
      "iii", (int64_t)(all ? ENGINE_LOCAL : taste.engine),
      (int64_t)(all || taste.others ? ENGINE_NONE : -1), (int64_t)(all ? ENGINE_SLURM : -1));
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && row) {
    *claim = (struct claim){.job_id = sqlite3_column_int64(statement, 0),
                            .attempt = sqlite3_column_int64(statement, 1),
                            .timeout_s = sqlite3_column_double(statement, 2),
                            .memory_bytes = (uint64_t)sqlite3_column_int64(statement, 3),
                            .document = sql_text_copy(statement, 4)};
    *reuse = sqlite3_column_int(statement, 5) != 0;
    if (!claim->document) {
      status = error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a job document.");
    }
  }
  sql_done(statement);
  return status;
}

/* Finds the next job that is to run: on the way those equal to a running one are set aside. One
 * that could be answered ends the search. */
static enum status claim_next(struct store *store, struct store_taste taste, struct claim *claim,
                              struct error *error) {
  for (int i = 0; i < SET_ASIDE_MAX; i++) {
    bool wanted = false;
    enum reuse reuse = REUSE_NONE;
    enum status status = claim_find(store->writer, taste, claim, &wanted, error);
    if (status == STATUS_OK && wanted) {
      status = reuse_try(store, claim->job_id, &reuse, error);
    }
    if (status != STATUS_OK || reuse == REUSE_NONE) {
      return status;
    }
    free(claim->document);
    *claim = (struct claim){.answered_id = reuse == REUSE_ANSWERED ? claim->job_id : 0};
    if (reuse == REUSE_ANSWERED) {
      break;
    }
  }
  return STATUS_OK;
}

enum status queue_take(struct store *store, const struct claim *claim, int64_t now,
                       struct error *error) {
  sqlite3 *db = store->writer;
  enum status status = sql_run(db, error,
                               "UPDATE job SET state = 'starting', attempt = ?, started_ms = ?, "
                               "retry_due = 0, reason_code = '', message = '' WHERE id = ?",
                               "iii", claim->attempt, now, claim->job_id);
  if (status == STATUS_OK) {
    status = sql_run(db, error, "INSERT INTO attempt (job_id, number, created_ms) VALUES (?, ?, ?)",
                     "iii", claim->job_id, claim->attempt, now);
  }
  if (status == STATUS_OK && claim->attempt == 1) {
    status = flatten_store(db, claim->job_id, store->units, error);
  }
  return status;
}

enum status store_claim(struct store *store, struct claim *claim, bool *claimed,
                        struct error *error) {
  return store_claim_for(store, (struct store_taste){ENGINE_NONE, true}, claim, claimed, error);
}

enum status store_claim_for(struct store *store, struct store_taste taste, struct claim *claim,
                            bool *claimed, struct error *error) {
  int64_t now = clock_unix_ms();
  *claim = (struct claim){0};
  *claimed = false;
  enum status status = store_write_begin(store, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = sql_run(store->writer, error,
                   "UPDATE job INDEXED BY job_retry SET retry_due = 1 "
                   "WHERE state = 'retry_wait' AND retry_due = 0 AND not_before_ms <= ?",
                   "i", now);
  if (status == STATUS_OK) {
    status = claim_next(store, taste, claim, error);
  }
  if (status == STATUS_OK && claim->job_id != 0) {
    status = queue_take(store, claim, now, error);
  }
  if (status == STATUS_OK && claim->job_id != 0) {
    status = chain_claim(store, claim, now, error);
  }
  status = store_write_end(store, status, error);
  *claimed = status == STATUS_OK && claim->job_id != 0;
  if (!*claimed) {
    int64_t answered = status == STATUS_OK ? claim->answered_id : 0;
    claim_clear(claim);
    claim->answered_id = answered;
  }
  return status;
}

enum status store_ready(struct store *store, int64_t *count, struct error *error) {
  *count = 0;
  return store_each(store, error, sql_take_integer, count,
                    "SELECT coalesce(sum(ready), 0) FROM submitter_queue", "");
}
