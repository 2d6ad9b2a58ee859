#include "server/exec/janitor.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/file.h"
#include "server/base/log.h"
#include "server/exec/run.h"

enum {
  TICK_MS = 1000,             /* between two tries to write while writing fails */
  RETENTION_EVERY_MS = 10000, /* at most; ten looks before files are too old */
  BATCH = 256,                /* jobs marked or measured in one transaction */
  SWEEP_PAUSE_AFTER = 64,     /* folders looked up before others get their turn */
  SWEEP_PAUSE_MS = 2
};

struct janitor {
  struct janitor_settings settings;
  pthread_t thread;
  pthread_mutex_t mutex; /* guards stopping */
  pthread_cond_t wake;
  bool stopping;
};

static bool path_of_attempt(char path[PATH_MAX], const char *data, int64_t job_id,
                            int64_t attempt) {
  char name[RUN_DIRECTORY_SIZE];
  run_directory(job_id, attempt, name);
  int length = snprintf(path, PATH_MAX, "%s/%s", data, name);
  return length > 0 && length < PATH_MAX;
}

void janitor_remove_files(const char *data, int64_t job_id, int64_t attempts) {
  char path[PATH_MAX];
  for (int64_t attempt = 1; attempt <= attempts; attempt++) {
    if (path_of_attempt(path, data, job_id, attempt)) {
      file_remove_tree(path);
    }
  }
}

/* Waits; false once the janitor is to end. */
static bool janitor_pause(struct janitor *janitor, int64_t ms) {
  struct timespec until = clock_deadline(ms);
  pthread_mutex_lock(&janitor->mutex);
  while (!janitor->stopping &&
         pthread_cond_timedwait(&janitor->wake, &janitor->mutex, &until) != ETIMEDOUT) {
  }
  bool stopping = janitor->stopping;
  pthread_mutex_unlock(&janitor->mutex);
  return !stopping;
}

/* Reads the name of an attempt's folder, "17-2"; other names are none of ours. */
static bool attempt_name_read(const char *name, int64_t *job_id, int64_t *attempt) {
  char *rest;
  char written[RUN_DIRECTORY_SIZE], expected[RUN_DIRECTORY_SIZE + 16];
  errno = 0;
  *job_id = strtoll(name, &rest, 10);
  if (*rest != '-') {
    return false;
  }
  *attempt = strtoll(rest + 1, &rest, 10);
  run_directory(*job_id, *attempt, written);
  snprintf(expected, sizeof expected, "attempts/%.40s", name);
  return errno == 0 && *job_id > 0 && *attempt > 0 && strcmp(written, expected) == 0;
}

/* Removes the folders of attempts that no job knows (it was deleted, or the database is an older
 * one) and of those whose removal a crash has interrupted. */
static void janitor_sweep(struct janitor *janitor) {
  const struct janitor_settings *settings = &janitor->settings;
  char path[PATH_MAX];
  snprintf(path, sizeof path, "%s/attempts", settings->data);
  DIR *folder = opendir(path);
  struct dirent *entry;
  unsigned seen = 0, removed = 0;
  while (folder && (entry = readdir(folder))) {
    int64_t job_id, attempt;
    bool kept = true;
    if (attempt_name_read(entry->d_name, &job_id, &attempt) &&
        store_files_kept(settings->store, job_id, attempt, &kept, NULL) == STATUS_OK && !kept &&
        path_of_attempt(path, settings->data, job_id, attempt)) {
      file_remove_tree(path);
      removed++;
    }
    if (++seen % SWEEP_PAUSE_AFTER == 0 && !janitor_pause(janitor, SWEEP_PAUSE_MS)) {
      break;
    }
  }
  if (folder) {
    closedir(folder);
  }
  if (removed > 0) {
    log_line("%u folders of attempts that no job knows were removed", removed);
  }
}

/* Measures the files of jobs that have ended; only a limit of bytes needs that. */
static enum status janitor_measure(const struct janitor_settings *settings, struct error *error) {
  struct job_files list[BATCH];
  size_t count = BATCH;
  enum status status = STATUS_OK;
  while (settings->limits.keep_bytes > 0 && status == STATUS_OK && count == BATCH) {
    status = store_files_unmeasured(settings->store, list, BATCH, &count, error);
    for (size_t i = 0; i < count; i++) {
      char path[PATH_MAX];
      for (int64_t attempt = 1; attempt <= list[i].attempts; attempt++) {
        if (path_of_attempt(path, settings->data, list[i].job_id, attempt)) {
          list[i].bytes += file_tree_bytes(path);
        }
      }
    }
    if (status == STATUS_OK && count > 0) {
      status = store_files_measured(settings->store, list, count, error);
    }
  }
  return status;
}

static void janitor_retain(const struct janitor_settings *settings) {
  struct job_files list[BATCH];
  struct error error;
  size_t count = BATCH;
  int64_t bytes = 0;
  unsigned jobs = 0;
  if (settings->limits.keep_ms == 0 && settings->limits.keep_bytes == 0) {
    return;
  }
  enum status status = janitor_measure(settings, &error);
  while (status == STATUS_OK && count > 0) {
    status = store_files_expire(settings->store, &settings->limits, list, BATCH, &count, &error);
    for (size_t i = 0; status == STATUS_OK && i < count; i++) {
      janitor_remove_files(settings->data, list[i].job_id, list[i].attempts);
      bytes += list[i].bytes;
      jobs++;
    }
  }
  if (jobs > 0) {
    log_line("the files of %u old jobs were removed (%lld bytes)", jobs, (long long)bytes);
  }
  if (status != STATUS_OK) {
    log_line("old files are not removed: %s", error.message);
  }
}

static void *janitor_main(void *context) {
  struct janitor *janitor = context;
  int64_t keep_ms = janitor->settings.limits.keep_ms, next_ms = 0;
  int64_t every_ms =
      keep_ms > 0 && keep_ms < 10 * RETENTION_EVERY_MS ? keep_ms / 10 : RETENTION_EVERY_MS;
  janitor_sweep(janitor);
  do {
    disk_watch(janitor->settings.disk);
    if (clock_monotonic_ms() >= next_ms) {
      janitor_retain(&janitor->settings);
      next_ms = clock_monotonic_ms() + every_ms;
    }
  } while (janitor_pause(janitor, TICK_MS));
  return NULL;
}

/* Copies and probes that a crash has left behind go. */
static enum status janitor_clear(const char *data, struct error *error) {
  static const char *const folders[] = {"tmp", "attempts"};
  char path[PATH_MAX];
  enum status status = STATUS_OK;
  for (size_t i = 0; i < sizeof folders / sizeof *folders && status == STATUS_OK; i++) {
    int length = snprintf(path, sizeof path, "%s/%s", data, folders[i]);
    if (length < 0 || (size_t)length >= sizeof path) {
      return error_set(error, STATUS_TOO_LARGE, NULL,
                       "The path of the data directory is too long.");
    }
    if (i == 0) {
      file_remove_tree(path);
    }
    status = file_make_directory(path, error);
  }
  return status;
}

enum status janitor_create(const struct janitor_settings *settings, struct janitor **janitor,
                           struct error *error) {
  enum status status = janitor_clear(settings->data, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct janitor *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the janitor.");
  }
  made->settings = *settings;
  pthread_mutex_init(&made->mutex, NULL);
  clock_condition_init(&made->wake);
  if (pthread_create(&made->thread, NULL, janitor_main, made) != 0) {
    pthread_cond_destroy(&made->wake);
    pthread_mutex_destroy(&made->mutex);
    free(made);
    return error_set(error, STATUS_NO_MEMORY, NULL, "Cannot start the janitor's thread.");
  }
  *janitor = made;
  return STATUS_OK;
}

void janitor_destroy(struct janitor *janitor) {
  if (!janitor) {
    return;
  }
  pthread_mutex_lock(&janitor->mutex);
  janitor->stopping = true;
  pthread_cond_broadcast(&janitor->wake);
  pthread_mutex_unlock(&janitor->mutex);
  pthread_join(janitor->thread, NULL);
  pthread_cond_destroy(&janitor->wake);
  pthread_mutex_destroy(&janitor->mutex);
  free(janitor);
}
