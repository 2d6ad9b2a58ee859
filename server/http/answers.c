#include "server/http/answers.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "server/store/store.h"

enum { SLOTS = 256 }; /* a job has the slot of its id modulo this */

struct answers {
  struct store *store;
  pthread_mutex_t mutex;
  struct {
    int64_t job_id;
    uint64_t version;
    struct answer *answer;
  } views[SLOTS];
  struct {
    int64_t job_id;
    const char *names[PLOT_NAMES]; /* static texts */
  } plots[SLOTS];
};

enum status answers_create(struct store *store, struct answers **answers, struct error *error) {
  struct answers *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for answers.");
  }
  made->store = store;
  pthread_mutex_init(&made->mutex, NULL);
  *answers = made;
  return STATUS_OK;
}

void answers_destroy(struct answers *answers) {
  if (!answers) {
    return;
  }
  for (size_t i = 0; i < SLOTS; i++) {
    if (answers->views[i].answer) {
      answer_release(answers->views[i].answer->text);
    }
  }
  pthread_mutex_destroy(&answers->mutex);
  free(answers);
}

struct answer *answers_find(struct answers *answers, int64_t job_id) {
  size_t at = (size_t)job_id % SLOTS;
  uint64_t version = store_version(answers->store);
  struct answer *found = NULL;
  pthread_mutex_lock(&answers->mutex);
  if (answers->views[at].job_id == job_id && answers->views[at].version == version) {
    found = answers->views[at].answer;
    atomic_fetch_add(&found->uses, 1);
  }
  pthread_mutex_unlock(&answers->mutex);
  return found;
}

void answer_release(void *text) {
  struct answer *answer = (struct answer *)((char *)text - offsetof(struct answer, text));
  if (atomic_fetch_sub(&answer->uses, 1) == 1) {
    free(answer);
  }
}

void answers_keep(struct answers *answers, int64_t job_id, uint64_t version, const char *text,
                  size_t size) {
  size_t at = (size_t)job_id % SLOTS;
  struct answer *made = malloc(sizeof *made + size);
  if (!made) {
    return;
  }
  atomic_init(&made->uses, 1);
  made->size = size;
  memcpy(made->text, text, size);
  pthread_mutex_lock(&answers->mutex);
  struct answer *before = answers->views[at].answer;
  answers->views[at].job_id = job_id;
  answers->views[at].version = version;
  answers->views[at].answer = made;
  pthread_mutex_unlock(&answers->mutex);
  if (before) {
    answer_release(before->text);
  }
}

bool answers_plots(struct answers *answers, int64_t job_id, const char *names[PLOT_NAMES]) {
  size_t at = (size_t)job_id % SLOTS;
  pthread_mutex_lock(&answers->mutex);
  bool found = answers->plots[at].job_id == job_id;
  if (found) {
    memcpy(names, answers->plots[at].names, sizeof answers->plots[at].names);
  }
  pthread_mutex_unlock(&answers->mutex);
  return found;
}

void answers_keep_plots(struct answers *answers, int64_t job_id, const char *names[PLOT_NAMES]) {
  size_t at = (size_t)job_id % SLOTS;
  pthread_mutex_lock(&answers->mutex);
  answers->plots[at].job_id = job_id;
  memcpy(answers->plots[at].names, names, sizeof answers->plots[at].names);
  pthread_mutex_unlock(&answers->mutex);
}
