#include "tests/bench/robust_pool.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include "solver/base/clock.h"

static const double grace_s = 5;
/* A command that waits instead of computing is ended after this multiple of its limit. */
static const double wall_limit = 10;

/* One running command. */
struct slot {
  pid_t pid; /* 0: free */
  int k;
  double start;
  double asked_at; /* wall time at which it was asked to end; 0: not yet */
};

/* Becomes the command; ends with the pool. */
static void become(const char **argv, const char *output, const char *log) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  int out = open(output, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  int err = open(log, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (out >= 0 && err >= 0 && dup2(out, STDOUT_FILENO) >= 0 && dup2(err, STDERR_FILENO) >= 0) {
    execv(argv[0], (char *const *)argv);
  }
  _exit(127);
}

static void start(const struct pool *pool, int k, struct slot *slot) {
  const char *argv[POOL_ARGUMENTS] = {NULL}, *output, *log;
  pool->prepare(pool->context, k, argv, &output, &log);
  *slot = (struct slot){.k = k, .start = clock_wall_s()};
  slot->pid = fork();
  if (slot->pid == 0) {
    become(argv, output, log);
  }
  if (slot->pid < 0) {
    slot->pid = 0;
    pool->finish(pool->context, k, &(struct pool_end){.exit_code = -1});
  }
}

static double seconds(struct timeval t) {
  return (double)t.tv_sec + 1e-6 * (double)t.tv_usec;
}

/* CPU time of a running process, s. */
static double cpu_time(pid_t pid) {
  clockid_t id;
  struct timespec t = {0};
  if (clock_getcpuclockid(pid, &id) == 0) {
    clock_gettime(id, &t);
  }
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Takes in the command when it has ended, and presses one that takes too long. */
static void look_after(const struct pool *pool, struct slot *slot) {
  int status;
  struct rusage usage;
  double now = clock_wall_s(), wall = now - slot->start;
  if (wait4(slot->pid, &status, WNOHANG, &usage) == slot->pid) {
    struct pool_end end = {.started = true,
                           .timed_out = slot->asked_at > 0,
                           .exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
                           .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
                           .wall_s = wall,
                           .cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime),
                           .peak_memory = 1024 * (double)usage.ru_maxrss};
    slot->pid = 0;
    pool->finish(pool->context, slot->k, &end);
  } else if (slot->asked_at > 0) {
    if (now - slot->asked_at > grace_s) {
      kill(slot->pid, SIGKILL);
    }
  } else if (wall > wall_limit * pool->limit_s || cpu_time(slot->pid) > pool->limit_s) {
    slot->asked_at = now;
    kill(slot->pid, SIGTERM);
  }
}

bool pool_run(const struct pool *pool) {
  struct slot *slots = calloc((size_t)pool->width, sizeof *slots);
  int next = 0, running = 0;
  if (!slots) {
    return false;
  }
  do {
    running = 0;
    for (int s = 0; s < pool->width; s++) {
      if (slots[s].pid > 0) {
        look_after(pool, &slots[s]);
      }
      if (slots[s].pid == 0 && next < pool->count) {
        start(pool, next++, &slots[s]);
      }
      running += slots[s].pid > 0;
    }
    nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
  } while (running > 0 || next < pool->count);
  free(slots);
  return true;
}
