#include "server/http/snapshots.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/base/clock.h"

enum { KEPT_MS = 60000 };

struct snapshots {
  struct store *store;
  const char *data;
  void (*done)(void *context, int64_t ticket);
  void *context;
  pthread_t thread;
  atomic_bool stopping;
  pthread_mutex_t mutex; /* guards everything below */
  pthread_cond_t asked;
  int64_t wanted, begun, ended; /* tickets */
  int fd;                       /* of the newest copy, -1 when there is none */
  struct error failure;         /* of the newest try */
};

static bool snapshot_stopped(void *context) {
  const struct snapshots *snapshots = context;
  return atomic_load(&snapshots->stopping);
}

/* Makes one copy: an open file without a name, or -1. */
static int snapshot_make(struct snapshots *snapshots, struct error *error) {
  char path[PATH_MAX];
  int length = snprintf(path, sizeof path, "%s/tmp/snapshot-XXXXXX", snapshots->data);
  int fd = length > 0 && (size_t)length < sizeof path ? mkostemp(path, O_CLOEXEC) : -1;
  if (fd < 0) {
    enum status status = errno == ENOSPC || errno == EDQUOT ? STATUS_NO_SPACE : STATUS_IO;
    error_set(error, status, NULL, "Cannot create a file for the copy: %s.",
              strerrordesc_np(errno));
    return -1;
  }
  if (store_snapshot(snapshots->store, path, snapshot_stopped, snapshots, error) != STATUS_OK) {
    close(fd);
    fd = -1;
  }
  unlink(path);
  return fd;
}

/* Waits until a copy is wanted, and forgets the last one when its time is over; false at the end.
 * With the mutex held. */
static bool snapshots_wait(struct snapshots *snapshots) {
  struct timespec until = clock_deadline(KEPT_MS);
  while (snapshots->wanted <= snapshots->begun && !atomic_load(&snapshots->stopping)) {
    if (snapshots->fd < 0) {
      pthread_cond_wait(&snapshots->asked, &snapshots->mutex);
    } else if (pthread_cond_timedwait(&snapshots->asked, &snapshots->mutex, &until) == ETIMEDOUT) {
      close(snapshots->fd);
      snapshots->fd = -1;
    }
  }
  return !atomic_load(&snapshots->stopping);
}

static void *snapshots_main(void *context) {
  struct snapshots *snapshots = context;
  pthread_mutex_lock(&snapshots->mutex);
  while (snapshots_wait(snapshots)) {
    struct error failure = {.status = STATUS_OK};
    int64_t ticket = ++snapshots->begun;
    pthread_mutex_unlock(&snapshots->mutex);
    int fd = snapshot_make(snapshots, &failure);
    pthread_mutex_lock(&snapshots->mutex);
    if (snapshots->fd >= 0) {
      close(snapshots->fd);
    }
    snapshots->fd = fd;
    snapshots->failure = failure;
    snapshots->ended = ticket;
    pthread_mutex_unlock(&snapshots->mutex);
    snapshots->done(snapshots->context, ticket);
    pthread_mutex_lock(&snapshots->mutex);
  }
  pthread_mutex_unlock(&snapshots->mutex);
  return NULL;
}

enum status snapshots_create(struct store *store, const char *data,
                             void (*done)(void *context, int64_t ticket), void *context,
                             struct snapshots **snapshots, struct error *error) {
  struct snapshots *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for copies of the database.");
  }
  made->store = store;
  made->data = data;
  made->done = done;
  made->context = context;
  made->fd = -1;
  pthread_mutex_init(&made->mutex, NULL);
  clock_condition_init(&made->asked);
  if (pthread_create(&made->thread, NULL, snapshots_main, made) != 0) {
    pthread_cond_destroy(&made->asked);
    pthread_mutex_destroy(&made->mutex);
    free(made);
    return error_set(error, STATUS_NO_MEMORY, NULL, "Cannot start the thread of the copies.");
  }
  *snapshots = made;
  return STATUS_OK;
}

void snapshots_destroy(struct snapshots *snapshots) {
  if (!snapshots) {
    return;
  }
  pthread_mutex_lock(&snapshots->mutex);
  atomic_store(&snapshots->stopping, true);
  pthread_cond_broadcast(&snapshots->asked);
  pthread_mutex_unlock(&snapshots->mutex);
  pthread_join(snapshots->thread, NULL);
  if (snapshots->fd >= 0) {
    close(snapshots->fd);
  }
  pthread_cond_destroy(&snapshots->asked);
  pthread_mutex_destroy(&snapshots->mutex);
  free(snapshots);
}

int64_t snapshots_ask(struct snapshots *snapshots) {
  pthread_mutex_lock(&snapshots->mutex);
  int64_t ticket = snapshots->begun + 1;
  snapshots->wanted = ticket;
  pthread_cond_broadcast(&snapshots->asked);
  pthread_mutex_unlock(&snapshots->mutex);
  return ticket;
}

bool snapshots_done(struct snapshots *snapshots, int64_t ticket) {
  pthread_mutex_lock(&snapshots->mutex);
  bool done = snapshots->ended >= ticket;
  pthread_mutex_unlock(&snapshots->mutex);
  return done;
}

enum status snapshots_take(struct snapshots *snapshots, int64_t ticket, int *fd, int64_t *size,
                           struct error *error) {
  enum status status = STATUS_OK;
  struct stat info;
  *fd = -1;
  pthread_mutex_lock(&snapshots->mutex);
  if (snapshots->ended < ticket) {
    status = error_set(error, STATUS_BUSY, NULL, "The copy of the database is not finished.");
  } else if (snapshots->fd < 0) {
    status = snapshots->failure.status;
    if (status == STATUS_OK) {
      status = error_set(error, STATUS_BUSY, NULL, "The copy of the database was not fetched.");
    } else if (error) {
      *error = snapshots->failure;
    }
  } else if (fstat(snapshots->fd, &info) != 0 ||
             (*fd = fcntl(snapshots->fd, F_DUPFD_CLOEXEC, 0)) < 0) {
    status = error_set(error, STATUS_IO, NULL, "Cannot open the copy: %s.", strerrordesc_np(errno));
  } else {
    *size = (int64_t)info.st_size;
  }
  pthread_mutex_unlock(&snapshots->mutex);
  return status;
}
