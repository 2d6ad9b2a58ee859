/* Runs many commands, a few at a time, each under a time limit. */
#ifndef PNEULAB_TESTS_ROBUST_POOL_H
#define PNEULAB_TESTS_ROBUST_POOL_H

#include <stdbool.h>

/* How one command ended. */
struct pool_end {
  bool started;
  bool timed_out; /* ended by the pool */
  int exit_code;  /* -1 when a signal ended it */
  int signal;     /* that signal, 0 otherwise */
  double wall_s, cpu_s;
  double peak_memory; /* bytes */
};

struct pool {
  int width;      /* commands at a time */
  double limit_s; /* of each, CPU time (ten times that by the clock); then it is asked to end, and
                   * killed five seconds later */
  int count;
  /* Arguments of command k, argv[0] being the program's path, ended by NULL, and where its output
   * goes; the arrays belong to the caller. */
  void (*prepare)(void *context, int k, const char **argv, const char **output, const char **log);
  /* Called once for each command, in the order in which they end. */
  void (*finish)(void *context, int k, const struct pool_end *end);
  void *context;
};

enum { POOL_ARGUMENTS = 16 };

/* Runs them all. False when memory runs out. */
bool pool_run(const struct pool *pool);

#endif
