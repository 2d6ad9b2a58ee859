/* Submission. Whatever happens between the intent in the database and the cluster's answer, an
 * array is submitted again only after the cluster was asked and knew none of its name, and after no
 * task of it has left a mark. */
#include <stdio.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/slurm/slurm_internal.h"

/* After an attempt to submit without an answer: from when on the array is there or not. Refused
 * ones are tried again after a while. */
enum {
  SETTLE_MS = 5000,
  FIRST_LOOK_MS = 1500,
  RETRY_LEAST_MS = 2000,
  RETRY_MOST_MS = 60000,
  NICE_A_STEP = 10
};

/* A shell's ulimit counts memory in kB, and files in blocks of 512 bytes. */
enum { KILO = 1024, BLOCK = 512 };

/* What the task has beside what its processes may allocate: programs, buffers of files. */
static const uint64_t memory_beside = 64 << 20;

static void submitted(struct slurm_batch *batch, int64_t job) {
  struct slurm *slurm = batch->slurm;
  struct error error;
  batch->cluster_job = job;
  batch->refusals = 0;
  if (store_batch_submitted(slurm->settings.engine.store, batch->id, job, &error) != STATUS_OK) {
    log_event(LOG_LEVEL_ERROR, error.message, LOG_TEXT("batch", batch->name));
  }
  log_event(LOG_LEVEL_INFO, "batch submitted", LOG_TEXT("batch", batch->name),
            LOG_NUMBER("cluster_job", job), LOG_NUMBER("tasks", batch->count));
}

static enum status try_submit(struct slurm_batch *batch, int64_t *job, struct error *error) {
  struct slurm *slurm = batch->slurm;
  const struct slurm_settings *settings = &slurm->settings;
  char memory[32], blocks[32];
  snprintf(memory, sizeof memory, "%llu", (unsigned long long)(batch->memory_bytes / KILO));
  snprintf(blocks, sizeof blocks, "%d", OUTPUT_BYTES_MAX / BLOCK);
  const char *script[] = {slurm->script, batch->folder, slurm->solver, memory, blocks, NULL};
  int nice = settings->nice - NICE_A_STEP * batch->priority;
  struct slurm_request request = {
      .name = batch->name,
      .tasks = (unsigned)batch->count,
      .partition = batch->partition[0] ? batch->partition : settings->partition,
      .account = settings->account,
      .memory_bytes = batch->memory_bytes ? batch->memory_bytes + memory_beside : 0,
      .time_s = batch->time_s,
      .nice = nice > 0 ? nice : 0,
      .script = script};
  return slurm_submit(&slurm->client, &request, job, error);
}

/* What only the jobs of this batch ask for and the cluster does not have: it would never start. */
static void refuse(struct slurm_batch *batch, const struct error *error) {
  struct slurm *slurm = batch->slurm;
  for (size_t i = 0; i < batch->count; i++) {
    struct slurm_task *task = &batch->task[i];
    for (size_t k = 0; k < task->count; k++) {
      struct outcome outcome;
      if (!task->member[k].settled) {
        outcome_make(&outcome, ATTEMPT_FAILED, "cluster_refuses", "The cluster refuses the job: %s",
                     error->message);
        ends_add(slurm, &task->member[k], &outcome);
      }
    }
  }
  batch_give_up(batch, "not_submitted", "");
}

static void failed(struct slurm_batch *batch, const struct error *error) {
  struct slurm *slurm = batch->slurm;
  int64_t wait_ms = RETRY_LEAST_MS << (batch->refusals < 6 ? batch->refusals : 6);
  bool refused = error->status == STATUS_CONFLICT;
  log_event(LOG_LEVEL_WARNING, "batch not submitted", LOG_TEXT("batch", batch->name),
            LOG_TEXT("reason", error->message));
  batch->retry_ms = clock_monotonic_ms() + (wait_ms < RETRY_MOST_MS ? wait_ms : RETRY_MOST_MS);
  if (refused) {
    batch->refusals++;
    if (batch->memory_own || batch->partition[0]) {
      refuse(batch, error);
    } else {
      slurm_note_trouble(slurm, error->message);
    }
  } else {
    batch->tried_ms = clock_monotonic_ms();
    slurm_note_answer(slurm, error);
  }
}

/* Whether nothing of an earlier try to submit it is with the cluster. */
static bool surely_new(struct slurm_batch *batch) {
  struct error error;
  int64_t job = 0;
  if (batch->tried_ms == 0) {
    return true;
  }
  if (clock_monotonic_ms() < batch->tried_ms + SETTLE_MS) {
    return false; /* a request may still be under way */
  }
  enum status status = slurm_find(&batch->slurm->client, batch->name, &job, &error);
  if (status != STATUS_OK) {
    batch->retry_ms = clock_monotonic_ms() + RETRY_LEAST_MS;
    slurm_note_answer(batch->slurm, &error);
    return false;
  }
  job = job ? job : batch_noted_job(batch);
  if (job != 0) {
    submitted(batch, job);
  }
  return job == 0;
}

static bool any_open(const struct slurm_batch *batch) {
  bool open = false;
  for (size_t i = 0; i < batch->count; i++) {
    open = open || batch->task[i].open > 0;
  }
  return open;
}

void slurm_submit_batches(struct slurm *slurm) {
  struct slurm_batch *next;
  for (struct slurm_batch *batch = slurm->first; batch; batch = next) {
    struct error error = {.status = STATUS_OK};
    int64_t job = 0;
    next = batch->next;
    if (batch->cluster_job == 0 && !any_open(batch)) {
      batch_give_up(batch, "", ""); /* should it be there, its script finds no folder */
      continue;
    }
    if (batch->cluster_job != 0 || !slurm_answers(slurm) ||
        clock_monotonic_ms() < batch->retry_ms || !surely_new(batch)) {
      continue;
    }
    if (try_submit(batch, &job, &error) == STATUS_OK) {
      submitted(batch, job);
      slurm_note_answer(slurm, NULL);
      slurm_note_trouble(slurm, "");
      slurm_poll_soon(slurm, FIRST_LOOK_MS);
      pthread_mutex_lock(&slurm->mutex);
      slurm->figures.submissions++;
      pthread_mutex_unlock(&slurm->mutex);
    } else {
      failed(batch, &error);
    }
  }
}
