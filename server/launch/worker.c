#include <errno.h>
#include <limits.h>
#include <linux/capability.h>
#include <linux/securebits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "server/launch/environment.h"
#include "server/launch/launch.h"

extern char **environ;

static const char *const kept_variables[] = {WORKER_VARIABLES, "LC_ALL"};

static void limit_set(int resource, uint64_t soft, uint64_t hard) {
  if (soft != 0) {
    struct rlimit limit = {.rlim_cur = soft, .rlim_max = hard};
    struct rlimit old;
    /* Only root may raise what the daemon itself was given. */
    if (getrlimit((__rlimit_resource_t)resource, &old) == 0 && limit.rlim_max > old.rlim_max) {
      limit.rlim_max = old.rlim_max;
      limit.rlim_cur = limit.rlim_cur < old.rlim_max ? limit.rlim_cur : old.rlim_max;
    }
    setrlimit((__rlimit_resource_t)resource, &limit);
  }
}

static void limits_set(const struct launch *launch) {
  struct rlimit none = {0, 0};
  limit_set(RLIMIT_DATA, launch->memory_bytes, launch->memory_bytes);
  if (launch->memory_bytes != 0) { /* shared memory too, with room for programs and files */
    uint64_t all = 2 * launch->memory_bytes + ((uint64_t)1 << 30);
    limit_set(RLIMIT_AS, all, all);
  }
  /* SIGXCPU can be caught, SIGKILL five seconds later cannot. */
  limit_set(RLIMIT_CPU, launch->cpu_s, launch->cpu_s + 5);
  limit_set(RLIMIT_FSIZE, launch->file_bytes, launch->file_bytes);
  limit_set(RLIMIT_NOFILE, launch->descriptors, launch->descriptors);
  if (launch->namespaces && namespaces_count_processes()) {
    limit_set(RLIMIT_NPROC, launch->processes, launch->processes);
  }
  setrlimit(RLIMIT_CORE, &none);
  setrlimit(RLIMIT_MSGQUEUE, &none);
  setrlimit(RLIMIT_MEMLOCK, &none);
}

/* No capability, neither now nor by executing something as root. */
static int capabilities_drop(void) {
  struct __user_cap_header_struct header = {.version = _LINUX_CAPABILITY_VERSION_3};
  struct __user_cap_data_struct none[2] = {{0}, {0}};
  for (unsigned long capability = 0; capability < 64; capability++) {
    prctl(PR_CAPBSET_DROP, capability, 0UL, 0UL, 0UL); /* fails without CAP_SETPCAP: none to drop */
  }
  prctl(PR_SET_SECUREBITS, (unsigned long)(SECBIT_NOROOT | SECBIT_NOROOT_LOCKED), 0UL, 0UL, 0UL);
  prctl(PR_CAP_AMBIENT, (unsigned long)PR_CAP_AMBIENT_CLEAR_ALL, 0UL, 0UL, 0UL);
  return syscall(SYS_capset, &header, none) == 0 ? 0 : errno;
}

/* A few variables of the daemon, and folders for scratch files in the attempt's own. */
static int environment_clean(const struct launch *launch) {
  enum { KEPT = sizeof kept_variables / sizeof *kept_variables };
  char *values[KEPT];
  for (size_t i = 0; i < KEPT; i++) {
    values[i] = getenv(kept_variables[i]);
  }
  int failed = clearenv();
  for (size_t i = 0; i < KEPT; i++) {
    failed |= values[i] ? setenv(kept_variables[i], values[i], 1) : 0;
  }
  if (launch->write_count > 0) {
    failed |= setenv("HOME", launch->write[0], 1) | setenv("TMPDIR", launch->write[0], 1);
  }
#ifdef PNEULAB_SANITIZED
  if (launch->namespaces) { /* the leak sanitizer looks for its threads in the outer /proc */
    char asan[512];
    const char *given = getenv("ASAN_OPTIONS");
    snprintf(asan, sizeof asan, "%s%sdetect_leaks=0", given ? given : "", given ? ":" : "");
    failed |= setenv("ASAN_OPTIONS", asan, 1);
  }
#endif
  return failed ? ENOMEM : 0;
}

static void signals_reset(void) {
  sigset_t none;
  for (int number = 1; number < NSIG; number++) {
    signal(number, SIG_DFL);
  }
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
}

static int confine(const struct launch *launch, const char **what) {
  int reason = capabilities_drop();
  *what = "drop privileges";
  if (reason == 0 && prctl(PR_SET_NO_NEW_PRIVS, 1UL, 0UL, 0UL, 0UL) != 0) {
    reason = errno;
  }
  if (reason == 0 && launch->landlock) {
    *what = "confine the worker with Landlock";
    reason = landlock_confine(launch);
  }
  if (reason == 0 && launch->seccomp) {
    *what = "confine the worker with seccomp";
    reason = syscalls_confine();
  }
  return reason;
}

void launch_worker(const struct launch *launch) {
  const char *what = "prepare the worker";
  /* Without a process namespace this is what ends the worker with its launcher. */
  prctl(PR_SET_PDEATHSIG, (unsigned long)SIGKILL, 0UL, 0UL, 0UL);
  setsid();
  limits_set(launch);
  setpriority(PRIO_PROCESS, 0, launch->nice);
  int reason = environment_clean(launch);
  if (reason == 0) {
    reason = confine(launch, &what);
  }
  if (reason == 0) {
    close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);
    signals_reset();
    execvp(launch->argv[0], launch->argv);
    reason = errno;
    what = "run";
  }
  bool run = strcmp(what, "run") == 0;
  dprintf(launch->report, "Cannot %s%s%s: %s.", what, run ? " " : "", run ? launch->argv[0] : "",
          strerrordesc_np(reason));
}
