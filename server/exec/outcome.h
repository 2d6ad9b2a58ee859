/* From the end of a worker to what it means for its job. */
#ifndef PNEULAB_EXEC_OUTCOME_H
#define PNEULAB_EXEC_OUTCOME_H

#include <jansson.h>
#include <stdbool.h>

#include "server/exec/process.h"
#include "server/store/store.h"

/* Why the daemon itself asked a worker to end. */
enum stop_cause {
  STOP_NONE,
  STOP_CANCEL,
  STOP_TIMEOUT,
  STOP_FILES, /* they exceed their limit together */
  STOP_SHUTDOWN,
  STOP_ABORT /* a shutdown that waits for nobody */
};

/* The end of an attempt with everything that struct attempt_outcome points to. */
struct outcome {
  struct attempt_outcome attempt;
  char reason_code[64];
  char message[400];
  char *result_text;
  json_t *result;
  json_t *artifacts;
};

/* Judges a worker that ended as *end after the daemon stopped it for `cause`; output_path holds
 * what it printed, artifacts_dir its files. Exit codes of the solver: 0 succeeded, 2 invalid job,
 * 3 stopped early with a result, 4 internal error, 5 cancelled. Fills *outcome (but the ids,
 * directory and retry delay), which the caller clears. */
void outcome_judge(struct outcome *outcome, const struct process_end *end, enum stop_cause cause,
                   const char *output_path, const char *artifacts_dir);

/* Names the cause of a worker's death that the limit of its memory (bytes, 0: none) explains: it
 * said so itself, or it had used most of it. Such a job is not tried again. */
void outcome_blame_memory(struct outcome *outcome, const struct process_end *end,
                          uint64_t limit_bytes);

/* An outcome without a result, of which no worker has told anything. */
void outcome_make(struct outcome *outcome, enum attempt_end end, const char *reason_code,
                  const char *format, ...) __attribute__((format(printf, 4, 5)));

/* The outcome of a worker that could not be started. */
void outcome_not_started(struct outcome *outcome, const struct error *error);

/* The files that the result refers to could not be made durable: without them it is no result. */
void outcome_set_files_lost(struct outcome *outcome, const struct error *error);

/* The disk, not the worker, is to blame for a lost attempt: it does not count, and the job is
 * queued again. */
void outcome_set_requeued(struct outcome *outcome);

/* The process ended before the job, one of several, had its turn: it is queued again. */
void outcome_put_back(struct outcome *outcome);

/* Makes a failure without a result of an outcome whose result the store refused. */
void outcome_set_unstorable(struct outcome *outcome, const struct error *error);

void outcome_clear(struct outcome *outcome);

/* Whether `result` has the form of a result document: "status" a text, "metrics" an object of
 * numbers, "samples" an array of objects. *error says what is wrong. */
bool result_check(const json_t *result, struct error *error);

#endif
