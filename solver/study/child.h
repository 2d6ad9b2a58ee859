/* One solver process of a study. */
#ifndef PNEULAB_STUDY_CHILD_H
#define PNEULAB_STUDY_CHILD_H

#include <stdbool.h>
#include <sys/types.h>
#include "solver/base/error.h"

struct child {
  pid_t pid; /* 0: none */
  int pidfd; /* readable once it has ended; -1 on a kernel without */
};

/* How a process ended. */
struct child_end {
  int exit_code; /* -1 when a signal ended it */
  int signal;    /* 0 when it ended by itself */
};

/* Starts this very program with `argv` (ended by NULL; argv[0] is only its name) as head of a
 * process group of its own, which the kernel ends with its parent. Standard output and error go to
 * new files. STATUS_OK, or STATUS_IO. */
enum status child_start(const char *const *argv, const char *output_path, const char *log_path,
                        struct child *child, struct error *error);

/* Starts a copy of this process that calls work(context) and ends, without flushing what this one
 * has buffered; head of a group and ended with its parent as above. STATUS_OK, or STATUS_IO. */
enum status child_fork(void (*work)(void *context), void *context, struct child *child,
                       struct error *error);

/* Whether the process has ended; then what is left of its group is ended, too, and *child cleared.
 * Does not wait. */
bool child_ended(struct child *child, struct child_end *end);

/* Sends a signal to the process and all of its group. */
void child_signal(const struct child *child, int signal);

/* Waits until one of the processes ends, a signal arrives or the time is over. */
void child_wait_any(const struct child *const *children, int count, int timeout_ms);

#endif
