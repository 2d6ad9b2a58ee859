/* The daemon's command line. */
#ifndef PNEULAB_SERVER_OPTIONS_H
#define PNEULAB_SERVER_OPTIONS_H

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>

#include "server/base/option.h"
#include "solver/base/error.h"

struct options {
  char data[PATH_MAX];     /* data directory */
  char solver[PATH_MAX];   /* path of pneulab-solve, or a bare name looked up in PATH */
  char launcher[PATH_MAX]; /* path of pneulab-launch, or "" */
  unsigned isolation;      /* enum isolation_mode */
  char worker_read[4096];  /* further paths of workers, joined by commas */
  char worker_write[4096];
  unsigned worker_nice;
  struct option_address listen; /* where to listen */
  unsigned executor;            /* enum options_executor */
  char slurm_partition[64];     /* "": the cluster's default, */
  char slurm_account[64];       /* likewise */
  char slurm_solver[PATH_MAX];  /* pneulab-solve on the nodes, "" for `solver` */
  unsigned slurm_queue;         /* tasks that wait on the cluster at a time */
  double slurm_bundle_s;        /* what small jobs of one task together take */
  unsigned slurm_nice;          /* of tasks of priority 0 */
  unsigned workers;
  unsigned connections_per_address;
  unsigned subscribers; /* to the stream of events; their connections do not count as others do */
  uint64_t files_limit_bytes;     /* of all files of an attempt; 0: none */
  uint64_t memory_limit_bytes;    /* of one worker; 0: none */
  double drain_timeout_s;         /* how long running jobs may go on after SIGTERM */
  double time_limit_s;            /* of a job that sets no timeout */
  double timeout_margin_s;        /* what a worker may overrun its job's timeout */
  double header_timeout_s;        /* for one request's header */
  double retry_delay_s;           /* before a second attempt; twice as long before a third */
  char tls_certificate[PATH_MAX]; /* PEM, "" for no TLS */
  char tls_key[PATH_MAX];         /* PEM */
  char hosts[1000];               /* names that requests may be for, separated by commas */
  bool behind_proxy;              /* X-Forwarded-For and X-Forwarded-Proto are believed */
  double request_rate_hz;         /* of a token or an address; 0: any, -1: by the address */
  double body_timeout_s;          /* for one request's body */
  unsigned connections;           /* in all, beside those of subscribers */
  unsigned log_level;             /* enum log_level */
  unsigned log_format;            /* enum log_format */
  uint64_t disk_reserve_bytes;    /* free space below which no job is accepted or started */
  double keep_files_days;         /* files of finished jobs; 0: for ever */
  uint64_t keep_files_bytes;      /* likewise in all; 0: no limit */
  char backup[PATH_MAX];          /* copy the database there instead of serving; "" for no */
  char restore[PATH_MAX];         /* restore the database from there instead; "" for no */
  bool check;                     /* check the database instead */
  bool force;                     /* replace what is there */
  unsigned action;                /* enum options_action */
};

/* Who solves jobs that do not say it. */
enum options_executor { EXECUTOR_LOCAL, EXECUTOR_SLURM, EXECUTOR_BOTH };

enum options_action { OPTIONS_RUN, OPTIONS_HELP, OPTIONS_VERSION };

/* The table of all options, for help and the manual page. Static storage. */
const struct option_row *options_rows(size_t *count);

/* Fills *options from the command line over the defaults. STATUS_INVALID with a sentence that
 * names the option, what is allowed and an example. */
enum status options_read(int argc, char **argv, struct options *options, struct error *error);

/* Writes the text of --help. */
void options_help(FILE *out);

#endif
