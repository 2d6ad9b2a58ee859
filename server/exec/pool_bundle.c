/* What a thread of the pool does with the members of a chain. */
#include "server/exec/pool_internal.h"

#include "server/base/clock.h"

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
  const struct pool_settings *settings = &slot->pool->settings;
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
  const struct pool_settings *settings = &slot->pool->settings;
  pthread_mutex_lock(&slot->pool->mutex);
  slot->progress = *progress;
  pthread_mutex_unlock(&slot->pool->mutex);
  settings->progressed(settings->context, claim->job_id, claim->attempt, progress);
}

/* All in one transaction, or, when that fails for one of them, one after the other. */
static void ended(void *context, struct bundle_end *ends, size_t count) {
  struct work *work = context;
  struct slot *slot = work->slot;
  const struct pool_settings *settings = &slot->pool->settings;
  const struct attempt_outcome *outcomes[BUNDLE_MEMBERS_MAX];
  char directory[BUNDLE_MEMBERS_MAX][SLOT_DIRECTORY_SIZE];
  enum job_state states[BUNDLE_MEMBERS_MAX];
  struct error error;
  for (size_t i = 0; i < count; i++) {
    slot_fill(slot, slot->member[ends[i].member], work->troubles, directory[i], &ends[i].outcome);
    outcomes[i] = &ends[i].outcome.attempt;
  }
  bool together = count > 1 && store_attempts_finish(settings->store, outcomes, count, states,
                                                     &error) == STATUS_OK;
  for (size_t i = 0; i < count; i++) {
    const struct slot_job *job = &slot->job[ends[i].member];
    if (together) {
      slot_count(slot, job, &ends[i].outcome, states[i]);
    } else {
      slot_finish(slot, job, &ends[i].outcome);
    }
    settings->changed(settings->context, ends[i].outcome.attempt.job_id);
  }
}

static enum stop_cause stop_wanted(void *context) {
  struct work *work = context;
  struct pool *pool = work->slot->pool;
  disk_check(pool->settings.disk, NULL); /* trouble that comes and goes is to be seen */
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
      pool->statistics.attempts_started++;
    }
  }
  slot->cancel = false;
  pool->statistics.busy += slot->members > 0 ? 1 : (unsigned)-1;
  pthread_mutex_unlock(&pool->mutex);
}

void slot_run_bundle(struct slot *slot, const struct claim *claim) {
  const struct pool_settings *settings = &slot->pool->settings;
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
    slot->job[k] = slot_job_read(slot, slot->member[k]);
    settings->changed(settings->context, slot->member[k]->job_id);
  }
  bundle_run(&run, slot->member, slot->members, &hooks);
  slot_turn(slot, NULL);
  slot_load(slot, NULL);
}
