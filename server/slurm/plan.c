/* What is handed to the cluster next: jobs are claimed, bundled into tasks and tasks into arrays.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/exec/tally.h"
#include "server/slurm/slurm_internal.h"

/* Tasks that wait at least and tasks of one array, jobs claimed and time spent in one round;
 * tasks that each core is to get of a queue; and what is believed of an unknown kind. */
enum {
  WAITING_LEAST = 16,
  TASKS_MAX = 256,
  ROUND_JOBS = 4096,
  ROUND_MS = 1000,
  CORES_MS = 60000,
  TASKS_A_CORE = 3,
  PLAN_IDLE_MS = 500
};
static const double unknown_s = 4, start_up_s = 60;

/* ---- what jobs take ----------------------------------------------------------------------- */

static struct slurm_kind *kind_find(struct slurm *slurm, const char *name) {
  for (size_t i = 0; i < slurm->kinds; i++) {
    if (strcmp(slurm->kind[i].name, name) == 0) {
      return &slurm->kind[i];
    }
  }
  return NULL;
}

void kinds_learn(struct slurm *slurm, const struct slurm_member *member,
                 const struct outcome *outcome) {
  struct slurm_kind *kind = kind_find(slurm, member->job.kind);
  double cpu_s = outcome->attempt.cpu_s;
  if (cpu_s <= 0) {
    return;
  }
  if (kind) {
    kind->mean_s += 0.2 * (cpu_s - kind->mean_s);
  } else if (slurm->kinds < SLURM_KINDS_MAX) {
    kind = &slurm->kind[slurm->kinds++];
    snprintf(kind->name, sizeof kind->name, "%s", member->job.kind);
    kind->mean_s = cpu_s;
  }
}

/* ---- claims ------------------------------------------------------------------------------- */

/* The queue of a round: tasks in the order of their making. */
struct plan {
  struct slurm *slurm;
  struct draft *first;
  size_t tasks, jobs;
  size_t bundle_max; /* jobs of a task, so that all cores get some */
};

static uint64_t memory_limit(const struct engine_settings *settings, const struct claim *claim) {
  uint64_t most = settings->memory_limit_bytes, own = claim->memory_bytes;
  return own != 0 && (most == 0 || own < most) ? own : most;
}

static void draft_take_member(struct slurm *slurm, struct draft *draft, struct claim *claim) {
  const struct engine_settings *settings = &slurm->settings.engine;
  struct draft_member *member = &draft->member[draft->count];
  double limit_s = claim->timeout_s > 0 ? claim->timeout_s : settings->time_limit_s;
  struct ending_job job = ending_job_read(&slurm->ending, claim->job_id, claim->attempt);
  const struct slurm_kind *kind = kind_find(slurm, job.kind);
  *member = (struct draft_member){.job_id = claim->job_id,
                                  .attempt = claim->attempt,
                                  .time_limit_s = limit_s + settings->timeout_margin_s,
                                  .document = claim->document,
                                  .start = draft->count == 0};
  snprintf(member->kind, sizeof member->kind, "%s", job.kind);
  claim->document = NULL;
  draft->count++;
  if (claim->timeout_s > 0) {
    draft->time_s += member->time_limit_s;
  } else {
    draft->rest_s = member->time_limit_s;
  }
  draft->mean_s += kind ? kind->mean_s : unknown_s;
}

/* A claim, with those behind it in its chain, as a task; NULL without memory. */
static struct draft *draft_create(struct slurm *slurm, struct claim *claim) {
  const struct engine_settings *settings = &slurm->settings.engine;
  struct draft *draft = calloc(1, sizeof *draft);
  struct job_record record;
  size_t count = 0;
  for (const struct claim *at = claim; at; at = at->next) {
    count += at->job_id != 0;
  }
  if (draft) {
    draft->room = count;
    draft->member = calloc(count, sizeof *draft->member);
  }
  if (!draft || !draft->member) {
    free(draft);
    return NULL;
  }
  draft->before_id = claim->before_id;
  draft->before_attempt = claim->before_attempt;
  draft->memory_bytes = memory_limit(settings, claim);
  draft->memory_own = claim->memory_bytes != 0;
  store_job_partition(settings->store, claim->job_id, draft->partition, NULL);
  if (store_job(settings->store, claim->job_id, &record, NULL) == STATUS_OK) {
    draft->priority = record.priority;
    job_record_clear(&record);
  }
  for (struct claim *at = claim; at; at = at->next) {
    if (at->job_id != 0) {
      draft_take_member(slurm, draft, at);
      settings->changed(settings->context, at->job_id);
    } else if (at->answered_id != 0) {
      settings->changed(settings->context, at->answered_id);
    }
  }
  tally_attempts_started(settings->tally, (unsigned)count);
  return draft;
}

/* Puts a draft to an open task that it fits, or makes it one of its own. */
static void plan_add(struct plan *plan, struct draft *draft) {
  double most_s = plan->slurm->settings.bundle_s;
  struct draft **at = &plan->first;
  plan->jobs += draft->count;
  for (; *at; at = &(*at)->next) {
    size_t count = (*at)->count + draft->count;
    bool fits = count <= plan->bundle_max && count <= DRAFT_MEMBERS_MAX &&
                (*at)->mean_s + draft->mean_s <= most_s && draft->before_id == 0 &&
                draft_alike(*at, draft);
    if (fits && draft_append(*at, draft, NULL) == STATUS_OK) {
      return;
    }
  }
  *at = draft;
  plan->tasks++;
}

/* Puts a claimed job back that cannot be handed over. */
static void put_back(struct slurm *slurm, int64_t job_id, int64_t attempt, const char *kind,
                     const char *why) {
  struct outcome outcome, *outcomes = &outcome;
  struct ending_job job = {.start_ms = clock_monotonic_ms()};
  const struct ending_job *jobs = &job;
  char directory[ENDING_DIRECTORY_SIZE];
  snprintf(job.kind, sizeof job.kind, "%s", kind);
  outcome_make(&outcome, ATTEMPT_REQUEUED, "not_submitted", "%s", why);
  ending_fill(&slurm->ending, job_id, attempt, slurm->troubles, directory, &outcome);
  ending_store(&slurm->ending, &jobs, &outcomes, 1);
  outcome_clear(&outcome);
}

static void draft_put_back(struct slurm *slurm, const struct draft *draft,
                           const struct error *why) {
  log_event(LOG_LEVEL_ERROR, why->message, LOG_NUMBER("jobs", draft->count));
  for (size_t k = 0; k < draft->count; k++) {
    const struct draft_member *member = &draft->member[k];
    put_back(slurm, member->job_id, member->attempt, member->kind, why->message);
  }
}

/* Claims until there are enough tasks, or no jobs. */
static void claim_some(struct plan *plan, size_t tasks) {
  struct slurm *slurm = plan->slurm;
  const struct engine_settings *settings = &slurm->settings.engine;
  int64_t until = clock_monotonic_ms() + ROUND_MS;
  bool claimed = true;
  while (claimed && plan->jobs < ROUND_JOBS && plan->tasks < tasks &&
         clock_monotonic_ms() < until) {
    struct claim claim = {0};
    struct error error;
    if (store_claim_for(settings->store, slurm->settings.taste, &claim, &claimed, &error) !=
        STATUS_OK) {
      log_event(LOG_LEVEL_ERROR, "cannot take a job", LOG_TEXT("error", error.message));
      claimed = false;
    } else if (claimed) {
      struct draft *draft = draft_create(slurm, &claim);
      for (const struct claim *at = &claim; at && !draft; at = at->next) {
        if (at->job_id != 0) {
          put_back(slurm, at->job_id, at->attempt, "", "There is no memory for it.");
        }
      }
      claimed = draft != NULL;
      if (draft) {
        plan_add(plan, draft);
      }
    } else if (claim.answered_id != 0) {
      settings->changed(settings->context, claim.answered_id);
      claimed = true; /* there may be more */
    }
    claim_clear(&claim);
  }
}

/* ---- arrays ------------------------------------------------------------------------------- */

/* Takes the tasks that are like the first one out of the plan. */
static struct draft *plan_take(struct plan *plan, size_t *count) {
  struct draft *taken = plan->first, **last = &taken->next, **at = &taken->next;
  plan->first = taken->next;
  at = &plan->first;
  *last = NULL;
  *count = 1;
  while (*at && *count < TASKS_MAX) {
    struct draft *draft = *at;
    if (draft_alike(taken, draft)) {
      *at = draft->next;
      draft->next = NULL;
      *last = draft;
      last = &draft->next;
      (*count)++;
    } else {
      at = &draft->next;
    }
  }
  return taken;
}

static enum status task_fill(struct slurm_task *task, const struct draft *draft,
                             struct error *error) {
  enum status status = task_create(task, draft->count, error);
  for (size_t k = 0; k < draft->count && status == STATUS_OK; k++) {
    struct slurm_member *member = &task->member[k];
    member->job_id = draft->member[k].job_id;
    member->attempt = draft->member[k].attempt;
    member->time_limit_s = draft->member[k].time_limit_s;
    member->job.start_ms = clock_monotonic_ms();
    snprintf(member->job.kind, sizeof member->job.kind, "%s", draft->member[k].kind);
  }
  return status;
}

/* Makes the batch durable, then its folders. */
static enum status batch_prepare(struct slurm_batch *batch, const struct draft *drafts,
                                 struct error *error) {
  struct slurm *slurm = batch->slurm;
  size_t count = 0, at = 0, index = 0;
  for (const struct draft *draft = drafts; draft; draft = draft->next) {
    count += draft->count;
  }
  struct cluster_attempt *attempts = calloc(count, sizeof *attempts);
  struct cluster_batch row = {.tasks = batch->count};
  if (!attempts) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a batch of jobs.");
  }
  for (const struct draft *draft = drafts; draft; draft = draft->next, index++) {
    for (size_t k = 0; k < draft->count; k++) {
      attempts[at++] = (struct cluster_attempt){.job_id = draft->member[k].job_id,
                                                .attempt = draft->member[k].attempt,
                                                .task = (int64_t)index,
                                                .place = (int64_t)k};
    }
  }
  memcpy(row.partition, batch->partition, sizeof row.partition);
  enum status status =
      store_batch_intend(slurm->settings.engine.store, &row, attempts, count, error);
  free(attempts);
  if (status == STATUS_OK) {
    char name[CLUSTER_NAME_SIZE + 16];
    batch->id = row.id;
    memcpy(batch->name, row.name, sizeof batch->name);
    snprintf(name, sizeof name, CLUSTER_FOLDER "/%s", row.name);
    status = run_path(batch->folder, slurm->data, name)
                 ? files_write_batch(batch, error)
                 : error_set(error, STATUS_TOO_LARGE, NULL, "The path of a batch is too long.");
  }
  index = 0;
  for (const struct draft *draft = drafts; draft && status == STATUS_OK; draft = draft->next) {
    status = files_write_task(&batch->task[index++], draft, error);
  }
  return status;
}

/* Makes an array of tasks; without it their jobs are put back. */
static void batch_make(struct slurm *slurm, struct draft *drafts, size_t count) {
  struct slurm_batch *batch = NULL;
  struct error error = {.status = STATUS_OK};
  size_t index = 0;
  enum status status = batch_create(slurm, count, &batch, &error);
  if (status == STATUS_OK) {
    batch->memory_bytes = drafts->memory_bytes;
    batch->memory_own = drafts->memory_own;
    batch->priority = drafts->priority;
    memcpy(batch->partition, drafts->partition, sizeof batch->partition);
  }
  for (const struct draft *draft = drafts; draft && status == STATUS_OK; draft = draft->next) {
    batch->time_s = fmax(batch->time_s, draft->time_s + draft->rest_s + start_up_s);
    status = task_fill(&batch->task[index++], draft, &error);
  }
  if (status == STATUS_OK) {
    status = batch_prepare(batch, drafts, &error);
  }
  if (status == STATUS_OK) {
    batch_enlist(batch);
  }
  for (struct draft *draft = drafts, *next; draft; draft = next) {
    next = draft->next;
    if (status != STATUS_OK) {
      draft_put_back(slurm, draft, &error);
    }
    draft_destroy(draft);
  }
  if (status != STATUS_OK) {
    if (batch && batch->id != 0) {
      store_batch_ended(slurm->settings.engine.store, batch->id, NULL);
    }
    batch_free(batch);
  }
}

/* ---- the round ---------------------------------------------------------------------------- */

/* Tasks that are to be handed over: as many wait as run, so that a free core finds one and the
 * others keep their place in our own queue, where they can be put in another order. */
static size_t tasks_wanted(struct slurm *slurm) {
  pthread_mutex_lock(&slurm->mutex);
  size_t waiting = slurm->tasks_waiting, wanted = slurm->tasks_running;
  bool open = slurm->reachable && !slurm->draining && !slurm->stopping;
  pthread_mutex_unlock(&slurm->mutex);
  size_t most = slurm->settings.queue;
  wanted = wanted < slurm->cores ? slurm->cores : wanted;
  wanted = wanted < WAITING_LEAST ? WAITING_LEAST : wanted;
  wanted = wanted < most ? wanted : most;
  return open && wanted > waiting ? wanted - waiting : 0;
}

/* Whether all batches so far are known to be with the cluster. */
static bool all_submitted(const struct slurm *slurm) {
  for (const struct slurm_batch *batch = slurm->first; batch; batch = batch->next) {
    if (batch->cluster_job == 0) {
      return false;
    }
  }
  return true;
}

static void look_for_cores(struct slurm *slurm) {
  int64_t now = clock_monotonic_ms();
  struct error error;
  unsigned cores = 0;
  if (now < slurm->cores_at_ms) {
    return;
  }
  slurm->cores_at_ms = now + CORES_MS;
  if (slurm_cores(&slurm->client, slurm->settings.partition, &cores, &error) == STATUS_OK &&
      cores > 0) {
    slurm->cores = cores;
  }
}

void slurm_plan(struct slurm *slurm) {
  const struct engine_settings *settings = &slurm->settings.engine;
  struct plan plan = {.slurm = slurm};
  int64_t now = clock_monotonic_ms(), ready = 0;
  size_t tasks = tasks_wanted(slurm);
  if (now < slurm->plan_at_ms || tasks == 0 || !all_submitted(slurm) ||
      disk_check(settings->disk, NULL) != STATUS_OK) {
    return;
  }
  slurm->plan_at_ms = now + PLAN_IDLE_MS;
  if (store_ready(settings->store, &ready, NULL) != STATUS_OK) {
    return;
  }
  if (ready > 0) {
    look_for_cores(slurm);
  }
  double share = (double)ready / (TASKS_A_CORE * (slurm->cores ? slurm->cores : 4));
  plan.bundle_max = share > 1 ? (size_t)ceil(share) : 1;
  claim_some(&plan, tasks);
  while (plan.first) {
    size_t count;
    struct draft *drafts = plan_take(&plan, &count);
    batch_make(slurm, drafts, count);
  }
}
