/* Inside the store: consistent copies of a database. */
#ifndef PNEULAB_STORE_SNAPSHOT_H
#define PNEULAB_STORE_SNAPSHOT_H

#include "server/store/connection.h"

/* Copies what `db` sees, in small steps, to an empty or absent file and makes that durable. Inside
 * a read transaction of db the copy is of one moment, and writers go on meanwhile. The copy needs
 * no log beside it. stop (or NULL) is asked between steps: STATUS_CANCELLED when it says so.
 * The file is the caller's to remove after a failure. */
enum status snapshot_copy(sqlite3 *db, const char *path, snapshot_stop *stop, void *context,
                          struct error *error);

#endif
