/* The stream of events: one thread reads what is new in the table `event`, keeps the latest of it
 * encoded in a ring that all subscribers share, and wakes those who want some of it. A subscriber
 * is a suspended connection and its place in the stream: it holds no thread and no events. One that
 * has fallen behind the ring reads from the table, so none misses a change of state. Of progress
 * only the newest report of each running job is kept. */
#ifndef PNEULAB_HTTP_FEED_H
#define PNEULAB_HTTP_FEED_H

#include <sys/types.h>

#include "server/http/event_text.h"
#include "solver/base/error.h"

struct MHD_Connection;
struct feed;
struct subscriber;

/* Starts at the newest event of the store; it watches the store's events from now on.
 * subscribers_max: how many may follow at a time. The caller owns *feed, which ends before the
 * store. */
enum status feed_create(struct store *store, unsigned subscribers_max, struct feed **feed,
                        struct error *error);

/* Tells what a running job has reported. From any thread, never waits for the network. */
void feed_progress(struct feed *feed, int64_t job_id, int64_t attempt,
                   const struct progress *progress);

/* Publishes what is left; then every stream ends once it has been sent, and new ones are refused.
 * NULL is fine. */
void feed_close(struct feed *feed);

/* Closes. There must be no subscriber any more. NULL is fine. */
void feed_destroy(struct feed *feed);

/* Lets a connection follow from the event after id `after` on (-1: from now on), with a filter
 * that is taken over on success. *subscriber is for feed_read and feed_unsubscribe. STATUS_CONFLICT
 * when too many follow or the feed is closed, STATUS_NO_MEMORY. */
enum status feed_subscribe(struct feed *feed, struct MHD_Connection *connection, int64_t after,
                           const struct event_filter *filter, struct subscriber **subscriber,
                           struct error *error);

/* libmicrohttpd's reader of a response: the next bytes for the subscriber. When there are none it
 * suspends the connection, to be resumed with news. */
ssize_t feed_read(void *subscriber, uint64_t position, char *buffer, size_t room);

/* libmicrohttpd's end of a response. */
void feed_unsubscribe(void *subscriber);

/* Number of subscribers. */
unsigned feed_subscribers(struct feed *feed);

#endif
