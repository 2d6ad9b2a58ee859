/* Inside the conductor, shared by its files. */
#ifndef PNEULAB_STUDY_CONDUCTOR_INTERNAL_H
#define PNEULAB_STUDY_CONDUCTOR_INTERNAL_H

#include <pthread.h>

#include "server/study/work.h"

struct conductor {
  struct conductor_settings settings;
  struct executor *executor;
  pthread_t thread;
  bool started;
  struct work *first; /* changed by the thread only, under the mutex */
  pthread_mutex_t mutex;
  pthread_cond_t news; /* guarded by the mutex, as what follows */
  bool woken, stopping;
};

void conductor_complain(int64_t id, const struct error *error);

/* Tells that a job has changed; or all members of a study, of which many were cancelled at once:
 * somebody may wait for one of them. */
void conductor_changed(struct conductor *conductor, int64_t id);
void conductor_changed_members(struct conductor *conductor, int64_t id);

/* Lets the members that wait follow; true when there may be more of them. */
bool conductor_follow(struct conductor *conductor, int64_t id, enum study_order order);

/* Asks the workers of a study to end. */
void conductor_cancel_running(struct conductor *conductor, int64_t id);

/* Deletes members of studies that were deleted; true when there may be more. */
bool conductor_delete(struct conductor *conductor);

#endif
