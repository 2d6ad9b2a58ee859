/* What runs of one job, runs of a bundle and tasks of a cluster share. */
#ifndef PNEULAB_EXEC_RUN_INTERNAL_H
#define PNEULAB_EXEC_RUN_INTERNAL_H

#include "server/exec/run.h"

enum {
  POLL_MS = 250,
  GRACE_MS = 5000,
  POLL_FIRST_MS = 20,
  OUTPUT_BYTES_MAX = 256 << 20,
  DESCRIPTORS_MAX = 512,
  PROCESSES_MAX = 64,
  MEASURE_MS = 1000,
  MEASURE_SHARE = 50 /* times as long as a look takes is waited at least */
};

/* The paths of one attempt; room for the longest name after the data directory. */
struct run_paths {
  char directory[PATH_MAX], job[PATH_MAX], events[PATH_MAX], log[PATH_MAX];
  char output[PATH_MAX]; /* what the worker prints, renamed once it is complete */
  char result[PATH_MAX], artifacts[PATH_MAX];
};

/* State of the watch over a running worker. */
struct watch {
  int64_t timeout_at_ms;
  int64_t measure_at_ms; /* when to look at the files' size next */
  int64_t kill_at_ms;    /* 0: not asked to stop */
  enum stop_cause cause;
};

/* Joins a folder and a name; false when the path is too long. */
bool run_path(char path[PATH_MAX], const char *directory, const char *name);

/* Fills in the paths of an attempt; STATUS_TOO_LARGE when they are too long. */
enum status run_paths_make(const char *data, int64_t job_id, int64_t attempt,
                           struct run_paths *paths, struct error *error);

/* Creates the folder of an attempt with the job in it. */
enum status run_folder_make(const struct run_paths *paths, const char *document,
                            struct error *error);

/* Both for a claim. */
enum status run_prepare(const struct run_settings *settings, const struct claim *claim,
                        struct run_paths *paths, struct error *error);

/* Whether the files of the attempt take more than they may. Looks about once a second, less often
 * when there are so many that looking takes long. */
bool run_files_full(const struct run_settings *settings, const struct run_paths *paths,
                    struct watch *watch);

/* Asks the worker to end when somebody wants that, and insists after a while. */
void run_watch_step(struct watch *watch, const struct run_hooks *hooks, bool files_full,
                    struct process *process);

/* Makes the files that the result refers to durable, with the folders they are in: the database
 * must not name what a power failure can take away. */
enum status run_sync(const struct run_paths *paths, const struct outcome *outcome,
                     struct error *error);

#endif
