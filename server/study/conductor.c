#include "server/study/conductor.h"

#include <pthread.h>
#include <stdlib.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/exec/tally.h"
#include "server/study/conductor_internal.h"

/* Between two looks at the studies, and when nothing was heard of any job. */
enum { PACE_MS = 50, IDLE_MS = 1000 };

/* Studies of one submitter that run at a time. */
enum { STUDIES_MAX = 4 };

enum status conductor_create(const struct conductor_settings *settings,
                             struct conductor **conductor, struct error *error) {
  struct conductor *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the studies.");
  }
  made->settings = *settings;
  pthread_condattr_t monotonic;
  pthread_condattr_init(&monotonic);
  pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
  pthread_mutex_init(&made->mutex, NULL);
  pthread_cond_init(&made->news, &monotonic);
  pthread_condattr_destroy(&monotonic);
  *conductor = made;
  return STATUS_OK;
}

/* ---- the list of works -------------------------------------------------------------------- */

static struct work *work_find(const struct conductor *conductor, int64_t id, int64_t attempt) {
  for (struct work *work = conductor->first; work; work = work->next) {
    if (work->id == id && work->attempt == attempt) {
      return work;
    }
  }
  return NULL;
}

static void work_enlist(struct conductor *conductor, struct work *work) {
  pthread_mutex_lock(&conductor->mutex);
  work->next = conductor->first;
  conductor->first = work;
  pthread_mutex_unlock(&conductor->mutex);
}

static void work_drop(struct conductor *conductor, struct work *work) {
  pthread_mutex_lock(&conductor->mutex);
  struct work **at = &conductor->first;
  while (*at && *at != work) {
    at = &(*at)->next;
  }
  if (*at) {
    *at = work->next;
  }
  pthread_mutex_unlock(&conductor->mutex);
  work_destroy(work);
}

/* Drops works whose study does not run any more, at least not under that attempt. */
static void works_sweep(struct conductor *conductor, const struct study_job *list, size_t count) {
  struct work *next;
  for (struct work *work = conductor->first; work; work = next) {
    bool runs = false;
    next = work->next;
    for (size_t i = 0; i < count; i++) {
      runs = runs || (list[i].id == work->id && list[i].attempt == work->attempt &&
                      list[i].state == JOB_STATE_RUNNING);
    }
    if (!runs) {
      work_drop(conductor, work);
    }
  }
}

/* ---- one study ---------------------------------------------------------------------------- */

/* Number of members that have not ended; -1 when that cannot be told. */
static int64_t count_live(struct conductor *conductor, int64_t id, int64_t *ended,
                          struct error *error) {
  int64_t counts[JOB_STATE_COUNT], live = 0;
  *ended = 0;
  if (store_study_counts(conductor->settings.store, id, counts, error) != STATUS_OK) {
    conductor_complain(id, error);
    return -1;
  }
  for (int s = 0; s < JOB_STATE_COUNT; s++) {
    bool terminal = job_state_terminal((enum job_state)s);
    *ended += terminal ? counts[s] : 0;
    live += terminal ? 0 : counts[s];
  }
  return live;
}

/* Goes on cancelling a study: first who waits, then who runs, then the study itself. */
static bool step_cancel(struct conductor *conductor, int64_t id) {
  struct error error;
  int64_t ended;
  bool more = conductor_follow(conductor, id, STUDY_CANCEL);
  if (more) {
    return true;
  }
  if (count_live(conductor, id, &ended, &error) > 0) {
    conductor_cancel_running(conductor, id);
  } else if (store_study_cancelled(conductor->settings.store, id, NULL) == STATUS_OK) {
    log_event(LOG_LEVEL_INFO, "study cancelled", LOG_NUMBER("study", id));
    conductor_changed(conductor, id);
    conductor_changed_members(conductor, id);
  }
  return false;
}

/* Adds what the members that run have reported. */
static double running_fractions(struct conductor *conductor, int64_t id) {
  int64_t ids[64];
  size_t count = 0;
  double sum = 0;
  store_study_running(conductor->settings.store, id, ids, sizeof ids / sizeof *ids, &count, NULL);
  for (size_t i = 0; i < count; i++) {
    struct progress progress;
    sum += executor_progress(conductor->executor, ids[i], &progress) ? progress.fraction : 0;
  }
  return sum;
}

static void report_progress(struct conductor *conductor, struct work *work, int64_t ended) {
  double members = (double)(work->search ? study_search_budget(work->search) : work->study.count);
  double fraction = ((double)ended + running_fractions(conductor, work->id)) / members;
  struct progress progress = progress_none();
  int64_t now = clock_monotonic_ms();
  if (fraction <= work->progress.fraction) {
    return;
  }
  pace_take(&work->pace, now, fraction);
  progress.fraction = fraction > 1 ? 1 : fraction;
  progress.step = ended;
  progress.steps = (int64_t)members;
  progress.since = pace_reference(&work->pace, now);
  pthread_mutex_lock(&conductor->mutex);
  work->progress = progress;
  pthread_mutex_unlock(&conductor->mutex);
  conductor->settings.progressed(conductor->settings.context, work->id, work->attempt, &progress);
}

static void view_make(struct conductor *conductor, int64_t id) {
  struct error error;
  if (store_study_view(conductor->settings.store, id, &error) != STATUS_OK) {
    conductor_complain(id, &error);
  }
}

/* All members have ended. */
static void finish(struct conductor *conductor, struct work *work) {
  enum job_state state = JOB_STATE_FAILED;
  struct error error = {.status = STATUS_OK};
  struct tally_attempt ended = {.kind = "study", .reason = "", .final = true};
  view_make(conductor, work->id);
  enum status status = work_finish(&conductor->settings, work, &state, &error);
  if (status != STATUS_OK && status != STATUS_CONFLICT && !store_failed(status)) {
    status = work_fail(&conductor->settings, work, &error, &error);
  }
  if (status != STATUS_OK) {
    conductor_complain(work->id, &error);
    return;
  }
  ended.state = job_state_word(state);
  ended.wall_s = 1e-3 * (double)(clock_monotonic_ms() - work->start_ms);
  tally_ended(executor_tally(conductor->executor), &ended);
  log_event(LOG_LEVEL_INFO, "study ended", LOG_NUMBER("study", work->id),
            LOG_TEXT("state", ended.state), LOG_NUMBER("wall_s", ended.wall_s));
  int64_t id = work->id;
  if (work->out_of_time) {
    conductor_changed_members(conductor, id);
  }
  work_drop(conductor, work);
  conductor_changed(conductor, id);
}

/* Whether the study has used up its time; members that wait or run are then cancelled. */
static bool out_of_time(struct conductor *conductor, struct work *work) {
  double used_s = work->elapsed_s + 1e-3 * (double)(clock_monotonic_ms() - work->start_ms);
  work->out_of_time = work->out_of_time || (work->limit_s > 0 && used_s > work->limit_s);
  if (work->out_of_time && !conductor_follow(conductor, work->id, STUDY_CANCEL)) {
    conductor_cancel_running(conductor, work->id);
  }
  return work->out_of_time;
}

/* Stores the next members; true when there are more. */
static bool step_add(struct conductor *conductor, struct work *work) {
  struct error error = {.status = STATUS_OK};
  bool more = false;
  if (disk_check(conductor->settings.disk, NULL) != STATUS_OK) {
    return false;
  }
  enum status status = work_add(&conductor->settings, work, &more, &error);
  if (status == STATUS_OK) {
    executor_wake(conductor->executor);
    if (work->stored) {
      view_make(conductor, work->id);
    }
    return more;
  }
  if (status != STATUS_CONFLICT) {
    conductor_complain(work->id, &error);
  }
  if (status != STATUS_CONFLICT && !store_failed(status) &&
      work_fail(&conductor->settings, work, &error, NULL) == STATUS_OK) {
    conductor_changed(conductor, work->id);
  }
  return false;
}

/* Lets a search ask for its next members when those it has have ended; true when there are some, or
 * the study has failed. */
static bool step_search(struct conductor *conductor, struct work *work) {
  struct error error = {.status = STATUS_OK};
  bool more = false;
  if (!work->search || work->stored || work->out_of_time || work->added < work->study.count) {
    return false;
  }
  enum status status = work_search(&conductor->settings, work, &more, &error);
  if (status == STATUS_OK || status == STATUS_CONFLICT) {
    return more;
  }
  conductor_complain(work->id, &error);
  if (!store_failed(status) && work_fail(&conductor->settings, work, &error, NULL) == STATUS_OK) {
    conductor_changed(conductor, work->id);
    return true;
  }
  return false;
}

/* Looks after a study that runs; true when there is more to do at once. */
static bool step_run(struct conductor *conductor, const struct study_job *job) {
  struct work *work = work_find(conductor, job->id, job->attempt);
  struct error error;
  int64_t ended;
  if (!work) {
    return false;
  }
  bool more = conductor_follow(conductor, job->id, STUDY_RELEASE);
  if (!work->followed || work->priority != job->priority) {
    work->priority = job->priority; /* of those that are still to be stored */
    work->followed = !conductor_follow(conductor, job->id, STUDY_PRIORITY);
    more = more || !work->followed;
  }
  bool waits = work->search && work->added == work->study.count; /* for the end of a round */
  if (!out_of_time(conductor, work) && !work->stored && !waits) {
    more = step_add(conductor, work) || more;
  }
  int64_t live = count_live(conductor, job->id, &ended, &error);
  if (live == 0 && step_search(conductor, work)) {
    return true;
  }
  if (live == 0 && (work->stored || work->out_of_time)) {
    finish(conductor, work);
    return true; /* another one may begin */
  }
  if (live >= 0) {
    report_progress(conductor, work, ended);
  }
  return more;
}

/* ---- all of them -------------------------------------------------------------------------- */

/* Takes the next study; true when there was one. */
static bool begin_next(struct conductor *conductor) {
  struct study_claim claim;
  struct work *work = NULL;
  struct error error = {.status = STATUS_OK};
  bool claimed = false;
  if (disk_check(conductor->settings.disk, NULL) != STATUS_OK ||
      store_study_claim(conductor->settings.store, STUDIES_MAX, &claim, &claimed, NULL) !=
          STATUS_OK ||
      !claimed) {
    return false;
  }
  int64_t id = claim.id;
  enum status status = work_begin(&conductor->settings, &claim, &work, &error);
  if (status == STATUS_OK) {
    work_enlist(conductor, work);
  } else if (status != STATUS_CONFLICT) {
    conductor_complain(id, &error);
    if (work && !store_failed(status)) {
      work_fail(&conductor->settings, work, &error, NULL);
    } else if (work) {
      work_requeue(&conductor->settings, work, NULL);
    }
  }
  if (status != STATUS_OK) {
    work_destroy(work);
  }
  conductor_changed(conductor, id);
  return status == STATUS_OK;
}

/* One look at all studies; true when there is more to do at once. */
static bool look(struct conductor *conductor) {
  struct study_job *list = NULL;
  struct error error = {.status = STATUS_OK};
  size_t count = 0;
  bool more = begin_next(conductor);
  more = conductor_delete(conductor) || more;
  if (store_studies_live(conductor->settings.store, &list, &count, &error) != STATUS_OK) {
    log_event(LOG_LEVEL_ERROR, "cannot read the studies", LOG_TEXT("error", error.message));
    return false;
  }
  works_sweep(conductor, list, count);
  for (size_t i = 0; i < count; i++) {
    bool rest = false;
    if (list[i].state == JOB_STATE_CANCELLING) {
      rest = step_cancel(conductor, list[i].id);
    } else if (list[i].state == JOB_STATE_HELD) {
      rest = conductor_follow(conductor, list[i].id, STUDY_HOLD);
    } else if (list[i].state == JOB_STATE_RUNNING) {
      rest = step_run(conductor, &list[i]);
    }
    more = more || rest;
  }
  free(list);
  return more;
}

/* Waits for news, at least for the pace; false once the conductor ends. */
static bool await_news(struct conductor *conductor, bool more) {
  struct timespec idle = clock_deadline(IDLE_MS), pace;
  pthread_mutex_lock(&conductor->mutex);
  while (!more && !conductor->woken && !conductor->stopping &&
         pthread_cond_timedwait(&conductor->news, &conductor->mutex, &idle) == 0) {
  }
  conductor->woken = false;
  pthread_mutex_unlock(&conductor->mutex);
  pace = clock_deadline(more ? 1 : PACE_MS);
  pthread_mutex_lock(&conductor->mutex);
  while (!conductor->stopping &&
         pthread_cond_timedwait(&conductor->news, &conductor->mutex, &pace) == 0) {
  }
  bool stopping = conductor->stopping;
  pthread_mutex_unlock(&conductor->mutex);
  return !stopping;
}

static void *conductor_main(void *context) {
  struct conductor *conductor = context;
  bool more = true;
  while (await_news(conductor, more)) {
    more = look(conductor);
  }
  return NULL;
}

enum status conductor_start(struct conductor *conductor, struct executor *executor,
                            struct error *error) {
  conductor->executor = executor;
  if (pthread_create(&conductor->thread, NULL, conductor_main, conductor) != 0) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "Cannot start the thread of the studies.");
  }
  conductor->started = true;
  return STATUS_OK;
}

void conductor_wake(struct conductor *conductor) {
  pthread_mutex_lock(&conductor->mutex);
  conductor->woken = true;
  pthread_cond_signal(&conductor->news);
  pthread_mutex_unlock(&conductor->mutex);
}

bool conductor_progress(struct conductor *conductor, int64_t job_id, struct progress *progress) {
  bool found = false;
  pthread_mutex_lock(&conductor->mutex);
  for (const struct work *work = conductor->first; work && !found; work = work->next) {
    found = work->id == job_id && work->progress.fraction >= 0;
    if (found) {
      *progress = work->progress;
    }
  }
  pthread_mutex_unlock(&conductor->mutex);
  return found;
}

void conductor_stop(struct conductor *conductor) {
  if (!conductor) {
    return;
  }
  pthread_mutex_lock(&conductor->mutex);
  conductor->stopping = true;
  pthread_cond_broadcast(&conductor->news);
  pthread_mutex_unlock(&conductor->mutex);
  if (conductor->started) {
    pthread_join(conductor->thread, NULL);
    conductor->started = false;
  }
  while (conductor->first) {
    work_requeue(&conductor->settings, conductor->first, NULL);
    work_drop(conductor, conductor->first);
  }
}

void conductor_destroy(struct conductor *conductor) {
  if (!conductor) {
    return;
  }
  conductor_stop(conductor);
  pthread_cond_destroy(&conductor->news);
  pthread_mutex_destroy(&conductor->mutex);
  free(conductor);
}
