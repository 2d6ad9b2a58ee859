/* The files of a result as files of another job's attempt. */
#ifndef PNEULAB_EXEC_SHARE_H
#define PNEULAB_EXEC_SHARE_H

#include <jansson.h>
#include <stdint.h>

#include "server/store/store.h"

/* A store_share_files with the data directory (const char *) as its context. The attempt's folder
 * gets hard links to the files, so either job can be deleted without the other; they and the log
 * are on disk when it returns. */
enum status share_files(void *context, const char *from, const json_t *names, int64_t job_id,
                        int64_t attempt, char directory[STORE_DIRECTORY_SIZE], struct error *error);

#endif
