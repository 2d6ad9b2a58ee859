#include "server/auth/tokens.h"

#include <gnutls/gnutls.h>
#include <limits.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "server/base/log.h"

/* What tells one version of the file from another; all zero when there is none. */
struct file_mark {
  ino_t inode;
  off_t size;
  struct timespec changed;
};

struct tokens {
  const char *data;
  struct token_list list;
  pthread_rwlock_t lock; /* guards list */
  struct file_mark mark; /* of the thread that refreshes */
  atomic_bool required;
};

static struct file_mark mark_now(const char *data) {
  char path[PATH_MAX];
  struct stat info;
  if (!token_file_path(data, path, sizeof path) || stat(path, &info) != 0) {
    return (struct file_mark){0};
  }
  return (struct file_mark){info.st_ino, info.st_size, info.st_ctim};
}

static bool mark_equal(const struct file_mark *a, const struct file_mark *b) {
  return a->inode == b->inode && a->size == b->size && a->changed.tv_sec == b->changed.tv_sec &&
         a->changed.tv_nsec == b->changed.tv_nsec;
}

/* Takes the file's tokens; without a file, none. */
static enum status tokens_load(struct tokens *tokens, struct error *error) {
  struct token_list list;
  enum status status = token_file_read(tokens->data, &list, error);
  if (status != STATUS_OK && status != STATUS_NOT_FOUND) {
    return status;
  }
  if (status == STATUS_OK) {
    atomic_store(&tokens->required, true);
  }
  pthread_rwlock_wrlock(&tokens->lock);
  struct token_list old = tokens->list;
  tokens->list = list;
  pthread_rwlock_unlock(&tokens->lock);
  token_list_clear(&old);
  return STATUS_OK;
}

enum status tokens_create(const char *data, bool always, struct tokens **tokens,
                          struct error *error) {
  struct tokens *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the tokens.");
  }
  made->data = data;
  pthread_rwlock_init(&made->lock, NULL);
  atomic_store(&made->required, always);
  made->mark = mark_now(data);
  enum status status = tokens_load(made, error);
  if (status != STATUS_OK) {
    tokens_destroy(made);
    return status;
  }
  *tokens = made;
  return STATUS_OK;
}

void tokens_destroy(struct tokens *tokens) {
  if (tokens) {
    token_list_clear(&tokens->list);
    pthread_rwlock_destroy(&tokens->lock);
    free(tokens);
  }
}

void tokens_refresh(struct tokens *tokens) {
  struct error error;
  struct file_mark mark = mark_now(tokens->data);
  if (mark_equal(&mark, &tokens->mark)) {
    return;
  }
  tokens->mark = mark;
  if (tokens_load(tokens, &error) != STATUS_OK) {
    log_line("the tokens stay as they were: %s", error.message);
  } else {
    log_line("tokens read: %zu are valid", tokens->list.count);
  }
}

bool tokens_required(struct tokens *tokens) {
  return atomic_load(&tokens->required);
}

bool tokens_check(struct tokens *tokens, const char *secret, struct caller *caller) {
  unsigned char hash[TOKEN_HASH_BYTES];
  bool found = false;
  token_hash(secret, hash);
  pthread_rwlock_rdlock(&tokens->lock);
  for (size_t i = 0; i < tokens->list.count; i++) { /* all of them, whether found or not */
    const struct token *token = &tokens->list.tokens[i];
    if (gnutls_memcmp(token->hash, hash, sizeof hash) == 0) {
      memcpy(caller->name, token->name, sizeof caller->name);
      caller->role = token->role;
      found = true;
    }
  }
  pthread_rwlock_unlock(&tokens->lock);
  return found;
}
