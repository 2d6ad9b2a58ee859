/* One child process in a process group of its own, with limits. */
#ifndef PNEULAB_EXEC_PROCESS_H
#define PNEULAB_EXEC_PROCESS_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "solver/base/error.h"

struct process_limits {
  uint64_t memory_bytes; /* of private writable memory (RLIMIT_DATA); 0: none */
  uint64_t cpu_s;        /* of processor time; 0: none */
  uint64_t file_bytes;   /* of any file it writes; 0: none */
};

struct process {
  pid_t pid; /* also the id of its group */
  int pidfd;
};

struct process_end {
  int exit_code; /* -1 when a signal ended it */
  int signal;    /* 0 when it exited */
  double cpu_s;
  double peak_memory_MB;
};

/* Starts argv[0] (looked up in PATH when it has no slash), standard input empty, standard output
 * and error written to the two files. The child is killed when the calling thread ends, so the
 * thread that starts a process also waits for it. STATUS_NOT_FOUND when the program cannot be run,
 * else STATUS_IO. */
enum status process_start(const char *const *argv, const char *output_path, const char *error_path,
                          const struct process_limits *limits, struct process *process,
                          struct error *error);

/* Waits up to timeout_ms for the end. When it has ended: fills *end, kills what is left of its
 * group, releases *process and returns true. */
bool process_wait(struct process *process, int timeout_ms, struct process_end *end);

/* Sends a signal to the whole group. */
void process_signal(const struct process *process, int signal);

#endif
