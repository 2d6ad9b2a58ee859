/* Runs studies: a thread that takes jobs of the kind "study", stores their members as jobs of their
 * own, lets those follow what becomes of the study, and when all have ended makes its result. The
 * members themselves are run by the executor. After a restart a study goes on where it was. */
#ifndef PNEULAB_STUDY_CONDUCTOR_H
#define PNEULAB_STUDY_CONDUCTOR_H

#include "server/exec/disk.h"
#include "server/exec/executor.h"
#include "server/exec/progress.h"
#include "server/store/store.h"
#include "solver/job/spec.h"

struct conductor;

struct conductor_settings {
  struct store *store;
  const char *data;                /* data directory; lives as long as the conductor */
  struct disk *disk;               /* nothing is stored while it is in trouble */
  const struct job_reader *reader; /* lives as long as the conductor */
  /* Called after changes of a job's state, from the conductor's thread. */
  void (*changed)(void *context, int64_t job_id);
  /* Called when a study has got on, likewise. */
  void (*progressed)(void *context, int64_t job_id, int64_t attempt,
                     const struct progress *progress);
  void *context;
};

/* The settings are copied. Nothing runs before conductor_start. The caller owns *conductor. */
enum status conductor_create(const struct conductor_settings *settings,
                             struct conductor **conductor, struct error *error);

/* Starts the thread; the executor runs the members, and lives until
 * conductor_stop. STATUS_NO_MEMORY. */
enum status conductor_start(struct conductor *conductor, struct executor *executor,
                            struct error *error);

/* Tells that a job has changed. From any thread; costs next to nothing. */
void conductor_wake(struct conductor *conductor);

/* How far a running study is; false when it does not run. */
bool conductor_progress(struct conductor *conductor, int64_t job_id, struct progress *progress);

/* Ends the thread; running studies are put back into the queue. NULL is fine. */
void conductor_stop(struct conductor *conductor);

/* Stops. NULL is fine. */
void conductor_destroy(struct conductor *conductor);

#endif
