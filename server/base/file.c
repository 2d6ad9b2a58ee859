#include "server/base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <fts.h>
#include <ftw.h>
#include <limits.h>
#include <linux/openat2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static enum status file_fail(struct error *error, const char *doing, const char *path) {
  int reason = errno;
  enum status status = STATUS_IO;
  if (reason == ENOENT) {
    status = STATUS_NOT_FOUND;
  } else if (reason == ENOSPC || reason == EDQUOT) {
    status = STATUS_NO_SPACE;
  }
  return error_set(error, status, NULL, "Cannot %s %s: %s.", doing, path, strerrordesc_np(reason));
}

enum status file_make_directory(const char *path, struct error *error) {
  char partial[PATH_MAX];
  size_t length = strlen(path);
  if (length == 0 || length >= sizeof partial) {
    errno = ENAMETOOLONG;
    return file_fail(error, "create the directory", path);
  }
  memcpy(partial, path, length + 1);
  for (size_t i = 1; i <= length; i++) {
    if (partial[i] != '/' && partial[i] != '\0') {
      continue;
    }
    char kept = partial[i];
    partial[i] = '\0';
    if (mkdir(partial, 0755) != 0 && errno != EEXIST) {
      return file_fail(error, "create the directory", partial);
    }
    partial[i] = kept;
  }
  return STATUS_OK;
}

static int file_remove_entry(const char *path, const struct stat *info, int type,
                             struct FTW *where) {
  (void)info;
  (void)type;
  (void)where;
  remove(path);
  return 0;
}

void file_remove_tree(const char *path) {
  nftw(path, file_remove_entry, 8, FTW_DEPTH | FTW_PHYS);
}

enum status file_read(const char *path, size_t limit, char **data, size_t *size,
                      struct error *error) {
  enum status status = STATUS_OK;
  char *buffer = NULL;
  size_t used = 0;
  int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  struct stat info;
  if (fd < 0 || fstat(fd, &info) != 0) {
    status = file_fail(error, "read", path);
    goto done;
  }
  if (!S_ISREG(info.st_mode) || (unsigned long long)info.st_size > limit) {
    status = error_set(error, STATUS_TOO_LARGE, NULL,
                       "%s is not a regular file of at most %zu bytes.", path, limit);
    goto done;
  }
  size_t expected = (size_t)info.st_size;
  buffer = malloc(expected + 1);
  if (!buffer) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "No memory to read %s.", path);
    goto done;
  }
  while (used < expected) {
    ssize_t got = read(fd, buffer + used, expected - used);
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got < 0) {
      status = file_fail(error, "read", path);
      goto done;
    }
    if (got == 0) {
      break;
    }
    used += (size_t)got;
  }
  buffer[used] = '\0';
  *data = buffer;
  *size = used;
  buffer = NULL;
done:
  free(buffer);
  if (fd >= 0) {
    close(fd);
  }
  return status;
}

int file_open_below(const char *directory, const char *path, size_t *size) {
  struct open_how how = {.flags = O_RDONLY | O_CLOEXEC | O_NONBLOCK,
                         .resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS};
  struct stat info;
  int at = open(directory, O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (at < 0) {
    return -1;
  }
  int fd = (int)syscall(SYS_openat2, at, path, &how, sizeof how);
  close(at);
  if (fd >= 0 && (fstat(fd, &info) != 0 || !S_ISREG(info.st_mode))) {
    close(fd);
    return -1;
  }
  *size = fd >= 0 ? (size_t)info.st_size : 0;
  return fd;
}

enum status file_write(const char *path, const char *data, size_t size, struct error *error) {
  int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (fd < 0) {
    return file_fail(error, "write", path);
  }
  enum status status = STATUS_OK;
  while (size > 0) {
    ssize_t written = write(fd, data, size);
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written < 0) {
      status = file_fail(error, "write", path);
      break;
    }
    data += written;
    size -= (size_t)written;
  }
  if (close(fd) != 0 && status == STATUS_OK) {
    status = file_fail(error, "write", path);
  }
  return status;
}

enum status file_sync(const char *path, struct error *error) {
  int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (fd < 0) {
    return file_fail(error, "open", path);
  }
  enum status status = fsync(fd) == 0 ? STATUS_OK : file_fail(error, "write", path);
  close(fd);
  return status;
}

enum status file_sync_parent(const char *path, struct error *error) {
  char parent[PATH_MAX];
  size_t length = strlen(path);
  if (length >= sizeof parent) {
    errno = ENAMETOOLONG;
    return file_fail(error, "write", path);
  }
  memcpy(parent, path, length + 1);
  char *slash = strrchr(parent, '/');
  if (!slash) {
    strcpy(parent, ".");
  } else {
    slash[slash == parent] = '\0';
  }
  return file_sync(parent, error);
}

int64_t file_tree_bytes(const char *path) {
  char *const paths[] = {(char *)(uintptr_t)path, NULL};
  int64_t bytes = 0;
  FTS *tree = fts_open(paths, FTS_PHYSICAL | FTS_NOCHDIR, NULL);
  FTSENT *entry;
  while (tree && (entry = fts_read(tree))) {
    if (entry->fts_info == FTS_F || entry->fts_info == FTS_D) {
      bytes += (int64_t)entry->fts_statp->st_blocks * 512;
    }
  }
  if (tree) {
    fts_close(tree);
  }
  return bytes;
}

bool file_name_is_plain(const char *name) {
  size_t length = strlen(name);
  static const char allowed[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
  return length >= 1 && length <= 100 && name[0] != '.' && strspn(name, allowed) == length;
}
