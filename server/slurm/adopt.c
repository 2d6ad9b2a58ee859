/* What an earlier daemon has handed to the cluster is taken over. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/file.h"
#include "server/base/log.h"
#include "server/slurm/slurm_internal.h"
#include "solver/job/json.h"

enum { BUNDLE_BYTES_MAX = 1 << 20 };

/* The number of members of a task, from its file; 0 when that is not there. */
static size_t members_count(const struct slurm_task *task) {
  char name[48], path[PATH_MAX], *text = NULL;
  size_t size = 0;
  json_t *document = NULL;
  snprintf(name, sizeof name, "%u/bundle.json", task->index);
  if (run_path(path, task->batch->folder, name) &&
      file_read(path, BUNDLE_BYTES_MAX, &text, &size, NULL) == STATUS_OK) {
    document = json_read(text, size, 0, NULL);
  }
  size_t count = json_array_size(json_object_get(document, "members"));
  json_decref(document);
  free(text);
  return count;
}

static void member_adopt(struct slurm_task *task, const struct cluster_attempt *attempt) {
  struct slurm *slurm = task->batch->slurm;
  const struct engine_settings *settings = &slurm->settings.engine;
  struct slurm_member *member = &task->member[attempt->place];
  double limit_s = attempt->timeout_s > 0 ? attempt->timeout_s : settings->time_limit_s;
  member->job_id = attempt->job_id;
  member->attempt = attempt->attempt;
  member->time_limit_s = limit_s + settings->timeout_margin_s;
  member->job = ending_job_read(&slurm->ending, attempt->job_id, 0);
  member->cancel = attempt->state == JOB_STATE_CANCELLING;
  member->noted = attempt->state == JOB_STATE_RUNNING;
  member->settled = false;
  slurm->cancels = slurm->cancels || member->cancel;
}

/* Fills a batch from the attempts that are open; true when its folder still holds all of them. */
static bool batch_fill(struct slurm_batch *batch, const struct cluster_attempt *attempts,
                       size_t count, struct error *error) {
  bool whole = true;
  for (size_t i = 0; i < batch->count; i++) {
    struct slurm_task *task = &batch->task[i];
    size_t members = members_count(task);
    for (size_t k = 0; k < count; k++) { /* also those that its file has lost */
      if (attempts[k].task == (int64_t)i && (size_t)attempts[k].place >= members) {
        members = (size_t)attempts[k].place + 1;
        whole = false;
      }
    }
    if (task_create(task, members, error) != STATUS_OK) {
      return false;
    }
    for (size_t k = 0; k < members; k++) {
      task->member[k].settled = true;
    }
  }
  for (size_t k = 0; k < count; k++) {
    if (attempts[k].task < (int64_t)batch->count) {
      member_adopt(&batch->task[attempts[k].task], &attempts[k]);
    }
  }
  return whole;
}

static enum status batch_adopt(struct slurm *slurm, const struct cluster_batch *row,
                               struct error *error) {
  struct cluster_attempt *attempts = NULL;
  struct slurm_batch *batch = NULL;
  char name[CLUSTER_NAME_SIZE + 16];
  size_t count = 0;
  enum status status =
      store_batch_attempts(slurm->settings.engine.store, row->id, &attempts, &count, error);
  if (status == STATUS_OK) {
    status = batch_create(slurm, row->tasks, &batch, error);
  }
  if (status != STATUS_OK) {
    free(attempts);
    return status;
  }
  batch->id = row->id;
  batch->cluster_job = row->cluster_job;
  memcpy(batch->name, row->name, sizeof batch->name);
  memcpy(batch->partition, row->partition, sizeof batch->partition);
  snprintf(name, sizeof name, CLUSTER_FOLDER "/%s", row->name);
  run_path(batch->folder, slurm->data, name);
  bool whole = batch_fill(batch, attempts, count, error);
  free(attempts);
  batch_enlist(batch);
  if (batch->cluster_job == 0) {
    batch->cluster_job = batch_noted_job(batch);
    batch->tried_ms = clock_monotonic_ms();
  }
  log_event(LOG_LEVEL_INFO, "batch adopted", LOG_TEXT("batch", batch->name),
            LOG_NUMBER("jobs", count), LOG_NUMBER("cluster_job", batch->cluster_job));
  if (!whole) { /* a crash before its files were complete, or a disk that has lost them */
    batch_give_up(batch, "not_submitted", "The files of the task were not complete.");
  }
  return STATUS_OK;
}

/* Removes folders of batches that are not open any more. */
static void sweep(struct slurm *slurm) {
  char folder[PATH_MAX], path[PATH_MAX];
  DIR *entries = run_path(folder, slurm->data, CLUSTER_FOLDER) ? opendir(folder) : NULL;
  const struct dirent *entry;
  while (entries && (entry = readdir(entries))) {
    bool known = strncmp(entry->d_name, "pneulab-", 8) != 0;
    for (const struct slurm_batch *batch = slurm->first; batch && !known; batch = batch->next) {
      known = strcmp(batch->name, entry->d_name) == 0;
    }
    if (!known && run_path(path, folder, entry->d_name)) {
      file_remove_tree(path);
    }
  }
  if (entries) {
    closedir(entries);
  }
}

enum status slurm_adopt(struct slurm *slurm, struct error *error) {
  struct cluster_batch *list = NULL;
  size_t count = 0;
  enum status status = store_batches_open(slurm->settings.engine.store, &list, &count, error);
  for (size_t i = 0; i < count && status == STATUS_OK; i++) {
    status = batch_adopt(slurm, &list[i], error);
  }
  free(list);
  if (status == STATUS_OK) {
    sweep(slurm);
  }
  return status;
}
