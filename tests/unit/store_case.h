/* The fixture of the tests of the store: a database in a folder of its own, and short forms. To be
 * included by the one source file of a test program. */
#ifndef PNEULAB_TESTS_STORE_CASE_H
#define PNEULAB_TESTS_STORE_CASE_H

#include <check.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "schema/embedded.h"
#include "server/base/file.h"
#include "server/store/store.h"

static char directory[64];
static struct store *store;

static const char document[] = "{\"kind\":\"response\",\"name\":\"n\",\"labels\":{\"paper\":\"m\"},"
                               "\"actuator\":{\"height\":\"15.6 mm\",\"count\":3,\"on\":true,"
                               "\"a/b~c\":\"text\"}}";

static inline void store_setup(void) {
  struct error error;
  strcpy(directory, "/tmp/pneulab-store-XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(directory));
  ck_assert_msg(store_open(directory, &store, &error) == STATUS_OK, "%s", error.message);
}

static inline void store_teardown(void) {
  store_close(store);
  file_remove_tree(directory);
}

static inline void store_reopen(void) {
  struct error error;
  store_close(store);
  ck_assert_msg(store_open(directory, &store, &error) == STATUS_OK, "%s", error.message);
}

static inline int64_t submit_text(const char *text, const char *key, enum status expected,
                                  bool *replayed) {
  struct error error;
  int64_t id = 0;
  json_t *root = json_loads(text, 0, NULL);
  ck_assert_ptr_nonnull(root);
  struct submission submission = {
      .document = text, .root = root, .spec_hash = "00", .idempotency_key = key};
  ck_assert_int_eq(store_submit(store, &submission, &id, replayed, &error), expected);
  json_decref(root);
  return id;
}

static inline int64_t submit(void) {
  bool replayed;
  return submit_text(document, NULL, STATUS_OK, &replayed);
}

static inline struct claim claim_next(void) {
  struct claim claim;
  struct error error;
  bool claimed;
  ck_assert_int_eq(store_claim(store, &claim, &claimed, &error), STATUS_OK);
  ck_assert(claimed);
  free(claim.document);
  claim.document = NULL;
  return claim;
}

static inline bool claim_none(void) {
  struct claim claim;
  struct error error;
  bool claimed;
  ck_assert_int_eq(store_claim(store, &claim, &claimed, &error), STATUS_OK);
  free(claim.document);
  return !claimed;
}

static inline enum job_state state_of(int64_t id) {
  struct job_record record;
  struct error error;
  ck_assert_int_eq(store_job(store, id, &record, &error), STATUS_OK);
  enum job_state state = record.state;
  job_record_clear(&record);
  return state;
}

static inline enum status finish(const struct claim *claim, enum attempt_end end,
                                 enum job_state *state) {
  static const char text[] = "{\"status\":\"succeeded\",\"metrics\":{\"angle_deg\":1.5},"
                             "\"samples\":[{\"p_kPa\":1},{\"p_kPa\":2}]}";
  struct error error;
  json_t *result = json_loads(text, 0, NULL);
  json_t *artifacts = json_pack("{s:i}", "surface.json", 12);
  struct attempt_outcome outcome = {.job_id = claim->job_id,
                                    .attempt = claim->attempt,
                                    .end = end,
                                    .reason_code = "why",
                                    .message = "",
                                    .exit_code = 0,
                                    .directory = "attempts/x"};
  if (end == ATTEMPT_SUCCEEDED) {
    outcome.result_text = text;
    outcome.result = result;
    outcome.artifacts = artifacts;
  }
  enum status status = store_attempt_finish(store, &outcome, state, &error);
  json_decref(result);
  json_decref(artifacts);
  return status;
}

static inline struct claim run_next(void) {
  struct error error;
  struct claim claim = claim_next();
  ck_assert_int_eq(store_attempt_running(store, claim.job_id, claim.attempt, 1, &error), STATUS_OK);
  return claim;
}

/* A number from the database as any other program sees it. */
static inline double sql_number(const char *sql) {
  char path[100];
  sqlite3 *db;
  sqlite3_stmt *statement;
  snprintf(path, sizeof path, "%s/pneulab.db", directory);
  ck_assert_int_eq(sqlite3_open(path, &db), SQLITE_OK);
  ck_assert_msg(sqlite3_prepare_v2(db, sql, -1, &statement, NULL) == SQLITE_OK, "%s",
                sqlite3_errmsg(db));
  ck_assert_int_eq(sqlite3_step(statement), SQLITE_ROW);
  double value = sqlite3_column_double(statement, 0);
  sqlite3_finalize(statement);
  sqlite3_close(db);
  return value;
}

static inline bool sql_allowed(const char *sql) {
  char path[100];
  sqlite3 *db;
  snprintf(path, sizeof path, "%s/pneulab.db", directory);
  ck_assert_int_eq(sqlite3_open(path, &db), SQLITE_OK);
  bool allowed = sqlite3_exec(db, sql, NULL, NULL, NULL) == SQLITE_OK;
  sqlite3_close(db);
  return allowed;
}

/* Replaces the store by a database as a program wrote it that knew the migrations up to `version`,
 * with rows added by `sql`. It is closed: store_reopen brings it up to date. */
static inline void store_make_old(int version, const char *sql) {
  char text[100];
  sqlite3 *db;
  store_close(store);
  store = NULL;
  file_remove_tree(directory);
  ck_assert_int_eq(mkdir(directory, 0700), 0);
  snprintf(text, sizeof text, "%s/pneulab.db", directory);
  ck_assert_int_eq(sqlite3_open(text, &db), SQLITE_OK);
  for (size_t i = 0; i < embedded_file_count; i++) {
    int number = (int)strtol(embedded_files[i].name, NULL, 10);
    if (number >= 1 && number <= version) {
      ck_assert_int_eq(sqlite3_exec(db, (const char *)embedded_files[i].data, NULL, NULL, NULL),
                       SQLITE_OK);
    }
  }
  snprintf(text, sizeof text, "PRAGMA user_version = %d", version);
  ck_assert_int_eq(sqlite3_exec(db, text, NULL, NULL, NULL), SQLITE_OK);
  ck_assert_msg(sqlite3_exec(db, sql, NULL, NULL, NULL) == SQLITE_OK, "%s", sqlite3_errmsg(db));
  sqlite3_close(db);
}

#endif
