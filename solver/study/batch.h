/* Solves light members of a study, many to a process. */
#ifndef PNEULAB_STUDY_BATCH_H
#define PNEULAB_STUDY_BATCH_H

#include <stdatomic.h>
#include "solver/job/study.h"
#include "solver/study/child.h"
#include "solver/study/store.h"
#include "solver/study/study_run.h"

/* What has become of a member. */
enum batch_fate { BATCH_OPEN, BATCH_SOLVED, BATCH_FAILED };

/* What one process is at. */
struct batch_place {
  atomic_size_t member;         /* its index and 1; 0: none */
  _Atomic(double) since_wall_s; /* clock_wall_s when it began */
};

/* Memory that all processes of a study share: each takes the next member when it has done one, so
 * that all are busy to the end. */
struct batch_board {
  size_t bytes;
  atomic_size_t next; /* in batch.todo */
  struct batch_place place[STUDY_JOBS_MAX];
  _Atomic(unsigned char) fate[]; /* of each member: enum batch_fate */
};

/* Everything that the processes need; it does not change while they run, but for the board. */
struct batch {
  const struct job_reader *reader;
  const json_t *document; /* the study */
  const struct study *study;
  const struct member_store *store;
  const size_t *todo; /* members to be solved */
  size_t todo_count;
  bool (*cancelled)(void *context);
  struct batch_board *board;
};

/* Creates the board for `members` members, owned by the caller. STATUS_NO_MEMORY. */
enum status batch_board_create(size_t members, struct batch_board **board, struct error *error);
void batch_board_destroy(struct batch_board *board);

/* Starts a process, number `place` of those of the study, that solves members until none is left or
 * it is asked to end. A solved member has its result in the store; one that failed has there what
 * member_store_error gives. STATUS_OK or STATUS_IO. */
enum status batch_start(const struct batch *batch, int place, struct child *child,
                        struct error *error);

#endif
