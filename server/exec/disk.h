/* Whether the data directory can be written. While it cannot, or is nearly full, no job is accepted
 * and none is started; once it can again, work goes on by itself. */
#ifndef PNEULAB_EXEC_DISK_H
#define PNEULAB_EXEC_DISK_H

#include <stdbool.h>
#include <stdint.h>

#include "server/store/store.h"

struct disk;

/* data: directory, lives as long as the disk. reserve_bytes: what is kept free for the results of
 * jobs that have been accepted. The caller owns *disk. */
enum status disk_create(struct store *store, const char *data, uint64_t reserve_bytes,
                        struct disk **disk, struct error *error);
void disk_destroy(struct disk *disk);

/* STATUS_OK, or why nothing should be begun: STATUS_NO_SPACE when less than the reserve is free,
 * else the failure that was met last. Waits for nobody; cheap enough for every request. */
enum status disk_check(struct disk *disk, struct error *error);

/* How often writing has come into trouble since the start. */
unsigned disk_troubles(struct disk *disk);

/* Whether the disk was, or is, in trouble since disk_troubles was `before`: for somebody whose work
 * has failed. Tries to write, and keeps what it finds for disk_check. */
bool disk_blamed(struct disk *disk, unsigned before);

/* Tries to write when the last that is known is a failure. To be called about once a second. */
void disk_watch(struct disk *disk);

#endif
