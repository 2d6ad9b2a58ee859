/* What keeps workers apart from everything else, and how much of it this kernel offers. */
#ifndef PNEULAB_EXEC_ISOLATION_H
#define PNEULAB_EXEC_ISOLATION_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>

#include "solver/base/error.h"

enum isolation_mode {
  ISOLATION_AUTO,    /* as much as the kernel offers */
  ISOLATION_REQUIRE, /* the daemon does not start without all of it */
  ISOLATION_OFF      /* limits, process groups and the end of all children only */
};

enum { ISOLATION_PATHS_MAX = 24 };

struct isolation {
  char launcher[PATH_MAX]; /* pneulab-launch */
  bool namespaces;         /* own process namespace: outside processes are not even seen */
  bool processes;          /* a worker's number of processes is limited by itself */
  int landlock;            /* version of its interface; 0: not used */
  bool seccomp;
  unsigned nice; /* of workers */
  /* Further paths for all workers; they live as long as the daemon. */
  const char *read[ISOLATION_PATHS_MAX + 1], *write[ISOLATION_PATHS_MAX + 1];
  char *paths; /* memory of the two */
};

struct isolation_settings {
  enum isolation_mode mode;
  const char *launcher;     /* path, or "" for the one beside this program or installed with it */
  const char *read, *write; /* further paths of workers, joined by commas */
  unsigned nice;
};

/* Finds the launcher, asks it what the kernel offers, writes to the log which means hold and which
 * do not, and fills *isolation. STATUS_NOT_FOUND without a launcher; STATUS_CONFLICT when all means
 * are required and one is missing. The caller releases *isolation, also after a failure. */
enum status isolation_open(const struct isolation_settings *settings, struct isolation *isolation,
                           struct error *error);

void isolation_release(struct isolation *isolation);

#endif
