/* The HTTP side of the daemon: sockets, requests, replies. */
#ifndef PNEULAB_HTTP_SERVER_H
#define PNEULAB_HTTP_SERVER_H

#include "server/base/options.h"
#include "server/http/service.h"

struct server;

/* Listens on options->address and port and answers requests from then on. service is the
 * caller's, complete, and outlives the server. STATUS_IO when the address cannot be had. */
enum status server_create(const struct options *options, struct service *service,
                          struct server **server, struct error *error);

/* The port it listens on. */
uint16_t server_port(const struct server *server);

/* Closes the listening socket; open connections are still served. */
void server_stop_accepting(struct server *server);

/* Ends all connections. NULL is fine. */
void server_destroy(struct server *server);

/* To be called when a job's state has changed, from any thread: wakes those who wait for it. */
void server_job_changed(struct service *service, int64_t job_id);

#endif
