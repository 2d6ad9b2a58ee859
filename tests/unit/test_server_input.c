/* What reaches the daemon beside HTTP: its command line, the reports and answers of workers. */
#include <check.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/file.h"
#include "server/base/option.h"
#include "server/base/options.h"
#include "server/exec/outcome.h"
#include "server/exec/progress.h"
#include "server/http/event_text.h"
#include "solver/job/json.h"
#include "tests/unit/suite.h"

/* ---- the command line -------------------------------------------------------------------- */

/* Reads a command line of up to nine words after the program's name, ended by NULL. */
static enum status read_line(struct options *options, struct error *error,
                             const char *const *words) {
  char *argv[11] = {(char *)"pneulabd"};
  int argc = 1;
  for (; words[argc - 1]; argc++) {
    argv[argc] = (char *)(uintptr_t)words[argc - 1];
  }
  optind = 0;
  return options_read(argc, argv, options, error);
}

START_TEST(letters_lists_and_words) {
  static const char *const words[] = {"-w3",    "-d", "data",        "--host", "a.example",
                                      "--host", "b",  "--isolation", "off",    NULL};
  struct options options;
  struct error error;
  ck_assert_int_eq(read_line(&options, &error, words), STATUS_OK);
  ck_assert_uint_eq(options.workers, 3);
  ck_assert_str_eq(options.data, "data");
  ck_assert_str_eq(options.hosts, "a.example,b");
  ck_assert_uint_eq(options.isolation, 2);
  ck_assert_int_eq(read_line(&options, &error, (const char *const[]){"-V", "rest", NULL}),
                   STATUS_OK);
  ck_assert_int_eq(options.action, OPTIONS_VERSION);
}
END_TEST

static const struct {
  const char *words[3], *phrase;
} refused_lines[] = {
    {{"--host", ""}, "--host takes 1 to"},
    {{"-x"}, "Unknown option"},
    {{"-w"}, "missing value"},
    {{"--time-limit", "1e999"}, "a number from 0.1 to"},
    {{"--time-limit", "0.01"}, "a number from 0.1 to"},
    {{"--time-limit", "inf"}, "a number from 0.1 to"},
    {{"--time-limit", "2s"}, "for example --time-limit 1"},
    {{"--worker-nice", "20"}, "a number from 0 to 19"},
    {{"--listen", ":80"}, "a numeric address and a port"},
    {{"--listen", "[::1:80"}, "a numeric address and a port"},
    {{"--listen", "[::1]"}, "a numeric address and a port"},
    {{"--listen", "127.0.0.1:80.5"}, "a numeric address and a port"},
    {{"--isolation", "on"}, "one of auto|require|off"},
    {{"--isolation", "aut"}, "one of auto|require|off"},
    {{"--isolation", ""}, "one of auto|require|off"},
    {{"serve"}, "Unexpected argument serve"},
};

START_TEST(lines_are_refused) {
  struct options options;
  struct error error;
  ck_assert_int_eq(read_line(&options, &error, refused_lines[_i].words), STATUS_INVALID);
  ck_assert_msg(strstr(error.message, refused_lines[_i].phrase) != NULL, "%s", error.message);
}
END_TEST

/* Texts that are longer than their place. */
START_TEST(long_words_are_refused) {
  static const char *const names[] = {"--data", "--host", "--listen"};
  char text[20000];
  struct options options;
  struct error error;
  memset(text, 'x', sizeof text - 1);
  text[sizeof text - 1] = '\0';
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    ck_assert_int_eq(read_line(&options, &error, (const char *const[]){names[i], text, NULL}),
                     STATUS_INVALID);
  }
  memcpy(text + sizeof text - 4, ":80", 4); /* a long host with its port */
  ck_assert_int_eq(read_line(&options, &error, (const char *const[]){"--listen", text, NULL}),
                   STATUS_INVALID);
  text[sizeof options.hosts - 10] = '\0'; /* fits alone, not with another */
  ck_assert_int_eq(read_line(&options, &error, (const char *const[]){"--host", text, NULL}),
                   STATUS_OK);
  ck_assert_int_eq(read_line(&options, &error,
                             (const char *const[]){"--host", text, "--host", "also.example", NULL}),
                   STATUS_INVALID);
  ck_assert_ptr_nonnull(strstr(error.message, "in all"));
}
END_TEST

START_TEST(help_names_every_option) {
  size_t count, size;
  const struct option_row *rows = options_rows(&count);
  char *text = NULL, name[100];
  FILE *out = open_memstream(&text, &size);
  ck_assert_ptr_nonnull(out);
  options_help(out);
  fclose(out);
  for (size_t i = 0; i < count; i++) {
    snprintf(name, sizeof name, " --%s%s%s", rows[i].name, rows[i].value ? " " : "\n",
             rows[i].value ? rows[i].value : "");
    name[strcspn(name, "\n")] = '\0';
    ck_assert_msg(strstr(text, name) != NULL, "%s", name);
    ck_assert_msg(strstr(text, rows[i].help) != NULL, "%s", rows[i].help);
  }
  free(text);
}
END_TEST

/* A table whose own preset is out of its limits, and an example that is within them. */
START_TEST(limits_of_a_row) {
  static const struct option_row rows[] = {
      {OPTION_NUMBER, 'n', "number", "N", 0, sizeof(double), 5, 9, "7", "a number"},
      {OPTION_NUMBER, 0, "wrong", "N", 0, sizeof(double), 5, 9, "3", "another"},
      {OPTION_NUMBER, 0, "last", "N", 0, sizeof(double), 5, 9, "8", "not reached"}};
  char *argv[] = {(char *)"test", (char *)"-n", (char *)"4", NULL};
  struct error error;
  double number = 0;
  int used;
  bool stopped;
  ck_assert_int_eq(option_preset(rows, 3, &number, &error), STATUS_INVALID);
  ck_assert_double_eq(number, 7);
  optind = 0;
  ck_assert_int_eq(option_read(rows, 1, "test", 3, argv, &number, &used, &stopped, &error),
                   STATUS_INVALID);
  ck_assert_ptr_nonnull(strstr(error.message, "for example --number 5"));
}
END_TEST

/* ---- reports of workers ------------------------------------------------------------------ */

static void take(struct progress *progress, const char *line) {
  progress_take_line(line, strlen(line), progress);
}

START_TEST(reports_out_of_range_change_nothing) {
  static const char *const lines[] = {
      "{\"event\":\"progress\",\"fraction\":-0.1}",
      "{\"event\":\"progress\",\"fraction\":0.9,\"fraction\":0.8}",
      "{\"event\":\"progress\",\"fraction\":1e999}",
      "{\"event\":\"progress\",\"fraction\":NaN}",
      "{\"event\":\"progress\",\"fraction\":0.9} {}",
      "\xff\xfe",
  };
  struct progress progress = progress_none();
  take(&progress, "{\"event\":\"progress\",\"fraction\":0.5,\"pressure_kPa\":\"12\"}");
  ck_assert_double_eq(progress.fraction, 0.5);
  ck_assert(isnan(progress.pressure_kPa)); /* a text is no pressure */
  for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
    take(&progress, lines[i]);
    ck_assert_double_eq(progress.fraction, 0.5);
  }
}
END_TEST

/* Appends a text to the file and tells whether that made a difference. */
static bool grow(struct progress_reader *reader, struct progress *progress, int fd,
                 const char *text) {
  ck_assert_int_eq(write(fd, text, strlen(text)), (ssize_t)strlen(text));
  return progress_poll(reader, progress);
}

#define REPORT(REST) "{\"event\":\"progress\",\"fraction\":0.5" REST "}\n"

START_TEST(every_part_of_a_report_counts) {
  struct progress_reader reader = {.path = "/tmp/pneulab-events-XXXXXX"};
  struct progress progress = progress_none();
  int fd = mkstemp(reader.path);
  ck_assert(grow(&reader, &progress, fd, REPORT("")));
  ck_assert(!grow(&reader, &progress, fd, REPORT("")));
  ck_assert(grow(&reader, &progress, fd, REPORT(",\"pressure_kPa\":3")));
  ck_assert(!grow(&reader, &progress, fd, REPORT(",\"pressure_kPa\":3")));
  ck_assert(grow(&reader, &progress, fd, REPORT(",\"pressure_kPa\":4")));
  ck_assert(grow(&reader, &progress, fd, REPORT(",\"pressure_kPa\":4,\"step\":1")));
  ck_assert(grow(&reader, &progress, fd, REPORT(",\"pressure_kPa\":4,\"step\":1,\"steps\":2")));
  ck_assert(grow(&reader, &progress, fd,
                 REPORT(",\"pressure_kPa\":4,\"step\":1,\"steps\":2,\"iteration\":5")));
  ck_assert(grow(&reader, &progress, fd, "{\"event\":\"progress\",\"fraction\":0.1}\n"));
  ck_assert_double_eq(progress.fraction, 0.1); /* another stage begins */
  ck_assert_double_eq(progress_left_s(&progress, progress.since.at_ms), -1);
  close(fd);
  unlink(reader.path);
}
END_TEST

START_TEST(a_line_without_end_is_skipped) {
  struct progress_reader reader = {.path = "/tmp/pneulab-events-XXXXXX"};
  struct progress progress = progress_none();
  int fd = mkstemp(reader.path);
  char text[4097];
  memset(text, 'x', sizeof text - 1);
  text[sizeof text - 1] = '\0';
  for (int i = 0; i < 48; i++) { /* 192 KiB */
    ck_assert(write(fd, text, sizeof text - 1) > 0);
  }
  ck_assert(!progress_poll(&reader, &progress));
  ck_assert_int_eq(reader.offset, 65536);
  ck_assert(!progress_poll(&reader, &progress));
  ck_assert(!progress_poll(&reader, &progress));
  ck_assert(grow(&reader, &progress, fd, "\n" REPORT("")));
  ck_assert_double_eq(progress.fraction, 0.5);
  close(fd);
  unlink(reader.path);
  ck_assert_int_eq(symlink("/etc/passwd", reader.path), 0);
  reader.offset = 0;
  ck_assert(!progress_poll(&reader, &progress)); /* links are not followed */
  ck_assert_int_eq(reader.offset, 0);
  unlink(reader.path);
}
END_TEST

/* ---- answers of workers ------------------------------------------------------------------ */

static const struct {
  const char *text, *pointer;
} answers[] = {
    {"[]", "/status"},
    {"{}", "/status"},
    {"{\"status\": 1, \"metrics\": {}}", "/status"},
    {"{\"status\": \"x\"}", "/metrics"},
    {"{\"status\": \"x\", \"metrics\": []}", "/metrics"},
    {"{\"status\": \"x\", \"metrics\": {\"a\": 1, \"b\": null}}", "/metrics"},
    {"{\"status\": \"x\", \"metrics\": {}, \"samples\": {}}", "/samples"},
    {"{\"status\": \"x\", \"metrics\": {}, \"samples\": [{}, 1]}", "/samples"},
    {"{\"status\": \"x\", \"metrics\": {}}", NULL},
    {"{\"status\": \"x\", \"metrics\": {\"a\": 1.5}, \"samples\": [{}]}", NULL},
};

START_TEST(answers_have_a_form) {
  struct error error = {.status = STATUS_OK};
  json_t *answer = json_read(answers[_i].text, strlen(answers[_i].text), 0, NULL);
  ck_assert_ptr_nonnull(answer);
  ck_assert_int_eq(result_check(answer, &error), answers[_i].pointer == NULL);
  ck_assert_str_eq(error.pointer, answers[_i].pointer ? answers[_i].pointer : "");
  json_decref(answer);
}
END_TEST

/* Judges a worker that printed the text. */
static void judge(struct outcome *outcome, const struct process_end *end, enum stop_cause cause,
                  const char *text) {
  char path[] = "/tmp/pneulab-output-XXXXXX";
  close(mkstemp(path));
  ck_assert_int_eq(file_write(path, text, strlen(text), NULL), STATUS_OK);
  outcome_judge(outcome, end, cause, path, "/tmp");
  unlink(path);
}

START_TEST(ends_are_told_in_words) {
  static const struct {
    struct process_end end;
    enum stop_cause cause;
    const char *text, *reason, *message;
  } rows[] = {
      {{.exit_code = 2},
       STOP_NONE,
       "{\"error\": {\"message\": \"No.\", \"pointer\": \"/a\"}}",
       "invalid_job",
       "No. At /a"},
      {{.exit_code = 2},
       STOP_NONE,
       "{\"error\": {\"message\": \"No.\", \"pointer\": \"\"}}",
       "invalid_job",
       "No."},
      {{.exit_code = 2}, STOP_NONE, "{\"error\": [1]}", "invalid_job", "The solver refuses"},
      {{.exit_code = 2}, STOP_NONE, "oops", "invalid_job", "The solver refuses"},
      {{.exit_code = 3},
       STOP_NONE,
       "{\"status\": \"x\", \"metrics\": {}, \"reason\": \"\"}",
       "diverged",
       "stopped early"},
      {{.exit_code = -1, .signal = SIGKILL}, STOP_FILES, "", "files_limit", "more space"},
      {{.exit_code = -1, .signal = 64}, STOP_NONE, "", "worker_killed", "Signal 64"},
      {{.exit_code = -1, .signal = 200}, STOP_NONE, "", "worker_killed", "Signal 200 (unknown)"},
      {{.exit_code = 0}, STOP_NONE, "7", "result_invalid", "no JSON object"},
      {{.exit_code = 0}, STOP_NONE, "{\"status\": 7}", "result_invalid", "/status"},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    struct outcome outcome;
    judge(&outcome, &rows[i].end, rows[i].cause, rows[i].text);
    ck_assert_str_eq(outcome.reason_code, rows[i].reason);
    ck_assert_msg(strstr(outcome.message, rows[i].message) != NULL, "%s", outcome.message);
    outcome_clear(&outcome);
  }
  struct outcome outcome;
  outcome_judge(&outcome, &(struct process_end){.exit_code = 0}, STOP_NONE, "/nowhere/file", "/");
  ck_assert_str_eq(outcome.reason_code, "result_invalid");
  outcome_clear(&outcome);
}
END_TEST

START_TEST(memory_is_blamed_where_it_was_short) {
  static const struct {
    int exit_code;
    double peak_MB;
    uint64_t limit_bytes;
    const char *text, *reason;
  } rows[] = {
      {4, 1, 100 << 20, "{\"error\": {\"code\": \"no_memory\"}}", "memory_limit"},
      {4, 1, 0, "{\"error\": {\"code\": \"no_memory\"}}", "internal_error"},
      {4, 1, 100 << 20, "{\"error\": {\"code\": \"other\"}}", "internal_error"},
      {1, 90, 100 << 20, "", "memory_limit"},
      {1, 90, 1000 << 20, "", "worker_failed"},
      {3, 1, 100 << 20, "{\"status\": \"x\", \"metrics\": {}, \"reason\": \"no_memory\"}",
       "memory_limit"},
      {3, 90, 100 << 20, "{\"status\": \"x\", \"metrics\": {}, \"reason\": \"fold\"}", "fold"},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    struct process_end end = {.exit_code = rows[i].exit_code, .peak_memory_MB = rows[i].peak_MB};
    struct outcome outcome;
    judge(&outcome, &end, STOP_NONE, rows[i].text);
    outcome_blame_memory(&outcome, &end, rows[i].limit_bytes);
    ck_assert_str_eq(outcome.reason_code, rows[i].reason);
    outcome_clear(&outcome);
  }
}
END_TEST

/* Of the files that an answer names only those with plain names that are there. */
START_TEST(files_of_an_answer) {
  char directory[] = "/tmp/pneulab-files-XXXXXX", path[100], output[100];
  static const char answer[] =
      "{\"status\": \"x\", \"metrics\": {}, \"artifacts\": [\"a.csv\", \"none.csv\", \"../b\", 7,"
      " \"folder\"]}";
  struct process_end end = {.exit_code = 0};
  struct outcome outcome;
  ck_assert_ptr_nonnull(mkdtemp(directory));
  snprintf(path, sizeof path, "%s/a.csv", directory);
  ck_assert_int_eq(file_write(path, "abc", 3, NULL), STATUS_OK);
  snprintf(path, sizeof path, "%s/folder", directory);
  ck_assert_int_eq(file_make_directory(path, NULL), STATUS_OK);
  snprintf(output, sizeof output, "%s/output", directory);
  ck_assert_int_eq(file_write(output, answer, sizeof answer - 1, NULL), STATUS_OK);
  outcome_judge(&outcome, &end, STOP_NONE, output, directory);
  ck_assert_uint_eq(json_object_size(outcome.artifacts), 1);
  ck_assert_int_eq(json_integer_value(json_object_get(outcome.artifacts, "a.csv")), 3);
  outcome_clear(&outcome);
  file_remove_tree(directory);
}
END_TEST

/* ---- events ------------------------------------------------------------------------------ */

START_TEST(filters_of_events) {
  struct event_filter filter = {.jobs = {3, 5}, .job_count = 2};
  json_t *labels = json_pack("{s:s, s:s}", "a", "1", "b", "2");
  ck_assert(event_filter_match(&filter, 5, NULL));
  ck_assert(!event_filter_match(&filter, 4, NULL));
  filter.labels[0].name = strdup("a");
  filter.labels[0].value = strdup("1");
  filter.labels[1].name = strdup("b");
  filter.labels[1].value = strdup("3");
  filter.label_count = 1;
  ck_assert(event_filter_match(&filter, 3, labels));
  ck_assert(!event_filter_match(&filter, 4, labels));
  ck_assert(!event_filter_match(&filter, 3, NULL));
  filter.label_count = 2;
  ck_assert(!event_filter_match(&filter, 3, labels));
  json_object_del(labels, "b");
  ck_assert(!event_filter_match(&filter, 3, labels));
  json_decref(labels);
  event_filter_clear(&filter);
  ck_assert(event_filter_match(&filter, 1, NULL)); /* nothing is asked for any more */
}
END_TEST

START_TEST(events_are_written_whole_or_not) {
  char text[EVENT_TEXT_MAX], reason[EVENT_TEXT_MAX];
  struct job_event event = {
      .id = 7, .at_ms = 1, .job_id = 3, .state = "failed", .reason_code = "fold", .attempt = 2};
  struct progress progress = {
      .fraction = 0.25, .pressure_kPa = NAN, .step = 4, .steps = 8, .since = {.fraction = 0.25}};
  size_t size = event_text_state(&event, text);
  static const char wanted[] = "id: 7\nevent: state\ndata: {\"job\":3,\"state\":\"failed\","
                               "\"reason_code\":\"fold\",\"attempt\":2,"
                               "\"at\":\"1970-01-01T00:00:00.001Z\"}\n\n";
  ck_assert_uint_eq(size, sizeof wanted - 1);
  ck_assert_mem_eq(text, wanted, size);
  memset(reason, 'x', sizeof reason - 1);
  reason[sizeof reason - 1] = '\0';
  event.reason_code = reason;
  ck_assert_uint_eq(event_text_state(&event, text), 0); /* too long */
  event.reason_code = "\xff";
  ck_assert_uint_eq(event_text_state(&event, text), 0); /* no UTF-8 */
  static const char report[] =
      "event: progress\ndata: {\"job\":3,\"attempt\":2,\"fraction\":0.25,\"pressure_kPa\":null,"
      "\"step\":4,\"steps\":8,\"iteration\":null,\"eta_s\":null}\n\n";
  size = event_text_progress(3, 2, &progress, text);
  ck_assert_uint_eq(size, sizeof report - 1);
  ck_assert_mem_eq(text, report, size);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("server input");
  TCase *tests = tcase_create("input");
  tcase_add_test(tests, letters_lists_and_words);
  tcase_add_loop_test(tests, lines_are_refused, 0, sizeof refused_lines / sizeof *refused_lines);
  tcase_add_test(tests, long_words_are_refused);
  tcase_add_test(tests, help_names_every_option);
  tcase_add_test(tests, limits_of_a_row);
  tcase_add_test(tests, reports_out_of_range_change_nothing);
  tcase_add_test(tests, every_part_of_a_report_counts);
  tcase_add_test(tests, a_line_without_end_is_skipped);
  tcase_add_loop_test(tests, answers_have_a_form, 0, sizeof answers / sizeof *answers);
  tcase_add_test(tests, ends_are_told_in_words);
  tcase_add_test(tests, memory_is_blamed_where_it_was_short);
  tcase_add_test(tests, files_of_an_answer);
  tcase_add_test(tests, filters_of_events);
  tcase_add_test(tests, events_are_written_whole_or_not);
  suite_add_tcase(suite, tests);
  return suite_run(suite);
}
