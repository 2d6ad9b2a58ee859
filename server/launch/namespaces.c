#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "server/launch/launch.h"

/* The kernel's own least value of pid_max. */
enum { PID_MAX_LEAST = 301 };

static int text_write(const char *path, const char *text) {
  int fd = open(path, O_WRONLY | O_CLOEXEC);
  if (fd < 0) {
    return errno;
  }
  ssize_t written = write(fd, text, strlen(text));
  int reason = written < 0 ? errno : 0;
  close(fd);
  return reason;
}

/* Keeps the ids as they are: files of the worker belong to the daemon's user. */
static int map_ids(uid_t user, gid_t group) {
  char text[64];
  snprintf(text, sizeof text, "%u %u 1\n", user, user);
  int reason = text_write("/proc/self/uid_map", text);
  if (reason == 0) {
    reason = text_write("/proc/self/setgroups", "deny");
  }
  if (reason == 0) {
    snprintf(text, sizeof text, "%u %u 1\n", group, group);
    reason = text_write("/proc/self/gid_map", text);
  }
  return reason;
}

int namespaces_enter(void) {
  uid_t user = geteuid();
  gid_t group = getegid();
  if (unshare(CLONE_NEWPID) == 0) {
    return 0;
  }
  if (unshare(CLONE_NEWUSER | CLONE_NEWPID) != 0) {
    return errno;
  }
  return map_ids(user, group);
}

static bool kernel_at_least(int major, int minor) {
  struct utsname name;
  int found[2] = {0, 0};
  if (uname(&name) != 0 || sscanf(name.release, "%d.%d", &found[0], &found[1]) != 2) {
    return false;
  }
  return found[0] > major || (found[0] == major && found[1] >= minor);
}

bool namespaces_limit_processes(uint64_t processes) {
  char text[32];
  /* Before 6.14 this file is one for the whole machine. */
  if (processes == 0 || !kernel_at_least(6, 14)) {
    return false;
  }
  uint64_t limit = processes < PID_MAX_LEAST ? PID_MAX_LEAST : processes;
  snprintf(text, sizeof text, "%llu\n", (unsigned long long)limit);
  return text_write("/proc/sys/kernel/pid_max", text) == 0;
}

bool namespaces_count_processes(void) {
  return geteuid() != 0 && kernel_at_least(5, 14);
}
