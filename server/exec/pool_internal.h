/* Inside of the pool: its threads, and what they do with single jobs and with bundles. */
#ifndef PNEULAB_EXEC_POOL_INTERNAL_H
#define PNEULAB_EXEC_POOL_INTERNAL_H

#include <pthread.h>

#include "server/exec/bundle.h"
#include "server/exec/ending.h"
#include "server/exec/pool.h"

/* One thread of the pool and the job it runs. */
struct slot {
  struct pool *pool;
  pthread_t thread;
  struct ending ending;
  int64_t job_id; /* 0: none */
  int64_t attempt;
  bool cancel;
  struct progress progress;
  const struct claim *member[BUNDLE_MEMBERS_MAX]; /* of a bundle, in the order of the chain */
  struct ending_job job[BUNDLE_MEMBERS_MAX];
  bool cancelled[BUNDLE_MEMBERS_MAX];
  size_t members; /* 0: a single job */
};

struct pool {
  struct pool_settings settings;
  pthread_mutex_t mutex; /* guards everything below */
  pthread_cond_t work;   /* a job may be ready, or the pool ends */
  bool draining, stopping, aborting;
  unsigned wakes; /* counts pool_wake, so that none is missed */
  unsigned busy;  /* threads with a worker */
  unsigned thread_count;
  struct slot slots[];
};

/* Writes a failure to the log. */
void slot_complain(const struct slot *slot, const struct error *error);

/* How the worker of a claim is to be run. */
void slot_run_settings(const struct slot *slot, const struct claim *claim,
                       struct run_settings *run);

/* Runs the claimed members of a chain in one process. */
void slot_run_bundle(struct slot *slot, const struct claim *claim);

#endif
