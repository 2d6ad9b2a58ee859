#include "server/http/analyst.h"

#include <pthread.h>
#include <stdlib.h>

enum { WAIT_MS = 600000 };

static const int64_t first_number = INT64_C(1) << 40; /* those below are of copies */

/* One request and what it is answered. */
struct task {
  struct task *next;
  struct request *request;
  handler *handle;
  struct reply reply;
  int64_t number;
  bool done;
};

struct analyst {
  void (*done)(void *context, int64_t waited);
  void *context;
  pthread_t thread;
  pthread_mutex_t mutex; /* guards everything below */
  pthread_cond_t changed;
  struct task *first; /* in the order of the numbers; until they are fetched */
  int64_t number;     /* of the last one */
  bool stopping, joined;
};

/* The first task that nobody has begun; with the mutex held. */
static struct task *next_task(const struct analyst *analyst) {
  struct task *task = analyst->first;
  while (task && task->done) {
    task = task->next;
  }
  return task;
}

static void *analyst_main(void *context) {
  struct analyst *analyst = context;
  pthread_mutex_lock(&analyst->mutex);
  for (;;) {
    struct task *task = next_task(analyst);
    if (!task && analyst->stopping) {
      break;
    }
    if (!task) {
      pthread_cond_wait(&analyst->changed, &analyst->mutex);
      continue;
    }
    bool stopping = analyst->stopping;
    int64_t number = task->number;
    pthread_mutex_unlock(&analyst->mutex);
    if (stopping) {
      reply_shutting_down(&task->reply);
    } else {
      task->handle(task->request, &task->reply);
    }
    pthread_mutex_lock(&analyst->mutex);
    task->done = true; /* whoever waits may free it from now on */
    pthread_cond_broadcast(&analyst->changed);
    pthread_mutex_unlock(&analyst->mutex);
    analyst->done(analyst->context, -number);
    pthread_mutex_lock(&analyst->mutex);
  }
  pthread_mutex_unlock(&analyst->mutex);
  return NULL;
}

enum status analyst_create(void (*done)(void *context, int64_t waited), void *context,
                           struct analyst **analyst, struct error *error) {
  struct analyst *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for analyses.");
  }
  made->done = done;
  made->context = context;
  made->number = first_number;
  pthread_mutex_init(&made->mutex, NULL);
  pthread_cond_init(&made->changed, NULL);
  if (pthread_create(&made->thread, NULL, analyst_main, made) != 0) {
    pthread_cond_destroy(&made->changed);
    pthread_mutex_destroy(&made->mutex);
    free(made);
    return error_set(error, STATUS_NO_MEMORY, NULL, "Cannot start the thread of analyses.");
  }
  *analyst = made;
  return STATUS_OK;
}

void analyst_stop(struct analyst *analyst) {
  if (!analyst) {
    return;
  }
  pthread_mutex_lock(&analyst->mutex);
  bool joined = analyst->joined;
  analyst->stopping = analyst->joined = true;
  pthread_cond_broadcast(&analyst->changed);
  pthread_mutex_unlock(&analyst->mutex);
  if (!joined) {
    pthread_join(analyst->thread, NULL);
  }
}

void analyst_destroy(struct analyst *analyst) {
  if (!analyst) {
    return;
  }
  analyst_stop(analyst);
  for (struct task *task = analyst->first; task;) { /* nobody came for these answers */
    struct task *next = task->next;
    reply_clear(&task->reply);
    free(task);
    task = next;
  }
  pthread_cond_destroy(&analyst->changed);
  pthread_mutex_destroy(&analyst->mutex);
  free(analyst);
}

/* The task of a number, or NULL; with the mutex held. */
static struct task **place_of(struct analyst *analyst, int64_t number) {
  struct task **place = &analyst->first;
  while (*place && (*place)->number != number) {
    place = &(*place)->next;
  }
  return place;
}

bool analyst_done(struct analyst *analyst, int64_t waited) {
  if (-waited <= first_number) {
    return false;
  }
  pthread_mutex_lock(&analyst->mutex);
  const struct task *task = *place_of(analyst, -waited);
  bool done = !task || task->done;
  pthread_mutex_unlock(&analyst->mutex);
  return done;
}

/* Replies with what the thread has made of the request, waiting for it if need be. */
static void fetch(struct request *request, struct reply *reply) {
  struct analyst *analyst = request->service->analyst;
  pthread_mutex_lock(&analyst->mutex);
  struct task **place = place_of(analyst, -request->job_id), *task = *place;
  while (task && !task->done) {
    pthread_cond_wait(&analyst->changed, &analyst->mutex);
  }
  if (task) {
    place = place_of(analyst, task->number); /* others may have gone meanwhile */
    *place = task->next;
  }
  pthread_mutex_unlock(&analyst->mutex);
  if (task) {
    *reply = task->reply;
    free(task);
  } else {
    reply_shutting_down(reply);
  }
}

void analyst_defer(struct request *request, struct reply *reply, handler *handle) {
  struct analyst *analyst = request->service->analyst;
  struct task *task = calloc(1, sizeof *task);
  if (!task) {
    reply_text(reply, "application/json", NULL, 0); /* no memory */
    return;
  }
  task->request = request;
  task->handle = handle;
  reply_init(&task->reply);
  pthread_mutex_lock(&analyst->mutex);
  bool stopping = analyst->stopping;
  if (!stopping) {
    task->number = ++analyst->number;
    request->job_id = -task->number;
    reply->wait_job_id = request->job_id;
    reply->wait_ms = WAIT_MS;
    reply->then = fetch;
    *place_of(analyst, 0) = task; /* at the end: no task has that number */
    pthread_cond_broadcast(&analyst->changed);
  }
  pthread_mutex_unlock(&analyst->mutex);
  if (stopping) {
    free(task);
    reply_shutting_down(reply);
  }
}
