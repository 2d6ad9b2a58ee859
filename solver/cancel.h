/* Requests to end, which come as signals: their state is all that a handler can reach, and so the
 * only one of the program that belongs to nobody.
 *
 * SIGTERM and SIGINT end the whole program. SIGUSR1, for a bundle, says that some member may be
 * cancelled: the one that is being solved ends when its folder has a file `cancel`. Thereby a
 * request that comes when its member is done does not hit the next one. */
#ifndef PNEULAB_CANCEL_H
#define PNEULAB_CANCEL_H

#include <stdbool.h>

/* Starts to take SIGTERM and SIGINT. */
void cancel_watch(void);

/* Also SIGUSR1, for the member in this folder (until the next call; NULL: none), which stays the
 * caller's. */
void cancel_watch_member(const char *folder);

/* Whether the program is to end. */
bool cancel_all_wanted(void);

/* Whether it, or the member that is being solved, is to end. The context is not used. */
bool cancel_wanted(void *context);

#endif
