#include "server/base/command.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/base/clock.h"

enum { SLICE_MS = 50, CHUNK = 16384, PROBLEM_MAX = 4096, NOT_RUN = 127 };

/* A pipe that is being read. */
struct stream {
  int fd; /* -1 once it has ended */
  char *text;
  size_t size, room, limit;
  bool keep_end; /* of a longer text the end is kept; otherwise it is a failure */
};

static void stream_close(struct stream *stream) {
  if (stream->fd >= 0) {
    close(stream->fd);
  }
  stream->fd = -1;
}

static enum status stream_room(struct stream *stream, struct error *error) {
  if (stream->room - stream->size > CHUNK) {
    return STATUS_OK;
  }
  size_t room = 2 * (stream->room + CHUNK);
  char *text = realloc(stream->text, room);
  if (!text) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the output of a program.");
  }
  stream->text = text;
  stream->room = room;
  return STATUS_OK;
}

/* Takes what is there. */
static enum status stream_read(struct stream *stream, struct error *error) {
  enum status status = stream_room(stream, error);
  if (status != STATUS_OK) {
    return status;
  }
  ssize_t got = read(stream->fd, stream->text + stream->size, CHUNK);
  if (got > 0) {
    stream->size += (size_t)got;
  } else if (got == 0 || (errno != EAGAIN && errno != EINTR)) {
    stream_close(stream);
  }
  if (stream->size > stream->limit && stream->keep_end) {
    memmove(stream->text, stream->text + stream->size - stream->limit, stream->limit);
    stream->size = stream->limit;
  } else if (stream->size > stream->limit) {
    return error_set(error, STATUS_TOO_LARGE, NULL, "A program prints more than %zu bytes.",
                     stream->limit);
  }
  return STATUS_OK;
}

/* Between fork and exec: async-signal-safe calls only. */
static void child_main(const struct command *command, pid_t parent, int output, int problem) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
  signal(SIGPIPE, SIG_DFL);
  int input = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (setpgid(0, 0) == 0 && prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && getppid() == parent &&
      dup2(input, 0) >= 0 && dup2(output, 1) >= 0 && dup2(problem, 2) >= 0) {
    close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);
    execvpe(command->argv[0], (char *const *)(uintptr_t)command->argv, command->environment);
    dprintf(2, "cannot run %s: %s\n", command->argv[0], strerrordesc_np(errno));
  }
  _exit(NOT_RUN);
}

/* Reads both streams until they end, the time is over or somebody wants to stop. */
static enum status follow(const struct command *command, struct stream streams[2],
                          struct error *error) {
  int64_t until = clock_monotonic_ms() + command->timeout_ms;
  enum status status = STATUS_OK;
  while (status == STATUS_OK && (streams[0].fd >= 0 || streams[1].fd >= 0)) {
    struct pollfd watched[2] = {{streams[0].fd, POLLIN, 0}, {streams[1].fd, POLLIN, 0}};
    poll(watched, 2, SLICE_MS);
    for (int i = 0; i < 2 && status == STATUS_OK; i++) {
      if (watched[i].revents && streams[i].fd >= 0) {
        status = stream_read(&streams[i], error);
      }
    }
    if (status == STATUS_OK && clock_monotonic_ms() >= until) {
      status = error_set(error, STATUS_TIMEOUT, NULL, "%s has not answered within %g s.",
                         command->argv[0], 1e-3 * command->timeout_ms);
    } else if (status == STATUS_OK && command->stop && command->stop(command->context)) {
      status = error_set(error, STATUS_CANCELLED, NULL, "%s was given up.", command->argv[0]);
    }
  }
  return status;
}

/* The last line that says something. */
static void problem_take(struct stream *stream, char problem[COMMAND_PROBLEM_SIZE]) {
  size_t end = stream->size;
  while (end > 0 && (stream->text[end - 1] == '\n' || stream->text[end - 1] == ' ')) {
    end--;
  }
  size_t start = end;
  while (start > 0 && stream->text[start - 1] != '\n') {
    start--;
  }
  snprintf(problem, COMMAND_PROBLEM_SIZE, "%.*s", (int)(end - start),
           stream->text ? stream->text + start : "");
}

static enum status pipes_open(int output[2], int problem[2], struct error *error) {
  if (pipe2(output, O_CLOEXEC | O_NONBLOCK) == 0) {
    if (pipe2(problem, O_CLOEXEC | O_NONBLOCK) == 0) {
      return STATUS_OK;
    }
    close(output[0]);
    close(output[1]);
  }
  return error_set(error, STATUS_IO, NULL, "Cannot create a pipe: %s.", strerrordesc_np(errno));
}

/* Waits for the child, which has closed its streams or is to be killed. */
static void reap(pid_t pid, bool killed, int timeout_ms, struct command_end *end) {
  struct rusage usage = {0};
  int state = 0;
  int64_t until = clock_monotonic_ms() + timeout_ms;
  pid_t got = 0;
  while (!killed && (got = wait4(pid, &state, WNOHANG, &usage)) == 0) {
    killed = clock_monotonic_ms() >= until;
    poll(NULL, 0, 1);
  }
  if (killed) {
    kill(-pid, SIGKILL);
    kill(pid, SIGKILL);
    while ((got = wait4(pid, &state, 0, &usage)) < 0 && errno == EINTR) {
    }
  }
  end->exit_code = got == pid && WIFEXITED(state) ? WEXITSTATUS(state) : -1;
  end->cpu_s = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
               1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

enum status command_run(const struct command *command, struct command_end *end,
                        struct error *error) {
  int output[2], problem[2];
  *end = (struct command_end){.exit_code = -1};
  enum status status = pipes_open(output, problem, error);
  if (status != STATUS_OK) {
    return status;
  }
  pid_t parent = getpid(), pid = fork();
  if (pid == 0) {
    fcntl(output[1], F_SETFL, 0);
    fcntl(problem[1], F_SETFL, 0);
    child_main(command, parent, output[1], problem[1]);
  }
  int reason = errno;
  close(output[1]);
  close(problem[1]);
  struct stream streams[2] = {{.fd = output[0], .limit = command->output_max},
                              {.fd = problem[0], .limit = PROBLEM_MAX, .keep_end = true}};
  if (pid < 0) {
    status =
        error_set(error, STATUS_IO, NULL, "Cannot start a process: %s.", strerrordesc_np(reason));
  } else {
    status = follow(command, streams, error);
    reap(pid, status != STATUS_OK, command->timeout_ms, end);
    problem_take(&streams[1], end->problem);
  }
  stream_close(&streams[0]);
  stream_close(&streams[1]);
  free(streams[1].text);
  if (status == STATUS_OK && end->exit_code == NOT_RUN) {
    status = error_set(error, STATUS_NOT_FOUND, NULL, "%s.", end->problem);
  }
  if (status == STATUS_OK && stream_room(&streams[0], error) == STATUS_OK) {
    streams[0].text[streams[0].size] = '\0';
    end->output = streams[0].text;
    end->size = streams[0].size;
  } else {
    status = status == STATUS_OK ? STATUS_NO_MEMORY : status;
    free(streams[0].text);
  }
  return status;
}
