#include "server/exec/ending.h"

#include <stdio.h>
#include <stdlib.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/exec/tally.h"

/* Outcomes stored in one transaction. */
enum { TOGETHER_MAX = 64 };

static void complain(const struct outcome *outcome, const struct error *error) {
  log_event(LOG_LEVEL_ERROR, error->message, LOG_NUMBER("job", outcome->attempt.job_id),
            LOG_NUMBER("attempt", outcome->attempt.attempt));
}

struct ending_job ending_job_read(const struct ending *ending, int64_t job_id, int64_t attempt) {
  const struct engine_settings *settings = ending->settings;
  struct ending_job job = {.start_ms = clock_monotonic_ms()};
  struct job_record record;
  if (store_job(settings->store, job_id, &record, NULL) == STATUS_OK) {
    snprintf(job.kind, sizeof job.kind, "%s", record.kind);
    if (attempt == 1) {
      tally_waited(settings->tally, 1e-3 * (double)(record.started_ms - record.created_ms));
    }
    job_record_clear(&record);
  }
  return job;
}

void ending_fill(const struct ending *ending, int64_t job_id, int64_t attempt, unsigned troubles,
                 char directory[ENDING_DIRECTORY_SIZE], struct outcome *outcome) {
  const struct engine_settings *settings = ending->settings;
  if (outcome->attempt.end == ATTEMPT_WORKER_LOST && disk_blamed(settings->disk, troubles)) {
    outcome_set_requeued(outcome);
  }
  run_directory(job_id, attempt, directory);
  outcome->attempt.job_id = job_id;
  outcome->attempt.attempt = attempt;
  outcome->attempt.directory = directory;
  outcome->attempt.retry_delay_ms = (int64_t)(1000 * settings->retry_delay_s);
}

static void count_one(const struct ending *ending, const struct ending_job *job,
                      const struct outcome *outcome, enum job_state state) {
  struct tally_attempt ended = {.kind = job->kind,
                                .state = job_state_word(state),
                                .reason = outcome->attempt.reason_code,
                                .final = job_state_terminal(state),
                                .wall_s = 1e-3 * (double)(clock_monotonic_ms() - job->start_ms),
                                .peak_memory_MB = outcome->attempt.peak_memory_MB};
  tally_ended(ending->settings->tally, &ended);
  tally_attempt_ended(ending->settings->tally, outcome->attempt.end, outcome->attempt.cpu_s);
  log_event(state == JOB_STATE_FAILED ? LOG_LEVEL_WARNING : LOG_LEVEL_INFO, "attempt ended",
            LOG_NUMBER("job", outcome->attempt.job_id),
            LOG_NUMBER("attempt", outcome->attempt.attempt), LOG_TEXT("kind", ended.kind),
            LOG_TEXT("state", ended.state), LOG_TEXT("reason", ended.reason),
            LOG_NUMBER("wall_s", ended.wall_s), LOG_NUMBER("cpu_s", outcome->attempt.cpu_s),
            LOG_NUMBER("memory_MB", ended.peak_memory_MB));
}

static enum status store_one(const struct ending *ending, struct outcome *outcome,
                             enum job_state *state, struct error *error) {
  struct store *store = ending->settings->store;
  enum status status, before = STATUS_OK;
  while (store_failed(status = store_attempt_finish(store, &outcome->attempt, state, error))) {
    if (status != before) {
      complain(outcome, error);
      before = status;
    }
    if (!ending->pause(ending->context)) {
      return status;
    }
  }
  if (status == STATUS_CONFLICT && outcome->attempt.result_text) {
    outcome_set_unstorable(outcome, error);
    status = store_attempt_finish(store, &outcome->attempt, state, error);
  }
  return status;
}

static void finish_one(const struct ending *ending, const struct ending_job *job,
                       struct outcome *outcome) {
  struct error error;
  enum job_state state;
  if (store_one(ending, outcome, &state, &error) == STATUS_OK) {
    count_one(ending, job, outcome, state);
  } else {
    complain(outcome, &error);
  }
}

static void store_some(const struct ending *ending, const struct ending_job *const *jobs,
                       struct outcome *const *outcomes, size_t count) {
  const struct engine_settings *settings = ending->settings;
  const struct attempt_outcome *attempts[TOGETHER_MAX] = {NULL};
  enum job_state states[TOGETHER_MAX];
  struct error error;
  for (size_t i = 0; i < count; i++) {
    attempts[i] = &outcomes[i]->attempt;
  }
  bool together = count > 1 && store_attempts_finish(settings->store, attempts, count, states,
                                                     &error) == STATUS_OK;
  for (size_t i = 0; i < count; i++) {
    if (together) {
      count_one(ending, jobs[i], outcomes[i], states[i]);
    } else {
      finish_one(ending, jobs[i], outcomes[i]);
    }
  }
}

void ending_store(const struct ending *ending, const struct ending_job *const *jobs,
                  struct outcome *const *outcomes, size_t count) {
  for (size_t done = 0; done < count; done += TOGETHER_MAX) {
    size_t some = count - done < TOGETHER_MAX ? count - done : TOGETHER_MAX;
    store_some(ending, jobs + done, outcomes + done, some);
  }
}
