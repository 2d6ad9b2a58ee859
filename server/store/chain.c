#include <stdlib.h>

#include "server/store/connection.h"
#include "server/store/sql.h"

enum { FOLLOWERS_MAX = 63 }; /* behind the first; solver/explore/chain.h makes no longer chains */

void claim_clear(struct claim *claim) {
  struct claim *next = claim->next;
  while (next) {
    struct claim *behind = next->next;
    free(next->document);
    free(next);
    next = behind;
  }
  free(claim->document);
  *claim = (struct claim){0};
}

/* A place in a chain. */
struct chain_at {
  int64_t study_id, chain, position;
};

/* Where the claimed job stands, and who was before it; at->study_id is 0 for one of no chain. */
static enum status chain_find(sqlite3 *db, struct claim *claim, struct chain_at *at,
                              struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status =
      sql_prepare(db, &statement, error,
                  "SELECT job.study_id, job.chain, job.chain_position, before.id, before.attempt "
                  "FROM job LEFT JOIN job AS before ON before.study_id = job.study_id "
                  "AND before.chain = job.chain AND before.chain_position = job.chain_position - 1 "
                  "AND before.state = 'succeeded' AND before.reused_from IS NULL "
                  "WHERE job.id = ? AND job.chain IS NOT NULL",
                  "i", claim->job_id);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && row) {
    *at = (struct chain_at){sqlite3_column_int64(statement, 0), sqlite3_column_int64(statement, 1),
                            sqlite3_column_int64(statement, 2)};
    claim->before_id = sqlite3_column_int64(statement, 3);
    claim->before_attempt = sqlite3_column_int64(statement, 4);
  }
  sql_done(statement);
  return status;
}

/* Reads the next job of the chain into *claim, and moves on to its place; job_id is 0 when it may
 * not start now or is to have another limit of memory. */
static enum status chain_next(sqlite3 *db, struct chain_at *at, uint64_t memory_bytes,
                              struct claim *claim, bool *reuse, struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status = sql_prepare(
      db, &statement, error,
      "SELECT id, attempt + 1, timeout_s, memory_bytes, document, reuse AND state = 'queued', "
      "chain_position, ready FROM job WHERE study_id = ? AND chain = ? AND chain_position > ? "
      "ORDER BY chain_position LIMIT 1",
      "iii", at->study_id, at->chain, at->position);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  *claim = (struct claim){0};
  if (status == STATUS_OK && row && sqlite3_column_int(statement, 7) &&
      (uint64_t)sqlite3_column_int64(statement, 3) == memory_bytes) {
    *claim = (struct claim){.job_id = sqlite3_column_int64(statement, 0),
                            .attempt = sqlite3_column_int64(statement, 1),
                            .timeout_s = sqlite3_column_double(statement, 2),
                            .memory_bytes = memory_bytes,
                            .document = sql_text_copy(statement, 4)};
    *reuse = sqlite3_column_int(statement, 5) != 0;
    at->position = sqlite3_column_int64(statement, 6);
    if (!claim->document) {
      status = error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a job document.");
    }
  }
  sql_done(statement);
  return status;
}

/* Takes one more job, or notes that it was answered; *more: whether there may be others behind. */
static enum status chain_step(struct store *store, struct chain_at *at, uint64_t memory_bytes,
                              struct claim *last, int64_t now, bool *more, struct error *error) {
  struct claim *claim = calloc(1, sizeof *claim);
  enum reuse reuse = REUSE_NONE;
  bool wanted = false;
  *more = false;
  if (!claim) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a chain of jobs.");
  }
  last->next = claim;
  enum status status = chain_next(store->writer, at, memory_bytes, claim, &wanted, error);
  if (status == STATUS_OK && claim->job_id != 0 && wanted) {
    status = reuse_try(store, claim->job_id, &reuse, error);
  }
  if (status == STATUS_OK && claim->job_id != 0 && reuse == REUSE_NONE) {
    *more = true;
    return queue_take(store, claim, now, error);
  }
  int64_t answered = status == STATUS_OK && reuse == REUSE_ANSWERED ? claim->job_id : 0;
  *more = answered != 0;
  free(claim->document);
  *claim = (struct claim){.answered_id = answered};
  return status;
}

enum status chain_claim(struct store *store, struct claim *claim, int64_t now,
                        struct error *error) {
  struct chain_at at = {0};
  enum status status = chain_find(store->writer, claim, &at, error);
  bool more = at.study_id != 0;
  struct claim *last = claim;
  for (int i = 0; i < FOLLOWERS_MAX && more && status == STATUS_OK; i++) {
    status = chain_step(store, &at, claim->memory_bytes, last, now, &more, error);
    last = last->next ? last->next : last;
  }
  return status;
}
