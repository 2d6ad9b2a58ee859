/* What Slurm's programs print, programs that misbehave, and the commands that are made for them. */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/command.h"
#include "server/base/file.h"
#include "server/slurm/client.h"
#include "server/slurm/draft.h"
#include "server/slurm/words.h"
#include "tests/unit/suite.h"

static char folder[] = "/tmp/pneulab-slurm-XXXXXX";
static char *environment[2];

/* A program of this name in PATH that is this shell script. */
static void program(const char *name, const char *script) {
  char path[200], text[2000];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  snprintf(text, sizeof text, "#!/bin/sh\n%s\n", script);
  ck_assert_int_eq(file_write(path, text, strlen(text), NULL), STATUS_OK);
  ck_assert_int_eq(chmod(path, 0755), 0);
}

static void set_up(void) {
  static char path[400];
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(path, sizeof path, "PATH=%s:%s", folder, getenv("PATH"));
  setenv("PATH", path + strlen("PATH="), 1);
  environment[0] = path;
}

static void tear_down(void) {
  file_remove_tree(folder);
}

static struct slurm_client client(void) {
  return (struct slurm_client){.environment = environment, .timeout_ms = 10000};
}

/* ---- words -------------------------------------------------------------------------------- */

START_TEST(lines_of_squeue) {
  char good[] = "12|[3-5,9%2]|PENDING|Nodes required for job are DOWN, DRAINED||main|pneulab-1";
  char running[] = "12|7|RUNNING|None|n[1-2]|main|pneulab-1";
  struct slurm_line line;
  struct slurm_range range;
  ck_assert(slurm_line_read(good, &line));
  ck_assert_int_eq(line.job, 12);
  ck_assert_int_eq(line.state, SLURM_PENDING);
  ck_assert_str_eq(line.name, "pneulab-1");
  const char *cursor = line.tasks;
  ck_assert(slurm_range_next(&cursor, &range));
  ck_assert_int_eq(range.low, 3);
  ck_assert_int_eq(range.high, 5);
  ck_assert(slurm_range_next(&cursor, &range));
  ck_assert_int_eq(range.low, 9);
  ck_assert_int_eq(range.high, 9);
  ck_assert(!slurm_range_next(&cursor, &range));
  ck_assert(slurm_line_read(running, &line));
  ck_assert_str_eq(line.node, "n[1-2]");
  ck_assert_int_eq(line.state, SLURM_RUNNING);
}
END_TEST

START_TEST(lines_that_are_none) {
  static const char *const bad[] = {"",
                                    "12|7|RUNNING|None|n1|main",
                                    "12|7|RUNNING|None|n1|main|a|b",
                                    "x|7|RUNNING|None|n1|main|a",
                                    "-3|7|RUNNING|None|n1|main|a",
                                    "99999999999999999999|7|RUNNING|None|n1|main|a",
                                    "slurm_load_jobs error: Unable to contact slurm controller"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    char text[200];
    struct slurm_line line;
    strcpy(text, bad[i]);
    ck_assert_msg(!slurm_line_read(text, &line), "%s is taken", bad[i]);
  }
}
END_TEST

START_TEST(ranges_that_make_no_sense) {
  static const char *const bad[] = {"", "N/A", "-1", "3-", "4:0", "3-x", "99999999999999999999"};
  struct slurm_range range;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    const char *cursor = bad[i];
    bool any = slurm_range_next(&cursor, &range);
    ck_assert_msg(!any, "%s is taken", bad[i]);
  }
  const char *cursor = "0-8:4";
  ck_assert(slurm_range_next(&cursor, &range));
  ck_assert_int_eq(range.step, 4);
}
END_TEST

START_TEST(states_and_reasons) {
  ck_assert_int_eq(slurm_state_of("COMPLETING"), SLURM_RUNNING);
  ck_assert_int_eq(slurm_state_of("CANCELLED by 1000"), SLURM_CANCELLED);
  ck_assert_int_eq(slurm_state_of("NODE_FAIL"), SLURM_NODE_LOST);
  ck_assert_int_eq(slurm_state_of("OUT_OF_MEMORY"), SLURM_OUT_OF_MEMORY);
  ck_assert_int_eq(slurm_state_of("COMPLETE"), SLURM_UNKNOWN);
  ck_assert_str_eq(slurm_state_word(SLURM_NODE_LOST), "node_lost");
  ck_assert_ptr_nonnull(slurm_reason_sentence("Resources"));
  ck_assert_ptr_nonnull(slurm_reason_sentence("AssocGrpCpuLimit"));
  ck_assert_ptr_null(slurm_reason_sentence("SomethingNew"));
  ck_assert(
      slurm_unreachable("squeue: error: slurm_load_jobs: Unable to contact slurm controller"));
  ck_assert(slurm_unreachable("sbatch: error: Socket timed out on send/recv operation"));
  ck_assert(!slurm_unreachable("sbatch: error: invalid partition specified: gpu"));
}
END_TEST

START_TEST(numbers_of_sbatch) {
  ck_assert_int_eq(slurm_submitted_job("123\n"), 123);
  ck_assert_int_eq(slurm_submitted_job("123;cluster\n"), 123);
  ck_assert_int_eq(slurm_submitted_job("Submitted batch job 123\n"), 0);
  ck_assert_int_eq(slurm_submitted_job(""), 0);
  ck_assert_int_eq(slurm_submitted_job("12x\n"), 0);
}
END_TEST

/* ---- programs ----------------------------------------------------------------------------- */

static enum status run(const char *name, int timeout_ms, size_t most, struct command_end *end,
                       struct error *error) {
  const char *const argv[] = {name, "a b", "$HOME;", NULL};
  struct command command = {
      .argv = argv, .environment = environment, .timeout_ms = timeout_ms, .output_max = most};
  return command_run(&command, end, error);
}

START_TEST(arguments_pass_no_shell) {
  struct command_end end;
  struct error error;
  program("says", "printf '%s|' \"$@\"; echo trouble >&2; echo last >&2; exit 3");
  ck_assert_int_eq(run("says", 10000, 100, &end, &error), STATUS_OK);
  ck_assert_str_eq(end.output, "a b|$HOME;|");
  ck_assert_int_eq(end.exit_code, 3);
  ck_assert_str_eq(end.problem, "last");
  free(end.output);
}
END_TEST

START_TEST(programs_are_bounded) {
  struct command_end end;
  struct error error;
  program("hangs", "sleep 60 & sleep 60");
  program("floods", "while :; do echo 0123456789012345678901234567890123456789; done");
  int64_t start = clock_monotonic_ms();
  ck_assert_int_eq(run("hangs", 300, 100, &end, &error), STATUS_TIMEOUT);
  ck_assert_ptr_null(end.output);
  ck_assert_int_eq(run("floods", 20000, 100000, &end, &error), STATUS_TOO_LARGE);
  ck_assert_int_eq(run("is-not-there", 10000, 100, &end, &error), STATUS_NOT_FOUND);
  ck_assert_ptr_nonnull(strstr(error.message, "is-not-there"));
  ck_assert_int_lt(clock_monotonic_ms() - start, 20000);
}
END_TEST

static bool at_once(void *context) {
  (void)context;
  return true;
}

START_TEST(programs_are_given_up) {
  const char *const argv[] = {"hangs", NULL};
  struct command command = {.argv = argv,
                            .environment = environment,
                            .timeout_ms = 20000,
                            .output_max = 10,
                            .stop = at_once};
  struct command_end end;
  struct error error;
  program("hangs", "sleep 60");
  ck_assert_int_eq(command_run(&command, &end, &error), STATUS_CANCELLED);
}
END_TEST

/* ---- the client --------------------------------------------------------------------------- */

START_TEST(an_array_is_submitted) {
  struct slurm_client c = client();
  struct error error;
  int64_t job;
  const char *const script[] = {"/x/task.sh", "/x/batch", NULL};
  struct slurm_request request = {.name = "pneulab-1",
                                  .tasks = 8,
                                  .partition = "main",
                                  .account = "",
                                  .memory_bytes = 1 << 30,
                                  .time_s = 61,
                                  .nice = 50,
                                  .script = script};
  program("sbatch", "echo \"$*\" > \"${0%/*}/called\"; echo 77");
  ck_assert_int_eq(slurm_submit(&c, &request, &job, &error), STATUS_OK);
  ck_assert_int_eq(job, 77);
  char path[200], *called;
  size_t size;
  snprintf(path, sizeof path, "%s/called", folder);
  ck_assert_int_eq(file_read(path, 2000, &called, &size, NULL), STATUS_OK);
  static const char *const expected[] = {"--parsable",
                                         "--no-requeue",
                                         "--array=0-7",
                                         "--partition=main",
                                         "--nice=50",
                                         "--mem=1048576K",
                                         "--time=2",
                                         "--job-name=pneulab-1",
                                         " /x/task.sh /x/batch\n"};
  for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
    ck_assert_msg(strstr(called, expected[i]) != NULL, "%s is not in %s", expected[i], called);
  }
  ck_assert_ptr_null(strstr(called, "--account"));
  free(called);
}
END_TEST

START_TEST(refusal_and_silence_differ) {
  struct slurm_client c = client();
  struct error error;
  const char *const script[] = {"/x/task.sh", NULL};
  struct slurm_request request = {
      .name = "n", .tasks = 1, .partition = "", .account = "", .script = script};
  int64_t job;
  program("sbatch", "echo 'sbatch: error: invalid partition specified: gpu' >&2; exit 1");
  ck_assert_int_eq(slurm_submit(&c, &request, &job, &error), STATUS_CONFLICT);
  ck_assert_ptr_nonnull(strstr(error.message, "invalid partition"));
  program("sbatch", "echo 'sbatch: error: Unable to contact slurm controller' >&2; exit 1");
  ck_assert_int_eq(slurm_submit(&c, &request, &job, &error), STATUS_NOT_FOUND);
  program("sbatch", "exit 1");
  ck_assert_int_eq(slurm_submit(&c, &request, &job, &error), STATUS_NOT_FOUND);
  program("sbatch", "echo Submitted");
  ck_assert_int_eq(slurm_submit(&c, &request, &job, &error), STATUS_IO);
  c.timeout_ms = 200;
  program("sbatch", "echo 5; sleep 60");
  ck_assert_int_eq(slurm_submit(&c, &request, &job, &error), STATUS_TIMEOUT);
  ck_assert_int_eq(job, 0);
}
END_TEST

START_TEST(cores_are_added_up) {
  struct slurm_client c = client();
  struct error error;
  unsigned cores;
  program("sinfo", "echo 3/5/2/10");
  ck_assert_int_eq(slurm_cores(&c, "", &cores, &error), STATUS_OK);
  ck_assert_uint_eq(cores, 8);
  program("sinfo", "echo nothing");
  ck_assert_int_eq(slurm_cores(&c, "main", &cores, &error), STATUS_IO);
}
END_TEST

START_TEST(tasks_that_have_ended_need_no_cancel) {
  struct slurm_client c = client();
  struct error error;
  const char *const tasks[] = {"1_2", "1_3"};
  program("scancel",
          "echo 'scancel: error: Kill job error on job id 1_2: Invalid job id' >&2; exit 1");
  ck_assert_int_eq(slurm_cancel(&c, tasks, 2, false, &error), STATUS_OK);
  program("scancel", "[ \"$*\" = '--batch --signal=USR1 1_2 1_3' ] || exit 1");
  ck_assert_int_eq(slurm_cancel(&c, tasks, 2, true, &error), STATUS_OK);
  program("scancel", "echo 'error: Unable to contact slurm controller' >&2; exit 1");
  ck_assert_int_eq(slurm_cancel(&c, tasks, 2, true, &error), STATUS_NOT_FOUND);
}
END_TEST

/* ---- drafts ------------------------------------------------------------------------------- */

static struct draft *draft_of(int64_t job_id) {
  struct draft *draft = calloc(1, sizeof *draft);
  draft->member = calloc(1, sizeof *draft->member);
  draft->count = draft->room = 1;
  draft->member[0] = (struct draft_member){.job_id = job_id, .document = strdup("{}")};
  draft->mean_s = 2;
  return draft;
}

START_TEST(drafts_are_joined) {
  struct draft *draft = draft_of(1);
  for (int64_t i = 2; i <= 100; i++) {
    ck_assert_int_eq(draft_append(draft, draft_of(i), NULL), STATUS_OK);
  }
  ck_assert_uint_eq(draft->count, 100);
  ck_assert_int_eq(draft->member[99].job_id, 100);
  ck_assert_double_eq_tol(draft->mean_s, 200, 1e-9);
  struct draft *other = draft_of(101);
  ck_assert(draft_alike(draft, other));
  strcpy(other->partition, "gpu");
  ck_assert(!draft_alike(draft, other));
  draft_destroy(other);
  draft_destroy(draft);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("slurm");
  TCase *words = tcase_create("words"), *programs = tcase_create("programs");
  tcase_add_test(words, lines_of_squeue);
  tcase_add_test(words, lines_that_are_none);
  tcase_add_test(words, ranges_that_make_no_sense);
  tcase_add_test(words, states_and_reasons);
  tcase_add_test(words, numbers_of_sbatch);
  tcase_add_test(words, drafts_are_joined);
  suite_add_tcase(suite, words);
  tcase_add_checked_fixture(programs, set_up, tear_down);
  tcase_set_timeout(programs, 60);
  tcase_add_test(programs, arguments_pass_no_shell);
  tcase_add_test(programs, programs_are_bounded);
  tcase_add_test(programs, programs_are_given_up);
  tcase_add_test(programs, an_array_is_submitted);
  tcase_add_test(programs, refusal_and_silence_differ);
  tcase_add_test(programs, cores_are_added_up);
  tcase_add_test(programs, tasks_that_have_ended_need_no_cancel);
  suite_add_tcase(suite, programs);
  return suite_run(suite);
}
