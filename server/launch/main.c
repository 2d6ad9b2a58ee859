/* pneulab-launch: shuts a worker in and waits for it; started by pneulabd, see launch.h. */
#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/launch/launch.h"

static const char usage[] =
    "usage: pneulab-launch [OPTION]... PROGRAM [ARGUMENT]...\n"
    "       pneulab-launch --probe\n"
    "Runs a worker of pneulabd shut in. Used by the daemon; not meant to be called by people.\n\n"
    "  --probe           print which means this kernel offers\n"
    "  --namespaces      own process namespace\n"
    "  --landlock        files only as the following two options say\n"
    "  --read PATH       may be read and executed (repeatable; the system's programs always may)\n"
    "  --write DIR       may be written (repeatable); the first one is HOME and TMPDIR\n"
    "  --seccomp         no network, tracing, mounts...\n"
    "  --memory BYTES    private memory of each process; 0 for no limit, here and below\n"
    "  --cpu SECONDS     processor time of each process\n"
    "  --file BYTES      size of any file written\n"
    "  --descriptors N   open files of each process\n"
    "  --processes N     processes and threads in all\n"
    "  --nice N          priority\n"
    "  --parent PID      end when this is not, or no longer, the parent\n"
    "  --report FD       where to say why the worker could not be started\n"
    "  --usage FD        where to tell its largest resident set: kilobytes in 8 bytes\n"
    "Exit status: that of the worker, or 127.\n";

enum { ROOM_FOR_SOLVER = 1 };

static uint64_t number_of(const char *text) {
  errno = 0;
  char *end;
  unsigned long long value = strtoull(text, &end, 10);
  if (end == text || *end != '\0' || errno != 0 || text[0] == '-') {
    fprintf(stderr, "pneulab-launch: %s is no number\n", text);
    exit(LAUNCH_FAILED);
  }
  return value;
}

static void path_add(const char *paths[], size_t *count, const char *path) {
  if (*count + ROOM_FOR_SOLVER >= LAUNCH_PATHS_MAX) {
    fputs("pneulab-launch: too many paths\n", stderr);
    exit(LAUNCH_FAILED);
  }
  paths[(*count)++] = path;
}

static bool option_take(struct launch *launch, int code, const char *value) {
  switch (code) {
  case 'N':
    launch->namespaces = true;
    return true;
  case 'L':
    launch->landlock = true;
    return true;
  case 'S':
    launch->seccomp = true;
    return true;
  case 'r':
    path_add(launch->read, &launch->read_count, value);
    return true;
  case 'w':
    path_add(launch->write, &launch->write_count, value);
    return true;
  case 'm':
    launch->memory_bytes = number_of(value);
    return true;
  case 'c':
    launch->cpu_s = number_of(value);
    return true;
  case 'f':
    launch->file_bytes = number_of(value);
    return true;
  case 'd':
    launch->descriptors = number_of(value);
    return true;
  case 'p':
    launch->processes = number_of(value);
    return true;
  case 'n':
    launch->nice = (int)number_of(value);
    return true;
  case 'P':
    launch->parent = (pid_t)number_of(value);
    return true;
  case 'R':
    launch->report = (int)number_of(value);
    return true;
  case 'U':
    launch->usage = (int)number_of(value);
    return true;
  default:
    return false;
  }
}

/* Where PATH finds the program, so that it may be read; static storage. */
static const char *program_find(const char *name) {
  static char path[PATH_MAX];
  const char *at = getenv("PATH");
  if (strchr(name, '/')) {
    return name;
  }
  while (at && *at) {
    size_t length = strcspn(at, ":");
    int made = snprintf(path, sizeof path, "%.*s/%s", (int)length, at, name);
    if (made > 0 && (size_t)made < sizeof path && access(path, X_OK) == 0) {
      return path;
    }
    at += length + (at[length] == ':');
  }
  return NULL;
}

/* Ends as the worker did, so that the daemon sees its exit code or signal. */
static int end_as(int status) {
  if (WIFSIGNALED(status)) {
    int number = WTERMSIG(status);
    sigset_t only;
    sigemptyset(&only);
    sigaddset(&only, number);
    signal(number, SIG_DFL);
    kill(getpid(), number);
    sigprocmask(SIG_UNBLOCK, &only, NULL);
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : LAUNCH_FAILED;
}

int main(int argc, char **argv) {
  static const struct option options[] = {{"namespaces", no_argument, NULL, 'N'},
                                          {"landlock", no_argument, NULL, 'L'},
                                          {"seccomp", no_argument, NULL, 'S'},
                                          {"read", required_argument, NULL, 'r'},
                                          {"write", required_argument, NULL, 'w'},
                                          {"memory", required_argument, NULL, 'm'},
                                          {"cpu", required_argument, NULL, 'c'},
                                          {"file", required_argument, NULL, 'f'},
                                          {"processes", required_argument, NULL, 'p'},
                                          {"descriptors", required_argument, NULL, 'd'},
                                          {"nice", required_argument, NULL, 'n'},
                                          {"parent", required_argument, NULL, 'P'},
                                          {"report", required_argument, NULL, 'R'},
                                          {"usage", required_argument, NULL, 'U'},
                                          {"probe", no_argument, NULL, 'T'},
                                          {"help", no_argument, NULL, 'h'},
                                          {0}};
  struct launch launch = {.parent = -1, .report = STDERR_FILENO, .usage = -1};
  int code;
  while ((code = getopt_long(argc, argv, "+", options, NULL)) != -1) {
    if (code == 'T') {
      return launch_probe();
    }
    if (code == 'h') {
      fputs(usage, stdout);
      return EXIT_SUCCESS;
    }
    if (!option_take(&launch, code, optarg)) {
      return LAUNCH_FAILED;
    }
  }
  launch.argv = argv + optind;
  if (!launch.argv[0]) {
    fputs(usage, stderr);
    return LAUNCH_FAILED;
  }
  const char *program = program_find(launch.argv[0]);
  if (program) {
    launch.read[launch.read_count++] = program;
  }
  return end_as(launch_supervise(&launch));
}
