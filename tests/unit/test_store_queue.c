/* The queue of the store: who is next, and databases of the time before it. */
#include "tests/unit/store_case.h"
#include "tests/unit/suite.h"

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
  ck_assert_int_eq(store_recover(store, false, &count, &error), STATUS_OK);
  ck_assert_int_eq(count, 1);
  ck_assert_double_eq(sql_number("SELECT sum(running) FROM submitter"), 0);
  ck_assert_double_eq(sql_number("SELECT sum(ready) FROM submitter_queue"), 3);
  ck_assert_int_eq(claim_next().job_id, 3);
  ck_assert_int_eq(claim_next().job_id, 4);
  ck_assert_int_eq(claim_next().job_id, 5);
  ck_assert(claim_none());
}
END_TEST

/* ---- who is next ------------------------------------------------------------------------- */

/* Submits a job of a submitter with a hash of its own or a shared one. */
static int64_t submit_as(const char *submitter, int priority, const char *hash, bool reuse) {
  struct error error;
  bool replayed;
  int64_t id = 0;
  json_t *root = json_loads(document, 0, NULL);
  struct submission submission = {.document = document,
                                  .root = root,
                                  .spec_hash = hash,
                                  .submitter = submitter,
                                  .priority = priority,
                                  .reuse = reuse};
  ck_assert_msg(store_submit(store, &submission, &id, &replayed, &error) == STATUS_OK, "%s",
                error.message);
  json_decref(root);
  return id;
}

static void patch(int64_t id, const char *text, enum status expected) {
  struct error error;
  json_t *changes = json_loads(text, JSON_DECODE_ANY, NULL);
  ck_assert_int_eq(store_patch(store, id, changes, &error), expected);
  json_decref(changes);
}

START_TEST(the_highest_priority_goes_first) {
  int64_t low = submit_as("ann", -5, "a", false), middle = submit_as("ann", 0, "b", false);
  int64_t high = submit_as("ann", 7, "c", false), late = submit_as("ann", 7, "d", false);
  ck_assert_int_eq(claim_next().job_id, high);
  ck_assert_int_eq(claim_next().job_id, late);
  ck_assert_int_eq(claim_next().job_id, middle);
  ck_assert_int_eq(claim_next().job_id, low);
  ck_assert(claim_none());
}
END_TEST

START_TEST(a_changed_priority_counts) {
  int64_t first = submit_as("ann", 0, "a", false), second = submit_as("ann", 0, "b", false);
  int64_t third = submit_as("ann", 0, "c", false);
  patch(third, "{\"priority\": 1}", STATUS_OK);
  patch(first, "{\"priority\": -1}", STATUS_OK);
  ck_assert_int_eq(claim_next().job_id, third);
  patch(third, "{\"priority\": 2}", STATUS_CONFLICT);
  patch(first, "{\"priority\": null}", STATUS_OK);
  ck_assert_int_eq(claim_next().job_id, first);
  ck_assert_int_eq(claim_next().job_id, second);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM submitter_queue"), 0);
}
END_TEST

/* The workers are shared: whoever has the fewest running jobs is next, however many he has. */
START_TEST(fewest_running_jobs_go_first) {
  int64_t ann[4], bob;
  for (int i = 0; i < 4; i++) {
    ann[i] = submit_as("ann", 0, "a", false);
  }
  bob = submit_as("bob", 0, "b", false);
  ck_assert_int_eq(claim_next().job_id, ann[0]);
  ck_assert_int_eq(claim_next().job_id, bob);
  ck_assert_int_eq(claim_next().job_id, ann[1]);
}
END_TEST

/* One worker: who has used it less goes first, whatever the number of his jobs. */
START_TEST(least_recent_worker_time_goes_first) {
  enum job_state state;
  static const struct {
    const char *submitter;
    int used_s; /* by the job when it runs */
  } jobs[] = {{"ann", 50}, {"ann", 50}, {"ann", 50}, {"bob", 20},
              {"eve", 60}, {"bob", 20}, {"bob", 20}};
  static const int64_t expected[] = {1, 4, 5, 6, 7, 2, 3};
  for (int i = 0; i < 7; i++) {
    submit_as(jobs[i].submitter, 0, "a", false);
  }
  for (int i = 0; i < 7; i++) {
    struct claim claim = run_next();
    char sql[120];
    ck_assert_msg(claim.job_id == expected[i], "place %d: job %d", i, (int)claim.job_id);
    snprintf(sql, sizeof sql, "UPDATE attempt SET created_ms = created_ms - %d WHERE job_id = %d",
             1000 * jobs[claim.job_id - 1].used_s, (int)claim.job_id);
    ck_assert(sql_allowed(sql));
    ck_assert_int_eq(finish(&claim, ATTEMPT_SUCCEEDED, &state), STATUS_OK);
  }
}
END_TEST

/* Somebody with much use behind him is not kept out by ever new names: each of them starts with as
 * much as is left of his after a while. */
START_TEST(old_use_fades) {
  enum job_state state;
  struct claim claim;
  int64_t old;
  submit_as("ann", 0, "a", false);
  claim = run_next();
  ck_assert_int_eq(finish(&claim, ATTEMPT_SUCCEEDED, &state), STATUS_OK);
  /* as if she had used 1000 s three hours ago: less than 0.01 s are left of it */
  ck_assert(sql_allowed("UPDATE submitter SET charge = (julianday('now') - 2440587.5) * 144 - 18 + "
                        "9.97 WHERE name = 'ann'"));
  submit_as("new 1", 0, "b", false);
  old = submit_as("ann", 0, "c", false);
  submit_as("new 2", 0, "d", false);
  ck_assert_int_eq(claim_next().job_id, old - 1);
  ck_assert_int_eq(claim_next().job_id, old);
  ck_assert_int_eq(claim_next().job_id, old + 1);
}
END_TEST

/* Submitters with nothing to their account are forgotten. */
START_TEST(faded_submitters_are_forgotten) {
  enum job_state state;
  struct claim claim;
  for (int i = 0; i < 5; i++) {
    char name[20];
    snprintf(name, sizeof name, "user %d", i);
    submit_as(name, 0, "a", false);
    claim = run_next();
    ck_assert_int_eq(finish(&claim, ATTEMPT_SUCCEEDED, &state), STATUS_OK);
  }
  ck_assert(sql_allowed("UPDATE submitter SET charge = charge - 60"));
  submit_as("last", 0, "a", false);
  claim = run_next();
  ck_assert_int_eq(finish(&claim, ATTEMPT_SUCCEEDED, &state), STATUS_OK);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM submitter WHERE name <> 'last'"), 0);
}
END_TEST

START_TEST(held_jobs_and_retries_keep_the_counts_right) {
  struct error error;
  enum job_state state;
  int64_t held = submit_as("ann", 3, "a", false), other = submit_as("ann", 0, "b", false);
  ck_assert_int_eq(store_hold(store, held, true, &error), STATUS_OK);
  patch(held, "{\"priority\": 5}", STATUS_OK);
  struct claim claim = run_next();
  ck_assert_int_eq(claim.job_id, other);
  ck_assert_int_eq(finish(&claim, ATTEMPT_WORKER_LOST, &state), STATUS_OK);
  ck_assert_int_eq(store_hold(store, held, false, &error), STATUS_OK);
  ck_assert_int_eq(claim_next().job_id, held);
  ck_assert_int_eq(claim_next().job_id, other);
  ck_assert(claim_none());
  ck_assert_double_eq(sql_number("SELECT running FROM submitter"), 2);
  ck_assert_double_eq(sql_number("SELECT ready FROM submitter"), 0);
}
END_TEST

/* ---- results that are used again --------------------------------------------------------- */

static enum status share(void *context, const char *from, const json_t *names, int64_t job_id,
                         int64_t attempt, char folder[STORE_DIRECTORY_SIZE], struct error *error) {
  bool *good = context;
  ck_assert_uint_eq(json_array_size(names), 1);
  ck_assert_str_eq(from, "attempts/x");
  snprintf(folder, STORE_DIRECTORY_SIZE, "attempts/x");
  ck_assert_int_gt(job_id, attempt);
  return *good ? STATUS_OK : error_set(error, STATUS_NOT_FOUND, NULL, "gone");
}

/* Runs the next job to a result of this version of the solver. */
static int64_t solve_next(void) {
  enum job_state state;
  struct claim claim = run_next();
  ck_assert_int_eq(finish(&claim, ATTEMPT_SUCCEEDED, &state), STATUS_OK);
  ck_assert(sql_allowed("UPDATE job SET solver_version = '" PNEULAB_VERSION
                        "' WHERE state = 'succeeded'"));
  return claim.job_id;
}

START_TEST(an_equal_job_is_answered_at_once) {
  bool good = true;
  struct error error;
  struct job_record record;
  submit_as("ann", 0, "first", false);
  int64_t original = solve_next();
  int64_t without = submit_as("ann", 0, "first", true); /* nobody to share files */
  ck_assert_int_eq(state_of(without), JOB_STATE_QUEUED);
  ck_assert_int_eq(solve_next(), without);
  ck_assert_int_eq(store_delete(store, without, &error), STATUS_OK);
  store_set_sharing(store, share, &good);
  ck_assert_int_eq(state_of(submit_as("ann", 0, "other", true)), JOB_STATE_QUEUED);
  ck_assert_int_eq(state_of(submit_as("ann", 0, "first", false)), JOB_STATE_QUEUED);
  int64_t copy = submit_as("ann", 0, "first", true);
  ck_assert_int_eq(store_job(store, copy, &record, &error), STATUS_OK);
  ck_assert_int_eq(record.state, JOB_STATE_SUCCEEDED);
  ck_assert_int_eq(record.reused_from, original);
  ck_assert_double_eq(json_number_value(json_object_get(record.metrics, "angle_deg")), 1.5);
  ck_assert_uint_eq(json_array_size(record.artifacts), 1);
  job_record_clear(&record);
  ck_assert_int_eq(store_delete(store, original, &error), STATUS_OK);
  int64_t second = submit_as("ann", 0, "first", true); /* from the copy */
  ck_assert_int_eq(store_job(store, second, &record, &error), STATUS_OK);
  ck_assert_int_eq(record.state, JOB_STATE_SUCCEEDED);
  ck_assert_int_eq(record.reused_from, original);
  job_record_clear(&record);
  good = false; /* its files are gone */
  ck_assert_int_eq(state_of(submit_as("ann", 0, "first", true)), JOB_STATE_QUEUED);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM event WHERE job_id = 6"), 2);
}
END_TEST

START_TEST(another_version_of_the_solver_does_not_answer) {
  bool good = true;
  store_set_sharing(store, share, &good);
  submit_as("ann", 0, "first", false);
  solve_next();
  ck_assert(sql_allowed("UPDATE job SET solver_version = '0.0.0'"));
  ck_assert_int_eq(state_of(submit_as("ann", 0, "first", true)), JOB_STATE_QUEUED);
}
END_TEST

/* While an equal job runs the others wait; its result answers them, its failure frees them. */
START_TEST(equal_jobs_wait_for_the_one_that_runs) {
  bool good = true, claimed;
  enum job_state state;
  struct error error;
  struct claim claim;
  store_set_sharing(store, share, &good);
  int64_t first = submit_as("ann", 0, "same", true), second = submit_as("bob", 0, "same", true);
  struct claim running = run_next();
  ck_assert_int_eq(running.job_id, first);
  ck_assert(claim_none());
  ck_assert_double_eq(sql_number("SELECT waits_for FROM job WHERE id = 2"), (double)first);
  int64_t third = submit_as("bob", 0, "same", true), other = submit_as("bob", 0, "other", true);
  ck_assert_double_eq(sql_number("SELECT waits_for FROM job WHERE id = 3"), (double)first);
  ck_assert_int_eq(claim_next().job_id, other);
  ck_assert_int_eq(finish(&running, ATTEMPT_WORKER_LOST, &state), STATUS_OK); /* will be repeated */
  ck_assert_int_eq(claim_next().job_id, first);
  running.attempt = 2;
  ck_assert(claim_none());
  ck_assert_int_eq(store_attempt_running(store, first, 2, 1, &error), STATUS_OK);
  ck_assert_int_eq(finish(&running, ATTEMPT_FAILED, &state), STATUS_OK);
  running = run_next();
  ck_assert_int_eq(running.job_id, second);
  ck_assert(claim_none());
  ck_assert_int_eq(finish(&running, ATTEMPT_SUCCEEDED, &state), STATUS_OK);
  ck_assert(sql_allowed("UPDATE job SET solver_version = '" PNEULAB_VERSION "' WHERE id = 2"));
  ck_assert_int_eq(store_claim(store, &claim, &claimed, &error), STATUS_OK);
  ck_assert(!claimed);
  ck_assert_int_eq(claim.answered_id, third);
  ck_assert_int_eq(state_of(third), JOB_STATE_SUCCEEDED);
  ck_assert(claim_none());
  ck_assert_double_eq(sql_number("SELECT count(*) FROM result"), 2);
}
END_TEST

/* ---- changes by people ------------------------------------------------------------------- */

START_TEST(a_patch_changes_name_and_labels) {
  struct job_record record;
  struct error error;
  int64_t id = submit();
  patch(id, "{\"name\": \"better\", \"labels\": {\"paper\": null, \"a\": \"b\"}}", STATUS_OK);
  patch(id, "{\"labels\": {\"c\": \"d\"}}", STATUS_OK);
  ck_assert_int_eq(store_job(store, id, &record, &error), STATUS_OK);
  ck_assert_str_eq(record.name, "better");
  char *labels = json_dumps(record.labels, JSON_COMPACT | JSON_SORT_KEYS);
  ck_assert_str_eq(labels, "{\"a\":\"b\",\"c\":\"d\"}");
  free(labels);
  job_record_clear(&record);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM job_label WHERE job_name = 'better'"), 2);
  json_t *many = json_object(), *whole = json_pack("{s:o}", "labels", many);
  for (int i = 0; i < STORE_LABELS_OWN_MAX - 1; i++) {
    char name[20];
    snprintf(name, sizeof name, "l%d", i);
    json_object_set_new(many, name, json_string("x"));
  }
  ck_assert_int_eq(store_patch(store, id, whole, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/labels");
  json_decref(whole);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM job_label"), 2);
  patch(id, "{\"labels\": null, \"name\": null}", STATUS_OK);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM job_label"), 0);
  patch(id, "{}", STATUS_OK);
  patch(77, "{}", STATUS_NOT_FOUND);
  solve_next();
  patch(id, "{\"name\": \"late\"}", STATUS_CONFLICT);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("store_queue");
  TCase *tests = tcase_create("store_queue");
  tcase_add_checked_fixture(tests, store_setup, store_teardown);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, version_two_is_migrated_with_its_jobs);
  tcase_add_test(tests, the_highest_priority_goes_first);
  tcase_add_test(tests, a_changed_priority_counts);
  tcase_add_test(tests, fewest_running_jobs_go_first);
  tcase_add_test(tests, least_recent_worker_time_goes_first);
  tcase_add_test(tests, old_use_fades);
  tcase_add_test(tests, faded_submitters_are_forgotten);
  tcase_add_test(tests, held_jobs_and_retries_keep_the_counts_right);
  tcase_add_test(tests, an_equal_job_is_answered_at_once);
  tcase_add_test(tests, another_version_of_the_solver_does_not_answer);
  tcase_add_test(tests, equal_jobs_wait_for_the_one_that_runs);
  tcase_add_test(tests, a_patch_changes_name_and_labels);
  suite_add_tcase(suite, tests);
  return suite_run(suite);
}
