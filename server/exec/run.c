#include "server/exec/run_internal.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/file.h"
#include "server/base/log.h"

void run_directory(int64_t job_id, int64_t attempt, char name[RUN_DIRECTORY_SIZE]) {
  snprintf(name, RUN_DIRECTORY_SIZE, "attempts/%lld-%lld", (long long)job_id, (long long)attempt);
}

bool run_path(char path[PATH_MAX], const char *directory, const char *name) {
  int length = snprintf(path, PATH_MAX, "%s/%s", directory, name);
  return length > 0 && length < PATH_MAX;
}

enum status run_paths_make(const char *data, int64_t job_id, int64_t attempt,
                           struct run_paths *paths, struct error *error) {
  char name[RUN_DIRECTORY_SIZE];
  run_directory(job_id, attempt, name);
  if (!run_path(paths->directory, data, name) ||
      !run_path(paths->job, paths->directory, "job.json") ||
      !run_path(paths->events, paths->directory, "events.jsonl") ||
      !run_path(paths->log, paths->directory, "log.txt") ||
      !run_path(paths->output, paths->directory, "result.json.part") ||
      !run_path(paths->result, paths->directory, "result.json") ||
      !run_path(paths->artifacts, paths->directory, "out")) {
    return error_set(error, STATUS_TOO_LARGE, NULL, "The path of the data directory is too long.");
  }
  return STATUS_OK;
}

enum status run_folder_make(const struct run_paths *paths, const char *document,
                            struct error *error) {
  file_remove_tree(paths->directory);
  enum status status = file_make_directory(paths->artifacts, error);
  return status == STATUS_OK ? file_write(paths->job, document, strlen(document), error) : status;
}

enum status run_prepare(const struct run_settings *settings, const struct claim *claim,
                        struct run_paths *paths, struct error *error) {
  enum status status = run_paths_make(settings->data, claim->job_id, claim->attempt, paths, error);
  return status == STATUS_OK ? run_folder_make(paths, claim->document, error) : status;
}

static enum status run_start(const struct run_settings *settings, const struct run_paths *paths,
                             double time_limit_s, struct process *process, struct error *error) {
  const char *argv[] = {settings->solver, "--out", paths->artifacts, "--events", paths->events,
                        "--threads",      "1",     paths->job,       NULL};
  struct process_limits limits = {.memory_bytes = settings->memory_limit_bytes,
                                  .cpu_s = (uint64_t)ceil(time_limit_s) + 1,
                                  .file_bytes = OUTPUT_BYTES_MAX,
                                  .descriptors = DESCRIPTORS_MAX,
                                  .processes = PROCESSES_MAX};
  const char *folders[] = {paths->directory, NULL};
  return process_start(argv, paths->output, paths->log, folders, &limits, settings->isolation,
                       process, error);
}

bool run_files_full(const struct run_settings *settings, const struct run_paths *paths,
                    struct watch *watch) {
  int64_t before = clock_monotonic_ms();
  if (settings->files_limit_bytes == 0 || before < watch->measure_at_ms) {
    return false;
  }
  int64_t bytes = file_tree_bytes(paths->directory);
  int64_t now = clock_monotonic_ms();
  watch->measure_at_ms = now + MEASURE_MS + MEASURE_SHARE * (now - before);
  return bytes > 0 && (uint64_t)bytes > settings->files_limit_bytes;
}

void run_watch_step(struct watch *watch, const struct run_hooks *hooks, bool files_full,
                    struct process *process) {
  int64_t now = clock_monotonic_ms();
  enum stop_cause wanted = hooks->stop_wanted(hooks->context);
  if (wanted == STOP_NONE && now >= watch->timeout_at_ms) {
    wanted = STOP_TIMEOUT;
  }
  if (wanted == STOP_NONE && files_full) {
    wanted = STOP_FILES;
  }
  if (wanted == STOP_ABORT || wanted == STOP_FILES) {
    watch->cause = wanted == STOP_FILES        ? wanted
                   : watch->cause == STOP_NONE ? STOP_SHUTDOWN
                                               : watch->cause;
    process_kill(process);
  } else if (watch->cause == STOP_NONE && wanted != STOP_NONE) {
    watch->cause = wanted;
    watch->kill_at_ms = now + GRACE_MS;
    process_terminate(process);
  } else if (watch->cause != STOP_NONE && now >= watch->kill_at_ms) {
    process_kill(process);
  }
}

static enum stop_cause run_watch(const struct run_settings *settings, const struct run_hooks *hooks,
                                 const struct run_paths *paths, double time_limit_s,
                                 struct process *process, struct process_end *end) {
  struct progress_reader reader = {.offset = 0};
  memcpy(reader.path, paths->events, sizeof reader.path);
  struct progress progress = progress_none();
  pace_start(&reader.pace, clock_monotonic_ms());
  struct watch watch = {.timeout_at_ms = clock_monotonic_ms() + (int64_t)(1000 * time_limit_s)};
  if (hooks->started(hooks->context, process->pid) != STATUS_OK) {
    watch.cause = STOP_CANCEL;
    watch.kill_at_ms = clock_monotonic_ms() + GRACE_MS;
    process_terminate(process);
  }
  int wait_ms = POLL_FIRST_MS;
  while (!process_wait(process, wait_ms, end)) {
    wait_ms = wait_ms < POLL_MS ? wait_ms * 2 : POLL_MS;
    if (progress_poll(&reader, &progress)) {
      hooks->progressed(hooks->context, &progress);
    }
    run_watch_step(&watch, hooks, run_files_full(settings, paths, &watch), process);
  }
  return watch.cause;
}

enum status run_sync(const struct run_paths *paths, const struct outcome *outcome,
                     struct error *error) {
  char path[PATH_MAX];
  const char *name;
  json_t *size;
  enum status status = STATUS_OK;
  if (json_object_size(outcome->artifacts) == 0) {
    return STATUS_OK;
  }
  json_object_foreach(outcome->artifacts, name, size) {
    if (status == STATUS_OK && run_path(path, paths->artifacts, name)) {
      status = file_sync(path, error);
    }
  }
  if (status == STATUS_OK) {
    status = file_sync(paths->artifacts, error);
  }
  if (status == STATUS_OK) {
    status = file_sync(paths->directory, error);
  }
  return status == STATUS_OK ? file_sync_parent(paths->directory, error) : status;
}

void run_attempt(const struct run_settings *settings, const struct claim *claim,
                 const struct run_hooks *hooks, struct outcome *outcome) {
  struct error error = {.status = STATUS_OK};
  struct run_paths paths;
  struct process process;
  struct process_end end;
  double time_limit_s = claim->timeout_s > 0 ? claim->timeout_s : settings->time_limit_s;
  time_limit_s += settings->timeout_margin_s;
  enum status status = run_prepare(settings, claim, &paths, &error);
  if (status == STATUS_OK) {
    status = run_start(settings, &paths, time_limit_s, &process, &error);
  }
  if (status != STATUS_OK) {
    log_event(LOG_LEVEL_ERROR, error.message, LOG_NUMBER("job", claim->job_id),
              LOG_NUMBER("attempt", claim->attempt));
    outcome_not_started(outcome, &error);
    return;
  }
  enum stop_cause cause = run_watch(settings, hooks, &paths, time_limit_s, &process, &end);
  const char *output = paths.output;
  if (end.exit_code >= 0 && rename(paths.output, paths.result) == 0) {
    output = paths.result;
  }
  outcome_judge(outcome, &end, cause, output, paths.artifacts);
  outcome_blame_memory(outcome, &end, settings->memory_limit_bytes);
  if (outcome->attempt.result && run_sync(&paths, outcome, &error) != STATUS_OK) {
    outcome_set_files_lost(outcome, &error);
  }
}
