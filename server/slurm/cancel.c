/* Requests to end, on their way to the tasks. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/file.h"
#include "server/base/log.h"
#include "server/slurm/slurm_internal.h"

enum { TASK_NAME_SIZE = 40, RETRY_AFTER_MS = 2000 };

/* Tasks that are to be told in one call. */
struct calls {
  struct slurm *slurm;
  bool member; /* by a signal to their scripts */
  size_t count;
  struct slurm_task *task[SLURM_SCANCEL_MAX];
};

static void calls_flush(struct calls *calls) {
  char text[SLURM_SCANCEL_MAX][TASK_NAME_SIZE];
  const char *names[SLURM_SCANCEL_MAX] = {NULL};
  struct error error;
  size_t count = calls->count;
  calls->count = 0;
  if (count == 0 || !slurm_answers(calls->slurm)) {
    return; /* what is to be killed is looked at again */
  }
  for (size_t i = 0; i < count; i++) {
    snprintf(text[i], sizeof text[i], "%lld_%u", (long long)calls->task[i]->batch->cluster_job,
             calls->task[i]->index);
    names[i] = text[i];
  }
  enum status status = slurm_cancel(&calls->slurm->client, names, count, calls->member, &error);
  if (status != STATUS_OK) {
    slurm_note_answer(calls->slurm, &error);
    return;
  }
  for (size_t i = 0; i < count; i++) {
    calls->task[i]->killed = calls->task[i]->killed || !calls->member;
  }
  slurm_poll_soon(calls->slurm, RETRY_AFTER_MS);
}

static void calls_add(struct calls *calls, struct slurm_task *task) {
  if (calls->count == SLURM_SCANCEL_MAX) {
    calls_flush(calls);
  }
  calls->task[calls->count++] = task;
}

/* Leaves the mark that the solver looks for when it gets the signal. */
static void mark(struct slurm_task *task, const struct slurm_member *member) {
  struct run_paths *paths = malloc(sizeof *paths);
  char path[PATH_MAX];
  struct error error;
  if (paths && member_paths(task->batch->slurm, member, paths) &&
      run_path(path, paths->directory, "cancel") && file_write(path, "", 0, &error) != STATUS_OK) {
    log_event(LOG_LEVEL_ERROR, error.message, LOG_NUMBER("job", member->job_id));
  }
  free(paths);
}

/* Deals with the members of a task that are to end. */
static void cancel_members(struct slurm_task *task, struct calls *signals) {
  struct slurm *slurm = task->batch->slurm;
  int running = task->follow ? task->follow->running : NO_MEMBER;
  for (size_t k = 0; k < task->count; k++) {
    struct slurm_member *member = &task->member[k];
    pthread_mutex_lock(&slurm->mutex);
    bool wanted = member->cancel && !member->told;
    pthread_mutex_unlock(&slurm->mutex);
    if (!wanted || member->settled) {
      continue;
    }
    if (running == (int)k) {
      mark(task, member);
      member->told = true;
      task->follow->kill_at_ms = clock_monotonic_ms() + GRACE_MS;
      calls_add(signals, task);
    } else {
      task_leave_out(task, k);
    }
  }
}

/* Whether the task as a whole is to end: it has nothing to do any more, or does not let go of the
 * member that is to end. */
static void look_at_task(struct slurm_task *task, int64_t now) {
  const struct slurm_follow *follow = task->follow;
  if (task->cause != STOP_NONE) {
    return;
  }
  if (task->open == 0 && task->phase == TASK_WAITS) {
    task->cause = STOP_CANCEL;
  } else if (follow && follow->kill_at_ms != 0 && now >= follow->kill_at_ms &&
             follow->running != NO_MEMBER) {
    task->cause = STOP_CANCEL;
    task->stopped = follow->running;
  }
}

/* Members of a batch whose attempts are not open any more. */
static void recall_batch(struct slurm_batch *batch) {
  struct slurm *slurm = batch->slurm;
  struct cluster_attempt *open = NULL;
  size_t count = 0, at = 0;
  if (store_batch_attempts(slurm->settings.engine.store, batch->id, &open, &count, NULL) !=
      STATUS_OK) {
    return;
  }
  for (size_t i = 0; i < batch->count; i++) {
    struct slurm_task *task = &batch->task[i];
    for (size_t k = 0; k < task->count; k++) {
      struct slurm_member *member = &task->member[k];
      while (at < count && (open[at].task < (int64_t)i ||
                            (open[at].task == (int64_t)i && open[at].place < (int64_t)k))) {
        at++;
      }
      bool there = at < count && open[at].task == (int64_t)i && open[at].place == (int64_t)k;
      if (!there && !member->settled) {
        pthread_mutex_lock(&slurm->mutex);
        member->gone = member->cancel = slurm->cancels = true;
        pthread_mutex_unlock(&slurm->mutex);
      }
    }
  }
  free(open);
}

void slurm_recall(struct slurm *slurm) {
  pthread_mutex_lock(&slurm->mutex);
  bool wanted = slurm->recall;
  slurm->recall = false;
  pthread_mutex_unlock(&slurm->mutex);
  if (!wanted) {
    return;
  }
  ends_flush(slurm);
  for (struct slurm_batch *batch = slurm->first; batch; batch = batch->next) {
    recall_batch(batch);
  }
}

void slurm_cancels(struct slurm *slurm) {
  struct calls *kills = calloc(1, sizeof *kills), *signals = calloc(1, sizeof *signals);
  int64_t now = clock_monotonic_ms();
  pthread_mutex_lock(&slurm->mutex);
  bool cancels = slurm->cancels;
  slurm->cancels = false;
  pthread_mutex_unlock(&slurm->mutex);
  for (struct slurm_batch *batch = slurm->first; batch && kills && signals; batch = batch->next) {
    for (size_t i = 0; i < batch->count; i++) {
      struct slurm_task *task = &batch->task[i];
      kills->slurm = signals->slurm = slurm;
      signals->member = true;
      if (task->phase == TASK_OVER) {
        continue;
      }
      if (cancels) {
        cancel_members(task, signals);
      }
      look_at_task(task, now);
      if (batch->cluster_job != 0 && task->cause != STOP_NONE && !task->killed) {
        calls_add(kills, task);
      }
    }
  }
  if (kills && signals) {
    calls_flush(signals);
    calls_flush(kills);
  }
  free(kills);
  free(signals);
}
