/* A disk that fails on order, for LD_PRELOAD: calls that write fail while the file named by
 * DISK_FAULTS says so. That file is an array of bytes which the test changes while the program
 * runs; see struct orders and Faults in reliability.py. */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum operation {
  OPERATION_WRITE = 1,
  OPERATION_SYNC = 2,
  OPERATION_TRUNCATE = 4,
  OPERATION_CREATE = 8, /* opening with O_CREAT */
  OPERATION_NAME = 16   /* mkdir, rename, link */
};

/* As it lies in the file. */
struct orders {
  _Atomic int32_t operations; /* those that fail; 0: none */
  int32_t code;               /* errno to fail with */
  _Atomic int64_t skip;       /* calls that succeed before */
  _Atomic int64_t count;      /* calls that fail */
  _Atomic int64_t failed;     /* calls that have failed */
  char part[64];              /* of the paths concerned */
};

static struct orders *orders;

__attribute__((constructor)) static void orders_open(void) {
  const char *path = getenv("DISK_FAULTS");
  int fd = path ? open(path, O_RDWR | O_CLOEXEC) : -1;
  void *map =
      fd < 0 ? MAP_FAILED : mmap(NULL, sizeof *orders, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (map != MAP_FAILED) {
    orders = map;
  }
  if (fd >= 0) {
    close(fd);
  }
}

/* The next definition of a function: that of a sanitizer or of the C library. */
static void *next(const char *name) {
  return dlsym(RTLD_NEXT, name);
}

static int fails(int operation, const char *path) {
  if (!orders || !(atomic_load(&orders->operations) & operation) || !strstr(path, orders->part)) {
    return 0;
  }
  if (atomic_fetch_sub(&orders->skip, 1) > 0 || atomic_fetch_sub(&orders->count, 1) <= 0) {
    return 0;
  }
  atomic_fetch_add(&orders->failed, 1);
  errno = orders->code;
  return 1;
}

static int fd_fails(int operation, int fd) {
  char link[32], path[4096];
  if (!orders || !(atomic_load(&orders->operations) & operation)) {
    return 0;
  }
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  ssize_t length = readlink(link, path, sizeof path - 1);
  path[length > 0 ? length : 0] = '\0';
  return fails(operation, path);
}

#define FORWARD_FD(OPERATION, TYPE, NAME, PARAMETERS, ...)                                         \
  TYPE NAME PARAMETERS;                                                                            \
  TYPE NAME PARAMETERS {                                                                           \
    TYPE(*real) PARAMETERS = (TYPE(*) PARAMETERS)(uintptr_t)next(#NAME);                           \
    return fd_fails(OPERATION, fd) ? -1 : real(__VA_ARGS__);                                       \
  }

#define FORWARD_PATH(OPERATION, NAME, PARAMETERS, ...)                                             \
  int NAME PARAMETERS;                                                                             \
  int NAME PARAMETERS {                                                                            \
    int(*real) PARAMETERS = (int(*) PARAMETERS)(uintptr_t)next(#NAME);                             \
    return fails(OPERATION, path) ? -1 : real(__VA_ARGS__);                                        \
  }

FORWARD_FD(OPERATION_WRITE, ssize_t, write, (int fd, const void *data, size_t size), fd, data, size)
FORWARD_FD(OPERATION_WRITE, ssize_t, pwrite, (int fd, const void *data, size_t size, off_t at), fd,
           data, size, at)
FORWARD_FD(OPERATION_WRITE, ssize_t, pwrite64, (int fd, const void *data, size_t size, off_t at),
           fd, data, size, at)
FORWARD_FD(OPERATION_SYNC, int, fsync, (int fd), fd)
FORWARD_FD(OPERATION_SYNC, int, fdatasync, (int fd), fd)
FORWARD_FD(OPERATION_TRUNCATE, int, ftruncate, (int fd, off_t size), fd, size)
FORWARD_FD(OPERATION_TRUNCATE, int, ftruncate64, (int fd, off_t size), fd, size)
FORWARD_PATH(OPERATION_NAME, mkdir, (const char *path, mode_t mode), path, mode)
FORWARD_PATH(OPERATION_NAME, rename, (const char *path, const char *to), path, to)
FORWARD_PATH(OPERATION_NAME, link, (const char *path, const char *to), path, to)

#define FORWARD_OPEN(NAME)                                                                         \
  int NAME(const char *path, int flags, ...);                                                      \
  int NAME(const char *path, int flags, ...) {                                                     \
    int (*real)(const char *, int, ...) = (int (*)(const char *, int, ...))(uintptr_t)next(#NAME); \
    mode_t mode = 0;                                                                               \
    if (flags & O_CREAT) {                                                                         \
      va_list arguments;                                                                           \
      va_start(arguments, flags);                                                                  \
      mode = va_arg(arguments, mode_t);                                                            \
      va_end(arguments);                                                                           \
    }                                                                                              \
    return (flags & O_CREAT) && fails(OPERATION_CREATE, path) ? -1 : real(path, flags, mode);      \
  }

FORWARD_OPEN(open)
FORWARD_OPEN(open64)
