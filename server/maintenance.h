/* What pneulabd does with a data directory instead of serving it. */
#ifndef PNEULAB_MAINTENANCE_H
#define PNEULAB_MAINTENANCE_H

#include <stdbool.h>

#include "server/base/options.h"

/* The exit statuses of pneulabd. */
enum exit_code {
  EXIT_FINE = 0,
  EXIT_FAILED = 1,           /* the system said no: port in use, full disk, no memory */
  EXIT_COMMAND_LINE = 2,     /* wrong options */
  EXIT_DATABASE_REFUSED = 3, /* damaged, newer or foreign database: starting again does not help */
  EXIT_IN_USE = 4            /* another pneulabd uses the data directory */
};

/* The exit status for a database that could not be opened. */
enum exit_code maintenance_exit_code(enum status status);

/* Whether the options ask for --backup, --restore or --check. */
bool maintenance_wanted(const struct options *options);

/* Does what they ask for, prints what came of it and returns the exit status. */
enum exit_code maintenance_run(const struct options *options);

#endif
