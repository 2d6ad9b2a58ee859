/* Keeps the data directory in order, on a thread of its own: files that no job knows are removed
 * after a start, files of old jobs when there are limits, and writing is tried again while it
 * fails. */
#ifndef PNEULAB_EXEC_JANITOR_H
#define PNEULAB_EXEC_JANITOR_H

#include "server/exec/disk.h"
#include "server/store/retention.h"

struct janitor;

struct janitor_settings {
  struct store *store;
  struct disk *disk;
  const char *data; /* data directory; lives as long as the janitor */
  struct retention limits;
};

/* Empties DIR/tmp and starts the thread; the settings are copied. The caller owns *janitor. */
enum status janitor_create(const struct janitor_settings *settings, struct janitor **janitor,
                           struct error *error);

/* Joins the thread. NULL is fine. */
void janitor_destroy(struct janitor *janitor);

/* Removes the folders of a job's attempts 1 to `attempts`. The database must know before that they
 * are to go: what a crash leaves is then removed after the next start. */
void janitor_remove_files(const char *data, int64_t job_id, int64_t attempts);

#endif
