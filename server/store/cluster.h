/* What a cluster solves, in the database: batches (job arrays), their tasks, and the attempts that
 * each task solves. See schema/0007-cluster.sql. */
#ifndef PNEULAB_STORE_CLUSTER_H
#define PNEULAB_STORE_CLUSTER_H

#include "server/store/store.h"

enum { CLUSTER_NAME_SIZE = 80, CLUSTER_WORD_SIZE = 64 };

/* An attempt that a task is to solve, or solves. */
struct cluster_attempt {
  int64_t job_id, attempt;
  double timeout_s;      /* the job's own, 0: none */
  uint64_t memory_bytes; /* likewise */
  enum job_state state;  /* of the job */
  int64_t task, place;
};

/* A batch that has not ended. */
struct cluster_batch {
  int64_t id;
  char name[CLUSTER_NAME_SIZE];
  int64_t cluster_job; /* 0: not known to be submitted */
  char partition[CLUSTER_WORD_SIZE];
  int64_t created_ms;
  size_t tasks;
};

/* Makes a batch of attempts that have been claimed (sorted by task, then by place) durable before
 * the cluster is asked for it: from now on a restart does not take them for lost. Fills batch->id
 * and batch->name; partition and tasks are the caller's. */
enum status store_batch_intend(struct store *store, struct cluster_batch *batch,
                               const struct cluster_attempt *attempts, size_t count,
                               struct error *error);

/* Notes the number under which the cluster has the batch. */
enum status store_batch_submitted(struct store *store, int64_t id, int64_t cluster_job,
                                  struct error *error);

/* Notes that nothing more comes of the batch. */
enum status store_batch_ended(struct store *store, int64_t id, struct error *error);

/* What is new of a task. Words as in the table; node NULL: as before. */
struct cluster_task_news {
  int64_t batch_id, task;
  const char *state, *reason, *node;
};

/* Writes what is new of tasks, in one transaction. */
enum status store_tasks_note(struct store *store, const struct cluster_task_news *news,
                             size_t count, struct error *error);

/* The batches that have not ended, oldest first; *list malloc'd. */
enum status store_batches_open(struct store *store, struct cluster_batch **list, size_t *count,
                               struct error *error);

/* The attempts of a batch that have not ended, in the order of tasks and places; *list malloc'd. */
enum status store_batch_attempts(struct store *store, int64_t id, struct cluster_attempt **list,
                                 size_t *count, struct error *error);

/* The partition that a job or its study asks for with the label "partition", "" for none. */
enum status store_job_partition(struct store *store, int64_t id, char partition[CLUSTER_WORD_SIZE],
                                struct error *error);

#endif
