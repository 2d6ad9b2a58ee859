/* pneulab-launch: the small program between the daemon and a worker. It shuts the worker in, waits
 * for it, and ends whatever the worker leaves behind. It has one thread, which namespaces need. */
#ifndef PNEULAB_LAUNCH_LAUNCH_H
#define PNEULAB_LAUNCH_LAUNCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

enum { LAUNCH_PATHS_MAX = 128, LAUNCH_FAILED = 127 };

/* What the command line asks for. Numbers of 0 set no limit. */
struct launch {
  uint64_t memory_bytes; /* private writable memory of each process */
  uint64_t cpu_s;        /* processor time of each process */
  uint64_t file_bytes;   /* size of any file written */
  uint64_t descriptors;  /* open files of each process */
  uint64_t processes;    /* processes and threads of the worker */
  int nice;
  const char *read[LAUNCH_PATHS_MAX]; /* files and folders it may read and execute */
  size_t read_count;
  const char *write[LAUNCH_PATHS_MAX]; /* folders in which it may also create and write */
  size_t write_count;
  bool namespaces, landlock, seccomp; /* means of isolation to use */
  pid_t parent;                       /* the daemon; -1: not checked */
  int report;                         /* descriptor for a sentence when the worker cannot start */
  int usage;                          /* descriptor for what the worker used; -1: none */
  char **argv;                        /* of the worker, ended by NULL */
};

/* ---- supervise.c ------------------------------------------------------------------------- */

/* Runs the worker and returns its wait status once it and everything it started are gone. SIGTERM
 * and SIGINT are passed on to the worker's process group; SIGHUP ends all of it at once, and so
 * does the death of the daemon. */
int launch_supervise(const struct launch *launch);

/* ---- worker.c ---------------------------------------------------------------------------- */

/* Becomes the worker: limits, environment, capabilities, Landlock, seccomp, exec. Returns only on
 * failure, with the reason written to launch->report. */
void launch_worker(const struct launch *launch);

/* ---- namespaces.c ------------------------------------------------------------------------ */

/* Moves the children that are forked from now on into a process namespace of their own, with a
 * user namespace around it unless the caller is privileged. 0, or an errno. */
int namespaces_enter(void);

/* Limits the processes of the calling process's namespace where the kernel can (6.14); for root,
 * whom RLIMIT_NPROC does not bind. Whether it took hold. */
bool namespaces_limit_processes(uint64_t processes);

/* Whether RLIMIT_NPROC counts each user namespace by itself (5.14). */
bool namespaces_count_processes(void);

/* ---- landlock.c -------------------------------------------------------------------------- */

/* Version of Landlock's interface, 0 when the kernel has none. */
int landlock_version(void);

/* Confines the calling process: reads and executes below launch->read and launch->write, writes
 * below launch->write, neither device nodes nor links are made; with newer versions no TCP, no
 * signals and no abstract sockets to the outside. 0, or an errno. */
int landlock_confine(const struct launch *launch);

/* ---- syscalls.c -------------------------------------------------------------------------- */

/* Refuses with EPERM what a worker never needs: sockets, tracing, mounts, modules, keys, new
 * namespaces, links and nodes... Needs no_new_privs. 0, or an errno. */
int syscalls_confine(void);

/* ---- probe.c ----------------------------------------------------------------------------- */

/* Tries every means in a child of its own and prints one "name=value" a line. */
int launch_probe(void);

#endif
