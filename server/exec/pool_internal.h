/* Inside of the pool: its threads, and what they do with single jobs and with bundles. */
#ifndef PNEULAB_EXEC_POOL_INTERNAL_H
#define PNEULAB_EXEC_POOL_INTERNAL_H

#include <pthread.h>

#include "server/exec/bundle.h"
#include "server/exec/pool.h"
#include "server/exec/tally.h"

enum { SLOT_DIRECTORY_SIZE = RUN_DIRECTORY_SIZE + 8 };

/* What is known of the job when its attempt starts, for the counts. */
struct slot_job {
  char kind[40];
  int64_t start_ms; /* monotonic */
};

/* One thread of the pool and the job it runs. */
struct slot {
  struct pool *pool;
  pthread_t thread;
  int64_t job_id; /* 0: none */
  int64_t attempt;
  bool cancel;
  struct progress progress;
  const struct claim *member[BUNDLE_MEMBERS_MAX]; /* of a bundle, in the order of the chain */
  struct slot_job job[BUNDLE_MEMBERS_MAX];
  bool cancelled[BUNDLE_MEMBERS_MAX];
  size_t members; /* 0: a single job */
};

struct pool {
  struct pool_settings settings;
  pthread_mutex_t mutex; /* guards everything below */
  pthread_cond_t work;   /* a job may be ready, or the pool ends */
  bool draining, stopping, aborting;
  unsigned wakes; /* counts pool_wake, so that none is missed */
  struct pool_statistics statistics;
  struct tally *tally; /* has a lock of its own */
  unsigned thread_count;
  struct slot slots[];
};

/* Writes a failure to the log. */
void slot_complain(const struct slot *slot, const struct error *error);

/* Reads what the counts need to know of a job whose attempt starts. */
struct slot_job slot_job_read(struct slot *slot, const struct claim *claim);

/* Counts an attempt that has ended, and writes it to the log. */
void slot_count(struct slot *slot, const struct slot_job *job, const struct outcome *outcome,
                enum job_state state);

/* Stores the outcome and counts it. */
void slot_finish(struct slot *slot, const struct slot_job *job, struct outcome *outcome);

/* How the worker of a claim is to be run. */
void slot_run_settings(const struct slot *slot, const struct claim *claim,
                       struct run_settings *run);

/* Completes an outcome for the store; `troubles` are those of the disk when the attempt began.
 * `directory` gets the name of its folder, and lives as long as the outcome. */
void slot_fill(struct slot *slot, const struct claim *claim, unsigned troubles,
               char directory[SLOT_DIRECTORY_SIZE], struct outcome *outcome);

/* Runs the claimed members of a chain in one process. */
void slot_run_bundle(struct slot *slot, const struct claim *claim);

#endif
