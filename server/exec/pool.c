#include "server/exec/pool_internal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/file.h"
#include "server/base/log.h"

enum { IDLE_MS = 500, STORE_RETRY_MS = 1000 };

void slot_complain(const struct slot *slot, const struct error *error) {
  log_event(LOG_LEVEL_ERROR, error->message, LOG_NUMBER("job", slot->job_id),
            LOG_NUMBER("attempt", slot->attempt));
}

static enum status slot_started(void *context, int64_t pid) {
  struct slot *slot = context;
  struct error error;
  enum status status =
      store_attempt_running(slot->pool->settings.store, slot->job_id, slot->attempt, pid, &error);
  if (status == STATUS_OK) {
    slot->pool->settings.changed(slot->pool->settings.context, slot->job_id);
  } else if (status != STATUS_CONFLICT) {
    slot_complain(slot, &error);
    status = STATUS_OK; /* the start could not be noted: no reason to end the worker */
  }
  return status;
}

static void slot_progressed(void *context, const struct progress *progress) {
  struct slot *slot = context;
  pthread_mutex_lock(&slot->pool->mutex);
  slot->progress = *progress;
  pthread_mutex_unlock(&slot->pool->mutex);
  const struct pool_settings *settings = &slot->pool->settings;
  settings->progressed(settings->context, slot->job_id, slot->attempt, progress);
}

static enum stop_cause slot_stop_wanted(void *context) {
  struct slot *slot = context;
  disk_check(slot->pool->settings.disk, NULL); /* trouble that comes and goes is to be seen */
  pthread_mutex_lock(&slot->pool->mutex);
  enum stop_cause cause = STOP_NONE;
  if (slot->pool->aborting) {
    cause = STOP_ABORT;
  } else if (slot->cancel) {
    cause = STOP_CANCEL;
  } else if (slot->pool->stopping) {
    cause = STOP_SHUTDOWN;
  }
  pthread_mutex_unlock(&slot->pool->mutex);
  return cause;
}

/* Notes the job in the slot (or, with no claim, that it is free). */
static void slot_assign(struct slot *slot, const struct claim *claim) {
  struct pool *pool = slot->pool;
  pthread_mutex_lock(&pool->mutex);
  slot->job_id = claim ? claim->job_id : 0;
  slot->attempt = claim ? claim->attempt : 0;
  slot->cancel = false;
  slot->progress = progress_none();
  if (claim) {
    pool->statistics.busy++;
    pool->statistics.attempts_started++;
  } else {
    pool->statistics.busy--;
  }
  pthread_mutex_unlock(&pool->mutex);
}

/* Pauses between tries to store an outcome; false once the pool ends. */
static bool slot_pause(struct slot *slot) {
  struct pool *pool = slot->pool;
  struct timespec until = clock_deadline(STORE_RETRY_MS);
  pthread_mutex_lock(&pool->mutex);
  while (!pool->stopping && pthread_cond_timedwait(&pool->work, &pool->mutex, &until) == 0) {
  }
  bool stopping = pool->stopping;
  pthread_mutex_unlock(&pool->mutex);
  return !stopping;
}

/* Stores the outcome. While the database fails (a full disk) it is asked again; if the daemon ends
 * before that helps, the attempt stays open and is recovered at the next start. A result that the
 * database refuses fails the job. */
static enum status slot_store(struct slot *slot, struct outcome *outcome, enum job_state *state,
                              struct error *error) {
  struct store *store = slot->pool->settings.store;
  enum status status, before = STATUS_OK;
  while (store_failed(status = store_attempt_finish(store, &outcome->attempt, state, error))) {
    if (status != before) {
      slot_complain(slot, error);
      before = status;
    }
    if (!slot_pause(slot)) {
      return status;
    }
  }
  if (status == STATUS_CONFLICT && outcome->attempt.result_text) {
    outcome_set_unstorable(outcome, error);
    status = store_attempt_finish(store, &outcome->attempt, state, error);
  }
  return status;
}

struct slot_job slot_job_read(struct slot *slot, const struct claim *claim) {
  struct slot_job job = {.start_ms = clock_monotonic_ms()};
  struct job_record record;
  if (store_job(slot->pool->settings.store, claim->job_id, &record, NULL) == STATUS_OK) {
    snprintf(job.kind, sizeof job.kind, "%s", record.kind);
    if (claim->attempt == 1) {
      tally_waited(slot->pool->tally, 1e-3 * (double)(record.started_ms - record.created_ms));
    }
    job_record_clear(&record);
  }
  return job;
}

void slot_count(struct slot *slot, const struct slot_job *job, const struct outcome *outcome,
                enum job_state state) {
  struct tally_attempt ended = {.kind = job->kind,
                                .state = job_state_word(state),
                                .reason = outcome->attempt.reason_code,
                                .final = job_state_terminal(state),
                                .wall_s = 1e-3 * (double)(clock_monotonic_ms() - job->start_ms),
                                .peak_memory_MB = outcome->attempt.peak_memory_MB};
  tally_ended(slot->pool->tally, &ended);
  pthread_mutex_lock(&slot->pool->mutex);
  slot->pool->statistics.attempts_ended[outcome->attempt.end]++;
  slot->pool->statistics.cpu_s += outcome->attempt.cpu_s;
  pthread_mutex_unlock(&slot->pool->mutex);
  log_event(state == JOB_STATE_FAILED ? LOG_LEVEL_WARNING : LOG_LEVEL_INFO, "attempt ended",
            LOG_NUMBER("job", outcome->attempt.job_id),
            LOG_NUMBER("attempt", outcome->attempt.attempt), LOG_TEXT("kind", ended.kind),
            LOG_TEXT("state", ended.state), LOG_TEXT("reason", ended.reason),
            LOG_NUMBER("wall_s", ended.wall_s), LOG_NUMBER("cpu_s", outcome->attempt.cpu_s),
            LOG_NUMBER("memory_MB", ended.peak_memory_MB));
}

void slot_finish(struct slot *slot, const struct slot_job *job, struct outcome *outcome) {
  struct error error;
  enum job_state state;
  if (slot_store(slot, outcome, &state, &error) == STATUS_OK) {
    slot_count(slot, job, outcome, state);
  } else {
    slot_complain(slot, &error);
  }
}

/* The least of the limits of the daemon and the job, 0: none. */
static uint64_t memory_limit(const struct pool_settings *settings, const struct claim *claim) {
  uint64_t most = settings->memory_limit_bytes, own = claim->memory_bytes;
  return own != 0 && (most == 0 || own < most) ? own : most;
}

void slot_run_settings(const struct slot *slot, const struct claim *claim,
                       struct run_settings *run) {
  const struct pool_settings *settings = &slot->pool->settings;
  *run = (struct run_settings){.data = settings->data,
                               .solver = settings->solver,
                               .isolation = settings->isolation,
                               .memory_limit_bytes = memory_limit(settings, claim),
                               .files_limit_bytes = settings->files_limit_bytes,
                               .time_limit_s = settings->time_limit_s,
                               .timeout_margin_s = settings->timeout_margin_s};
}

void slot_fill(struct slot *slot, const struct claim *claim, unsigned troubles,
               char directory[SLOT_DIRECTORY_SIZE], struct outcome *outcome) {
  const struct pool_settings *settings = &slot->pool->settings;
  if (outcome->attempt.end == ATTEMPT_WORKER_LOST && disk_blamed(settings->disk, troubles)) {
    outcome_set_requeued(outcome);
  }
  run_directory(claim->job_id, claim->attempt, directory);
  outcome->attempt.job_id = claim->job_id;
  outcome->attempt.attempt = claim->attempt;
  outcome->attempt.directory = directory;
  outcome->attempt.retry_delay_ms = (int64_t)(1000 * settings->retry_delay_s);
}

static void slot_run(struct slot *slot, const struct claim *claim) {
  const struct pool_settings *settings = &slot->pool->settings;
  struct run_settings run;
  struct run_hooks hooks = {.context = slot,
                            .started = slot_started,
                            .progressed = slot_progressed,
                            .stop_wanted = slot_stop_wanted};
  struct outcome outcome;
  char directory[SLOT_DIRECTORY_SIZE];
  unsigned troubles = disk_troubles(settings->disk);
  slot_run_settings(slot, claim, &run);
  slot_assign(slot, claim);
  struct slot_job job = slot_job_read(slot, claim);
  settings->changed(settings->context, claim->job_id);
  run_attempt(&run, claim, &hooks, &outcome);
  slot_fill(slot, claim, troubles, directory, &outcome);
  slot_finish(slot, &job, &outcome);
  outcome_clear(&outcome);
  slot_assign(slot, NULL);
  settings->changed(settings->context, claim->job_id);
}

/* Runs what was claimed: a job by itself, or those of a chain in one process. */
static void slot_run_claimed(struct slot *slot, const struct claim *claim) {
  const struct pool_settings *settings = &slot->pool->settings;
  bool several = claim->before_id != 0;
  for (const struct claim *next = claim->next; next; next = next->next) {
    several = several || next->job_id != 0;
    if (next->answered_id != 0) {
      settings->changed(settings->context, next->answered_id);
    }
  }
  if (several) {
    slot_run_bundle(slot, claim);
  } else {
    slot_run(slot, claim);
  }
}

/* Waits until there may be work; false when the pool ends. */
static bool slot_wait(struct slot *slot, unsigned *seen) {
  struct pool *pool = slot->pool;
  pthread_mutex_lock(&pool->mutex);
  if (*seen == pool->wakes && !pool->stopping) {
    struct timespec until = clock_deadline(IDLE_MS);
    pthread_cond_timedwait(&pool->work, &pool->mutex, &until);
  }
  while (pool->draining && !pool->stopping) {
    pthread_cond_wait(&pool->work, &pool->mutex);
  }
  *seen = pool->wakes;
  bool stopping = pool->stopping;
  pthread_mutex_unlock(&pool->mutex);
  return !stopping;
}

static void *slot_main(void *context) {
  struct slot *slot = context;
  unsigned seen = 0;
  while (slot_wait(slot, &seen)) {
    struct claim claim = {0};
    struct error error;
    bool claimed = true;
    while (claimed) {
      pthread_mutex_lock(&slot->pool->mutex);
      bool open = !slot->pool->draining;
      pthread_mutex_unlock(&slot->pool->mutex);
      claimed = false;
      if (open && disk_check(slot->pool->settings.disk, NULL) == STATUS_OK &&
          store_claim(slot->pool->settings.store, &claim, &claimed, &error) != STATUS_OK) {
        log_event(LOG_LEVEL_ERROR, "cannot take a job", LOG_TEXT("error", error.message));
      }
      if (claimed) {
        slot_run_claimed(slot, &claim);
        claim_clear(&claim);
      } else if (open && claim.answered_id != 0) {
        slot->pool->settings.changed(slot->pool->settings.context, claim.answered_id);
        claimed = true; /* there may be more */
      }
    }
  }
  return NULL;
}

enum status pool_create(const struct pool_settings *settings, struct pool **pool,
                        struct error *error) {
  struct pool *made = calloc(1, sizeof *made + settings->workers * sizeof *made->slots);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the worker pool.");
  }
  char bundles[PATH_MAX];
  made->settings = *settings;
  if (snprintf(bundles, sizeof bundles, "%s/" BUNDLE_FOLDER, settings->data) < PATH_MAX) {
    file_remove_tree(bundles); /* left by a crash */
  }
  made->statistics.workers = settings->workers;
  pthread_mutex_init(&made->mutex, NULL);
  clock_condition_init(&made->work);
  if (tally_create(&made->tally, error) != STATUS_OK) {
    pool_destroy(made);
    return error->status;
  }
  for (unsigned i = 0; i < settings->workers; i++) {
    made->slots[i].pool = made;
    if (pthread_create(&made->slots[i].thread, NULL, slot_main, &made->slots[i]) != 0) {
      pool_destroy(made);
      return error_set(error, STATUS_NO_MEMORY, NULL, "Cannot start worker thread %u.", i + 1);
    }
    made->thread_count++;
  }
  *pool = made;
  return STATUS_OK;
}

void pool_wake(struct pool *pool) {
  pthread_mutex_lock(&pool->mutex);
  pool->wakes++;
  pthread_cond_broadcast(&pool->work);
  pthread_mutex_unlock(&pool->mutex);
}

void pool_cancel(struct pool *pool, int64_t job_id) {
  pthread_mutex_lock(&pool->mutex);
  for (unsigned i = 0; i < pool->thread_count; i++) {
    struct slot *slot = &pool->slots[i];
    slot->cancel = slot->cancel || slot->job_id == job_id;
    for (size_t k = 0; k < slot->members; k++) {
      slot->cancelled[k] = slot->cancelled[k] || slot->member[k]->job_id == job_id;
    }
  }
  pthread_mutex_unlock(&pool->mutex);
}

bool pool_progress(struct pool *pool, int64_t job_id, struct progress *progress) {
  bool found = false;
  pthread_mutex_lock(&pool->mutex);
  for (unsigned i = 0; i < pool->thread_count; i++) {
    if (pool->slots[i].job_id == job_id && pool->slots[i].progress.fraction >= 0) {
      *progress = pool->slots[i].progress;
      found = true;
    }
  }
  pthread_mutex_unlock(&pool->mutex);
  return found;
}

void pool_statistics(struct pool *pool, struct pool_statistics *statistics) {
  pthread_mutex_lock(&pool->mutex);
  *statistics = pool->statistics;
  pthread_mutex_unlock(&pool->mutex);
}

enum status pool_check(const struct pool *pool, struct error *error) {
  const char *programs[] = {pool->settings.isolation->launcher, pool->settings.solver};
  for (size_t i = 0; i < sizeof programs / sizeof *programs; i++) {
    if (strchr(programs[i], '/') && access(programs[i], X_OK) != 0) {
      return error_set(error, STATUS_NOT_FOUND, NULL, "No worker can be started: %s: %s.",
                       programs[i], strerrordesc_np(errno));
    }
  }
  return STATUS_OK;
}

struct tally *pool_tally(struct pool *pool) {
  return pool->tally;
}

void pool_drain(struct pool *pool) {
  pthread_mutex_lock(&pool->mutex);
  pool->draining = true;
  pthread_mutex_unlock(&pool->mutex);
}

bool pool_idle(struct pool *pool) {
  pthread_mutex_lock(&pool->mutex);
  bool idle = pool->statistics.busy == 0;
  pthread_mutex_unlock(&pool->mutex);
  return idle;
}

void pool_stop(struct pool *pool, bool abort) {
  pthread_mutex_lock(&pool->mutex);
  pool->draining = true;
  pool->stopping = true;
  pool->aborting = pool->aborting || abort;
  pthread_cond_broadcast(&pool->work);
  pthread_mutex_unlock(&pool->mutex);
}

void pool_destroy(struct pool *pool) {
  if (!pool) {
    return;
  }
  pool_stop(pool, false);
  for (unsigned i = 0; i < pool->thread_count; i++) {
    pthread_join(pool->slots[i].thread, NULL);
  }
  tally_destroy(pool->tally);
  pthread_cond_destroy(&pool->work);
  pthread_mutex_destroy(&pool->mutex);
  free(pool);
}
