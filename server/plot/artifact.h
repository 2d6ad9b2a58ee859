/* Files that a job left, read whole. */
#ifndef PNEULAB_PLOT_ARTIFACT_H
#define PNEULAB_PLOT_ARTIFACT_H

#include <stddef.h>
#include "solver/base/error.h"

/* Reads `directory`/`name` of at most 64 MiB. directory may be NULL: no file. *data (malloc'd, the
 * caller's) gets *size bytes and a NUL. what: what is drawn from it, for the message. Errors:
 * STATUS_NOT_FOUND, STATUS_TOO_LARGE, STATUS_NO_MEMORY. */
enum status artifact_read(const char *directory, const char *name, const char *what, char **data,
                          size_t *size, struct error *error);

#endif
