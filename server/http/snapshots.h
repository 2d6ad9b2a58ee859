/* Copies of the database for GET /api/v1/database. They are made on a thread of their own, one at
 * a time, so that a large one stops no other request; all that ask while one is being made share
 * the next. */
#ifndef PNEULAB_HTTP_SNAPSHOTS_H
#define PNEULAB_HTTP_SNAPSHOTS_H

#include <stdbool.h>
#include <stdint.h>

#include "server/store/store.h"

struct snapshots;

/* data: the data directory; the copies are files without a name in its folder tmp. done is called
 * on the thread of the copies with the ticket of each copy that has come to its end. The caller
 * owns *snapshots. */
enum status snapshots_create(struct store *store, const char *data,
                             void (*done)(void *context, int64_t ticket), void *context,
                             struct snapshots **snapshots, struct error *error);

/* Gives up the copy under way and joins the thread. NULL is fine. */
void snapshots_destroy(struct snapshots *snapshots);

/* Asks for a copy that is begun from now on; the ticket (positive) is for the calls below. */
int64_t snapshots_ask(struct snapshots *snapshots);

/* Whether the copy of a ticket, or a later one, has come to its end. */
bool snapshots_done(struct snapshots *snapshots, int64_t ticket);

/* Takes the newest copy: an open file of *size bytes for the caller to close. To be called soon
 * after `done`: a copy is kept for a minute. STATUS_BUSY when it is not there (yet, or any more),
 * else why it could not be made. */
enum status snapshots_take(struct snapshots *snapshots, int64_t ticket, int *fd, int64_t *size,
                           struct error *error);

#endif
