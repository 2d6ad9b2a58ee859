/* The end of a study: its result, made of those of its members. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/exec/run.h"
#include "server/study/work.h"
#include "solver/explore/study_document.h"
#include "solver/job/json.h"

/* Pages and plots read a result as a whole: one that is longer goes without samples. */
enum { RESULT_BYTES_MAX = 32 << 20 };

/* What the members have come to. */
struct report {
  struct store *store;
  struct study_member_job *list;
  size_t count;
  const struct study_member_job **of; /* by member, NULL: it was never stored, or is deleted */
};

static json_t *result_of(void *context, size_t index, const char **reason, const char **message) {
  const struct report *report = context;
  const struct study_member_job *job = report->of[index];
  char *text = NULL;
  *reason = job ? job->reason : "not_run";
  *message = job ? job->message : "the study ended before this member";
  if (!job || store_result(report->store, job->job_id, &text, NULL, NULL) != STATUS_OK) {
    return NULL;
  }
  json_t *result = json_read(text, strlen(text), 0, NULL);
  free(text);
  return result;
}

static enum status report_open(const struct conductor_settings *settings, const struct work *work,
                               struct report *report, struct error *error) {
  *report = (struct report){.store = settings->store};
  enum status status =
      store_study_members(settings->store, work->id, &report->list, &report->count, error);
  report->of = calloc(work->study.count + 1, sizeof *report->of);
  if (status == STATUS_OK && !report->of) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the result of a study.");
  }
  for (size_t i = 0; i < report->count && status == STATUS_OK; i++) {
    size_t member = (size_t)report->list[i].member;
    if (member < work->study.count) {
      report->of[member] = &report->list[i];
    }
  }
  return status;
}

static void report_close(struct report *report) {
  free(report->list);
  free(report->of);
}

/* How the study ends: STATUS_DIVERGED when not a single member was solved. */
static enum status ending_of(const struct work *work, const struct report *report) {
  bool solved = false;
  for (size_t i = 0; i < report->count; i++) {
    solved = solved || report->list[i].state == JOB_STATE_SUCCEEDED;
  }
  return work->out_of_time ? STATUS_TIMEOUT : solved ? STATUS_OK : STATUS_DIVERGED;
}

static json_t *document_make(const struct conductor_settings *settings, struct work *work,
                             struct report *report, enum status ending) {
  struct study_results results = {.context = report, .result = result_of, .each = true};
  struct study_figures figures = {.wall_s = work->elapsed_s +
                                            1e-3 * (double)(clock_monotonic_ms() - work->start_ms)};
  for (size_t i = 0; i < report->count; i++) {
    figures.resumed += report->list[i].reused;
  }
  figures.computed = report->count - figures.resumed;
  store_study_cpu(settings->store, work->id, &figures.cpu_s, NULL);
  json_t *document = study_document(&work->spec, &work->study, &results, &figures, ending);
  if (document && work->search && study_search_report(work->search, document) != STATUS_OK) {
    json_decref(document);
    document = NULL;
  }
  return document;
}

/* The document as text; *document as it was written. NULL without memory. */
static char *document_write(const struct conductor_settings *settings, struct work *work,
                            struct report *report, enum status ending, json_t **document) {
  *document = document_make(settings, work, report, ending);
  char *text = *document ? json_dumps(*document, JSON_COMPACT | JSON_REAL_PRECISION(12)) : NULL;
  if (text && strlen(text) > RESULT_BYTES_MAX && work->study.keep_samples) {
    free(text);
    json_decref(*document);
    work->study.keep_samples = false;
    *document = document_make(settings, work, report, ending);
    json_array_append_new(
        json_object_get(*document, "warnings"),
        json_string("the samples of the members are in their own results only: together they are "
                    "more than 32 MiB"));
    text = *document ? json_dumps(*document, JSON_COMPACT | JSON_REAL_PRECISION(12)) : NULL;
  }
  return text;
}

static struct attempt_outcome outcome_of(const struct work *work, enum attempt_end end) {
  return (struct attempt_outcome){.job_id = work->id,
                                  .attempt = work->attempt,
                                  .end = end,
                                  .reason_code = "",
                                  .message = "",
                                  .exit_code = -1};
}

static const char *text_of(const json_t *document, const char *key) {
  const char *text = json_string_value(json_object_get(document, key));
  return text ? text : "";
}

enum status work_finish(const struct conductor_settings *settings, struct work *work,
                        enum job_state *state, struct error *error) {
  char directory[RUN_DIRECTORY_SIZE];
  struct report report;
  json_t *document = NULL;
  char *text = NULL;
  enum status status = report_open(settings, work, &report, error);
  if (status == STATUS_OK) {
    enum status ending = ending_of(work, &report);
    struct attempt_outcome outcome = outcome_of(work, ending == STATUS_OK        ? ATTEMPT_SUCCEEDED
                                                      : ending == STATUS_TIMEOUT ? ATTEMPT_TIMED_OUT
                                                                                 : ATTEMPT_FAILED);
    run_directory(work->id, work->attempt, directory);
    text = document_write(settings, work, &report, ending, &document);
    outcome.reason_code = text_of(document, "reason");
    outcome.message = text_of(document, "message");
    outcome.directory = directory;
    outcome.result = document;
    outcome.result_text = text;
    status = text ? store_attempt_finish(settings->store, &outcome, state, error)
                  : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a study's result.");
  }
  report_close(&report);
  json_decref(document);
  free(text);
  return status;
}

enum status work_requeue(const struct conductor_settings *settings, const struct work *work,
                         struct error *error) {
  struct attempt_outcome outcome = outcome_of(work, ATTEMPT_REQUEUED);
  enum job_state state;
  outcome.reason_code = "daemon_stopped";
  outcome.message = "The daemon shut down while the study ran; it will go on.";
  return store_attempt_finish(settings->store, &outcome, &state, error);
}

enum status work_fail(const struct conductor_settings *settings, const struct work *work,
                      const struct error *why, struct error *error) {
  struct attempt_outcome outcome = outcome_of(work, ATTEMPT_FAILED);
  enum job_state state;
  outcome.reason_code = "invalid_job";
  outcome.message = why->message;
  return store_attempt_finish(settings->store, &outcome, &state, error);
}
