#include "server/exec/bundle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/file.h"
#include "server/base/log.h"
#include "server/exec/members.h"
#include "server/exec/run_internal.h"
#include "solver/job/json.h"

enum { NOBODY = BUNDLE_MEMBERS_MAX };

/* One member and what is known of it. */
struct member {
  const struct claim *claim;
  struct run_paths paths;
  double time_limit_s;
  bool settled; /* its end was told */
};

struct bundle {
  const struct run_settings *settings;
  const struct bundle_hooks *hooks;
  size_t count;
  struct member *member;
  char folder[PATH_MAX], file[PATH_MAX], lines[PATH_MAX], log[PATH_MAX];
  char before[PATH_MAX]; /* states that the first member starts from, "" for none */
  struct process process;
  struct watch watch;
  size_t stopped; /* the member that the process was asked to end for, or NOBODY */
  size_t running; /* or NOBODY */
  bool told;      /* that it runs */
  bool any;       /* some member is done */
  off_t offset;   /* in the lines */
  struct progress_reader reader;
  struct progress progress;
  struct bundle_end end[BUNDLE_MEMBERS_MAX]; /* not told yet */
  size_t ends;
};

static void settle(struct bundle *b, size_t index, const struct outcome *outcome) {
  b->member[index].settled = true;
  b->end[b->ends++] = (struct bundle_end){index, *outcome};
}

static void tell_ends(struct bundle *b) {
  for (size_t i = 0; i < b->ends; i++) { /* the texts have moved with the outcome */
    struct outcome *outcome = &b->end[i].outcome;
    outcome->attempt.reason_code = outcome->reason_code;
    outcome->attempt.message = outcome->message;
  }
  if (b->ends > 0) {
    b->hooks->ended(b->hooks->context, b->end, b->ends);
  }
  for (size_t i = 0; i < b->ends; i++) {
    outcome_clear(&b->end[i].outcome);
  }
  b->ends = 0;
}

/* Settles a member as the process, or its part of it, has ended. A process that was asked to end
 * for the sake of another member ends this one before its time. */
static void judge(struct bundle *b, size_t index, const struct process_end *end) {
  struct member *member = &b->member[index];
  struct outcome outcome;
  struct error error;
  enum stop_cause cause = b->watch.cause;
  bool solved = end->exit_code == 0 || end->exit_code == 3;
  bool meant = b->stopped == index || cause == STOP_SHUTDOWN || cause == STOP_ABORT;
  if (cause != STOP_NONE && !meant && !solved) {
    outcome_put_back(&outcome);
  } else {
    outcome_judge(&outcome, end, meant ? cause : STOP_NONE, member->paths.result,
                  member->paths.artifacts);
    outcome_blame_memory(&outcome, end, b->settings->memory_limit_bytes);
    if (outcome.attempt.result && run_sync(&member->paths, &outcome, &error) != STATUS_OK) {
      outcome_set_files_lost(&outcome, &error);
    }
  }
  settle(b, index, &outcome);
}

/* ---- what the process says ---------------------------------------------------------------- */

static void begin(struct bundle *b, size_t index) {
  const struct member *member = &b->member[index];
  int64_t now = clock_monotonic_ms();
  b->running = index;
  b->told = false;
  b->watch.timeout_at_ms = now + (int64_t)(1000 * member->time_limit_s);
  b->progress = progress_none();
  b->reader = (struct progress_reader){.offset = 0};
  memcpy(b->reader.path, member->paths.events, sizeof b->reader.path);
  pace_start(&b->reader.pace, now);
}

static void done(struct bundle *b, size_t index, const struct process_end *end) {
  b->any = true;
  b->running = NOBODY;
  b->watch.timeout_at_ms = clock_monotonic_ms() + (int64_t)(1000 * b->member[index].time_limit_s);
  if (!b->member[index].settled) {
    judge(b, index, end);
  }
  if (index == 0 && b->before[0]) {
    unlink(b->before);
  }
}

/* Only the member whose turn it is can begin, and only one that has begun can be done. */
static void take_event(void *context, const struct member_event *event) {
  struct bundle *b = context;
  if (!event->done && b->running == NOBODY) {
    begin(b, event->member);
  } else if (event->done && b->running == event->member) {
    done(b, event->member, &event->end);
  }
}

/* ---- the watch ---------------------------------------------------------------------------- */

static enum stop_cause stop_wanted(void *context) {
  struct bundle *b = context;
  enum stop_cause wanted = b->hooks->stop_wanted(b->hooks->context);
  bool open = b->running != NOBODY && !b->member[b->running].settled;
  if (wanted == STOP_NONE && open && b->hooks->cancel_wanted(b->hooks->context, b->running)) {
    wanted = STOP_CANCEL;
  }
  return wanted;
}

/* Members that are cancelled before their turn: without its job the process passes one over. */
static void leave_out(struct bundle *b) {
  for (size_t k = 0; k < b->count; k++) {
    struct member *member = &b->member[k];
    if (!member->settled && k != b->running && b->hooks->cancel_wanted(b->hooks->context, k)) {
      struct process_end end = {.exit_code = -1};
      struct outcome outcome;
      unlink(member->paths.job);
      outcome_judge(&outcome, &end, STOP_CANCEL, member->paths.result, member->paths.artifacts);
      settle(b, k, &outcome);
    }
  }
}

/* Tells what has happened since the last look, and ends the process when that is due. */
static void look(struct bundle *b) {
  const struct bundle_hooks *hooks = b->hooks;
  const struct run_hooks watched = {.context = b, .stop_wanted = stop_wanted};
  members_follow(b->lines, &b->offset, b->count, take_event, b);
  leave_out(b);
  tell_ends(b);
  enum stop_cause before = b->watch.cause;
  bool full = false;
  if (b->running != NOBODY) {
    const struct member *member = &b->member[b->running];
    bool open = !member->settled;
    if (open && !b->told && hooks->begun(hooks->context, b->running, b->process.pid) != STATUS_OK) {
      b->watch.cause = STOP_CANCEL;
      b->watch.kill_at_ms = clock_monotonic_ms() + GRACE_MS;
      process_terminate(&b->process);
    }
    b->told = true;
    if (open && progress_poll(&b->reader, &b->progress)) {
      hooks->progressed(hooks->context, b->running, &b->progress);
    }
    full = run_files_full(b->settings, &member->paths, &b->watch);
  }
  run_watch_step(&b->watch, &watched, full, &b->process);
  if (before == STOP_NONE && b->watch.cause != STOP_NONE) {
    b->stopped = b->running;
  }
}

/* Whatever has not ended by itself ends with the process. */
static void settle_rest(struct bundle *b, const struct process_end *end) {
  bool charged = false;
  members_follow(b->lines, &b->offset, b->count, take_event, b);
  for (size_t k = 0; k < b->count; k++) {
    struct outcome outcome;
    if (b->member[k].settled) {
      continue;
    }
    bool blamed = b->running == k || (b->running == NOBODY && !b->any && !charged);
    if (blamed) {
      charged = true;
      b->stopped = b->stopped == NOBODY ? k : b->stopped;
      judge(b, k, end);
    } else {
      outcome_put_back(&outcome);
      settle(b, k, &outcome);
    }
  }
  tell_ends(b);
}

/* ---- start -------------------------------------------------------------------------------- */

/* The states that the member before the first one has left, copied to where the process may read
 * them. */
static void take_before(struct bundle *b, char path[PATH_MAX]) {
  const struct claim *first = b->member[0].claim;
  char name[RUN_DIRECTORY_SIZE], folder[PATH_MAX], *data = NULL;
  size_t size;
  if (first->before_id == 0) {
    path[0] = '\0';
    return;
  }
  run_directory(first->before_id, first->before_attempt, name);
  bool there = run_path(folder, b->settings->data, name) && run_path(b->before, folder, "path") &&
               run_path(path, b->folder, "path") &&
               file_read(b->before, OUTPUT_BYTES_MAX, &data, &size, NULL) == STATUS_OK &&
               file_write(path, data, size, NULL) == STATUS_OK;
  if (!there) {
    b->before[0] = path[0] = '\0';
  }
  free(data);
}

/* The bundle's own folder with the list of its members. */
static enum status write_list(struct bundle *b, struct error *error) {
  const struct claim *first = b->member[0].claim;
  char name[80], before[PATH_MAX];
  snprintf(name, sizeof name, BUNDLE_FOLDER "/%lld-%lld", (long long)first->job_id,
           (long long)first->attempt);
  if (!run_path(b->folder, b->settings->data, name) ||
      !run_path(b->file, b->folder, "bundle.json") ||
      !run_path(b->lines, b->folder, "members.jsonl") || !run_path(b->log, b->folder, "log.txt")) {
    return error_set(error, STATUS_TOO_LARGE, NULL, "The path of the data directory is too long.");
  }
  file_remove_tree(b->folder);
  enum status status = file_make_directory(b->folder, error);
  if (status != STATUS_OK) {
    return status;
  }
  take_before(b, before);
  json_t *list = json_array();
  for (size_t k = 0; k < b->count; k++) {
    json_array_append_new(list, json_string(b->member[k].paths.directory));
  }
  json_t *document = json_pack("{s:o, s:s*}", "members", list, "from", before[0] ? before : NULL);
  char *text = document ? json_dumps(document, JSON_INDENT(1)) : NULL;
  status = text ? file_write(b->file, text, strlen(text), error)
                : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a bundle.");
  free(text);
  json_decref(document);
  return status;
}

static enum status start(struct bundle *b, struct error *error) {
  const char *argv[] = {b->settings->solver, "--threads", "1", "--bundle", b->file, NULL};
  const char *folders[PROCESS_FOLDERS_MAX + 1] = {b->folder};
  double cpu_s = 0;
  enum status status = STATUS_OK;
  for (size_t k = 0; k < b->count && status == STATUS_OK; k++) {
    struct member *member = &b->member[k];
    status = run_prepare(b->settings, member->claim, &member->paths, error);
    folders[1 + k] = member->paths.directory;
    cpu_s += ceil(member->time_limit_s) + 1;
  }
  if (status == STATUS_OK) {
    status = write_list(b, error);
  }
  struct process_limits limits = {.memory_bytes = b->settings->memory_limit_bytes,
                                  .cpu_s = (uint64_t)cpu_s,
                                  .file_bytes = OUTPUT_BYTES_MAX,
                                  .descriptors = DESCRIPTORS_MAX,
                                  .processes = PROCESSES_MAX};
  if (status == STATUS_OK) {
    status = process_start(argv, b->lines, b->log, folders, &limits, b->settings->isolation,
                           &b->process, error);
  }
  return status;
}

static void not_started(struct bundle *b, const struct error *error) {
  struct outcome outcome;
  log_event(LOG_LEVEL_ERROR, error->message, LOG_NUMBER("job", b->member[0].claim->job_id),
            LOG_NUMBER("attempt", b->member[0].claim->attempt));
  for (size_t k = 0; k < b->count; k++) {
    if (k == 0) {
      outcome_not_started(&outcome, error);
    } else {
      outcome_put_back(&outcome);
    }
    settle(b, k, &outcome);
  }
  tell_ends(b);
}

void bundle_run(const struct run_settings *settings, const struct claim *const *members,
                size_t count, const struct bundle_hooks *hooks) {
  struct error error = {.status = STATUS_OK};
  struct process_end end;
  struct bundle *b = calloc(1, sizeof *b);
  struct member *list = calloc(count, sizeof *list);
  if (!b || !list) {
    error_set(&error, STATUS_NO_MEMORY, NULL, "No memory for a bundle of jobs.");
  } else {
    *b = (struct bundle){.settings = settings,
                         .hooks = hooks,
                         .count = count,
                         .member = list,
                         .stopped = NOBODY,
                         .running = NOBODY};
    for (size_t k = 0; k < count; k++) {
      double own = members[k]->timeout_s;
      list[k].claim = members[k];
      list[k].time_limit_s = (own > 0 ? own : settings->time_limit_s) + settings->timeout_margin_s;
    }
    b->watch.timeout_at_ms = clock_monotonic_ms() + (int64_t)(1000 * list[0].time_limit_s);
    if (start(b, &error) != STATUS_OK) {
      not_started(b, &error);
    } else {
      int wait_ms = POLL_FIRST_MS;
      while (!process_wait(&b->process, wait_ms, &end)) {
        wait_ms = wait_ms < POLL_MS ? wait_ms * 2 : POLL_MS;
        look(b);
      }
      settle_rest(b, &end);
    }
    file_remove_tree(b->folder);
  }
  free(list);
  free(b);
}
