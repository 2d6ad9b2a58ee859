#include "server/exec/isolation.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/base/log.h"

extern char **environ;

/* Beside our own executable when built, below the same prefix or where `make install` put it. */
static bool launcher_find(const char *wanted, char launcher[PATH_MAX]) {
  static const char *const places[] = {"", "../libexec/pneulab/"};
  char own[PATH_MAX];
  int length = snprintf(launcher, PATH_MAX, "%s", wanted);
  if (length > 0) {
    return length < PATH_MAX && access(launcher, X_OK) == 0;
  }
  ssize_t size = readlink("/proc/self/exe", own, sizeof own - 1);
  own[size > 0 ? size : 0] = '\0';
  const char *slash = strrchr(own, '/');
  for (size_t i = 0; slash && i < sizeof places / sizeof *places; i++) {
    length =
        snprintf(launcher, PATH_MAX, "%.*s/%spneulab-launch", (int)(slash - own), own, places[i]);
    if (length > 0 && length < PATH_MAX && access(launcher, X_OK) == 0) {
      return true;
    }
  }
  snprintf(launcher, PATH_MAX, "%s/pneulab-launch", PNEULAB_LIBEXEC);
  return access(launcher, X_OK) == 0;
}

/* What `launcher --probe` prints, at most size - 1 bytes; whether it ended well. */
static bool launcher_ask(const char *launcher, char *text, size_t size) {
  char *argv[] = {(char *)(uintptr_t)launcher, (char[]){"--probe"}, NULL};
  int ends[2], state = -1;
  size_t used = 0;
  ssize_t got = 0;
  pid_t pid;
  posix_spawn_file_actions_t actions;
  if (pipe2(ends, O_CLOEXEC) != 0) {
    return false;
  }
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  bool started = posix_spawn(&pid, launcher, &actions, NULL, argv, environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  while (started && used < size - 1 && (got = read(ends[0], text + used, size - 1 - used)) != 0) {
    if (got < 0 && errno != EINTR) {
      break;
    }
    used += got > 0 ? (size_t)got : 0;
  }
  close(ends[0]);
  text[used] = '\0';
  return started && waitpid(pid, &state, 0) == pid && state == 0;
}

/* The number behind "name=" at the start of a line, 0 when absent. */
static int answer_number(const char *text, const char *name) {
  size_t length = strlen(name);
  for (const char *line = text; line; line = strchr(line, '\n')) {
    line += *line == '\n';
    if (strncmp(line, name, length) == 0 && line[length] == '=') {
      return atoi(line + length + 1);
    }
  }
  return 0;
}

/* Cuts a list in place at its commas. */
static char *paths_cut(char *text, const char *paths[ISOLATION_PATHS_MAX + 1]) {
  size_t count = 0;
  char *rest = NULL;
  for (char *path = strtok_r(text, ",", &rest); path && count < ISOLATION_PATHS_MAX;
       path = strtok_r(NULL, ",", &rest)) {
    paths[count++] = path;
  }
  return text;
}

static enum status paths_take(const struct isolation_settings *settings,
                              struct isolation *isolation, struct error *error) {
  size_t read_size = strlen(settings->read) + 1, write_size = strlen(settings->write) + 1;
  isolation->paths = malloc(read_size + write_size);
  if (!isolation->paths) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the paths of workers.");
  }
  memcpy(isolation->paths, settings->read, read_size);
  memcpy(isolation->paths + read_size, settings->write, write_size);
  paths_cut(isolation->paths, isolation->read);
  paths_cut(isolation->paths + read_size, isolation->write);
  return STATUS_OK;
}

/* One line of the log that says what holds; *missing gets what does not. */
static void isolation_report(const struct isolation *isolation, char *missing, size_t size) {
  char landlock[64] = "";
  const char *text = landlock;
  snprintf(landlock, sizeof landlock, "landlock %d (files%s%s), ", isolation->landlock,
           isolation->landlock >= 4 ? ", tcp" : "", isolation->landlock >= 6 ? ", signals" : "");
  snprintf(missing, size, "%s%s%s%s", isolation->landlock ? "" : "landlock, ",
           isolation->seccomp ? "" : "seccomp, ",
           isolation->namespaces ? "" : "process namespace, ",
           isolation->processes ? "" : "number of processes, ");
  size_t length = strlen(missing);
  if (length > 1) {
    missing[length - 2] = '\0';
  }
  char sentence[320];
  snprintf(sentence, sizeof sentence,
           "isolation of workers: %s%s%s%slimits, no privileges, clean environment; %s%s",
           isolation->landlock ? text : "", isolation->seccomp ? "seccomp (no network), " : "",
           isolation->namespaces ? "process namespace, " : "",
           isolation->processes ? "number of processes, " : "",
           length ? "not on this kernel: " : "nothing is missing", missing);
  log_write(length ? LOG_LEVEL_WARNING : LOG_LEVEL_INFO, sentence, NULL, 0);
}

enum status isolation_open(const struct isolation_settings *settings, struct isolation *isolation,
                           struct error *error) {
  char answer[512], missing[128];
  *isolation = (struct isolation){.nice = settings->nice};
  if (!launcher_find(settings->launcher, isolation->launcher)) {
    return error_set(error, STATUS_NOT_FOUND, NULL,
                     "There is no program %s, which starts workers. Run make install, or name it "
                     "with --launcher.",
                     isolation->launcher);
  }
  enum status status = paths_take(settings, isolation, error);
  if (status != STATUS_OK || settings->mode == ISOLATION_OFF) {
    if (status == STATUS_OK) {
      log_write(LOG_LEVEL_WARNING, "isolation of workers is off: only limits hold", NULL, 0);
    }
    return status;
  }
  if (!launcher_ask(isolation->launcher, answer, sizeof answer)) {
    return error_set(error, STATUS_NOT_FOUND, NULL, "%s does not answer.", isolation->launcher);
  }
  isolation->namespaces = answer_number(answer, "namespaces") > 0;
  isolation->processes = answer_number(answer, "processes") > 0;
  isolation->landlock = answer_number(answer, "landlock");
  isolation->seccomp = answer_number(answer, "seccomp") > 0;
  isolation_report(isolation, missing, sizeof missing);
  if (settings->mode == ISOLATION_REQUIRE && missing[0]) {
    return error_set(error, STATUS_CONFLICT, NULL,
                     "--isolation require: this kernel does not offer %s.", missing);
  }
  return STATUS_OK;
}

void isolation_release(struct isolation *isolation) {
  free(isolation->paths);
  isolation->paths = NULL;
}
