/* The programs of Slurm: sbatch, squeue, scancel, sinfo. Each call runs one of them and waits for
 * it, at most for the time limit of the client. */
#ifndef PNEULAB_SLURM_CLIENT_H
#define PNEULAB_SLURM_CLIENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "solver/base/error.h"

enum { SLURM_SCANCEL_MAX = 200 };

struct slurm_client {
  char *const *environment; /* of the programs, and thereby of tasks */
  int timeout_ms;
  bool (*stop)(void *context); /* whether to give up */
  void *context;
  double cpu_s; /* that the programs have used */
};

/* A job array to be submitted. */
struct slurm_request {
  const char *name;
  unsigned tasks;        /* numbered from 0 */
  const char *partition; /* "": the cluster's default */
  const char *account;   /* likewise */
  uint64_t memory_bytes; /* of a task; 0: what the cluster gives */
  double time_s;         /* of a task; 0: what the cluster gives */
  int nice;
  const char *const *script; /* the path of the script and its arguments, ended by NULL */
};

/* Submits an array that is never started again by the cluster, one core a task. *job: its number.
 * STATUS_CONFLICT when the cluster refuses it (*error has its words); after any other failure it
 * may have been submitted or not. */
enum status slurm_submit(struct slurm_client *client, const struct slurm_request *request,
                         int64_t *job, struct error *error);

/* Asks for all tasks of this user that have not ended, or (`job` not NULL) for those of an array
 * however they are, as lines for slurm_line_read; *lines is malloc'd. STATUS_CONFLICT when the
 * cluster does not know the array any more. */
enum status slurm_list(struct slurm_client *client, const char *job, char **lines,
                       struct error *error);

/* Looks for an array of this user by its name, whether it has ended or not. *job: its number, 0 for
 * none. */
enum status slurm_find(struct slurm_client *client, const char *name, int64_t *job,
                       struct error *error);

/* Ends tasks ("12_7"), at most SLURM_SCANCEL_MAX; with `member` only their scripts are told, by
 * SIGUSR1. Tasks that have ended are passed over. */
enum status slurm_cancel(struct slurm_client *client, const char *const *tasks, size_t count,
                         bool member, struct error *error);

/* The number of processors of a partition ("": of all nodes) that are not down. */
enum status slurm_cores(struct slurm_client *client, const char *partition, unsigned *cores,
                        struct error *error);

#endif
