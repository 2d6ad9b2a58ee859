/* A job array: its tasks, its folder, its end. */
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "server/base/file.h"
#include "server/base/log.h"
#include "server/slurm/index.h"
#include "server/slurm/slurm_internal.h"

/* Looks at a folder after its last change: a clock that is coarse, or a cache of the file system,
 * may hide an entry that came at the same time. */
enum { LOOKS_AGAIN = 8 };

enum status batch_create(struct slurm *slurm, size_t tasks, struct slurm_batch **batch,
                         struct error *error) {
  struct slurm_batch *made = calloc(1, sizeof *made);
  struct slurm_task *task = calloc(tasks, sizeof *task);
  if (!made || !task) {
    free(made);
    free(task);
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a batch of jobs.");
  }
  made->slurm = slurm;
  made->count = made->open = tasks;
  made->task = task;
  for (size_t i = 0; i < tasks; i++) {
    task[i].batch = made;
    task[i].index = (unsigned)i;
    task[i].stopped = NO_MEMBER;
    task[i].state = SLURM_PENDING;
  }
  *batch = made;
  return STATUS_OK;
}

enum status task_create(struct slurm_task *task, size_t count, struct error *error) {
  task->member = calloc(count ? count : 1, sizeof *task->member);
  if (!task->member) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a batch of jobs.");
  }
  task->count = count;
  for (size_t k = 0; k < count; k++) {
    task->member[k].task = task;
  }
  return STATUS_OK;
}

void batch_free(struct slurm_batch *batch) {
  if (!batch) {
    return;
  }
  for (size_t i = 0; i < batch->count; i++) {
    free(batch->task[i].member);
    free(batch->task[i].follow);
  }
  free(batch->task);
  free(batch);
}

void batch_enlist(struct slurm_batch *batch) {
  struct slurm *slurm = batch->slurm;
  struct slurm_batch **last = &slurm->first;
  struct error error;
  while (*last) {
    last = &(*last)->next;
  }
  pthread_mutex_lock(&slurm->mutex);
  *last = batch;
  for (size_t i = 0; i < batch->count; i++) {
    struct slurm_task *task = &batch->task[i];
    for (size_t k = 0; k < task->count; k++) {
      struct slurm_member *member = &task->member[k];
      if (!member->settled) {
        task->open++;
        slurm->members++;
        if (index_add(&slurm->index, member, &error) != STATUS_OK) { /* it is only not shown */
          log_event(LOG_LEVEL_ERROR, error.message, LOG_NUMBER("job", member->job_id));
        }
      }
    }
    slurm->tasks_waiting++;
  }
  pthread_mutex_unlock(&slurm->mutex);
}

void batch_drop(struct slurm_batch *batch) {
  struct slurm *slurm = batch->slurm;
  struct slurm_batch **at = &slurm->first;
  struct error error;
  ends_flush(slurm); /* it has members of this batch */
  while (*at && *at != batch) {
    at = &(*at)->next;
  }
  pthread_mutex_lock(&slurm->mutex);
  if (*at) {
    *at = batch->next;
  }
  pthread_mutex_unlock(&slurm->mutex);
  if (store_batch_ended(slurm->settings.engine.store, batch->id, &error) != STATUS_OK) {
    log_event(LOG_LEVEL_ERROR, error.message, LOG_TEXT("batch", batch->name));
  }
  file_remove_tree(batch->folder);
  batch_free(batch);
}

void batch_give_up(struct slurm_batch *batch, const char *reason, const char *message) {
  for (size_t i = 0; i < batch->count; i++) {
    struct slurm_task *task = &batch->task[i];
    for (size_t k = 0; k < task->count; k++) {
      struct outcome outcome;
      if (!task->member[k].settled) {
        outcome_make(&outcome, ATTEMPT_REQUEUED, reason, "%s", message);
        ends_add(batch->slurm, &task->member[k], &outcome);
      }
    }
    if (task->phase != TASK_OVER) {
      pthread_mutex_lock(&batch->slurm->mutex);
      if (task->phase == TASK_WAITS) {
        batch->slurm->tasks_waiting--;
      } else {
        batch->slurm->tasks_running--;
      }
      task->phase = TASK_OVER;
      batch->open--;
      pthread_mutex_unlock(&batch->slurm->mutex);
    }
  }
  batch_drop(batch);
}

/* ---- marks -------------------------------------------------------------------------------- */

/* Whether a folder of marks is to be read: it has changed, or did so a moment ago. */
static bool marks_changed(const char *path, struct timespec *seen, int *again) {
  struct stat info;
  if (stat(path, &info) != 0) {
    return false;
  }
  if (info.st_mtim.tv_sec != seen->tv_sec || info.st_mtim.tv_nsec != seen->tv_nsec) {
    *seen = info.st_mtim;
    *again = LOOKS_AGAIN;
  }
  return *again > 0 && (*again)-- > 0;
}

/* The task that a mark is of, NULL for other names. */
static struct slurm_task *marked(const struct slurm_batch *batch, const char *name) {
  char *end;
  errno = 0;
  unsigned long index = strtoul(name, &end, 10);
  bool good = name[0] >= '0' && name[0] <= '9' && *end == '\0' && errno == 0;
  return good && index < batch->count ? &batch->task[index] : NULL;
}

static void take_begun(struct slurm_task *task, const char *path) {
  (void)path;
  if (task->phase == TASK_WAITS) {
    task_begun(task);
  }
}

/* The shell's number for the end of the solver: 128 and more for signals. */
static void take_ended(struct slurm_task *task, const char *path) {
  char *text = NULL;
  size_t size;
  if (task->phase == TASK_OVER || file_read(path, 64, &text, &size, NULL) != STATUS_OK) {
    return;
  }
  int code = atoi(text);
  struct process_end end = {.exit_code = code > 128 ? -1 : code,
                            .signal = code > 128 ? code - 128 : 0};
  free(text);
  task_ended(task, &end);
}

static bool read_marks(struct slurm_batch *batch, const char *name,
                       void (*take)(struct slurm_task *task, const char *path),
                       struct timespec *seen, int *again) {
  char folder[PATH_MAX], path[PATH_MAX];
  bool any = false;
  if (!run_path(folder, batch->folder, name) || !marks_changed(folder, seen, again)) {
    return false;
  }
  DIR *marks = opendir(folder);
  const struct dirent *entry;
  while (marks && (entry = readdir(marks))) {
    struct slurm_task *task = marked(batch, entry->d_name);
    enum slurm_phase before = task ? task->phase : TASK_OVER;
    if (before != TASK_OVER && run_path(path, folder, entry->d_name)) {
      take(task, path);
      any = any || task->phase != before;
    }
  }
  if (marks) {
    closedir(marks);
  }
  return any;
}

bool batch_look(struct slurm_batch *batch, bool progress) {
  bool any = read_marks(batch, "begun", take_begun, &batch->begun_seen, &batch->begun_again);
  for (size_t i = 0; i < batch->count; i++) {
    struct slurm_task *task = &batch->task[i];
    if (task->phase == TASK_RUNS) {
      off_t before = task->follow->offset;
      task_read(task);
      task_watch(task, progress);
      any = any || task->follow->offset != before;
    }
  }
  return read_marks(batch, "ended", take_ended, &batch->ended_seen, &batch->ended_again) || any;
}

void batch_look_end(struct slurm_task *task) {
  char name[32], path[PATH_MAX];
  snprintf(name, sizeof name, "ended/%u", task->index);
  if (run_path(path, task->batch->folder, name)) {
    take_ended(task, path);
  }
}

int64_t batch_noted_job(const struct slurm_batch *batch) {
  int64_t job = 0;
  for (size_t i = 0; i < batch->count && job == 0; i++) {
    char name[48], path[PATH_MAX], *text = NULL;
    size_t size;
    snprintf(name, sizeof name, "begun/%zu/job", i);
    if (run_path(path, batch->folder, name) &&
        file_read(path, 64, &text, &size, NULL) == STATUS_OK) {
      job = slurm_submitted_job(text);
    }
    free(text);
  }
  return job;
}
