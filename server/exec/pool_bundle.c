/* What a thread of the pool does with the members of a chain. */
#include "server/exec/pool_internal.h"

#include "server/base/clock.h"
#include "server/exec/tally.h"

/* A bundle on its way. */
struct work {
  struct slot *slot;
  unsigned troubles; /* of the disk, when it began */
};

/* Notes the member that is solved now, NULL: none. */
static void slot_turn(struct slot *slot, const struct claim *claim) {
  pthread_mutex_lock(&slot->pool->mutex);
  slot->job_id = claim ? claim->job_id : 0;
  slot->attempt = claim ? claim->attempt : 0;
  slot->progress = progress_none();
  pthread_mutex_unlock(&slot->pool->mutex);
}

static enum status begun(void *context, size_t index, int64_t pid) {
  struct work *work = context;
  struct slot *slot = work->slot;
  const struct claim *claim = slot->member[index];
  const struct engine_settings *settings = &slot->pool->settings.engine;
  struct error error;
  slot->job[index].start_ms = clock_monotonic_ms();
  slot_turn(slot, claim);
  enum status status =
      store_attempt_running(settings->store, claim->job_id, claim->attempt, pid, &error);
  if (status == STATUS_OK) {
    settings->changed(settings->context, claim->job_id);
  } else if (status != STATUS_CONFLICT) {
    slot_complain(slot, &error);
    status = STATUS_OK; /* the start could not be noted: no reason to end the worker */
  }
  return status;
}

static void progressed(void *context, size_t index, const struct progress *progress) {
  struct work *work = context;
  struct slot *slot = work->slot;
  const struct claim *claim = slot->member[index];
  const struct engine_settings *settings = &slot->pool->settings.engine;
  pthread_mutex_lock(&slot->pool->mutex);
  slot->progress = *progress;
  pthread_mutex_unlock(&slot->pool->mutex);
  settings->progressed(settings->context, claim->job_id, claim->attempt, progress);
}

static void ended(void *context, struct bundle_end *ends, size_t count) {
  struct work *work = context;
  struct slot *slot = work->slot;
  const struct engine_settings *settings = &slot->pool->settings.engine;
  const struct ending_job *jobs[BUNDLE_MEMBERS_MAX] = {NULL};
  struct outcome *outcomes[BUNDLE_MEMBERS_MAX] = {NULL};
  char directory[BUNDLE_MEMBERS_MAX][ENDING_DIRECTORY_SIZE];
  for (size_t i = 0; i < count; i++) {
    const struct claim *claim = slot->member[ends[i].member];
    ending_fill(&slot->ending, claim->job_id, claim->attempt, work->troubles, directory[i],
                &ends[i].outcome);
    jobs[i] = &slot->job[ends[i].member];
    outcomes[i] = &ends[i].outcome;
  }
  ending_store(&slot->ending, jobs, outcomes, count);
  for (size_t i = 0; i < count; i++) {
    settings->changed(settings->context, ends[i].outcome.attempt.job_id);
  }
}

static enum stop_cause stop_wanted(void *context) {
  struct work *work = context;
  struct pool *pool = work->slot->pool;
  disk_check(pool->settings.engine.disk, NULL); /* trouble that comes and goes is to be seen */
  pthread_mutex_lock(&pool->mutex);
  enum stop_cause cause = pool->aborting ? STOP_ABORT : pool->stopping ? STOP_SHUTDOWN : STOP_NONE;
  pthread_mutex_unlock(&pool->mutex);
  return cause;
}

static bool cancel_wanted(void *context, size_t index) {
  struct work *work = context;
  pthread_mutex_lock(&work->slot->pool->mutex);
  bool cancelled = work->slot->cancelled[index];
  pthread_mutex_unlock(&work->slot->pool->mutex);
  return cancelled;
}

/* Puts the members into the slot, or takes them out (no claim). */
static void slot_load(struct slot *slot, const struct claim *claim) {
  struct pool *pool = slot->pool;
  pthread_mutex_lock(&pool->mutex);
  slot->members = 0;
  for (; claim && slot->members < BUNDLE_MEMBERS_MAX; claim = claim->next) {
    if (claim->job_id != 0) {
      slot->cancelled[slot->members] = false;
      slot->member[slot->members++] = claim;
    }
  }
  slot->cancel = false;
  pool->busy += slot->members > 0 ? 1 : (unsigned)-1;
  pthread_mutex_unlock(&pool->mutex);
  tally_attempts_started(pool->settings.engine.tally, (unsigned)slot->members);
}

void slot_run_bundle(struct slot *slot, const struct claim *claim) {
  const struct engine_settings *settings = &slot->pool->settings.engine;
  const struct bundle_hooks hooks = {.context = &(struct work){slot, disk_troubles(settings->disk)},
                                     .begun = begun,
                                     .progressed = progressed,
                                     .ended = ended,
                                     .stop_wanted = stop_wanted,
                                     .cancel_wanted = cancel_wanted};
  struct run_settings run;
  slot_run_settings(slot, claim, &run);
  slot_load(slot, claim);
  for (size_t k = 0; k < slot->members; k++) {
    slot->job[k] =
        ending_job_read(&slot->ending, slot->member[k]->job_id, slot->member[k]->attempt);
    settings->changed(settings->context, slot->member[k]->job_id);
  }
  bundle_run(&run, slot->member, slot->members, &hooks);
  slot_turn(slot, NULL);
  slot_load(slot, NULL);
}
