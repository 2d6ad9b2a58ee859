/* The engine that has jobs solved by a Slurm cluster which shares the data directory with the
 * daemon.
 *
 * Jobs are claimed as the pool claims them and handed over in batches: job arrays whose tasks each
 * solve a bundle (solver/bundle.h), chains of studies as they are and small jobs together. A batch
 * is durable in the database before the cluster is asked for it, and bears a name that no other one
 * has: after a crash, or when an answer was lost, it is looked for by this name and never submitted
 * twice. The cluster starts no task again; a task refuses to run twice; and what belongs to an
 * attempt that is no longer its job's current one counts for nothing, whoever finishes it.
 *
 * One thread does everything: it looks at the files that tasks leave, asks squeue now and then, all
 * tasks at once, and stores what has ended. While the cluster does not answer, jobs wait, with that
 * as their reason. The end of the daemon ends no task: the next one adopts them. */
#ifndef PNEULAB_SLURM_SLURM_H
#define PNEULAB_SLURM_SLURM_H

#include "server/exec/executor.h"

struct slurm_settings {
  struct engine_settings engine; /* solver: the program as the nodes find it */
  struct store_taste taste;      /* which jobs are its own */
  const char *partition;         /* "": the cluster's default; lives as long as the engine, */
  const char *account;           /* likewise */
  unsigned queue;                /* tasks that wait on the cluster at a time */
  double bundle_s;               /* what small jobs of one task together should take */
  int nice;                      /* of jobs of priority 0 */
};

/* Starts the thread; the settings are copied. store_recover must have left the attempts of a
 * cluster open. The caller owns *engine. */
enum status slurm_create(const struct slurm_settings *settings, struct engine *engine,
                         struct error *error);

#endif
