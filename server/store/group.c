#include "server/store/group.h"

#include <stdlib.h>

#include "server/store/connection.h"
#include "server/store/sql.h"

enum { GROUP_MAX = 64 };

/* One submission that waits for its commit, on the stack of its thread. */
struct member {
  const struct submission *submission;
  struct member *next;
  int64_t id;
  bool replayed, done;
  enum status status;
  struct error error;
};

struct group {
  pthread_mutex_t mutex; /* guards everything below and `done` of the members */
  pthread_cond_t changed;
  struct member *first, **end; /* waiting, oldest first */
  bool led;                    /* one of them commits */
};

struct group *group_create(void) {
  struct group *group = calloc(1, sizeof *group);
  if (group) {
    group->end = &group->first;
    pthread_mutex_init(&group->mutex, NULL);
    pthread_cond_init(&group->changed, NULL);
  }
  return group;
}

void group_destroy(struct group *group) {
  if (group) {
    pthread_cond_destroy(&group->changed);
    pthread_mutex_destroy(&group->mutex);
    free(group);
  }
}

/* Takes those who wait now out of the list. */
static struct member *group_take(struct group *group) {
  pthread_mutex_lock(&group->mutex);
  struct member *first = group->first, *last = first;
  for (int i = 1; last && last->next && i < GROUP_MAX; i++) {
    last = last->next;
  }
  if (last) {
    group->first = last->next;
    last->next = NULL;
  }
  if (!group->first) {
    group->end = &group->first;
  }
  pthread_mutex_unlock(&group->mutex);
  return first;
}

/* Writes one submission of the open transaction so that its failure leaves the others alone. */
static void member_write(struct store *store, struct member *member) {
  struct error *error = &member->error;
  member->status = sql_run(store->writer, error, "SAVEPOINT member", "");
  if (member->status != STATUS_OK) {
    return;
  }
  member->status =
      submission_write(store, member->submission, &member->id, &member->replayed, error);
  if (member->status != STATUS_OK && !sqlite3_get_autocommit(store->writer)) {
    sql_run(store->writer, NULL, "ROLLBACK TO member", "");
  }
  sql_run(store->writer, NULL, "RELEASE member", "");
}

/* Writes all in one transaction. Once it is committed, each has its own answer; if that fails, or
 * SQLite had to give up the transaction on the way (a full disk), all have the reason. */
static void group_commit(struct store *store, struct member **members) {
  struct error error = {.status = STATUS_OK};
  enum status status = store_write_begin(store, &error);
  *members = group_take(store->group);
  if (status == STATUS_OK) {
    for (struct member *at = *members; at && status == STATUS_OK; at = at->next) {
      member_write(store, at);
      if (sqlite3_get_autocommit(store->writer)) {
        status = at->status;
        error = at->error;
      }
    }
    status = store_write_end(store, status, &error);
  }
  for (struct member *at = *members; at && status != STATUS_OK; at = at->next) {
    at->status = status;
    at->error = error;
  }
}

/* Commits for those who wait. Under the mutex, which it lets go meanwhile. */
static void group_lead(struct store *store, struct group *group) {
  struct member *members, *next;
  group->led = true;
  pthread_mutex_unlock(&group->mutex);
  group_commit(store, &members);
  pthread_mutex_lock(&group->mutex);
  for (; members; members = next) {
    next = members->next; /* done, its thread may take it away */
    members->done = true;
  }
  group->led = false;
  pthread_cond_broadcast(&group->changed);
}

enum status store_submit(struct store *store, const struct submission *submission, int64_t *id,
                         bool *replayed, struct error *error) {
  struct group *group = store->group;
  struct member own = {.submission = submission};
  pthread_mutex_lock(&group->mutex);
  *group->end = &own;
  group->end = &own.next;
  while (!own.done) {
    if (group->led) {
      pthread_cond_wait(&group->changed, &group->mutex);
    } else {
      group_lead(store, group);
    }
  }
  pthread_mutex_unlock(&group->mutex);
  *id = own.id;
  *replayed = own.replayed;
  if (own.status != STATUS_OK && error) {
    *error = own.error;
  }
  return own.status;
}
