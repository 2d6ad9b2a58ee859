/* The results database: durability rules, the state machine, the fence, lists. */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/store_case.h"
#include "tests/unit/suite.h"

START_TEST(job_survives_reopening) {
  int64_t id = submit();
  store_reopen();
  char *text;
  struct error error;
  ck_assert_int_eq(store_document(store, id, &text, &error), STATUS_OK);
  ck_assert_str_eq(text, document);
  free(text);
  ck_assert_int_eq(state_of(id), JOB_STATE_QUEUED);
}
END_TEST

/* Whoever asks for the parameters of a job before they are rows is answered from its document. */
START_TEST(parameters_are_the_same_before_and_after_the_start) {
  struct error error;
  json_t *before, *after;
  int64_t id = submit();
  ck_assert_int_eq(store_parameters(store, id, &before, &error), STATUS_OK);
  ck_assert_uint_gt(json_object_size(before), 3);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM design_parameter"), 0);
  claim_next();
  ck_assert_double_eq(sql_number("SELECT count(*) FROM design_parameter"),
                      (double)json_object_size(before));
  ck_assert_int_eq(store_parameters(store, id, &after, &error), STATUS_OK);
  ck_assert(json_equal(before, after));
  json_decref(before);
  json_decref(after);
}
END_TEST

START_TEST(a_job_cancelled_before_its_start_has_parameters) {
  struct error error;
  enum job_state state;
  int64_t id = submit();
  ck_assert_int_eq(store_cancel(store, id, &state, &error), STATUS_OK);
  ck_assert_double_eq(
      sql_number("SELECT value FROM design_parameter WHERE pointer = '/actuator/count'"), 3);
}
END_TEST

START_TEST(parameters_are_flattened_in_si) {
  submit();
  claim_next();
  ck_assert_double_eq_tol(
      sql_number("SELECT value FROM design_parameter WHERE pointer = '/actuator/height' "
                 "AND unit = 'm'"),
      0.0156, 1e-15);
  ck_assert_double_eq(
      sql_number("SELECT value FROM design_parameter WHERE pointer = '/actuator/count'"), 3);
  ck_assert_double_eq(
      sql_number("SELECT value FROM design_parameter WHERE pointer = '/actuator/on'"), 1);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM design_parameter "
                                 "WHERE pointer = '/actuator/a~1b~0c' AND text = 'text'"),
                      1);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM design_parameter WHERE pointer GLOB "
                                 "'/name*' OR pointer GLOB '/labels*'"),
                      0);
}
END_TEST

START_TEST(idempotency_key_names_one_job) {
  bool replayed;
  int64_t first = submit_text(document, "key", STATUS_OK, &replayed);
  ck_assert(!replayed);
  ck_assert_int_eq(submit_text(document, "key", STATUS_OK, &replayed), first);
  ck_assert(replayed);
  submit_text("{\"kind\":\"response\"}", "key", STATUS_CONFLICT, &replayed);
  ck_assert_int_ne(submit_text(document, "other", STATUS_OK, &replayed), first);
}
END_TEST

START_TEST(oldest_job_is_claimed_first_and_once) {
  int64_t first = submit(), second = submit();
  struct claim claim = claim_next();
  ck_assert_int_eq(claim.job_id, first);
  ck_assert_int_eq(claim.attempt, 1);
  ck_assert_int_eq(claim_next().job_id, second);
  ck_assert(claim_none());
}
END_TEST

START_TEST(result_arrives_with_the_state) {
  enum job_state state;
  struct job_record record;
  struct error error;
  submit();
  struct claim claim = run_next();
  ck_assert_int_eq(finish(&claim, ATTEMPT_SUCCEEDED, &state), STATUS_OK);
  ck_assert_int_eq(state, JOB_STATE_SUCCEEDED);
  ck_assert_int_eq(store_job(store, claim.job_id, &record, &error), STATUS_OK);
  ck_assert(record.has_result);
  ck_assert_double_eq(json_number_value(json_object_get(record.metrics, "angle_deg")), 1.5);
  ck_assert_str_eq(json_string_value(json_array_get(record.artifacts, 0)), "surface.json");
  job_record_clear(&record);
  ck_assert_double_eq(sql_number("SELECT sum(value) FROM sample"), 3);
  ck_assert_int_eq(store_artifact(store, claim.job_id, "surface.json", &error), STATUS_OK);
  ck_assert_int_eq(store_artifact(store, claim.job_id, "../pneulab.db", &error), STATUS_NOT_FOUND);
}
END_TEST

START_TEST(late_writer_is_fenced) {
  enum job_state state;
  int64_t count;
  struct error error;
  int64_t id = submit();
  struct claim lost = run_next();
  ck_assert_int_eq(store_recover(store, false, &count, &error), STATUS_OK); /* as after a crash */
  ck_assert_int_eq(count, 1);
  ck_assert_int_eq(finish(&lost, ATTEMPT_SUCCEEDED, &state), STATUS_CONFLICT);
  ck_assert_int_eq(state_of(id), JOB_STATE_QUEUED);
  struct claim again = run_next();
  ck_assert_int_eq(again.attempt, 2);
  ck_assert_int_eq(finish(&lost, ATTEMPT_SUCCEEDED, &state), STATUS_CONFLICT);
  ck_assert_int_eq(finish(&again, ATTEMPT_SUCCEEDED, &state), STATUS_OK);
  ck_assert_int_eq(finish(&again, ATTEMPT_SUCCEEDED, &state), STATUS_CONFLICT);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM result"), 1);
  ck_assert_double_eq(sql_number("SELECT attempt FROM result"), 2);
}
END_TEST

START_TEST(lost_workers_fail_the_job_in_the_end) {
  enum job_state state;
  submit();
  for (int i = 0; i < STORE_FAILURES_MAX; i++) {
    struct claim claim = run_next();
    ck_assert_int_eq(finish(&claim, ATTEMPT_WORKER_LOST, &state), STATUS_OK);
    ck_assert_int_eq(state, JOB_STATE_RETRY_WAIT);
  }
  struct claim claim = run_next();
  ck_assert_int_eq(finish(&claim, ATTEMPT_WORKER_LOST, &state), STATUS_OK);
  ck_assert_int_eq(state, JOB_STATE_FAILED);
  ck_assert(claim_none());
}
END_TEST

START_TEST(jobs_that_are_always_lost_fail) {
  struct error error;
  int64_t count, id = submit();
  for (int i = 0; i < STORE_ATTEMPTS_MAX; i++) {
    ck_assert_int_eq(state_of(id), JOB_STATE_QUEUED);
    run_next();
    ck_assert_int_eq(store_recover(store, false, &count, &error), STATUS_OK);
  }
  ck_assert_int_eq(state_of(id), JOB_STATE_FAILED);
}
END_TEST

START_TEST(requeued_jobs_do_not_count_as_failures) {
  enum job_state state;
  submit();
  for (int i = 0; i < STORE_FAILURES_MAX + 2; i++) {
    struct claim claim = run_next();
    ck_assert_int_eq(finish(&claim, ATTEMPT_REQUEUED, &state), STATUS_OK);
    ck_assert_int_eq(state, JOB_STATE_QUEUED);
  }
}
END_TEST

START_TEST(cancelling_wins) {
  enum job_state state;
  struct error error;
  int64_t waiting = submit();
  ck_assert_int_eq(store_cancel(store, waiting, &state, &error), STATUS_OK);
  ck_assert_int_eq(state, JOB_STATE_CANCELLED);
  ck_assert_int_eq(store_cancel(store, waiting, &state, &error), STATUS_CONFLICT);
  submit();
  struct claim claim = run_next();
  ck_assert_int_eq(store_cancel(store, claim.job_id, &state, &error), STATUS_OK);
  ck_assert_int_eq(state, JOB_STATE_CANCELLING);
  ck_assert_int_eq(finish(&claim, ATTEMPT_SUCCEEDED, &state), STATUS_OK);
  ck_assert_int_eq(state, JOB_STATE_CANCELLED);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM result"), 0);
  submit();
  claim = claim_next();
  ck_assert_int_eq(store_cancel(store, claim.job_id, &state, &error), STATUS_OK);
  ck_assert_int_eq(store_attempt_running(store, claim.job_id, claim.attempt, 1, &error),
                   STATUS_CONFLICT);
}
END_TEST

/* Whatever is not in the table of transitions is refused, whoever tries. */
START_TEST(illegal_transitions_are_refused) {
  static const char *const legal[][2] = {
      {"queued", "starting"},      {"queued", "held"},          {"queued", "cancelled"},
      {"held", "queued"},          {"held", "cancelled"},       {"starting", "running"},
      {"starting", "cancelling"},  {"starting", "queued"},      {"starting", "retry_wait"},
      {"starting", "failed"},      {"running", "succeeded"},    {"running", "failed"},
      {"running", "timed_out"},    {"running", "cancelling"},   {"running", "retry_wait"},
      {"running", "queued"},       {"cancelling", "cancelled"}, {"retry_wait", "starting"},
      {"retry_wait", "cancelled"}, {"queued", "succeeded"},
  };
  for (int from = 0; from < JOB_STATE_COUNT; from++) {
    for (int to = 0; to < JOB_STATE_COUNT; to++) {
      const char *from_word = job_state_word((enum job_state)from);
      const char *to_word = job_state_word((enum job_state)to);
      bool expected = from == to;
      for (size_t i = 0; i < sizeof legal / sizeof *legal; i++) {
        expected =
            expected || (strcmp(legal[i][0], from_word) == 0 && strcmp(legal[i][1], to_word) == 0);
      }
      char sql[300];
      snprintf(sql, sizeof sql,
               "BEGIN; INSERT INTO job (state, kind, name, document, spec_hash, "
               "created_ms) VALUES ('%s', 'k', '', '', '', 0); UPDATE job SET state = '%s' WHERE "
               "id = last_insert_rowid();",
               from_word, to_word);
      ck_assert_msg(sql_allowed(sql) == expected, "%s -> %s", from_word, to_word);
    }
  }
}
END_TEST

START_TEST(only_terminal_jobs_are_deleted) {
  enum job_state state;
  struct error error;
  int64_t id = submit();
  ck_assert_int_eq(store_delete(store, id, &error), STATUS_CONFLICT);
  ck_assert(!sql_allowed("DELETE FROM job"));
  struct claim claim = run_next();
  finish(&claim, ATTEMPT_SUCCEEDED, &state);
  ck_assert_int_eq(store_delete(store, id, &error), STATUS_OK);
  ck_assert_int_eq(store_delete(store, id, &error), STATUS_NOT_FOUND);
  ck_assert_double_eq(sql_number("SELECT (SELECT count(*) FROM result) + (SELECT count(*) FROM "
                                 "metric) + (SELECT count(*) FROM design_parameter)"),
                      0);
  ck_assert_int_gt(submit(), id); /* ids are not used again */
}
END_TEST

/* Opening an older database brings its views up to date and loses nothing. */
START_TEST(older_database_is_migrated) {
  store_make_old(1, "INSERT INTO job (state, kind, name, document, spec_hash, created_ms, "
                    "finished_ms) VALUES ('succeeded', 'response', 'n', '{}', '00', 1, 2)");
  store_reopen();
  ck_assert_double_eq(sql_number("SELECT count(*) FROM comparison WHERE twist_angle_deg IS NULL"),
                      1);
  ck_assert_double_gt(sql_number("PRAGMA user_version"), 1);
  ck_assert_int_eq(state_of(1), JOB_STATE_SUCCEEDED);
}
END_TEST

START_TEST(newer_database_is_refused) {
  struct error error;
  struct store *second = NULL;
  ck_assert(sql_allowed("PRAGMA user_version = 9999"));
  ck_assert_int_eq(store_open(directory, &second, &error), STATUS_CONFLICT);
  ck_assert_ptr_null(second);
}
END_TEST

START_TEST(pages_cover_every_job_once) {
  struct list_query query = {.sort = LIST_BY_CREATED, .limit = 4};
  struct job_record *records;
  struct error error;
  size_t count;
  int64_t seen = 0, pages = 0;
  char *next, *cursor = NULL;
  for (int i = 0; i < 10; i++) {
    submit();
  }
  do {
    query.cursor = cursor;
    ck_assert_int_eq(store_list(store, &query, &records, &count, &next, &error), STATUS_OK);
    for (size_t i = 0; i < count; i++) {
      ck_assert_int_eq(records[i].id, ++seen);
      job_record_clear(&records[i]);
    }
    free(records);
    free(cursor);
    cursor = next;
    pages++;
  } while (next);
  ck_assert_int_eq(seen, 10);
  ck_assert_int_eq(pages, 3);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("store");
  TCase *tests = tcase_create("store");
  tcase_add_checked_fixture(tests, store_setup, store_teardown);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, job_survives_reopening);
  tcase_add_test(tests, parameters_are_flattened_in_si);
  tcase_add_test(tests, parameters_are_the_same_before_and_after_the_start);
  tcase_add_test(tests, a_job_cancelled_before_its_start_has_parameters);
  tcase_add_test(tests, idempotency_key_names_one_job);
  tcase_add_test(tests, oldest_job_is_claimed_first_and_once);
  tcase_add_test(tests, result_arrives_with_the_state);
  tcase_add_test(tests, late_writer_is_fenced);
  tcase_add_test(tests, lost_workers_fail_the_job_in_the_end);
  tcase_add_test(tests, jobs_that_are_always_lost_fail);
  tcase_add_test(tests, requeued_jobs_do_not_count_as_failures);
  tcase_add_test(tests, cancelling_wins);
  tcase_add_test(tests, illegal_transitions_are_refused);
  tcase_add_test(tests, only_terminal_jobs_are_deleted);
  tcase_add_test(tests, older_database_is_migrated);
  tcase_add_test(tests, newer_database_is_refused);
  tcase_add_test(tests, pages_cover_every_job_once);
  suite_add_tcase(suite, tests);
  return suite_run(suite);
}
