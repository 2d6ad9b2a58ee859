/* Jobs and clusters in the database: whose job is whose, batches, what a restart leaves open, and
 * what is taken back. */
#include "tests/unit/store_case.h"

#include "server/store/cluster.h"
#include "tests/unit/suite.h"

/* Submits a job that asks for an engine, or for none (NULL). */
static int64_t submit_for(const char *engine) {
  char text[300];
  snprintf(text, sizeof text, "{\"kind\":\"response\",\"labels\":{\"executor\":\"%s\"}}",
           engine ? engine : "");
  return submit_text(text, NULL, STATUS_OK, &(bool){false});
}

static int64_t claim_for(enum store_engine engine, bool others) {
  struct claim claim;
  struct error error;
  bool claimed;
  ck_assert_int_eq(
      store_claim_for(store, (struct store_taste){engine, others}, &claim, &claimed, &error),
      STATUS_OK);
  int64_t id = claimed ? claim.job_id : 0;
  claim_clear(&claim);
  return id;
}

/* A batch of one task with the first attempt of a job. */
static struct cluster_batch batch_of(int64_t job_id) {
  struct cluster_batch batch = {.tasks = 1};
  struct cluster_attempt attempt = {.job_id = job_id, .attempt = 1};
  struct error error;
  ck_assert_msg(store_batch_intend(store, &batch, &attempt, 1, &error) == STATUS_OK, "%s",
                error.message);
  return batch;
}

START_TEST(engines_take_their_own) {
  int64_t here = submit_for("local"), there = submit_for("slurm"), any = submit_for(NULL);
  ck_assert_int_eq(claim_for(ENGINE_SLURM, false), there);
  ck_assert_int_eq(claim_for(ENGINE_SLURM, false), 0);
  ck_assert_int_eq(claim_for(ENGINE_LOCAL, true), here);
  ck_assert_int_eq(claim_for(ENGINE_LOCAL, true), any);
  int64_t second = submit_for("slurm");
  ck_assert_int_eq(claim_for(ENGINE_NONE, true), second);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM submitter_queue"), 0);
}
END_TEST

START_TEST(a_label_that_is_changed_counts) {
  struct error error;
  int64_t id = submit_for("slurm");
  json_t *patch = json_pack("{s:{s:s}}", "labels", "executor", "local");
  ck_assert_int_eq(store_patch(store, id, patch, &error), STATUS_OK);
  json_decref(patch);
  ck_assert_int_eq(claim_for(ENGINE_SLURM, true), 0);
  ck_assert_int_eq(claim_for(ENGINE_LOCAL, false), id);
}
END_TEST

START_TEST(batches_stay_open_over_a_restart) {
  struct error error;
  struct cluster_batch *list;
  struct cluster_attempt *attempts;
  size_t count;
  int64_t recovered, here = submit_for(NULL), there = submit_for("slurm");
  ck_assert_int_eq(claim_for(ENGINE_LOCAL, true), here);
  ck_assert_int_eq(claim_for(ENGINE_SLURM, false), there);
  struct cluster_batch batch = batch_of(there);
  store_reopen();
  ck_assert_int_eq(store_recover(store, true, &recovered, &error), STATUS_OK);
  ck_assert_int_eq(recovered, 1);
  ck_assert_int_eq(state_of(here), JOB_STATE_QUEUED);
  ck_assert_int_eq(state_of(there), JOB_STATE_STARTING);
  ck_assert_int_eq(store_batches_open(store, &list, &count, &error), STATUS_OK);
  ck_assert_uint_eq(count, 1);
  ck_assert_str_eq(list[0].name, batch.name);
  ck_assert_int_eq(list[0].cluster_job, 0);
  free(list);
  ck_assert_int_eq(store_batch_attempts(store, batch.id, &attempts, &count, &error), STATUS_OK);
  ck_assert_uint_eq(count, 1);
  ck_assert_int_eq(attempts[0].job_id, there);
  free(attempts);
  ck_assert_int_eq(store_batch_submitted(store, batch.id, 77, &error), STATUS_OK);
  ck_assert_double_eq(sql_number("SELECT cluster_job FROM cluster_batch"), 77);
  ck_assert_int_eq(store_batch_ended(store, batch.id, &error), STATUS_OK);
  ck_assert_int_eq(store_batches_open(store, &list, &count, &error), STATUS_OK);
  ck_assert_uint_eq(count, 0);
  free(list);
  ck_assert_int_eq(store_recover(store, false, &recovered, &error), STATUS_OK);
  ck_assert_int_eq(state_of(there), JOB_STATE_QUEUED); /* without a cluster it runs again */
}
END_TEST

START_TEST(no_two_batches_have_one_name) {
  int64_t first = submit_for("slurm"), second = submit_for("slurm");
  ck_assert_int_eq(claim_for(ENGINE_SLURM, false), first);
  ck_assert_int_eq(claim_for(ENGINE_SLURM, false), second);
  struct cluster_batch a = batch_of(first), b = batch_of(second);
  ck_assert_str_ne(a.name, b.name);
  ck_assert(strncmp(a.name, "pneulab-", 8) == 0);
}
END_TEST

START_TEST(what_waits_on_a_cluster_is_taken_back) {
  struct error error;
  int64_t id = submit_for("slurm"), local = submit_for("local");
  json_t *patch = json_pack("{s:i}", "priority", 7);
  ck_assert_int_eq(claim_for(ENGINE_SLURM, false), id);
  ck_assert_int_eq(claim_for(ENGINE_LOCAL, false), local);
  struct cluster_batch batch = batch_of(id);
  ck_assert_int_eq(store_patch(store, id, patch, &error), STATUS_OK);
  ck_assert_int_eq(store_patch(store, local, patch, &error), STATUS_CONFLICT);
  json_decref(patch);
  ck_assert_int_eq(state_of(id), JOB_STATE_QUEUED);
  ck_assert_int_eq(claim_for(ENGINE_SLURM, false), id);
  ck_assert_double_eq(sql_number("SELECT count(*) FROM attempt WHERE reason_code = 'withdrawn'"),
                      1);
  ck_assert_int_eq(store_hold(store, id, true, &error), STATUS_CONFLICT); /* it has no batch yet */
  struct cluster_attempt again = {.job_id = id, .attempt = 2};
  ck_assert_int_eq(store_batch_intend(store, &batch, &again, 1, &error), STATUS_OK);
  ck_assert_int_eq(store_hold(store, id, true, &error), STATUS_OK);
  ck_assert_int_eq(state_of(id), JOB_STATE_HELD);
  ck_assert_int_eq(store_attempt_running(store, id, 2, 0, &error), STATUS_CONFLICT);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("store_cluster");
  TCase *cases = tcase_create("cluster");
  tcase_add_checked_fixture(cases, store_setup, store_teardown);
  tcase_add_test(cases, engines_take_their_own);
  tcase_add_test(cases, a_label_that_is_changed_counts);
  tcase_add_test(cases, batches_stay_open_over_a_restart);
  tcase_add_test(cases, no_two_batches_have_one_name);
  tcase_add_test(cases, what_waits_on_a_cluster_is_taken_back);
  suite_add_tcase(suite, cases);
  return suite_run(suite);
}
