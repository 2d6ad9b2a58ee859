#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/launch/launch.h"

/* Runs one trial in a child, since none can be taken back; whether it succeeded. */
static bool try_alone(bool (*trial)(void)) {
  pid_t pid = fork();
  if (pid == 0) {
    _exit(trial() ? 0 : 1);
  }
  int status = -1;
  return pid > 0 && waitpid(pid, &status, 0) == pid && status == 0;
}

static bool try_namespaces(void) {
  if (namespaces_enter() != 0) {
    return false;
  }
  pid_t pid = fork();
  if (pid == 0) {
    _exit(getpid() == 1 ? 0 : 1);
  }
  int status = -1;
  return pid > 0 && waitpid(pid, &status, 0) == pid && status == 0;
}

static bool try_limit_processes(void) {
  if (namespaces_enter() != 0) {
    return false;
  }
  pid_t pid = fork();
  if (pid == 0) {
    _exit(namespaces_count_processes() || namespaces_limit_processes(1000) ? 0 : 1);
  }
  int status = -1;
  return pid > 0 && waitpid(pid, &status, 0) == pid && status == 0;
}

static bool try_landlock(void) {
  const struct launch nothing = {.write_count = 0};
  return prctl(PR_SET_NO_NEW_PRIVS, 1UL, 0UL, 0UL, 0UL) == 0 && landlock_confine(&nothing) == 0 &&
         open("/etc/passwd", O_RDONLY | O_CLOEXEC) < 0;
}

static bool try_seccomp(void) {
  return prctl(PR_SET_NO_NEW_PRIVS, 1UL, 0UL, 0UL, 0UL) == 0 && syscalls_confine() == 0 &&
         socket(AF_INET, SOCK_STREAM, 0) < 0 && errno == EPERM;
}

int launch_probe(void) {
  printf("namespaces=%d\n", try_alone(try_namespaces));
  printf("processes=%d\n", try_alone(try_limit_processes));
  printf("landlock=%d\n", try_alone(try_landlock) ? landlock_version() : 0);
  printf("seccomp=%d\n", try_alone(try_seccomp));
  return fflush(stdout) == 0 ? 0 : LAUNCH_FAILED;
}
