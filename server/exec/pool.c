#include "server/exec/pool_internal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/file.h"
#include "server/base/log.h"
#include "server/base/meter.h"
#include "server/exec/tally.h"

enum { IDLE_MS = 500, STORE_RETRY_MS = 1000 };

void slot_complain(const struct slot *slot, const struct error *error) {
  log_event(LOG_LEVEL_ERROR, error->message, LOG_NUMBER("job", slot->job_id),
            LOG_NUMBER("attempt", slot->attempt));
}

static enum status slot_started(void *context, int64_t pid) {
  struct slot *slot = context;
  const struct engine_settings *settings = &slot->pool->settings.engine;
  struct error error;
  enum status status =
      store_attempt_running(settings->store, slot->job_id, slot->attempt, pid, &error);
  if (status == STATUS_OK) {
    settings->changed(settings->context, slot->job_id);
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
  const struct engine_settings *settings = &slot->pool->settings.engine;
  settings->progressed(settings->context, slot->job_id, slot->attempt, progress);
}

static enum stop_cause slot_stop_wanted(void *context) {
  struct slot *slot = context;
  disk_check(slot->pool->settings.engine.disk,
             NULL); /* trouble that comes and goes is to be seen */
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
    pool->busy++;
  } else {
    pool->busy--;
  }
  pthread_mutex_unlock(&pool->mutex);
  tally_attempts_started(pool->settings.engine.tally, claim ? 1 : 0);
}

/* For struct ending. */
static bool slot_pause(void *context) {
  struct slot *slot = context;
  struct pool *pool = slot->pool;
  struct timespec until = clock_deadline(STORE_RETRY_MS);
  pthread_mutex_lock(&pool->mutex);
  while (!pool->stopping && pthread_cond_timedwait(&pool->work, &pool->mutex, &until) == 0) {
  }
  bool stopping = pool->stopping;
  pthread_mutex_unlock(&pool->mutex);
  return !stopping;
}

/* The least of the limits of the daemon and the job, 0: none. */
static uint64_t memory_limit(const struct engine_settings *settings, const struct claim *claim) {
  uint64_t most = settings->memory_limit_bytes, own = claim->memory_bytes;
  return own != 0 && (most == 0 || own < most) ? own : most;
}

void slot_run_settings(const struct slot *slot, const struct claim *claim,
                       struct run_settings *run) {
  const struct engine_settings *settings = &slot->pool->settings.engine;
  *run = (struct run_settings){.data = settings->data,
                               .solver = settings->solver,
                               .isolation = slot->pool->settings.isolation,
                               .memory_limit_bytes = memory_limit(settings, claim),
                               .files_limit_bytes = settings->files_limit_bytes,
                               .time_limit_s = settings->time_limit_s,
                               .timeout_margin_s = settings->timeout_margin_s};
}

static void slot_run(struct slot *slot, const struct claim *claim) {
  const struct engine_settings *settings = &slot->pool->settings.engine;
  struct run_settings run;
  struct run_hooks hooks = {.context = slot,
                            .started = slot_started,
                            .progressed = slot_progressed,
                            .stop_wanted = slot_stop_wanted};
  struct outcome outcome;
  char directory[ENDING_DIRECTORY_SIZE];
  unsigned troubles = disk_troubles(settings->disk);
  slot_run_settings(slot, claim, &run);
  slot_assign(slot, claim);
  struct ending_job job = ending_job_read(&slot->ending, claim->job_id, claim->attempt);
  settings->changed(settings->context, claim->job_id);
  run_attempt(&run, claim, &hooks, &outcome);
  ending_fill(&slot->ending, claim->job_id, claim->attempt, troubles, directory, &outcome);
  ending_store(&slot->ending, &(const struct ending_job *){&job}, &(struct outcome *){&outcome}, 1);
  outcome_clear(&outcome);
  slot_assign(slot, NULL);
  settings->changed(settings->context, claim->job_id);
}

/* Runs what was claimed: a job by itself, or those of a chain in one process. */
static void slot_run_claimed(struct slot *slot, const struct claim *claim) {
  const struct engine_settings *settings = &slot->pool->settings.engine;
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
  const struct engine_settings *settings = &slot->pool->settings.engine;
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
      if (open && disk_check(settings->disk, NULL) == STATUS_OK &&
          store_claim_for(settings->store, slot->pool->settings.taste, &claim, &claimed, &error) !=
              STATUS_OK) {
        log_event(LOG_LEVEL_ERROR, "cannot take a job", LOG_TEXT("error", error.message));
      }
      if (claimed) {
        slot_run_claimed(slot, &claim);
        claim_clear(&claim);
      } else if (open && claim.answered_id != 0) {
        settings->changed(settings->context, claim.answered_id);
        claimed = true; /* there may be more */
      }
    }
  }
  return NULL;
}

/* ---- the engine --------------------------------------------------------------------------- */

static void pool_wake(void *engine) {
  struct pool *pool = engine;
  pthread_mutex_lock(&pool->mutex);
  pool->wakes++;
  pthread_cond_broadcast(&pool->work);
  pthread_mutex_unlock(&pool->mutex);
}

static void pool_cancel(void *engine, int64_t job_id) {
  struct pool *pool = engine;
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

static bool pool_progress(void *engine, int64_t job_id, struct progress *progress) {
  struct pool *pool = engine;
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

static enum status pool_check(void *engine, struct error *error) {
  const struct pool_settings *settings = &((struct pool *)engine)->settings;
  const char *programs[] = {settings->isolation->launcher, settings->engine.solver};
  for (size_t i = 0; i < sizeof programs / sizeof *programs; i++) {
    if (strchr(programs[i], '/') && access(programs[i], X_OK) != 0) {
      return error_set(error, STATUS_NOT_FOUND, NULL, "No worker can be started: %s: %s.",
                       programs[i], strerrordesc_np(errno));
    }
  }
  return STATUS_OK;
}

static void pool_drain(void *engine) {
  struct pool *pool = engine;
  pthread_mutex_lock(&pool->mutex);
  pool->draining = true;
  pthread_mutex_unlock(&pool->mutex);
}

static bool pool_idle(void *engine) {
  struct pool *pool = engine;
  pthread_mutex_lock(&pool->mutex);
  bool idle = pool->busy == 0;
  pthread_mutex_unlock(&pool->mutex);
  return idle;
}

static void pool_stop(void *engine, bool abort) {
  struct pool *pool = engine;
  pthread_mutex_lock(&pool->mutex);
  pool->draining = true;
  pool->stopping = true;
  pool->aborting = pool->aborting || abort;
  pthread_cond_broadcast(&pool->work);
  pthread_mutex_unlock(&pool->mutex);
}

static void gauge(FILE *out, const char *name, const char *help, unsigned value) {
  meter_head(out, name, "gauge", help);
  fprintf(out, "%s %u\n", name, value);
}

static void pool_metrics(void *engine, FILE *out) {
  struct pool *pool = engine;
  pthread_mutex_lock(&pool->mutex);
  unsigned busy = pool->busy;
  pthread_mutex_unlock(&pool->mutex);
  gauge(out, "pneulab_workers", "Worker processes that may run at a time.", pool->settings.workers);
  gauge(out, "pneulab_workers_busy", "Worker processes that run.", busy);
}

static void pool_destroy(void *engine) {
  struct pool *pool = engine;
  pool_stop(pool, false);
  for (unsigned i = 0; i < pool->thread_count; i++) {
    pthread_join(pool->slots[i].thread, NULL);
  }
  pthread_cond_destroy(&pool->work);
  pthread_mutex_destroy(&pool->mutex);
  free(pool);
}

enum status pool_create(const struct pool_settings *settings, struct engine *engine,
                        struct error *error) {
  static const struct engine_methods methods = {.name = "local",
                                                .wake = pool_wake,
                                                .cancel = pool_cancel,
                                                .progress = pool_progress,
                                                .check = pool_check,
                                                .drain = pool_drain,
                                                .idle = pool_idle,
                                                .stop = pool_stop,
                                                .metrics = pool_metrics,
                                                .destroy = pool_destroy};
  struct pool *made = calloc(1, sizeof *made + settings->workers * sizeof *made->slots);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the worker pool.");
  }
  char bundles[PATH_MAX];
  made->settings = *settings;
  if (snprintf(bundles, sizeof bundles, "%s/" BUNDLE_FOLDER, settings->engine.data) < PATH_MAX) {
    file_remove_tree(bundles); /* left by a crash */
  }
  pthread_mutex_init(&made->mutex, NULL);
  clock_condition_init(&made->work);
  for (unsigned i = 0; i < settings->workers; i++) {
    struct slot *slot = &made->slots[i];
    slot->pool = made;
    slot->ending = (struct ending){&made->settings.engine, slot_pause, slot};
    if (pthread_create(&slot->thread, NULL, slot_main, slot) != 0) {
      pool_destroy(made);
      return error_set(error, STATUS_NO_MEMORY, NULL, "Cannot start worker thread %u.", i + 1);
    }
    made->thread_count++;
  }
  *engine = (struct engine){&methods, made};
  return STATUS_OK;
}
