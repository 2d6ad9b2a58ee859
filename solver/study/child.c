#include "solver/study/child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

enum { WATCHED_MAX = 256, EXEC_FAILED = 127 };

/* Makes the new process head of a group that is ended with its parent, which may have died before
 * that took hold. */
static bool join_parent(pid_t parent) {
  return setpgid(0, 0) == 0 && prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && getppid() == parent;
}

/* Between fork and exec: async-signal-safe calls only. */
static void run_child(pid_t parent, const char *const *argv, const int files[3]) {
  if (join_parent(parent) && dup2(files[0], STDIN_FILENO) >= 0 &&
      dup2(files[1], STDOUT_FILENO) >= 0 && dup2(files[2], STDERR_FILENO) >= 0) {
    execv("/proc/self/exe", (char *const *)argv);
  }
  _exit(EXEC_FAILED);
}

enum status child_start(const char *const *argv, const char *output_path, const char *log_path,
                        struct child *child, struct error *error) {
  int flags = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC;
  int files[3] = {open("/dev/null", O_RDONLY | O_CLOEXEC), open(output_path, flags, 0666),
                  open(log_path, flags, 0666)};
  enum status status = STATUS_OK;
  pid_t parent = getpid(), pid = -1;
  if (files[0] >= 0 && files[1] >= 0 && files[2] >= 0) {
    pid = fork();
  }
  if (pid == 0) {
    run_child(parent, argv, files);
  }
  if (pid < 0) {
    status = error_set(error, STATUS_IO, NULL, "cannot start a solver that writes %s: %s",
                       output_path, strerror(errno));
  } else {
    *child = (struct child){.pid = pid, .pidfd = (int)syscall(SYS_pidfd_open, pid, 0)};
  }
  for (int i = 0; i < 3; i++) {
    if (files[i] >= 0) {
      close(files[i]);
    }
  }
  return status;
}

enum status child_fork(void (*work)(void *context), void *context, struct child *child,
                       struct error *error) {
  pid_t parent = getpid(), pid = fork();
  if (pid == 0) {
    if (join_parent(parent)) {
      work(context);
    }
    _exit(0);
  }
  if (pid < 0) {
    return error_set(error, STATUS_IO, NULL, "cannot start a process for members: %s",
                     strerror(errno));
  }
  *child = (struct child){.pid = pid, .pidfd = (int)syscall(SYS_pidfd_open, pid, 0)};
  return STATUS_OK;
}

bool child_ended(struct child *child, struct child_end *end) {
  int state = 0;
  pid_t got = waitpid(child->pid, &state, WNOHANG);
  if (got == 0 || (got < 0 && errno == EINTR)) {
    return false;
  }
  bool exited = got > 0 && WIFEXITED(state);
  *end = (struct child_end){.exit_code = exited ? WEXITSTATUS(state) : -1,
                            .signal = got > 0 && WIFSIGNALED(state) ? WTERMSIG(state) : 0};
  kill(-child->pid, SIGKILL);
  if (child->pidfd >= 0) {
    close(child->pidfd);
  }
  *child = (struct child){.pid = 0, .pidfd = -1};
  return true;
}

void child_signal(const struct child *child, int signal) {
  /* Right after the fork the group may not be there yet, but the process is. */
  if (kill(-child->pid, signal) != 0) {
    kill(child->pid, signal);
  }
}

void child_wait_any(const struct child *const *children, int count, int timeout_ms) {
  struct pollfd watched[WATCHED_MAX];
  nfds_t used = 0;
  for (int i = 0; i < count && used < WATCHED_MAX; i++) {
    if (children[i]->pidfd >= 0) {
      watched[used++] = (struct pollfd){.fd = children[i]->pidfd, .events = POLLIN};
    }
  }
  poll(watched, used, timeout_ms);
}
