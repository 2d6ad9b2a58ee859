#include "server/http/waiters.h"

#include <microhttpd.h>
#include <pthread.h>
#include <stdlib.h>

#include "server/base/clock.h"

enum { WAITERS_MAX = 256 };

struct waiter {
  struct MHD_Connection *connection;
  int64_t job_id;
  int64_t until_ms;
};

struct waiters {
  pthread_mutex_t mutex;
  struct waiter list[WAITERS_MAX];
  size_t count;
};

enum status waiters_create(struct waiters **waiters, struct error *error) {
  *waiters = calloc(1, sizeof **waiters);
  if (!*waiters) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for waiting requests.");
  }
  pthread_mutex_init(&(*waiters)->mutex, NULL);
  return STATUS_OK;
}

void waiters_destroy(struct waiters *waiters) {
  if (waiters) {
    pthread_mutex_destroy(&waiters->mutex);
    free(waiters);
  }
}

bool waiters_add(struct waiters *waiters, struct MHD_Connection *connection, int64_t job_id,
                 int64_t wait_ms) {
  pthread_mutex_lock(&waiters->mutex);
  bool room = waiters->count < WAITERS_MAX;
  if (room) {
    waiters->list[waiters->count++] =
        (struct waiter){connection, job_id, clock_monotonic_ms() + wait_ms};
  }
  pthread_mutex_unlock(&waiters->mutex);
  return room;
}

bool waiters_want(struct waiters *waiters, int64_t job_id) {
  bool wanted = false;
  pthread_mutex_lock(&waiters->mutex);
  for (size_t i = 0; i < waiters->count && !wanted; i++) {
    wanted = waiters->list[i].job_id == job_id;
  }
  pthread_mutex_unlock(&waiters->mutex);
  return wanted;
}

/* Resumes the waiters of a job, or (job_id 0) those whose time is over at now_ms. Under the mutex:
 * a connection is resumed exactly once. */
static void waiters_resume(struct waiters *waiters, int64_t job_id, int64_t now_ms) {
  pthread_mutex_lock(&waiters->mutex);
  size_t kept = 0;
  for (size_t i = 0; i < waiters->count; i++) {
    struct waiter waiter = waiters->list[i];
    if (job_id != 0 ? waiter.job_id == job_id : waiter.until_ms <= now_ms) {
      MHD_resume_connection(waiter.connection);
    } else {
      waiters->list[kept++] = waiter;
    }
  }
  waiters->count = kept;
  pthread_mutex_unlock(&waiters->mutex);
}

void waiters_job_ended(struct waiters *waiters, int64_t job_id) {
  waiters_resume(waiters, job_id, 0);
}

void waiters_expire(struct waiters *waiters, bool all) {
  waiters_resume(waiters, 0, all ? INT64_MAX : clock_monotonic_ms());
}
