#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "server/launch/launch.h"

/* What a supervisor that could not start its child answers. */
enum { STATUS_NOT_STARTED = LAUNCH_FAILED << 8 };

static void signals_block(sigset_t *signals) {
  sigemptyset(signals);
  sigaddset(signals, SIGTERM);
  sigaddset(signals, SIGINT);
  sigaddset(signals, SIGHUP);
  sigaddset(signals, SIGCHLD);
  sigprocmask(SIG_BLOCK, signals, NULL);
}

/* Reaps what has ended; true, with its status, once the child is among it. */
static bool reap(pid_t child, int *status) {
  bool ended = false;
  int state;
  pid_t pid;
  while ((pid = waitpid(-1, &state, WNOHANG)) > 0) {
    if (pid == child) {
      *status = state;
      ended = true;
    }
  }
  return ended;
}

/* Waits for the child, passing on to `target` (a process, or minus a group) what asks for the
 * end. */
static int child_watch(pid_t child, pid_t target, const sigset_t *signals) {
  int status = STATUS_NOT_STARTED;
  while (!reap(child, &status)) {
    int number = sigwaitinfo(signals, NULL);
    if (number == SIGTERM || number == SIGINT) {
      if (kill(target, number) != 0) { /* the group is not there in its first moment */
        kill(child, number);
      }
    } else if (number == SIGHUP) {
      kill(child, SIGKILL);
    }
  }
  return status;
}

/* The parent of a process by /proc, -1 when it is gone. */
static pid_t parent_of(pid_t pid) {
  char path[64], text[512];
  snprintf(path, sizeof path, "/proc/%d/stat", pid);
  int fd = open(path, O_RDONLY | O_CLOEXEC);
  ssize_t got = fd >= 0 ? read(fd, text, sizeof text - 1) : -1;
  if (fd >= 0) {
    close(fd);
  }
  text[got > 0 ? got : 0] = '\0';
  const char *after = strrchr(text, ')'); /* the name before it may be anything */
  int parent = -1;
  return after && sscanf(after + 1, " %*c %d", &parent) == 1 ? parent : -1;
}

static void children_kill(void) {
  DIR *processes = opendir("/proc");
  const struct dirent *entry;
  while (processes && (entry = readdir(processes))) {
    pid_t pid = isdigit((unsigned char)entry->d_name[0]) ? (pid_t)atoi(entry->d_name) : -1;
    if (pid > 1 && parent_of(pid) == getpid()) {
      kill(pid, SIGKILL);
    }
  }
  if (processes) {
    closedir(processes);
  }
}

/* Without a process namespace: orphans of the worker become children of this process, the nearest
 * that asked for them. They are killed until there are none. */
static void orphans_end(void) {
  struct timespec pause = {.tv_nsec = 1000000};
  pid_t pid;
  while ((pid = waitpid(-1, NULL, WNOHANG)) >= 0) {
    if (pid == 0) {
      children_kill();
      nanosleep(&pause, NULL);
    }
  }
}

static pid_t worker_start(const struct launch *launch) {
  pid_t pid = fork();
  if (pid == 0) {
    launch_worker(launch);
    _exit(LAUNCH_FAILED);
  }
  if (pid < 0) {
    dprintf(launch->report, "Cannot start a process: %s.", strerrordesc_np(errno));
  }
  close(launch->report); /* the reader waits for its last end */
  return pid;
}

/* Tells the largest resident set of the worker and of what it waited for. */
static void usage_tell(const struct launch *launch) {
  struct rusage usage = {0};
  getrusage(RUSAGE_CHILDREN, &usage);
  int64_t kilobytes = usage.ru_maxrss;
  if (launch->usage >= 0) {
    ssize_t ignored = write(launch->usage, &kilobytes, sizeof kilobytes);
    (void)ignored; /* then it is not known */
  }
}

/* The first process of the namespace. When it ends the kernel kills and reaps all others there. */
static int namespace_main(const struct launch *launch, const sigset_t *signals) {
  prctl(PR_SET_PDEATHSIG, (unsigned long)SIGKILL, 0UL, 0UL, 0UL);
  namespaces_limit_processes(launch->processes);
  pid_t worker = worker_start(launch);
  int status = worker > 0 ? child_watch(worker, -worker, signals) : STATUS_NOT_STARTED;
  usage_tell(launch);
  return status;
}

static int supervise_namespace(const struct launch *launch, const sigset_t *signals) {
  int results[2];
  int status = STATUS_NOT_STARTED, state;
  int reason = pipe2(results, O_CLOEXEC) == 0 ? namespaces_enter() : errno;
  pid_t first = reason == 0 ? fork() : -1;
  if (first == 0) {
    status = namespace_main(launch, signals);
    ssize_t ignored = write(results[1], &status, sizeof status);
    (void)ignored; /* without it the first process counts as killed */
    _exit(0);
  }
  if (first < 0) {
    dprintf(launch->report, "Cannot start a process in a namespace of its own: %s.",
            strerrordesc_np(reason ? reason : errno));
    return status;
  }
  close(launch->report);
  close(results[1]);
  state = child_watch(first, first, signals);
  if (read(results[0], &status, sizeof status) != (ssize_t)sizeof status) {
    status = state;
  }
  return status;
}

int launch_supervise(const struct launch *launch) {
  sigset_t signals;
  signals_block(&signals);
  prctl(PR_SET_CHILD_SUBREAPER, 1UL, 0UL, 0UL, 0UL);
  /* When the daemon dies the kernel alone ends a namespace, process by process; without one there
   * is work left for orphans_end. */
  prctl(PR_SET_PDEATHSIG, (unsigned long)(launch->namespaces ? SIGKILL : SIGHUP), 0UL, 0UL, 0UL);
  if (launch->parent >= 0 && getppid() != launch->parent) {
    return STATUS_NOT_STARTED; /* the daemon died before that took hold */
  }
  if (launch->namespaces) {
    return supervise_namespace(launch, &signals);
  }
  pid_t worker = worker_start(launch);
  int status = worker > 0 ? child_watch(worker, -worker, &signals) : STATUS_NOT_STARTED;
  usage_tell(launch);
  orphans_end();
  return status;
}
