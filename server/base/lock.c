#include "server/base/lock.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "server/base/file.h"

enum status lock_take(const char *directory, int *lock, struct error *error) {
  char path[PATH_MAX];
  *lock = -1;
  enum status status = file_make_directory(directory, error);
  if (status != STATUS_OK) {
    return status;
  }
  int length = snprintf(path, sizeof path, "%s/pneulabd.lock", directory);
  if (length < 0 || (size_t)length >= sizeof path) {
    return error_set(error, STATUS_TOO_LARGE, NULL, "The path of the data directory is too long.");
  }
  *lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (*lock >= 0 && flock(*lock, LOCK_EX | LOCK_NB) == 0) {
    return STATUS_OK;
  }
  int reason = errno;
  if (*lock >= 0) {
    close(*lock);
    *lock = -1;
  }
  if (reason == EWOULDBLOCK) {
    return error_set(error, STATUS_CONFLICT, NULL,
                     "Cannot lock the data directory %s: another pneulabd uses it. Stop that one, "
                     "or choose another directory with --data.",
                     directory);
  }
  return error_set(error, reason == ENOSPC || reason == EDQUOT ? STATUS_NO_SPACE : STATUS_IO, NULL,
                   "Cannot lock the data directory %s: %s.", directory, strerrordesc_np(reason));
}
