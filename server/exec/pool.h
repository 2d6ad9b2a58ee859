/* The local executor: a fixed number of threads, each running one worker process at a time for
 * the oldest job in the store. */
#ifndef PNEULAB_EXEC_POOL_H
#define PNEULAB_EXEC_POOL_H

#include <stdbool.h>
#include <stdint.h>

#include "server/exec/isolation.h"
#include "server/exec/disk.h"
#include "server/exec/progress.h"
#include "server/store/store.h"

struct pool;
struct tally;

struct pool_settings {
  struct store *store;
  struct disk *disk;                 /* no attempt is begun while it is in trouble */
  const char *data;                  /* data directory; lives as long as the pool */
  const char *solver;                /* likewise */
  const struct isolation *isolation; /* likewise */
  unsigned workers;
  uint64_t memory_limit_bytes;
  uint64_t files_limit_bytes; /* of all files of an attempt; 0: none */
  double time_limit_s, timeout_margin_s, retry_delay_s;
  /* Called after every change of a job's state, from any of the pool's threads. */
  void (*changed)(void *context, int64_t job_id);
  /* Called when a running job has reported, likewise. */
  void (*progressed)(void *context, int64_t job_id, int64_t attempt,
                     const struct progress *progress);
  void *context;
};

/* Counters since the start. */
struct pool_statistics {
  unsigned workers, busy;
  uint64_t attempts_started;
  uint64_t attempts_ended[ATTEMPT_REQUEUED + 1]; /* by enum attempt_end */
  double cpu_s;                                  /* of ended workers */
};

/* Starts the threads; the settings are copied. The caller owns *pool. */
enum status pool_create(const struct pool_settings *settings, struct pool **pool,
                        struct error *error);

/* Tells the pool that a job may have become ready. */
void pool_wake(struct pool *pool);

/* Ends the worker of a job that the store has marked cancelling, if one runs. */
void pool_cancel(struct pool *pool, int64_t job_id);

/* What a running job has reported; false when it does not run here. */
bool pool_progress(struct pool *pool, int64_t job_id, struct progress *progress);

void pool_statistics(struct pool *pool, struct pool_statistics *statistics);

/* Whether workers can be started: the launcher and the solver are there. STATUS_NOT_FOUND. */
enum status pool_check(const struct pool *pool, struct error *error);

/* What the workers' ends were, owned by the pool. */
struct tally *pool_tally(struct pool *pool);

/* No job is started any more. */
void pool_drain(struct pool *pool);

/* Whether no worker runs. */
bool pool_idle(struct pool *pool);

/* Ends what still runs and puts those jobs back into the queue, without waiting for it: workers get
 * SIGTERM, then five seconds; with `abort` SIGKILL at once. */
void pool_stop(struct pool *pool, bool abort);

/* Stops, then joins the threads. NULL is fine. */
void pool_destroy(struct pool *pool);

#endif
