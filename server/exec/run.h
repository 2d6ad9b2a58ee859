/* One attempt from claim to outcome: the part that deals with files and the worker process. */
#ifndef PNEULAB_EXEC_RUN_H
#define PNEULAB_EXEC_RUN_H

#include <limits.h>
#include <stdint.h>

#include "server/exec/outcome.h"
#include "server/exec/progress.h"

struct run_settings {
  const char *data;   /* data directory */
  const char *solver; /* program to run */
  const struct isolation *isolation;
  uint64_t memory_limit_bytes; /* of each process */
  uint64_t files_limit_bytes;  /* of all files of an attempt; 0: none */
  double time_limit_s;
  double timeout_margin_s;
};

/* What the run asks of and tells its owner; called on the thread of run_attempt. */
struct run_hooks {
  void *context;
  /* The worker was started. STATUS_CONFLICT when the attempt should not go on. */
  enum status (*started)(void *context, int64_t pid);
  void (*progressed)(void *context, const struct progress *progress);
  /* STOP_CANCEL, STOP_SHUTDOWN or STOP_ABORT once the worker is to end. */
  enum stop_cause (*stop_wanted)(void *context);
};

enum { RUN_DIRECTORY_SIZE = STORE_DIRECTORY_SIZE };

/* Writes the attempt's folder "attempts/JOB-NUMBER", relative to the data directory. */
void run_directory(int64_t job_id, int64_t attempt, char name[RUN_DIRECTORY_SIZE]);

/* Runs the worker of a claimed attempt to its end and judges it. Files in the attempt's folder:
 * job.json, events.jsonl, log.txt, result.json (once complete), out/ with the artifacts. A worker
 * asked to stop gets SIGTERM, and SIGKILL five seconds later. *outcome is for the caller to
 * clear. */
void run_attempt(const struct run_settings *settings, const struct claim *claim,
                 const struct run_hooks *hooks, struct outcome *outcome);

#endif
