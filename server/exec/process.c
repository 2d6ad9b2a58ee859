#include "server/exec/process.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

static void child_limit(int resource, uint64_t soft, uint64_t hard) {
  if (soft != 0) {
    struct rlimit limit = {.rlim_cur = soft, .rlim_max = hard};
    setrlimit((__rlimit_resource_t)resource, &limit);
  }
}

/* Between fork and exec in a program with threads: async-signal-safe calls only. */
static int child_prepare(pid_t parent, int input, int output, int errors,
                         const struct process_limits *limits) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
  signal(SIGPIPE, SIG_DFL);
  /* The parent may have died before the request took hold. */
  if (setpgid(0, 0) != 0 || prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent) {
    return errno ? errno : ESRCH;
  }
  child_limit(RLIMIT_DATA, limits->memory_bytes, limits->memory_bytes);
  child_limit(RLIMIT_CPU, limits->cpu_s, limits->cpu_s + 5);
  child_limit(RLIMIT_FSIZE, limits->file_bytes, limits->file_bytes);
  struct rlimit no_core = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  if (dup2(input, STDIN_FILENO) < 0 || dup2(output, STDOUT_FILENO) < 0 ||
      dup2(errors, STDERR_FILENO) < 0) {
    return errno;
  }
  close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);
  return 0;
}

/* Forks and executes; the child reports why exec failed through a pipe that a success closes. */
static enum status process_fork(const char *const *argv, const int files[3],
                                const struct process_limits *limits, struct process *process,
                                struct error *error) {
  int report[2];
  if (pipe2(report, O_CLOEXEC) != 0) {
    return error_set(error, STATUS_IO, NULL, "Cannot create a pipe: %s.", strerrordesc_np(errno));
  }
  pid_t parent = getpid();
  pid_t pid = fork();
  if (pid == 0) {
    int reason = child_prepare(parent, files[0], files[1], files[2], limits);
    if (reason == 0) {
      execvp(argv[0], (char *const *)argv);
      reason = errno;
    }
    ssize_t ignored = write(report[1], &reason, sizeof reason);
    (void)ignored;
    _exit(127);
  }
  int fork_reason = errno;
  close(report[1]);
  if (pid < 0) {
    close(report[0]);
    return error_set(error, STATUS_IO, NULL, "Cannot start a process: %s.",
                     strerrordesc_np(fork_reason));
  }
  int reason = 0;
  ssize_t got;
  do {
    got = read(report[0], &reason, sizeof reason);
  } while (got < 0 && errno == EINTR);
  close(report[0]);
  if (got > 0) {
    waitpid(pid, NULL, 0);
    return error_set(error, STATUS_NOT_FOUND, NULL, "Cannot run %s: %s.", argv[0],
                     strerrordesc_np(reason));
  }
  *process = (struct process){.pid = pid, .pidfd = (int)syscall(SYS_pidfd_open, pid, 0)};
  return STATUS_OK;
}

enum status process_start(const char *const *argv, const char *output_path, const char *error_path,
                          const struct process_limits *limits, struct process *process,
                          struct error *error) {
  int flags = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW;
  int files[3] = {open("/dev/null", O_RDONLY | O_CLOEXEC), open(output_path, flags, 0644),
                  open(error_path, flags | O_APPEND, 0644)};
  enum status status;
  if (files[0] < 0 || files[1] < 0 || files[2] < 0) {
    status = error_set(error, STATUS_IO, NULL, "Cannot create %s: %s.", output_path,
                       strerrordesc_np(errno));
  } else {
    status = process_fork(argv, files, limits, process, error);
  }
  for (int i = 0; i < 3; i++) {
    if (files[i] >= 0) {
      close(files[i]);
    }
  }
  return status;
}

bool process_wait(struct process *process, int timeout_ms, struct process_end *end) {
  struct pollfd watched = {.fd = process->pidfd, .events = POLLIN};
  if (process->pidfd >= 0) {
    poll(&watched, 1, timeout_ms);
  } else {
    poll(NULL, 0, timeout_ms); /* a kernel without pidfd: the wait is merely less prompt */
  }
  int state;
  struct rusage usage;
  pid_t got = wait4(process->pid, &state, WNOHANG, &usage);
  if (got == 0 || (got < 0 && errno == EINTR)) {
    return false;
  }
  *end = (struct process_end){.exit_code = -1};
  if (got > 0) {
    end->exit_code = WIFEXITED(state) ? WEXITSTATUS(state) : -1;
    end->signal = WIFSIGNALED(state) ? WTERMSIG(state) : 0;
    end->cpu_s = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                 1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    end->peak_memory_MB = (double)usage.ru_maxrss / 1024;
  }
  kill(-process->pid, SIGKILL);
  if (process->pidfd >= 0) {
    close(process->pidfd);
  }
  *process = (struct process){.pid = -1, .pidfd = -1};
  return true;
}

void process_signal(const struct process *process, int signal) {
  kill(-process->pid, signal);
}
