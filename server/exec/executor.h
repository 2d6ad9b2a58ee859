/* What runs jobs. An engine takes jobs out of the store, has them solved and stores the outcomes:
 * the pool of processes of this machine (pool.h), or a cluster (server/slurm/slurm.h). The executor
 * is all engines of a daemon; its functions may be called from any thread and wait for nobody but
 * executor_destroy. */
#ifndef PNEULAB_EXEC_EXECUTOR_H
#define PNEULAB_EXEC_EXECUTOR_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "server/exec/disk.h"
#include "server/exec/progress.h"
#include "server/store/store.h"

struct executor;
struct tally;

/* What an engine can do. Each function has the engine as its first argument and answers for its own
 * jobs alone; those that may be NULL say so. */
struct engine_methods {
  const char *name; /* "local", as logs and views have it */
  /* A job may have become ready. */
  void (*wake)(void *engine);
  /* The store has marked the job cancelling: its worker is to end. */
  void (*cancel)(void *engine, int64_t job_id);
  /* The store may have taken back jobs that wait with the engine. May be NULL. */
  void (*recall)(void *engine);
  /* What a running job has reported; false when it does not run here. */
  bool (*progress)(void *engine, int64_t job_id, struct progress *progress);
  /* Where a job is and what it waits for, as an object for people, a new reference; NULL when there
   * is nothing to tell. asked: whose job it is; waits: in the queue of the store. May be NULL. */
  json_t *(*place)(void *engine, int64_t job_id, enum store_engine asked, bool waits);
  /* Whether workers can be started. STATUS_NOT_FOUND with the reason. */
  enum status (*check)(void *engine, struct error *error);
  /* No job is started any more. */
  void (*drain)(void *engine);
  /* Whether nothing runs that the end of the daemon would end, too. */
  bool (*idle)(void *engine);
  /* Ends what still runs and would end with the daemon, without waiting for it; `abort`: at once.
   */
  void (*stop)(void *engine, bool abort);
  /* Writes metrics of its own in the text form of Prometheus. */
  void (*metrics)(void *engine, FILE *out);
  /* Stops, joins the threads and frees. */
  void (*destroy)(void *engine);
};

struct engine {
  const struct engine_methods *methods;
  void *self;
};

/* What every engine needs. */
struct engine_settings {
  struct store *store;
  struct disk *disk;   /* no attempt is begun while it is in trouble */
  struct tally *tally; /* of the executor */
  const char *data;    /* data directory; lives as long as the engine */
  const char *solver;  /* likewise */
  uint64_t memory_limit_bytes;
  uint64_t files_limit_bytes; /* of all files of an attempt; 0: none */
  double time_limit_s, timeout_margin_s, retry_delay_s;
  /* Called after every change of a job's state, from any of the engine's threads. */
  void (*changed)(void *context, int64_t job_id);
  /* Called when a running job has reported, likewise. */
  void (*progressed)(void *context, int64_t job_id, int64_t attempt,
                     const struct progress *progress);
  void *context;
};

enum { EXECUTOR_ENGINES_MAX = 2 };

/* An executor without engines; the caller owns *executor. */
enum status executor_create(struct executor **executor, struct error *error);

/* Takes over an engine. Before any other thread uses the executor; at most EXECUTOR_ENGINES_MAX. */
void executor_add(struct executor *executor, struct engine engine);

/* Tells that a job may have become ready. */
void executor_wake(struct executor *executor);

/* Ends the worker of a job that the store has marked cancelling, if one runs. */
void executor_cancel(struct executor *executor, int64_t job_id);

/* Tells that jobs may have been taken back from a cluster into the queue. */
void executor_recall(struct executor *executor);

/* What a running job has reported; false when it does not run here. */
bool executor_progress(struct executor *executor, int64_t job_id, struct progress *progress);

/* Where a job is: see struct engine_methods. A new reference, NULL when there is nothing to tell.
 */
json_t *executor_place(struct executor *executor, int64_t job_id, enum store_engine asked,
                       bool waits);

/* Whether workers can be started. STATUS_NOT_FOUND with the reason of the first engine that
 * cannot. */
enum status executor_check(struct executor *executor, struct error *error);

/* What workers' ends were, owned by the executor. */
struct tally *executor_tally(struct executor *executor);

/* No job is started any more. */
void executor_drain(struct executor *executor);

/* Whether nothing runs that would end with the daemon. */
bool executor_idle(struct executor *executor);

/* Ends what still runs here and puts those jobs back into the queue, without waiting for it:
 * processes get SIGTERM, then five seconds; with `abort` SIGKILL at once. */
void executor_stop(struct executor *executor, bool abort);

/* Writes the metrics of all engines and of the tally in the text form of Prometheus. */
void executor_metrics(struct executor *executor, FILE *out);

/* Stops, then joins the threads. NULL is fine. */
void executor_destroy(struct executor *executor);

#endif
