/* One task: what it writes, and what that means for its members. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/exec/members.h"
#include "server/slurm/slurm_internal.h"

enum { LOOKS_MAX = 64 };

bool member_paths(const struct slurm *slurm, const struct slurm_member *member,
                  struct run_paths *paths) {
  return run_paths_make(slurm->data, member->job_id, member->attempt, paths, NULL) == STATUS_OK;
}

/* The limit of memory of the task's processes. */
static uint64_t memory_limit(const struct slurm_task *task) {
  return task->batch->memory_bytes;
}

/* ---- what members come to ----------------------------------------------------------------- */

static void put_back(struct slurm_task *task, size_t index) {
  struct outcome outcome;
  outcome_put_back(&outcome);
  ends_add(task->batch->slurm, &task->member[index], &outcome);
}

/* Settles a member by how its part of the solver has ended. */
static void judge(struct slurm_task *task, size_t index, const struct process_end *end,
                  enum stop_cause cause) {
  struct slurm_member *member = &task->member[index];
  struct run_paths *paths = malloc(sizeof *paths);
  struct outcome outcome;
  struct error error;
  if (!paths || !member_paths(task->batch->slurm, member, paths)) {
    put_back(task, index);
    free(paths);
    return;
  }
  outcome_judge(&outcome, end, cause, paths->result, paths->artifacts);
  outcome_blame_memory(&outcome, end, memory_limit(task));
  if (outcome.attempt.result && run_sync(paths, &outcome, &error) != STATUS_OK) {
    outcome_set_files_lost(&outcome, &error);
  }
  free(paths);
  ends_add(task->batch->slurm, member, &outcome);
}

void task_leave_out(struct slurm_task *task, size_t index) {
  struct slurm_member *member = &task->member[index];
  struct process_end end = {.exit_code = -1};
  struct run_paths *paths = malloc(sizeof *paths);
  if (paths && member_paths(task->batch->slurm, member, paths)) {
    unlink(paths->job);
  }
  free(paths);
  member->told = true;
  judge(task, index, &end, STOP_CANCEL);
}

/* ---- what the solver says ----------------------------------------------------------------- */

void task_begun(struct slurm_task *task) {
  struct slurm *slurm = task->batch->slurm;
  struct slurm_follow *follow = calloc(1, sizeof *follow);
  if (!follow) {
    return; /* without memory now it is found at the next look */
  }
  follow->running = NO_MEMBER;
  follow->progress = progress_none();
  follow->watch.timeout_at_ms = INT64_MAX;
  pthread_mutex_lock(&slurm->mutex);
  task->follow = follow;
  task->phase = TASK_RUNS;
  task->state = SLURM_RUNNING;
  task->reason[0] = '\0';
  slurm->tasks_waiting--;
  slurm->tasks_running++;
  pthread_mutex_unlock(&slurm->mutex);
}

static void begin(struct slurm_task *task, int index) {
  struct slurm *slurm = task->batch->slurm;
  struct slurm_follow *follow = task->follow;
  struct slurm_member *member = &task->member[index];
  struct run_paths *paths = malloc(sizeof *paths);
  int64_t now = clock_monotonic_ms();
  pthread_mutex_lock(&slurm->mutex);
  follow->running = index;
  follow->progress = progress_none();
  pthread_mutex_unlock(&slurm->mutex);
  follow->kill_at_ms = 0;
  follow->watch = (struct watch){.timeout_at_ms = now + (int64_t)(1000 * member->time_limit_s)};
  follow->reader = (struct progress_reader){.offset = 0};
  pace_start(&follow->reader.pace, now);
  if (paths && member_paths(slurm, member, paths)) {
    memcpy(follow->reader.path, paths->events, sizeof follow->reader.path);
  }
  free(paths);
  member->job.start_ms = now;
}

static void done(struct slurm_task *task, int index, const struct process_end *end) {
  struct slurm *slurm = task->batch->slurm;
  pthread_mutex_lock(&slurm->mutex);
  task->follow->running = NO_MEMBER;
  bool cancel = task->member[index].cancel && task->member[index].told;
  pthread_mutex_unlock(&slurm->mutex);
  task->follow->any = true;
  int64_t start_ms =
      clock_monotonic_ms() - (int64_t)(1000 * end->cpu_s); /* it may have begun and */
  if (task->member[index].job.start_ms > start_ms) {       /* ended between two looks */
    task->member[index].job.start_ms = start_ms;
  }
  if (!task->member[index].settled) {
    judge(task, (size_t)index, end, cancel ? STOP_CANCEL : STOP_NONE);
  }
}

/* Only the member whose turn it is can begin, and only one that has begun can be done. */
static void take_event(void *context, const struct member_event *event) {
  struct slurm_task *task = context;
  int index = (int)event->member;
  if (!event->done && task->follow->running == NO_MEMBER) {
    begin(task, index);
  } else if (event->done && task->follow->running == index) {
    done(task, index, &event->end);
  }
}

void task_read(struct slurm_task *task) {
  char path[PATH_MAX], name[64];
  snprintf(name, sizeof name, "%u/members.jsonl", task->index);
  bool more = run_path(path, task->batch->folder, name);
  for (int i = 0; more && i < LOOKS_MAX; i++) {
    more = members_follow(path, &task->follow->offset, task->count, take_event, task);
  }
}

/* ---- the watch ---------------------------------------------------------------------------- */

/* Notes in the database that the member runs; one that is to run no more is cancelled. */
static void note_running(struct slurm_task *task, struct slurm_member *member) {
  struct slurm *slurm = task->batch->slurm;
  const struct engine_settings *settings = &slurm->settings.engine;
  struct error error;
  enum status status =
      store_attempt_running(settings->store, member->job_id, member->attempt, 0, &error);
  member->noted = true;
  if (status == STATUS_OK) {
    settings->changed(settings->context, member->job_id);
  } else if (status == STATUS_CONFLICT) { /* it is cancelled, or was taken back */
    pthread_mutex_lock(&slurm->mutex);
    member->cancel = slurm->recall = true;
    slurm->cancels = true;
    pthread_mutex_unlock(&slurm->mutex);
  } else {
    log_event(LOG_LEVEL_ERROR, error.message, LOG_NUMBER("job", member->job_id));
  }
}

static void report_progress(struct slurm_task *task, const struct slurm_member *member) {
  struct slurm *slurm = task->batch->slurm;
  const struct engine_settings *settings = &slurm->settings.engine;
  struct progress progress = task->follow->progress;
  if (progress_poll(&task->follow->reader, &progress)) {
    pthread_mutex_lock(&slurm->mutex);
    task->follow->progress = progress;
    pthread_mutex_unlock(&slurm->mutex);
    settings->progressed(settings->context, member->job_id, member->attempt, &progress);
  }
}

static bool files_full(struct slurm_task *task, const struct slurm_member *member) {
  const struct engine_settings *settings = &task->batch->slurm->settings.engine;
  const struct run_settings limits = {.files_limit_bytes = settings->files_limit_bytes};
  struct run_paths *paths = malloc(sizeof *paths);
  bool full = paths && member_paths(task->batch->slurm, member, paths) &&
              run_files_full(&limits, paths, &task->follow->watch);
  free(paths);
  return full;
}

void task_watch(struct slurm_task *task, bool progress) {
  struct slurm_follow *follow = task->follow;
  int64_t now = clock_monotonic_ms();
  if (follow->running == NO_MEMBER || task->member[follow->running].settled) {
    return;
  }
  struct slurm_member *member = &task->member[follow->running];
  if (!member->noted) {
    note_running(task, member);
  }
  if (progress) {
    report_progress(task, member);
  }
  if (task->cause == STOP_NONE && now >= follow->watch.timeout_at_ms) {
    task->cause = STOP_TIMEOUT;
    task->stopped = follow->running;
  } else if (task->cause == STOP_NONE && progress && files_full(task, member)) {
    task->cause = STOP_FILES;
    task->stopped = follow->running;
  }
}

/* ---- the end ------------------------------------------------------------------------------ */

/* The member that the end of the task is charged to: the one that was being solved, or the first
 * when none was ever done; NO_MEMBER when it falls between two. */
static int blamed(const struct slurm_task *task) {
  int running = task->follow ? task->follow->running : NO_MEMBER;
  if (running != NO_MEMBER) {
    return task->member[running].settled ? NO_MEMBER : running;
  }
  for (size_t k = 0; k < task->count && !(task->follow && task->follow->any); k++) {
    if (!task->member[k].settled) {
      return (int)k;
    }
  }
  return NO_MEMBER;
}

static void put_back_rest(struct slurm_task *task) {
  for (size_t k = 0; k < task->count; k++) {
    if (!task->member[k].settled) {
      put_back(task, k);
    }
  }
}

static void task_over(struct slurm_task *task, enum slurm_state state) {
  struct slurm *slurm = task->batch->slurm;
  pthread_mutex_lock(&slurm->mutex);
  if (task->phase == TASK_WAITS) {
    slurm->tasks_waiting--;
  } else {
    slurm->tasks_running--;
  }
  task->phase = TASK_OVER;
  task->state = state;
  task->batch->open--;
  pthread_mutex_unlock(&slurm->mutex);
}

void task_ended(struct slurm_task *task, const struct process_end *end) {
  if (!task->follow) {
    task_begun(task);
  }
  if (!task->follow) {
    return;
  }
  task_read(task);
  int charged = blamed(task);
  bool meant = task->cause != STOP_NONE && task->stopped == charged;
  if (charged != NO_MEMBER && (meant || task->cause == STOP_NONE)) {
    judge(task, (size_t)charged, end, meant ? task->cause : STOP_NONE);
  }
  put_back_rest(task);
  task_over(task, end->exit_code == 0 ? SLURM_COMPLETED : SLURM_FAILED);
}

/* The outcome of a member whose task is gone. Who is not to blame for it is put back, but not for
 * ever: a job may be what brings nodes down. */
static void lose(struct slurm_task *task, int charged, enum slurm_state state, const char *node) {
  struct slurm_member *member = &task->member[charged];
  struct outcome outcome;
  enum attempt_end lost =
      member->attempt < STORE_ATTEMPTS_MAX ? ATTEMPT_REQUEUED : ATTEMPT_WORKER_LOST;
  const char *at = node[0] ? node : "a node";
  switch (state) {
  case SLURM_NODE_LOST:
    outcome_make(&outcome, lost, "node_lost",
                 "The cluster lost %s, or gave it away, while the job was there.", at);
    break;
  case SLURM_UNKNOWN:
    outcome_make(&outcome, lost, "task_lost", "The cluster knows nothing of the task any more.");
    break;
  case SLURM_OUT_OF_MEMORY:
    outcome_make(&outcome, ATTEMPT_FAILED, "memory_limit",
                 "The solve needs more memory than its task has on the cluster.");
    break;
  case SLURM_CANCELLED:
    outcome_make(&outcome, ATTEMPT_WORKER_LOST, "task_cancelled",
                 "Somebody cancelled the task on the cluster.");
    break;
  default:
    outcome_make(&outcome, ATTEMPT_WORKER_LOST, "task_failed",
                 "The task ended on %s without a word: its processes were killed, or the solver or "
                 "the data folder is not there.",
                 at);
  }
  ends_add(task->batch->slurm, member, &outcome);
}

void task_lost(struct slurm_task *task, enum slurm_state state, const char *node) {
  struct process_end end = {.exit_code = -1, .signal = SIGKILL};
  if (task->follow) {
    task_read(task);
  }
  int charged = blamed(task);
  if (charged != NO_MEMBER && task->cause != STOP_NONE) {
    if (task->stopped == charged) {
      judge(task, (size_t)charged, &end, task->cause);
    }
  } else if (charged != NO_MEMBER && state == SLURM_TIMED_OUT) {
    judge(task, (size_t)charged, &end, STOP_TIMEOUT);
  } else if (charged != NO_MEMBER) {
    lose(task, charged, state, node);
  }
  put_back_rest(task);
  task_over(task, state);
}
