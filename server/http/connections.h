/* Open connections and the time each has for the request it is sending. libmicrohttpd's own
 * timeout starts anew with every byte; this one does not. */
#ifndef PNEULAB_HTTP_CONNECTIONS_H
#define PNEULAB_HTTP_CONNECTIONS_H

#include <stdint.h>

#include "solver/base/error.h"

struct connections;
struct connection;

enum connection_phase {
  CONNECTION_HEADER, /* idle, or a header is arriving */
  CONNECTION_BODY,
  CONNECTION_ANSWER,
  CONNECTION_STREAM /* an answer without an end */
};

/* timeout_ms: for the header, and again for the body. The caller owns *connections. */
enum status connections_create(int64_t timeout_ms, struct connections **connections,
                               struct error *error);
void connections_destroy(struct connections *connections);

/* Notes a new connection in phase header; NULL without memory. The socket stays the caller's. */
struct connection *connections_add(struct connections *connections, int socket);
/* Forgets a connection before its socket is closed. NULL is fine. */
void connections_remove(struct connections *connections, struct connection *connection);
/* Enters a phase; its time starts now. A NULL connection is fine. */
void connections_phase(struct connections *connections, struct connection *connection,
                       enum connection_phase phase);
/* Shuts down the sockets whose time is over; a request that did not arrive gets a 408. */
void connections_expire(struct connections *connections);
/* Number of connections with a request that is not answered yet. */
unsigned connections_busy(struct connections *connections);

#endif
