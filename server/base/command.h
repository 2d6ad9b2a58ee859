/* Programs of others that the daemon asks something: run with an argument vector, never a shell,
 * with bounded time and output. */
#ifndef PNEULAB_BASE_COMMAND_H
#define PNEULAB_BASE_COMMAND_H

#include <stdbool.h>
#include <stddef.h>

#include "solver/base/error.h"

enum { COMMAND_PROBLEM_SIZE = 300 };

struct command {
  const char *const *argv;     /* ended by NULL; argv[0] is looked up in PATH when without slash */
  char *const *environment;    /* of the program, ended by NULL */
  int timeout_ms;              /* then it is killed */
  size_t output_max;           /* bytes of standard output; more is a failure */
  bool (*stop)(void *context); /* asked every 50 ms: whether to give up; or NULL */
  void *context;
};

/* What has become of it. */
struct command_end {
  char
      *output; /* standard output with a NUL behind, malloc'd, the caller's; NULL after a failure */
  size_t size;
  int exit_code;                      /* -1: a signal ended it, or it did not end in time */
  double cpu_s;                       /* user and system time */
  char problem[COMMAND_PROBLEM_SIZE]; /* the end of standard error, in one line */
};

/* Runs a program to its end, with empty standard input. STATUS_OK when it has ended by itself, with
 * whatever exit code; STATUS_NOT_FOUND when it cannot be run, STATUS_TIMEOUT when it was killed
 * because its time was over, STATUS_CANCELLED on stop, STATUS_TOO_LARGE, STATUS_NO_MEMORY or
 * STATUS_IO. The caller frees end->output. */
enum status command_run(const struct command *command, struct command_end *end,
                        struct error *error);

#endif
