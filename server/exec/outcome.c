#include "server/exec/outcome.h"

#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "server/base/file.h"
#include "solver/job/json.h"

enum {
  EXIT_SUCCEEDED = 0,
  EXIT_INVALID_JOB = 2,
  EXIT_STOPPED_EARLY = 3,
  EXIT_INTERNAL = 4,
  EXIT_CANCELLED = 5,
  RESULT_BYTES_MAX = 32 << 20,
  ARTIFACTS_MAX = 4096
};

/* Of its limit: a worker that dies with so much in use has met it. An allocation that fails does
 * not count, so the share leaves room for a large one. */
#define MEMORY_SHARE 0.75

static void outcome_set(struct outcome *outcome, enum attempt_end end, const char *reason_code,
                        const char *format, ...) __attribute__((format(printf, 4, 5)));

static void outcome_set(struct outcome *outcome, enum attempt_end end, const char *reason_code,
                        const char *format, ...) {
  outcome->attempt.end = end;
  snprintf(outcome->reason_code, sizeof outcome->reason_code, "%s", reason_code);
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(outcome->message, sizeof outcome->message, format, arguments);
  va_end(arguments);
  outcome->attempt.reason_code = outcome->reason_code;
  outcome->attempt.message = outcome->message;
}

static enum status wrong(struct error *error, const char *pointer, const char *sentence) {
  return error_set(error, STATUS_INVALID, pointer, "The result document is wrong at %s: %s.",
                   pointer, sentence);
}

static bool result_samples_check(const json_t *samples, struct error *error) {
  if (samples && !json_is_array(samples)) {
    wrong(error, "/samples", "an array is expected");
    return false;
  }
  for (size_t i = 0; i < json_array_size(samples); i++) {
    if (!json_is_object(json_array_get(samples, i))) {
      wrong(error, "/samples", "every sample is an object");
      return false;
    }
  }
  return true;
}

bool result_check(const json_t *result, struct error *error) {
  if (!json_is_object(result) || !json_is_string(json_object_get(result, "status"))) {
    wrong(error, "/status", "a text is expected");
    return false;
  }
  const json_t *metrics = json_object_get(result, "metrics");
  const char *name;
  json_t *value;
  if (!json_is_object(metrics)) {
    wrong(error, "/metrics", "an object is expected");
    return false;
  }
  json_object_foreach((json_t *)metrics, name, value) {
    if (!json_is_number(value)) {
      wrong(error, "/metrics", "every metric is a number");
      return false;
    }
  }
  return result_samples_check(json_object_get(result, "samples"), error);
}

/* Lists the files that the result names and that are there. */
static void outcome_artifacts(struct outcome *outcome, const char *directory) {
  const json_t *names = json_object_get(outcome->result, "artifacts");
  outcome->artifacts = json_object();
  for (size_t i = 0; i < json_array_size(names) && i < ARTIFACTS_MAX; i++) {
    const char *name = json_string_value(json_array_get(names, i));
    char path[PATH_MAX];
    struct stat info;
    if (!name || !file_name_is_plain(name)) {
      continue;
    }
    int length = snprintf(path, sizeof path, "%s/%s", directory, name);
    if (length > 0 && (size_t)length < sizeof path && lstat(path, &info) == 0 &&
        S_ISREG(info.st_mode)) {
      json_object_set_new(outcome->artifacts, name, json_integer(info.st_size));
    }
  }
  outcome->attempt.artifacts = outcome->artifacts;
}

/* Reads what the worker printed; false when it is no JSON object. */
static bool outcome_read(struct outcome *outcome, const char *path, struct error *error) {
  size_t size;
  if (file_read(path, RESULT_BYTES_MAX, &outcome->result_text, &size, error) != STATUS_OK) {
    return false;
  }
  json_error_t reason;
  outcome->result = json_read(outcome->result_text, size, JSON_REJECT_DUPLICATES, &reason);
  if (!outcome->result && errno == ENOMEM) {
    error_set(error, STATUS_NO_MEMORY, NULL, "There is no memory for the solver's answer.");
    return false;
  }
  if (!json_is_object(outcome->result)) {
    error_set(error, STATUS_SYNTAX, NULL, "The solver printed no JSON object: %s (line %d).",
              outcome->result ? "another value" : reason.text, reason.line);
    return false;
  }
  return true;
}

static const char *result_text_of(const struct outcome *outcome, const char *key,
                                  const char *otherwise) {
  const char *text = json_string_value(json_object_get(outcome->result, key));
  return text && text[0] ? text : otherwise;
}

/* A worker that ended by itself with a result document. */
static void outcome_with_result(struct outcome *outcome, int exit_code, const char *output_path,
                                const char *artifacts_dir) {
  struct error error;
  if (!outcome_read(outcome, output_path, &error) || !result_check(outcome->result, &error)) {
    outcome_set(outcome, ATTEMPT_WORKER_LOST, "result_invalid", "%s", error.message);
    return;
  }
  if (exit_code == EXIT_SUCCEEDED) {
    outcome_set(outcome, ATTEMPT_SUCCEEDED, "", "%s", result_text_of(outcome, "message", ""));
  } else {
    const char *reason = result_text_of(outcome, "reason", "diverged");
    outcome_set(outcome, strcmp(reason, "timeout") == 0 ? ATTEMPT_TIMED_OUT : ATTEMPT_FAILED,
                reason, "%s", result_text_of(outcome, "message", "The solve stopped early."));
  }
  outcome->attempt.result_text = outcome->result_text;
  outcome->attempt.result = outcome->result;
  outcome_artifacts(outcome, artifacts_dir);
}

static void outcome_invalid_job(struct outcome *outcome, const char *output_path) {
  const char *message = NULL, *pointer = NULL;
  if (outcome_read(outcome, output_path, NULL)) {
    const json_t *problem = json_object_get(outcome->result, "error");
    message = json_string_value(json_object_get(problem, "message"));
    pointer = json_string_value(json_object_get(problem, "pointer"));
  }
  outcome_set(outcome, ATTEMPT_FAILED, "invalid_job", "%s%s%s",
              message ? message : "The solver refuses this job.",
              pointer && pointer[0] ? " At " : "", pointer ? pointer : "");
}

void outcome_judge(struct outcome *outcome, const struct process_end *end, enum stop_cause cause,
                   const char *output_path, const char *artifacts_dir) {
  *outcome = (struct outcome){0};
  if (cause == STOP_CANCEL) {
    outcome_set(outcome, ATTEMPT_CANCELLED, "cancel_requested", "Cancelled on request.");
  } else if (end->exit_code == EXIT_SUCCEEDED || end->exit_code == EXIT_STOPPED_EARLY) {
    outcome_with_result(outcome, end->exit_code, output_path, artifacts_dir);
  } else if (cause == STOP_TIMEOUT || end->signal == SIGXCPU) {
    outcome_set(outcome, ATTEMPT_TIMED_OUT, "timeout",
                "The worker was ended: it overran the time limit of its job.");
  } else if (cause == STOP_FILES) {
    outcome_set(outcome, ATTEMPT_FAILED, "files_limit",
                "The worker was ended: its files take more space than a job may have.");
  } else if (cause == STOP_SHUTDOWN) {
    outcome_set(outcome, ATTEMPT_REQUEUED, "daemon_stopped",
                "The daemon shut down while the job ran; it will run again.");
  } else if (end->exit_code == EXIT_INVALID_JOB) {
    outcome_invalid_job(outcome, output_path);
  } else if (end->signal != 0) {
    outcome_set(outcome, ATTEMPT_WORKER_LOST, "worker_killed", "Signal %d (%s) ended the worker.",
                end->signal, sigdescr_np(end->signal) ? sigdescr_np(end->signal) : "unknown");
  } else {
    outcome_read(outcome, output_path, NULL); /* an error document, if any */
    outcome_set(outcome, ATTEMPT_WORKER_LOST,
                end->exit_code == EXIT_INTERNAL ? "internal_error" : "worker_failed",
                "The worker ended with exit code %d.", end->exit_code);
  }
  outcome->attempt.exit_code = end->exit_code;
  outcome->attempt.signal = end->signal;
  outcome->attempt.cpu_s = end->cpu_s;
  outcome->attempt.peak_memory_MB = end->peak_memory_MB;
}

void outcome_blame_memory(struct outcome *outcome, const struct process_end *end,
                          uint64_t limit_bytes) {
  const json_t *problem = json_object_get(outcome->result, "error");
  const char *code = json_string_value(json_object_get(problem, "code"));
  bool said = code && strcmp(code, "no_memory") == 0;
  bool full = end->peak_memory_MB * 1048576 >= MEMORY_SHARE * (double)limit_bytes;
  if (limit_bytes == 0) {
    return;
  }
  if (outcome->attempt.end == ATTEMPT_FAILED && strcmp(outcome->reason_code, "no_memory") == 0) {
    strcpy(outcome->reason_code, "memory_limit"); /* with the result as far as it came */
  } else if (outcome->attempt.end == ATTEMPT_WORKER_LOST && (said || full)) {
    outcome_set(outcome, ATTEMPT_FAILED, "memory_limit",
                "The solve needs more memory than the %.0f MB that it may use.",
                (double)limit_bytes / 1e6);
  }
}

void outcome_make(struct outcome *outcome, enum attempt_end end, const char *reason_code,
                  const char *format, ...) {
  char message[sizeof outcome->message];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  *outcome = (struct outcome){0};
  outcome_set(outcome, end, reason_code, "%s", message);
  outcome->attempt.exit_code = -1;
}

void outcome_not_started(struct outcome *outcome, const struct error *error) {
  outcome_make(outcome, ATTEMPT_WORKER_LOST, "worker_not_started", "%s", error->message);
}

void outcome_set_unstorable(struct outcome *outcome, const struct error *error) {
  outcome_set(outcome, ATTEMPT_FAILED, "result_refused", "%s", error->message);
  outcome->attempt.result_text = NULL;
  outcome->attempt.result = NULL;
  outcome->attempt.artifacts = NULL;
}

void outcome_set_files_lost(struct outcome *outcome, const struct error *error) {
  outcome_set(outcome, ATTEMPT_WORKER_LOST, "files_not_stored", "%s", error->message);
  outcome->attempt.result_text = NULL;
  outcome->attempt.result = NULL;
  outcome->attempt.artifacts = NULL;
}

void outcome_set_requeued(struct outcome *outcome) {
  char found[sizeof outcome->message];
  snprintf(found, sizeof found, "%s", outcome->message);
  outcome_set(outcome, ATTEMPT_REQUEUED, "disk_failed",
              "The disk was full or failed while the job ran; it will run again. %.200s", found);
}

void outcome_put_back(struct outcome *outcome) {
  outcome_make(outcome, ATTEMPT_REQUEUED, "not_begun",
               "The process that was to solve the job after others ended before; it will run "
               "again.");
}

void outcome_clear(struct outcome *outcome) {
  free(outcome->result_text);
  json_decref(outcome->result);
  json_decref(outcome->artifacts);
  *outcome = (struct outcome){0};
}
