/* Studies in the store: who runs them, how their members are stored, and what they follow. */
#include "tests/unit/store_case.h"

#include <math.h>

#include "server/store/study.h"
#include "tests/unit/suite.h"

static const char study_text[] = "{\"kind\":\"study\",\"name\":\"s\"}";

static struct study_claim claim_study(bool expected) {
  struct study_claim claim;
  struct error error;
  bool claimed;
  ck_assert_msg(store_study_claim(store, 2, &claim, &claimed, &error) == STATUS_OK, "%s",
                error.message);
  ck_assert_int_eq(claimed, expected);
  int64_t id = claim.id, attempt = claim.attempt;
  study_claim_clear(&claim);
  return (struct study_claim){.id = id, .attempt = attempt};
}

/* Stores members 0 .. count - 1, of which each has its index as the value of one parameter. */
static enum status add_members(const struct study_claim *claim, size_t count) {
  struct study_member_row row[20];
  struct study_value_row value[20];
  struct error error;
  size_t stored;
  json_t *root = json_loads(document, 0, NULL);
  for (size_t i = 0; i < count; i++) {
    value[i] = (struct study_value_row){.number = (double)i, .text = "1 mm"};
    row[i] = (struct study_member_row){.value = &value[i],
                                       .submission = {.document = document,
                                                      .root = root,
                                                      .spec_hash = "00",
                                                      .study_id = claim->id,
                                                      .member = (int64_t)i,
                                                      .chain = -1}};
  }
  enum status status = STATUS_OK;
  for (size_t done = 0; done < count && status == STATUS_OK; done += stored) {
    status = store_study_add(store, claim->id, claim->attempt, row + done, count - done, 1, &stored,
                             &error);
  }
  json_decref(root);
  return status;
}

static struct study_claim begin(size_t members) {
  static const struct study_parameter_row parameter = {
      .pointer = "/a", .name = "a", .unit = "mm", .low = 0, .high = NAN};
  struct error error;
  bool replayed;
  submit_text(study_text, NULL, STATUS_OK, &replayed);
  struct study_claim claim = claim_study(true);
  ck_assert_int_eq(store_study_begin(store, claim.id, claim.attempt, "grid", members, false,
                                     &parameter, 1, &error),
                   STATUS_OK);
  ck_assert_int_eq(add_members(&claim, members), STATUS_OK);
  return claim;
}

static int follow(int64_t id, enum study_order order, int most) {
  struct error error;
  int changed;
  ck_assert_int_eq(store_study_follow(store, id, order, most, &changed, &error), STATUS_OK);
  return changed;
}

START_TEST(a_study_takes_no_worker) {
  bool replayed;
  int64_t id = submit_text(study_text, NULL, STATUS_OK, &replayed);
  ck_assert(claim_none());
  struct study_claim claim = claim_study(true);
  ck_assert_int_eq(claim.id, id);
  ck_assert_int_eq(state_of(id), JOB_STATE_RUNNING);
  ck_assert(claim_none());
  ck_assert_double_eq(sql_number("SELECT coalesce(sum(running), 0) FROM submitter"), 0);
  claim_study(false);
}
END_TEST

START_TEST(a_submitter_has_a_few_at_a_time) {
  bool replayed;
  for (int i = 0; i < 3; i++) {
    submit_text(study_text, NULL, STATUS_OK, &replayed);
  }
  int64_t urgent = submit_text("{\"kind\":\"study\"}", NULL, STATUS_OK, &replayed);
  ck_assert(sql_allowed("UPDATE job SET priority = 5 WHERE id = 4"));
  ck_assert_int_eq(claim_study(true).id, urgent);
  ck_assert_int_eq(claim_study(true).id, 1);
  claim_study(false);
  submit_text("{\"kind\":\"study\",\"labels\":{\"user\":\"other\"}}", NULL, STATUS_OK, &replayed);
  ck_assert_int_eq(claim_study(true).id, 5);
}
END_TEST

START_TEST(members_are_stored_once) {
  struct study_claim claim = begin(5);
  ck_assert_int_eq(add_members(&claim, 7), STATUS_OK);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM job WHERE study_id = 1"), 7);
  ck_assert_double_eq(sql_number("SELECT sum(number) FROM study_value"), 21);
  ck_assert(!sql_allowed("INSERT INTO job (kind, name, document, spec_hash, created_ms, study_id, "
                         "member) VALUES ('response', '', '{}', '', 1, 1, 3)"));
  struct study_claim late = {.id = claim.id, .attempt = claim.attempt + 1};
  ck_assert_int_eq(add_members(&late, 9), STATUS_CONFLICT);
}
END_TEST

START_TEST(single_jobs_go_first) {
  begin(3);
  int64_t single = submit();
  ck_assert_int_eq(claim_next().job_id, single);
  ck_assert_int_eq(claim_next().job_id, 2);
}
END_TEST

START_TEST(members_follow_their_study) {
  struct error error;
  enum job_state state;
  struct study_claim claim = begin(6);
  struct claim member = run_next();
  ck_assert_int_eq(store_hold(store, member.job_id + 1, true, &error), STATUS_CONFLICT);
  ck_assert_int_eq(store_hold(store, claim.id, true, &error), STATUS_OK);
  ck_assert_int_eq(state_of(claim.id), JOB_STATE_HELD);
  ck_assert_int_eq(follow(claim.id, STUDY_HOLD, 4), 4);
  ck_assert_int_eq(follow(claim.id, STUDY_HOLD, 4), 1);
  ck_assert(claim_none());
  ck_assert_int_eq(store_hold(store, claim.id, false, &error), STATUS_OK);
  claim = claim_study(true);
  ck_assert_int_eq(claim.attempt, 2);
  ck_assert_int_eq(follow(claim.id, STUDY_RELEASE, 10), 5);
  ck_assert_int_eq(store_cancel(store, claim.id, &state, &error), STATUS_OK);
  ck_assert_int_eq(state, JOB_STATE_CANCELLING);
  ck_assert_int_eq(follow(claim.id, STUDY_CANCEL, 10), 5);
  ck_assert_int_eq(store_study_cancelled(store, claim.id, &error), STATUS_CONFLICT);
  ck_assert_int_eq(store_delete(store, member.job_id + 1, &error), STATUS_CONFLICT);
  ck_assert_int_eq(finish(&member, ATTEMPT_SUCCEEDED, &state), STATUS_OK);
  ck_assert_int_eq(store_study_cancelled(store, claim.id, &error), STATUS_OK);
  ck_assert_int_eq(state_of(claim.id), JOB_STATE_CANCELLED);
}
END_TEST

START_TEST(a_held_study_is_cancelled_with_its_members) {
  struct error error;
  enum job_state state;
  struct study_claim claim = begin(2);
  ck_assert_int_eq(store_hold(store, claim.id, true, &error), STATUS_OK);
  ck_assert_int_eq(store_cancel(store, claim.id, &state, &error), STATUS_OK);
  ck_assert_int_eq(state, JOB_STATE_CANCELLING);
  store_reopen();
  int64_t count;
  ck_assert_int_eq(store_recover(store, false, &count, &error), STATUS_OK);
  ck_assert_int_eq(state_of(claim.id), JOB_STATE_CANCELLING);
  ck_assert_int_eq(follow(claim.id, STUDY_CANCEL, 10), 2);
  ck_assert_int_eq(store_study_cancelled(store, claim.id, &error), STATUS_OK);
}
END_TEST

START_TEST(a_study_survives_any_number_of_daemons) {
  struct error error;
  int64_t count;
  begin(2);
  for (int i = 0; i < STORE_ATTEMPTS_MAX + 3; i++) {
    ck_assert_int_eq(store_recover(store, false, &count, &error), STATUS_OK);
    ck_assert_int_eq(claim_study(true).attempt, i + 2);
  }
}
END_TEST

START_TEST(members_go_after_their_study) {
  struct job_files files[2];
  struct error error;
  enum job_state state;
  size_t count, sum = 0;
  struct study_claim claim = begin(3);
  ck_assert_int_eq(store_study_view(store, claim.id, &error), STATUS_OK);
  ck_assert_double_eq(sql_number("SELECT sum(a_mm) FROM study_1"), 3);
  store_cancel(store, claim.id, &state, &error);
  follow(claim.id, STUDY_CANCEL, 10);
  ck_assert_int_eq(store_study_cancelled(store, claim.id, &error), STATUS_OK);
  ck_assert_int_eq(store_delete(store, claim.id, &error), STATUS_OK);
  do {
    ck_assert_int_eq(store_study_delete(store, files, 2, &count, &error), STATUS_OK);
    sum += count;
  } while (count > 0);
  ck_assert_uint_eq(sum, 3);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM job"), 0);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM sqlite_schema WHERE name = 'study_1'"), 0);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM study_deleted"), 0);
}
END_TEST

/* Before, a study occupied a worker. */
START_TEST(studies_of_older_databases) {
  struct error error;
  int64_t count;
  store_make_old(4,
                 "INSERT INTO job (kind, name, document, spec_hash, created_ms, submitter) "
                 "VALUES ('study', 'runs', '{}', 'h', 1, 'ada'), "
                 "('study', 'waits', '{}', 'h', 2, 'ada'), ('response', '', '{}', 'h', 3, 'ada');"
                 "UPDATE job SET state = 'starting', attempt = 1 WHERE id = 1;"
                 "UPDATE job SET state = 'running' WHERE id = 1;"
                 "INSERT INTO attempt (job_id, number, created_ms) VALUES (1, 1, 1)");
  ck_assert_msg(store_open(directory, &store, &error) == STATUS_OK, "%s", error.message);
  ck_assert_double_eq(sql_number("SELECT running + 10 * ready FROM submitter"), 10);
  ck_assert_int_eq(store_recover(store, false, &count, &error), STATUS_OK);
  ck_assert_int_eq(claim_next().job_id, 3);
  ck_assert_int_eq(claim_study(true).id, 1);
  ck_assert_double_eq(sql_number("SELECT running FROM submitter"), 1);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("store_study");
  TCase *tests = tcase_create("store_study");
  tcase_add_checked_fixture(tests, store_setup, store_teardown);
  tcase_set_timeout(tests, 120);
  tcase_add_test(tests, a_study_takes_no_worker);
  tcase_add_test(tests, a_submitter_has_a_few_at_a_time);
  tcase_add_test(tests, members_are_stored_once);
  tcase_add_test(tests, single_jobs_go_first);
  tcase_add_test(tests, members_follow_their_study);
  tcase_add_test(tests, a_held_study_is_cancelled_with_its_members);
  tcase_add_test(tests, a_study_survives_any_number_of_daemons);
  tcase_add_test(tests, members_go_after_their_study);
  tcase_add_test(tests, studies_of_older_databases);
  suite_add_tcase(suite, tests);
  return suite_run(suite);
}
