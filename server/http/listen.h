/* The listening socket: libmicrohttpd with the daemon's settings. */
#ifndef PNEULAB_HTTP_LISTEN_H
#define PNEULAB_HTTP_LISTEN_H

#include <microhttpd.h>

#include "server/base/options.h"

/* What libmicrohttpd calls, each with `context` first; see its manual for when. */
struct listen_calls {
  void *context;
  MHD_AccessHandlerCallback handle;
  void *(*note_target)(void *context, const char *target, struct MHD_Connection *connection);
  MHD_RequestCompletedCallback completed;
  MHD_NotifyConnectionCallback connection;
};

/* Starts to listen and to answer. *daemon is the caller's, to be ended with MHD_stop_daemon;
 * everything in *calls must outlive it. STATUS_IO when the address cannot be had. */
enum status listen_start(const struct options *options, const struct listen_calls *calls,
                         struct MHD_Daemon **daemon, struct error *error);

#endif
