#include "server/slurm/slurm.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/launch/environment.h"
#include "server/slurm/index.h"
#include "server/slurm/metrics.h"
#include "server/slurm/slurm_internal.h"

/* Looks at the files of tasks that find nothing: as often as keeps their processor time below
 * 1/LOOK_SHARE of a core; at the progress of members more rarely; commands of the cluster may take
 * COMMAND_MS. */
enum {
  LOOK_MS = 200,
  LOOK_MOST_MS = 5000,
  LOOK_SHARE = 200,
  IDLE_MS = 500,
  PROGRESS_MS = 1000,
  COMMAND_MS = 20000,
  STORE_RETRY_MS = 1000
};

/* ---- whether the cluster answers ---------------------------------------------------------- */

bool slurm_answers(struct slurm *slurm) {
  pthread_mutex_lock(&slurm->mutex);
  bool answers = slurm->reachable && !slurm->stopping;
  pthread_mutex_unlock(&slurm->mutex);
  return answers;
}

void slurm_note_trouble(struct slurm *slurm, const char *text) {
  pthread_mutex_lock(&slurm->mutex);
  bool differs = strncmp(slurm->trouble, text, sizeof slurm->trouble - 1) != 0;
  snprintf(slurm->trouble, sizeof slurm->trouble, "%.*s", (int)sizeof slurm->trouble - 1, text);
  pthread_mutex_unlock(&slurm->mutex);
  if (differs) {
    store_probe(slurm->settings.engine.store, NULL); /* views of jobs that wait are made anew */
  }
}

void slurm_note_answer(struct slurm *slurm, const struct error *error) {
  if (error && error->status == STATUS_CANCELLED) {
    return; /* it was we who gave up */
  }
  pthread_mutex_lock(&slurm->mutex);
  bool differs = !slurm->asked || slurm->reachable != !error;
  slurm->asked = true;
  slurm->reachable = !error;
  pthread_mutex_unlock(&slurm->mutex);
  if (error) {
    slurm_note_trouble(slurm, error->message);
  }
  if (differs && error) {
    log_event(LOG_LEVEL_WARNING, "the cluster does not answer", LOG_TEXT("reason", error->message));
  } else if (differs) {
    log_line("the cluster answers");
    slurm_note_trouble(slurm, "");
    slurm->plan_at_ms = 0;
  }
}

/* ---- the thread --------------------------------------------------------------------------- */

/* For struct ending. */
static bool pause_for_store(void *context) {
  struct slurm *slurm = context;
  struct timespec until = clock_deadline(STORE_RETRY_MS);
  pthread_mutex_lock(&slurm->mutex);
  while (!slurm->stopping && pthread_cond_timedwait(&slurm->news, &slurm->mutex, &until) == 0) {
  }
  bool stopping = slurm->stopping;
  pthread_mutex_unlock(&slurm->mutex);
  return !stopping;
}

/* For the client. */
static bool stop_wanted(void *context) {
  struct slurm *slurm = context;
  pthread_mutex_lock(&slurm->mutex);
  bool stopping = slurm->stopping;
  pthread_mutex_unlock(&slurm->mutex);
  return stopping;
}

/* Looks at all files. */
static void look(struct slurm *slurm) {
  int64_t now = clock_monotonic_ms();
  struct timespec before, after;
  bool progress = now >= slurm->progress_at_ms;
  bool any = false;
  struct slurm_batch *next;
  if (now < slurm->look_at_ms) {
    return;
  }
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &before);
  for (struct slurm_batch *batch = slurm->first; batch; batch = next) {
    next = batch->next;
    any = batch_look(batch, progress) || any;
    if (batch->open == 0) {
      batch_drop(batch);
      any = true;
    }
  }
  any = any || slurm->ends > 0;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &after);
  ends_flush(slurm);
  double took_s =
      (double)(after.tv_sec - before.tv_sec) + 1e-9 * (double)(after.tv_nsec - before.tv_nsec);
  int64_t pace_ms = (int64_t)(1000 * took_s * LOOK_SHARE);
  pace_ms = pace_ms < LOOK_MS || any ? LOOK_MS : pace_ms; /* what is new takes time of its own */
  slurm->look_at_ms = now + (pace_ms < LOOK_MOST_MS ? pace_ms : LOOK_MOST_MS);
  if (progress) {
    slurm->progress_at_ms = now + PROGRESS_MS;
  }
  pthread_mutex_lock(&slurm->mutex);
  slurm->figures.command_cpu_s = slurm->client.cpu_s;
  slurm->figures.look_cpu_s +=
      (double)(after.tv_sec - before.tv_sec) + 1e-9 * (double)(after.tv_nsec - before.tv_nsec);
  pthread_mutex_unlock(&slurm->mutex);
}

/* Waits until there is something to do; false once the engine ends. */
static bool await_news(struct slurm *slurm) {
  int64_t now = clock_monotonic_ms(), wait_ms = slurm->first ? slurm->look_at_ms - now : IDLE_MS;
  struct timespec until = clock_deadline(wait_ms > 1 ? wait_ms : 1);
  pthread_mutex_lock(&slurm->mutex);
  while (!slurm->woken && !slurm->stopping &&
         pthread_cond_timedwait(&slurm->news, &slurm->mutex, &until) == 0) {
  }
  slurm->woken = false;
  if (slurm->planning) {
    slurm->plan_at_ms = 0;
    slurm->planning = false;
  }
  bool stopping = slurm->stopping;
  pthread_mutex_unlock(&slurm->mutex);
  return !stopping;
}

static void *slurm_main(void *context) {
  struct slurm *slurm = context;
  while (await_news(slurm)) {
    slurm_recall(slurm);
    slurm_cancels(slurm);
    look(slurm);
    slurm_poll(slurm);
    ends_flush(slurm);
    slurm_submit_batches(slurm);
    slurm_plan(slurm);
    slurm_submit_batches(slurm);
  }
  ends_flush(slurm);
  return NULL;
}

/* ---- the engine --------------------------------------------------------------------------- */

static void engine_wake(void *engine) {
  struct slurm *slurm = engine;
  pthread_mutex_lock(&slurm->mutex);
  slurm->woken = slurm->planning = true;
  pthread_cond_signal(&slurm->news);
  pthread_mutex_unlock(&slurm->mutex);
}

static void engine_cancel(void *engine, int64_t job_id) {
  struct slurm *slurm = engine;
  pthread_mutex_lock(&slurm->mutex);
  struct slurm_member *member = index_find(&slurm->index, job_id);
  if (member) {
    member->cancel = true;
    slurm->cancels = slurm->woken = true;
    pthread_cond_signal(&slurm->news);
  }
  pthread_mutex_unlock(&slurm->mutex);
}

/* What the store has taken back is found by comparing. */
static void engine_recall(void *engine) {
  struct slurm *slurm = engine;
  pthread_mutex_lock(&slurm->mutex);
  slurm->recall = slurm->woken = true;
  pthread_cond_signal(&slurm->news);
  pthread_mutex_unlock(&slurm->mutex);
}

static bool engine_progress(void *engine, int64_t job_id, struct progress *progress) {
  struct slurm *slurm = engine;
  pthread_mutex_lock(&slurm->mutex);
  const struct slurm_member *member = index_find(&slurm->index, job_id);
  const struct slurm_follow *follow = member ? member->task->follow : NULL;
  bool found = follow && follow->running != NO_MEMBER &&
               &member->task->member[follow->running] == member && follow->progress.fraction >= 0;
  if (found) {
    *progress = follow->progress;
  }
  pthread_mutex_unlock(&slurm->mutex);
  return found;
}

/* What a task is doing, for people; under the mutex. */
static json_t *task_place(const struct slurm *slurm, const struct slurm_member *member) {
  const struct slurm_task *task = member->task;
  const struct slurm_batch *batch = task->batch;
  const struct slurm_follow *follow = task->follow;
  const char *message = "", *state = slurm_state_word(task->state);
  const char *partition = batch->partition[0] ? batch->partition : slurm->settings.partition;
  bool turn = follow && follow->running != NO_MEMBER && &task->member[follow->running] == member;
  if (batch->cluster_job == 0) {
    state = "waiting";
    message = slurm->trouble[0] ? slurm->trouble : "It is being handed to the cluster.";
  } else if (task->state == SLURM_PENDING && task->reason[0]) {
    message = slurm_reason_sentence(task->reason);
  } else if (task->phase == TASK_RUNS && !turn) {
    message = "Its task runs and solves others before it.";
  }
  return json_pack("{s:s, s:s, s:o, s:i, s:s, s:s, s:s, s:s}", "engine", "slurm", "state", state,
                   "job", batch->cluster_job ? json_integer(batch->cluster_job) : json_null(),
                   "task", (int)task->index, "reason", task->reason, "message",
                   message ? message : "The cluster gives this reason.", "partition", partition,
                   "node", task->node);
}

static json_t *engine_place(void *engine, int64_t job_id, enum store_engine asked, bool waits) {
  struct slurm *slurm = engine;
  const struct store_taste taste = slurm->settings.taste;
  bool ours = taste.engine == ENGINE_NONE || asked == taste.engine ||
              (asked == ENGINE_NONE && taste.others);
  json_t *place = NULL;
  pthread_mutex_lock(&slurm->mutex);
  const struct slurm_member *member = index_find(&slurm->index, job_id);
  if (member && !waits) {
    place = task_place(slurm, member);
  } else if (waits && ours && slurm->trouble[0]) {
    place =
        json_pack("{s:s, s:s, s:n, s:n, s:s, s:s, s:s, s:s}", "engine", "slurm", "state", "waiting",
                  "job", "task", "reason", slurm->reachable ? "refused" : "unreachable", "message",
                  slurm->trouble, "partition", slurm->settings.partition, "node", "");
  }
  pthread_mutex_unlock(&slurm->mutex);
  return place;
}

static enum status engine_check(void *engine, struct error *error) {
  (void)engine;
  (void)error;
  return STATUS_OK; /* jobs wait for a cluster that does not answer; so does nobody else */
}

static void engine_drain(void *engine) {
  struct slurm *slurm = engine;
  pthread_mutex_lock(&slurm->mutex);
  slurm->draining = true;
  pthread_mutex_unlock(&slurm->mutex);
}

static bool engine_idle(void *engine) {
  (void)engine;
  return true; /* what runs there goes on without us */
}

static void engine_stop(void *engine, bool abort) {
  struct slurm *slurm = engine;
  (void)abort;
  pthread_mutex_lock(&slurm->mutex);
  slurm->draining = slurm->stopping = true;
  pthread_cond_broadcast(&slurm->news);
  pthread_mutex_unlock(&slurm->mutex);
}

static void engine_destroy(void *engine) {
  struct slurm *slurm = engine;
  engine_stop(slurm, false);
  if (slurm->started) {
    pthread_join(slurm->thread, NULL);
  }
  while (slurm->first) {
    struct slurm_batch *next = slurm->first->next;
    for (size_t i = 0; i < slurm->first->count; i++) {
      for (size_t k = 0; k < slurm->first->task[i].count; k++) {
        index_remove(&slurm->index, &slurm->first->task[i].member[k]);
      }
    }
    batch_free(slurm->first);
    slurm->first = next;
  }
  for (size_t i = 0; slurm->environment && slurm->environment[i]; i++) {
    free(slurm->environment[i]);
  }
  free(slurm->environment);
  pthread_cond_destroy(&slurm->news);
  pthread_mutex_destroy(&slurm->mutex);
  free(slurm);
}

/* ---- the beginning ------------------------------------------------------------------------ */

/* What the programs of the cluster, and thereby tasks, have of the daemon's environment. */
static enum status environment_make(struct slurm *slurm, struct error *error) {
  static const char *const kept[] = {WORKER_VARIABLES, "HOME", "USER", "LOGNAME", "SLURM_CONF"};
  enum { KEPT = sizeof kept / sizeof *kept };
  size_t count = 0;
  slurm->environment = calloc(KEPT + 3, sizeof *slurm->environment);
  bool good = slurm->environment != NULL;
  for (size_t i = 0; i < KEPT && good; i++) {
    const char *value = getenv(kept[i]);
    if (value) {
      good = asprintf(&slurm->environment[count++], "%s=%s", kept[i], value) > 0;
    }
  }
  if (good) { /* lists of tasks are not to be cut */
    good = (slurm->environment[count++] = strdup("SLURM_BITSTR_LEN=0")) != NULL &&
           (slurm->environment[count++] = strdup("LC_ALL=C")) != NULL;
  }
  return good ? STATUS_OK : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the cluster.");
}

/* The path as the nodes are to find it; a bare name is looked up in PATH there. */
static enum status path_make(char path[PATH_MAX], const char *from, struct error *error) {
  if (!strchr(from, '/')) {
    snprintf(path, PATH_MAX, "%s", from);
    return STATUS_OK;
  }
  return realpath(from, path) ? STATUS_OK
                              : error_set(error, STATUS_NOT_FOUND, NULL, "Cannot find %s: %s.",
                                          from, strerrordesc_np(errno));
}

static enum status slurm_start(struct slurm *slurm, struct error *error) {
  enum status status = environment_make(slurm, error);
  slurm->client = (struct slurm_client){.environment = slurm->environment,
                                        .timeout_ms = COMMAND_MS,
                                        .stop = stop_wanted,
                                        .context = slurm};
  slurm->ending = (struct ending){&slurm->settings.engine, pause_for_store, slurm};
  slurm->troubles = disk_troubles(slurm->settings.engine.disk);
  if (status == STATUS_OK && !realpath(slurm->settings.engine.data, slurm->data)) {
    status = error_set(error, STATUS_NOT_FOUND, NULL, "Cannot find %s: %s.",
                       slurm->settings.engine.data, strerrordesc_np(errno));
  }
  if (status == STATUS_OK) {
    status = path_make(slurm->solver, slurm->settings.engine.solver, error);
  }
  if (status == STATUS_OK) {
    status = files_write_script(slurm, error);
  }
  if (status == STATUS_OK) {
    status = slurm_adopt(slurm, error);
  }
  if (status == STATUS_OK && pthread_create(&slurm->thread, NULL, slurm_main, slurm) != 0) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "Cannot start the thread of the cluster.");
  }
  slurm->started = status == STATUS_OK;
  return status;
}

enum status slurm_create(const struct slurm_settings *settings, struct engine *engine,
                         struct error *error) {
  static const struct engine_methods methods = {.name = "slurm",
                                                .wake = engine_wake,
                                                .cancel = engine_cancel,
                                                .recall = engine_recall,
                                                .progress = engine_progress,
                                                .place = engine_place,
                                                .check = engine_check,
                                                .drain = engine_drain,
                                                .idle = engine_idle,
                                                .stop = engine_stop,
                                                .metrics = slurm_metrics,
                                                .destroy = engine_destroy};
  struct slurm *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the cluster.");
  }
  made->settings = *settings;
  pthread_mutex_init(&made->mutex, NULL);
  clock_condition_init(&made->news);
  enum status status = slurm_start(made, error);
  if (status != STATUS_OK) {
    engine_destroy(made);
    return status;
  }
  *engine = (struct engine){&methods, made};
  return STATUS_OK;
}
