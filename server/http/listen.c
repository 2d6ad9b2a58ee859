#include "server/http/listen.h"

#include <arpa/inet.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <sys/resource.h>

#include "server/base/log.h"
#include "server/http/tls.h"

enum {
  THREADS = 4,           /* more of them than cores cost latency under load */
  DESCRIPTORS_OWN = 300, /* for the database, workers, files that are being sent */
  IDLE_TIMEOUT_S = 15
};

/* Raises the soft limit of open files as far as it is wanted and the hard limit allows. */
static void descriptors_raise(rlim_t wanted) {
  struct rlimit limit;
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= wanted) {
    return;
  }
  rlim_t allowed = limit.rlim_max < wanted ? limit.rlim_max : wanted;
  limit.rlim_cur = allowed;
  if (setrlimit(RLIMIT_NOFILE, &limit) != 0 || allowed < wanted) {
    log_line("only %llu open files are allowed (ulimit -n), %llu may be needed: some connections "
             "will be refused",
             (unsigned long long)allowed, (unsigned long long)wanted);
  }
}

/* libmicrohttpd is to leave escapes alone: url_parse reads the target as it was sent. */
static size_t keep_escapes(void *context, struct MHD_Connection *connection, char *text) {
  (void)context;
  (void)connection;
  return strlen(text);
}

enum status listen_start(const struct options *options, const struct listen_calls *calls,
                         struct MHD_Daemon **daemon, struct error *error) {
  const struct option_address *listen = &options->listen;
  struct sockaddr_in four = {.sin_family = AF_INET, .sin_port = htons((uint16_t)listen->port)};
  struct sockaddr_in6 six = {.sin6_family = AF_INET6, .sin6_port = htons((uint16_t)listen->port)};
  bool is_six = inet_pton(AF_INET6, listen->host, &six.sin6_addr) == 1;
  inet_pton(AF_INET, listen->host, &four.sin_addr);
  const void *address = is_six ? (const void *)&six : (const void *)&four;
  bool secure = options->tls_certificate[0] != '\0';
  unsigned flags = MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME |
                   (is_six ? MHD_USE_IPv6 : 0U) | (secure ? MHD_USE_TLS : 0U);
  struct MHD_OptionItem tls[] = {
      {MHD_OPTION_HTTPS_CERT_CALLBACK2, 0, (void *)(uintptr_t)tls_retrieve},
      {MHD_OPTION_HTTPS_PRIORITIES, 0, (void *)(uintptr_t)TLS_PRIORITIES},
      {MHD_OPTION_END, 0, NULL}};
  /* Behind a proxy all connections come from its address: there requests are counted instead. */
  unsigned per_address = options->behind_proxy ? 0 : options->connections_per_address;
  void *context = calls->context;
  descriptors_raise((rlim_t)options->connections + options->subscribers + DESCRIPTORS_OWN);
  *daemon = MHD_start_daemon(
      flags, (uint16_t)listen->port, NULL, NULL, calls->handle, context, MHD_OPTION_SOCK_ADDR,
      address, MHD_OPTION_THREAD_POOL_SIZE, (unsigned)THREADS, MHD_OPTION_PER_IP_CONNECTION_LIMIT,
      per_address, MHD_OPTION_CONNECTION_LIMIT, options->connections + options->subscribers,
      MHD_OPTION_CONNECTION_TIMEOUT, (unsigned)IDLE_TIMEOUT_S, MHD_OPTION_STRICT_FOR_CLIENT, 1,
      MHD_OPTION_URI_LOG_CALLBACK, calls->note_target, context, MHD_OPTION_UNESCAPE_CALLBACK,
      keep_escapes, NULL, MHD_OPTION_NOTIFY_COMPLETED, calls->completed, context,
      MHD_OPTION_NOTIFY_CONNECTION, calls->connection, context, MHD_OPTION_ARRAY,
      secure ? tls : tls + 2, MHD_OPTION_END);
  if (!*daemon) {
    return error_set(error, STATUS_IO, NULL, "Cannot listen on %s port %u.", listen->host,
                     listen->port);
  }
  return STATUS_OK;
}
