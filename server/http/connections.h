/* Open connections and the time each has for the request it is sending. libmicrohttpd's own
 * timeout starts anew with every byte; this one does not. */
#ifndef PNEULAB_HTTP_CONNECTIONS_H
#define PNEULAB_HTTP_CONNECTIONS_H

#include <stdint.h>

#include "solver/base/error.h"

struct connections;
struct connection;
struct tls;

enum connection_phase {
  CONNECTION_HEADER, /* idle, or a header is arriving */
  CONNECTION_BODY,
  CONNECTION_ANSWER,
  CONNECTION_STREAM /* an answer without an end */
};

/* How long a client may take to send a header and a body, however busily it trickles. */
struct connection_times {
  int64_t header_ms, body_ms;
};

/* tls: of all connections, NULL for plain HTTP; outlives *connections, which is the caller's. */
enum status connections_create(const struct connection_times *times, struct tls *tls,
                               struct connections **connections, struct error *error);
void connections_destroy(struct connections *connections);

/* Notes a new connection in phase header; NULL without memory. The socket stays the caller's. */
struct connection *connections_add(struct connections *connections, int socket);
/* Forgets a connection before its socket is closed. NULL is fine. */
void connections_remove(struct connections *connections, struct connection *connection);
/* Enters a phase; its time starts now. A NULL connection is fine. */
void connections_phase(struct connections *connections, struct connection *connection,
                       enum connection_phase phase);
/* Shuts down the sockets whose time is over; a request that did not arrive gets a 408. An answer
 * may take any time as long as the client takes 1 kB/s of it. */
void connections_expire(struct connections *connections);
/* Notes whose request a connection carries, and tells how many open ones are theirs, with this. */
unsigned connections_party(struct connections *connections, struct connection *connection,
                           const char *party);
/* What a connection was made with. NULL is fine. */
struct tls *connection_tls(const struct connection *connection);
/* Number of open connections. */
unsigned connections_count(struct connections *connections);
/* Number of connections with a request that is not answered yet. */
unsigned connections_busy(struct connections *connections);

#endif
