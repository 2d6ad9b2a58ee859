/* One worker process, started through pneulab-launch, which limits it, shuts it in and ends
 * everything it leaves behind. */
#ifndef PNEULAB_EXEC_PROCESS_H
#define PNEULAB_EXEC_PROCESS_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "server/exec/isolation.h"
#include "solver/base/error.h"

enum { PROCESS_FOLDERS_MAX = 66 };

/* Numbers of 0 set no limit. */
struct process_limits {
  uint64_t memory_bytes; /* private writable memory of each process (RLIMIT_DATA) */
  uint64_t cpu_s;        /* processor time of each process */
  uint64_t file_bytes;   /* size of any file it writes */
  unsigned descriptors;  /* open files of each process */
  unsigned processes;    /* processes and threads in all */
};

struct process {
  pid_t pid; /* of its launcher, which ends last and as the worker did */
  int pidfd;
  int used;    /* where the launcher tells what the worker used */
  bool ending; /* its end has been demanded */
};

struct process_end {
  int exit_code; /* -1 when a signal ended it */
  int signal;    /* 0 when it exited */
  double cpu_s;
  double peak_memory_MB; /* largest resident set of any of its processes; 0: not known */
};

/* Starts argv[0] (looked up in PATH when it has no slash), standard input empty, standard output
 * and error written to the two files, with `folders` (ended by NULL, at most PROCESS_FOLDERS_MAX)
 * as those it may write; the first one is its home. The child is ended when the calling thread
 * ends, so the thread that starts a process also waits for it. STATUS_NOT_FOUND when the program
 * cannot be run, else STATUS_IO. */
enum status process_start(const char *const *argv, const char *output_path, const char *error_path,
                          const char *const *folders, const struct process_limits *limits,
                          const struct isolation *isolation, struct process *process,
                          struct error *error);

/* Waits up to timeout_ms for the end of the worker and of everything it started. Then fills *end,
 * releases *process and returns true. */
bool process_wait(struct process *process, int timeout_ms, struct process_end *end);

/* Asks the worker's process group to end (SIGTERM). */
void process_terminate(const struct process *process);

/* Kills the worker with everything it started. To be repeated until process_wait tells the end. */
void process_kill(struct process *process);

#endif
