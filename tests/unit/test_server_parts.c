/* The parts of the daemon that have an answer of their own: targets, hosts, options, progress,
 * the judgement of a worker's end. */
#include <check.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/file.h"
#include "server/base/options.h"
#include "server/exec/outcome.h"
#include "server/exec/progress.h"
#include "server/http/encoding.h"
#include "server/http/guard.h"
#include "server/http/url.h"
#include "tests/unit/suite.h"

START_TEST(url_is_cut_and_decoded) {
  char target[] = "/api/v1/jobs/a%20b%C3%A9?label.x=1%2B1+2&flag&empty=";
  struct url url;
  ck_assert_ptr_null(url_parse(target, &url));
  ck_assert_uint_eq(url.segment_count, 4);
  ck_assert_str_eq(url.segments[3], "a b\xc3\xa9");
  ck_assert_str_eq(url_query(&url, "label.x"), "1+1 2");
  ck_assert_str_eq(url_query(&url, "flag"), "");
  ck_assert_str_eq(url_query(&url, "empty"), "");
  ck_assert_ptr_null(url_query(&url, "other"));
}
END_TEST

START_TEST(url_in_absolute_form) {
  char target[] = "http://[::1]:80/a?b=c";
  struct url url;
  ck_assert_ptr_null(url_parse(target, &url));
  ck_assert_str_eq(url.authority, "[::1]:80");
  ck_assert_uint_eq(url.segment_count, 1);
  ck_assert_str_eq(url.segments[0], "a");
  ck_assert_str_eq(url_query(&url, "b"), "c");
}
END_TEST

START_TEST(url_root_has_no_segments) {
  char target[] = "/?x=1";
  struct url url;
  ck_assert_ptr_null(url_parse(target, &url));
  ck_assert_uint_eq(url.segment_count, 0);
}
END_TEST

START_TEST(url_refuses_what_is_ambiguous) {
  static const char *const bad[] = {"",
                                    "a",
                                    "*",
                                    "/%",
                                    "/%4",
                                    "/%4g",
                                    "/%00",
                                    "/%2f",
                                    "/%5c",
                                    "/..",
                                    "/a/../b",
                                    "/%2e%2E",
                                    "/.",
                                    "/a%0a",
                                    "/\x7f",
                                    "/%80",
                                    "/%c0%af",
                                    "/%ed%a0%80",
                                    "/%f4%90%80%80",
                                    "/a\\b",
                                    "/a#b",
                                    "http://",
                                    "http:///a",
                                    "http://h",
                                    "http://h?x",
                                    "https://h/",
                                    "/a?x=1&x=2",
                                    "/a?x=%00",
                                    "/1/2/3/4/5/6/7/8/9"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    char target[64];
    struct url url;
    strcpy(target, bad[i]);
    ck_assert_msg(url_parse(target, &url) != NULL, "%s is taken", bad[i]);
  }
}
END_TEST

START_TEST(url_bounds_the_query) {
  char target[400] = "/a?";
  struct url url;
  for (int i = 0; i <= URL_QUERY_MAX; i++) {
    size_t used = strlen(target);
    snprintf(target + used, sizeof target - used, "k%d=v&", i);
  }
  ck_assert_ptr_nonnull(url_parse(target, &url));
}
END_TEST

START_TEST(encodings_are_accepted_by_weight) {
  static const struct {
    const char *accept;
    bool gzip, brotli;
  } cases[] = {{NULL, false, false},
               {"", false, false},
               {"gzip", true, false},
               {"GZIP , br", true, true},
               {"gzip, deflate, br, zstd", true, true},
               {"xgzip, gzipx", false, false},
               {"*", true, true},
               {"*;q=0, gzip", true, false},
               {"gzip;q=0, *", false, true},
               {"br; q=0.000, gzip;q=0.5", true, false},
               {"br;q=0.001", false, true},
               {"br;q=", false, true},
               {", ,, ;q=0,", false, false}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    ck_assert_msg(encoding_accepted(cases[i].accept, "gzip") == cases[i].gzip, "%zu", i);
    ck_assert_msg(encoding_accepted(cases[i].accept, "br") == cases[i].brotli, "%zu", i);
  }
}
END_TEST

START_TEST(loopback_hosts) {
  static const char *const good[] = {"localhost",   "LocalHost:80", "127.0.0.1",
                                     "127.1.2.3:9", "[::1]",        "[::1]:8080"};
  static const char *const bad[] = {
      "",    ":80", "localhost.",  "localhost.evil",  "128.0.0.1", "0.0.0.0",       "[::1", "[::2]",
      "::1", "[]",  "localhost:x", "localhost:80:80", "[::1]x",    "evil@localhost"};
  for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
    ck_assert_msg(guard_host_is_loopback(good[i]), "%s", good[i]);
  }
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    ck_assert_msg(!guard_host_is_loopback(bad[i]), "%s", bad[i]);
  }
}
END_TEST

static enum status options_of(struct options *options, struct error *error, const char *name,
                              const char *value) {
  char *argv[] = {(char *)"pneulabd", (char *)(uintptr_t)name, (char *)(uintptr_t)value, NULL};
  optind = 0;
  return options_read(value ? 3 : 2, argv, options, error);
}

START_TEST(options_are_read) {
  struct options options;
  struct error error;
  ck_assert_int_eq(options_of(&options, &error, "--listen", "[::1]:0"), STATUS_OK);
  ck_assert_str_eq(options.listen.host, "::1");
  ck_assert_uint_eq(options.listen.port, 0);
  ck_assert_str_eq(options.data, "var");
  ck_assert_uint_ge(options.workers, 1);
  ck_assert_int_eq(options_of(&options, &error, "--memory-limit", "512"), STATUS_OK);
  ck_assert_uint_eq(options.memory_limit_bytes, 512ULL << 20);
  ck_assert_int_eq(options_of(&options, &error, "--help", NULL), STATUS_OK);
  ck_assert_int_eq(options.action, OPTIONS_HELP);
}
END_TEST

START_TEST(options_are_refused_with_an_example) {
  static const char *const bad[][2] = {{"--listen", "8080"},
                                       {"--listen", "localhost:80"},
                                       {"--listen", "127.0.0.1:70000"},
                                       {"--listen", "127.0.0.1:x"},
                                       {"--workers", "0"},
                                       {"--workers", "1.5"},
                                       {"--workers", "many"},
                                       {"--memory-limit", "-1"},
                                       {"--drain-timeout", "nan"},
                                       {"--data", ""},
                                       {"--nonsense", "1"},
                                       {"--executor", "cloud"},
                                       {"extra", NULL},
                                       {"--workers", NULL}};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    struct options options;
    struct error error = {.status = STATUS_OK};
    ck_assert_msg(options_of(&options, &error, bad[i][0], bad[i][1]) == STATUS_INVALID, "%s",
                  bad[i][0]);
    ck_assert_uint_gt(strlen(error.message), 10);
  }
}
END_TEST

static void take(struct progress *progress, const char *line) {
  progress_take_line(line, strlen(line), progress);
}

START_TEST(progress_takes_only_what_makes_sense) {
  struct progress progress = progress_none();
  take(&progress, "{\"event\":\"progress\",\"fraction\":0.25,\"pressure_kPa\":12.5}");
  ck_assert_double_eq(progress.fraction, 0.25);
  ck_assert_double_eq(progress.pressure_kPa, 12.5);
  static const char *const ignored[] = {"",
                                        "{",
                                        "[]",
                                        "{\"event\":\"other\",\"fraction\":0.5}",
                                        "{\"event\":\"progress\"}",
                                        "{\"event\":\"progress\",\"fraction\":2}",
                                        "{\"event\":\"progress\",\"fraction\":\"1\"}",
                                        "{\"event\":7,\"fraction\":1}"};
  for (size_t i = 0; i < sizeof ignored / sizeof *ignored; i++) {
    take(&progress, ignored[i]);
    ck_assert_double_eq(progress.fraction, 0.25);
  }
}
END_TEST

START_TEST(progress_tells_steps_and_iterations) {
  struct progress progress = progress_none();
  take(&progress, "{\"event\":\"progress\",\"fraction\":0.25,\"step\":3,\"steps\":12,"
                  "\"iteration\":40}");
  ck_assert_int_eq(progress.step, 3);
  ck_assert_int_eq(progress.steps, 12);
  ck_assert_int_eq(progress.iteration, 40);
  ck_assert(isnan(progress.pressure_kPa));
  take(&progress, "{\"event\":\"progress\",\"fraction\":0.5,\"step\":-3,\"steps\":\"x\"}");
  ck_assert_int_eq(progress.step, 0);
  ck_assert_int_eq(progress.steps, 0);
  ck_assert_int_eq(progress.iteration, 0);
}
END_TEST

/* The time left of a solve that took the given moments for equal parts, asked at the last. */
static double time_left(const int64_t *at_ms, size_t count, double part) {
  struct pace pace;
  struct progress progress = progress_none();
  pace_start(&pace, 0);
  for (size_t i = 0; i < count; i++) {
    progress.fraction = part * (double)(i + 1);
    pace_take(&pace, at_ms[i], progress.fraction);
  }
  progress.since = pace_reference(&pace, at_ms[count - 1]);
  return progress_left_s(&progress, at_ms[count - 1]);
}

START_TEST(pace_estimates_the_time_left) {
  int64_t even[100], slower[8];
  ck_assert_double_eq_tol(time_left((int64_t[]){1000, 2000, 3000, 4000}, 4, 0.1), 6, 1e-9);
  ck_assert_double_eq(time_left((int64_t[]){100}, 1, 0.1), -1); /* too early */
  for (int i = 0; i < 100; i++) {                               /* more points than are kept */
    even[i] = 1000 * (i + 1);
  }
  ck_assert_double_eq_tol(time_left(even, 100, 0.005), 100, 3);
  for (int i = 0; i < 8; i++) { /* every step takes longer than the one before */
    slower[i] = 100 * (i + 1) * (i + 1);
  }
  double left = time_left(slower, 8, 0.1); /* 3.6 s by their law; 1.6 s by the mean rate */
  ck_assert(left > 2 && left < 4.5);
  int64_t slow_start[15] = {100};
  for (int i = 1; i < 15; i++) { /* one long step, then short ones */
    slow_start[i] = 1000 + 100 * i;
  }
  ck_assert_double_eq_tol(time_left(slow_start, 15, 0.05), 0.5, 1e-9);
}
END_TEST

START_TEST(progress_follows_a_growing_file) {
  struct progress_reader reader = {.offset = 0};
  struct progress progress = progress_none();
  strcpy(reader.path, "/tmp/pneulab-events-XXXXXX");
  ck_assert(!progress_poll(&reader, &progress)); /* not there yet */
  int fd = mkstemp(reader.path);
  static const char first[] = "{\"event\":\"progress\",\"fraction\":0.5}\n{\"event\":\"prog";
  static const char second[] = "ress\",\"fraction\":1}\n";
  ck_assert(write(fd, first, sizeof first - 1) > 0);
  ck_assert(progress_poll(&reader, &progress));
  ck_assert_double_eq(progress.fraction, 0.5);
  ck_assert(!progress_poll(&reader, &progress)); /* half a line waits for its rest */
  ck_assert(write(fd, second, sizeof second - 1) > 0);
  ck_assert(progress_poll(&reader, &progress));
  ck_assert_double_eq(progress.fraction, 1);
  close(fd);
  unlink(reader.path);
}
END_TEST

static const char good_result[] =
    "{\"status\":\"diverged\",\"reason\":\"limit_point\",\"metrics\":{\"a\":1},\"samples\":[]}";
static const char late_result[] =
    "{\"status\":\"diverged\",\"reason\":\"timeout\",\"metrics\":{},\"samples\":[]}";
static const char bad_result[] = "{\"status\":\"succeeded\",\"metrics\":{\"a\":\"b\"}}";

static const struct {
  int exit_code, signal;
  enum stop_cause cause;
  const char *output;
  enum attempt_end end;
  const char *reason;
  bool result;
} judgements[] = {
    {0, 0, STOP_NONE, good_result, ATTEMPT_SUCCEEDED, "", true},
    {0, 0, STOP_NONE, bad_result, ATTEMPT_WORKER_LOST, "result_invalid", false},
    {0, 0, STOP_NONE, "nothing", ATTEMPT_WORKER_LOST, "result_invalid", false},
    {0, 0, STOP_NONE, "[]", ATTEMPT_WORKER_LOST, "result_invalid", false},
    {3, 0, STOP_NONE, good_result, ATTEMPT_FAILED, "limit_point", true},
    {3, 0, STOP_NONE, late_result, ATTEMPT_TIMED_OUT, "timeout", true},
    {3, 0, STOP_TIMEOUT, late_result, ATTEMPT_TIMED_OUT, "timeout", true},
    {2, 0, STOP_NONE, "{}", ATTEMPT_FAILED, "invalid_job", false},
    {4, 0, STOP_NONE, "", ATTEMPT_WORKER_LOST, "internal_error", false},
    {1, 0, STOP_NONE, "", ATTEMPT_WORKER_LOST, "worker_failed", false},
    {-1, SIGKILL, STOP_NONE, good_result, ATTEMPT_WORKER_LOST, "worker_killed", false},
    {-1, SIGKILL, STOP_TIMEOUT, "", ATTEMPT_TIMED_OUT, "timeout", false},
    {-1, SIGXCPU, STOP_NONE, "", ATTEMPT_TIMED_OUT, "timeout", false},
    {5, 0, STOP_CANCEL, "", ATTEMPT_CANCELLED, "cancel_requested", false},
    {0, 0, STOP_CANCEL, good_result, ATTEMPT_CANCELLED, "cancel_requested", false},
    {5, 0, STOP_SHUTDOWN, "", ATTEMPT_REQUEUED, "daemon_stopped", false},
    {-1, SIGKILL, STOP_SHUTDOWN, "", ATTEMPT_REQUEUED, "daemon_stopped", false},
    {0, 0, STOP_SHUTDOWN, good_result, ATTEMPT_SUCCEEDED, "", true},
};

START_TEST(workers_are_judged) {
  char path[] = "/tmp/pneulab-output-XXXXXX";
  int fd = mkstemp(path);
  struct process_end end = {.exit_code = judgements[_i].exit_code, .signal = judgements[_i].signal};
  struct outcome outcome;
  close(fd);
  file_write(path, judgements[_i].output, strlen(judgements[_i].output), NULL);
  outcome_judge(&outcome, &end, judgements[_i].cause, path, "/tmp");
  ck_assert_int_eq(outcome.attempt.end, judgements[_i].end);
  ck_assert_str_eq(outcome.attempt.reason_code, judgements[_i].reason);
  ck_assert_int_eq(outcome.attempt.result_text != NULL, judgements[_i].result);
  outcome_clear(&outcome);
  unlink(path);
}
END_TEST

START_TEST(plain_names) {
  static const char *const bad[] = {"", ".", "..", ".hidden", "a/b", "a b", "\xc3\xa9", "a\n"};
  ck_assert(file_name_is_plain("surface-0000.vtu"));
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    ck_assert_msg(!file_name_is_plain(bad[i]), "%s", bad[i]);
  }
}
END_TEST

START_TEST(times_are_written) {
  char text[CLOCK_TEXT_SIZE];
  clock_format(951782400007, text);
  ck_assert_str_eq(text, "2000-02-29T00:00:00.007Z");
}
END_TEST

int main(void) {
  Suite *suite = suite_create("server parts");
  TCase *tests = tcase_create("parts");
  tcase_add_test(tests, url_is_cut_and_decoded);
  tcase_add_test(tests, url_in_absolute_form);
  tcase_add_test(tests, url_root_has_no_segments);
  tcase_add_test(tests, url_refuses_what_is_ambiguous);
  tcase_add_test(tests, url_bounds_the_query);
  tcase_add_test(tests, encodings_are_accepted_by_weight);
  tcase_add_test(tests, loopback_hosts);
  tcase_add_test(tests, options_are_read);
  tcase_add_test(tests, options_are_refused_with_an_example);
  tcase_add_test(tests, progress_takes_only_what_makes_sense);
  tcase_add_test(tests, progress_tells_steps_and_iterations);
  tcase_add_test(tests, pace_estimates_the_time_left);
  tcase_add_test(tests, progress_follows_a_growing_file);
  tcase_add_loop_test(tests, workers_are_judged, 0, sizeof judgements / sizeof *judgements);
  tcase_add_test(tests, plain_names);
  tcase_add_test(tests, times_are_written);
  suite_add_tcase(suite, tests);
  return suite_run(suite);
}
