/* The queue of the store: who is next, and databases of the time before it. */
#include "tests/unit/store_case.h"

/* A database of version 2 with jobs in every stage keeps them all, and the queue goes on. */
START_TEST(version_two_is_migrated_with_its_jobs) {
  store_make_old(
      2, "INSERT INTO job (state, kind, name, document, spec_hash, attempt, created_ms, started_ms,"
         " finished_ms) VALUES"
         " ('succeeded', 'response', 'done', '{}', 'aa', 1, 1000, 1100, 1200),"
         " ('failed', 'snap', 'bad', '{}', 'bb', 1, 1900, 1100, NULL),"
         " ('queued', 'response', 'waits', '{}', 'cc', 0, 1500, NULL, NULL),"
         " ('running', 'response', 'open', '{}', 'dd', 1, 2500, 2600, NULL),"
         " ('queued', 'hlpv', 'waits too', '{}', 'ee', 0, 3000, NULL, NULL);"
         "INSERT INTO job_label VALUES (1, 'user', 'ann'), (3, 'user', 'bob'), (3, 'paper', 'm');"
         "INSERT INTO attempt (job_id, number, outcome, created_ms) VALUES"
         " (1, 1, 'succeeded', 1100), (2, 1, 'failed', 1100), (4, 1, '', 2600);"
         "INSERT INTO result VALUES"
         " (1, 1, '{\"provenance\":{\"version\":\"0.0.9\"}}', 'attempts/1-1', 1200);"
         "INSERT INTO metric VALUES (1, 'angle_deg', 64);");
  store_reopen();
  ck_assert_double_eq(sql_number("SELECT count(*) FROM job"), 5);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM job WHERE id = 1 AND submitter = 'ann' "
                                 "AND solver_version = '0.0.9' AND priority = 0"),
                      1);
  ck_assert_double_eq(sql_number("SELECT value FROM metric"), 64);
  ck_assert_double_eq(sql_number("SELECT created_ms FROM job WHERE id = 3"), 1900);
  ck_assert_double_eq(sql_number("SELECT finished_ms FROM job WHERE id = 2"), 1100);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM job_label WHERE job_id = 3 AND "
                                 "state = 'queued' AND kind = 'response' AND job_name = 'waits'"),
                      2);
  ck_assert_double_eq(sql_number("SELECT jobs FROM job_count WHERE state = 'queued'"), 2);
  struct error error;
  int64_t count;
  ck_assert_int_eq(store_recover(store, &count, &error), STATUS_OK);
  ck_assert_int_eq(count, 1);
  ck_assert_double_eq(sql_number("SELECT sum(running) FROM submitter"), 0);
  ck_assert_double_eq(sql_number("SELECT sum(ready) FROM submitter_queue"), 3);
  ck_assert_int_eq(claim_next().job_id, 3);
  ck_assert_int_eq(claim_next().job_id, 4);
  ck_assert_int_eq(claim_next().job_id, 5);
  ck_assert(claim_none());
}
END_TEST

int main(void) {
  Suite *suite = suite_create("store_queue");
  TCase *tests = tcase_create("store_queue");
  tcase_add_checked_fixture(tests, store_setup, store_teardown);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, version_two_is_migrated_with_its_jobs);
  suite_add_tcase(suite, tests);
  SRunner *runner = srunner_create(suite);
  srunner_run_all(runner, CK_NORMAL);
  int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
