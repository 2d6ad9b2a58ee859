#include "server/exec/disk.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/file.h"
#include "server/base/log.h"

enum { LOOK_MS = 100, PROBE_BYTES = 65536, INODES_MIN = 64 };

struct disk {
  struct store *store;
  const char *data;
  uint64_t reserve_bytes;
  pthread_mutex_t trying; /* one try to write at a time */
  pthread_mutex_t mutex;  /* guards everything below */
  struct error space;     /* as the file system says, looked up every LOOK_MS */
  struct error probe;     /* how the last try to write ended */
  int64_t looked_ms;
  bool trouble;
  unsigned troubles;
};

enum status disk_create(struct store *store, const char *data, uint64_t reserve_bytes,
                        struct disk **disk, struct error *error) {
  struct disk *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory to watch the disk.");
  }
  *made = (struct disk){.store = store, .data = data, .reserve_bytes = reserve_bytes};
  pthread_mutex_init(&made->trying, NULL);
  pthread_mutex_init(&made->mutex, NULL);
  *disk = made;
  return STATUS_OK;
}

void disk_destroy(struct disk *disk) {
  if (disk) {
    pthread_mutex_destroy(&disk->trying);
    pthread_mutex_destroy(&disk->mutex);
    free(disk);
  }
}

/* Asks one file system how much room there is. */
static void disk_look_at(struct disk *disk, const char *path) {
  struct statvfs info;
  if (disk->reserve_bytes == 0 || statvfs(path, &info) != 0) {
    return;
  }
  uint64_t free_bytes = (uint64_t)info.f_bavail * info.f_frsize;
  if (free_bytes < disk->reserve_bytes) {
    error_set(&disk->space, STATUS_NO_SPACE, NULL,
              "Only %llu MiB are free on the disk of %.100s, and %llu MiB are kept for results "
              "(--disk-reserve): no job is accepted or started until there is more.",
              (unsigned long long)(free_bytes >> 20), path,
              (unsigned long long)(disk->reserve_bytes >> 20));
  } else if (info.f_files > 0 && info.f_favail < INODES_MIN) {
    error_set(&disk->space, STATUS_NO_SPACE, NULL,
              "The file system of %.100s has only %llu inodes left: no job is accepted or started "
              "until there are more.",
              path, (unsigned long long)info.f_favail);
  }
}

/* Asks those of the database and of the files of jobs, which may be different ones. */
static void disk_look(struct disk *disk) {
  char attempts[PATH_MAX];
  int64_t now = clock_monotonic_ms();
  if (disk->looked_ms != 0 && now - disk->looked_ms < LOOK_MS) {
    return;
  }
  disk->looked_ms = now;
  disk->space.status = STATUS_OK;
  disk_look_at(disk, disk->data);
  int length = snprintf(attempts, sizeof attempts, "%s/attempts", disk->data);
  if (disk->space.status == STATUS_OK && length > 0 && (size_t)length < sizeof attempts) {
    disk_look_at(disk, attempts);
  }
}

/* What is known, with the mutex held; notes when trouble begins and ends. */
static enum status disk_state(struct disk *disk, struct error *error) {
  struct error found = {.status = STATUS_OK};
  disk_look(disk);
  /* A try to write knows its reason best: SQLite cannot always tell a full disk from a broken one.
   */
  if (disk->probe.status != STATUS_OK) {
    found = disk->probe;
  } else if (store_health(disk->store, &found) == STATUS_OK) {
    found = disk->space;
  }
  bool trouble = found.status != STATUS_OK;
  if (trouble && !disk->trouble) {
    disk->troubles++;
    log_line("no job is accepted or started: %s", found.message);
  } else if (!trouble && disk->trouble) {
    log_line("the data directory can be written again");
  }
  disk->trouble = trouble;
  if (trouble && error) {
    *error = found;
  }
  return found.status;
}

enum status disk_check(struct disk *disk, struct error *error) {
  pthread_mutex_lock(&disk->mutex);
  enum status status = disk_state(disk, error);
  pthread_mutex_unlock(&disk->mutex);
  return status;
}

unsigned disk_troubles(struct disk *disk) {
  pthread_mutex_lock(&disk->mutex);
  unsigned troubles = disk->troubles;
  pthread_mutex_unlock(&disk->mutex);
  return troubles;
}

/* Writes a file where attempts are written, and one transaction. */
static enum status disk_try(const struct disk *disk, struct error *error) {
  static const char bytes[PROBE_BYTES];
  char path[PATH_MAX];
  int length = snprintf(path, sizeof path, "%s/attempts/.probe", disk->data);
  if (length < 0 || (size_t)length >= sizeof path) {
    return STATUS_OK;
  }
  enum status status = file_write(path, bytes, sizeof bytes, error);
  if (status == STATUS_OK) {
    status = file_sync(path, error);
  }
  unlink(path);
  return status == STATUS_OK ? store_probe(disk->store, error) : status;
}

static void disk_try_and_note(struct disk *disk) {
  struct error found = {.status = STATUS_OK};
  pthread_mutex_lock(&disk->trying);
  enum status status = disk_try(disk, &found);
  pthread_mutex_lock(&disk->mutex);
  disk->probe = found;
  disk->probe.status = status == STATUS_BUSY ? STATUS_OK : status;
  disk->looked_ms = 0;
  disk_state(disk, NULL);
  pthread_mutex_unlock(&disk->mutex);
  pthread_mutex_unlock(&disk->trying);
}

bool disk_blamed(struct disk *disk, unsigned before) {
  disk_try_and_note(disk);
  return disk_check(disk, NULL) != STATUS_OK || disk_troubles(disk) != before;
}

void disk_watch(struct disk *disk) {
  pthread_mutex_lock(&disk->mutex);
  disk_state(disk, NULL);
  bool failed = disk->probe.status != STATUS_OK || store_health(disk->store, NULL) != STATUS_OK;
  pthread_mutex_unlock(&disk->mutex);
  if (failed) {
    disk_try_and_note(disk);
  }
}
