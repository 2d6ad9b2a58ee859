#include "server/http/connections.h"

#include <linux/sockios.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include "server/base/clock.h"

/* A reader has to take this much in this time while something waits to be taken. The time is less
 * than that after which libmicrohttpd gives up, which leaves the rest to the system for minutes. */
enum { READER_WINDOW_MS = 12000, READER_LEAST_BYTES = 12000, READER_CHECK_MS = 1000 };

struct connection {
  struct connection *next, *previous;
  int socket;
  enum connection_phase phase;
  int64_t since_ms;
  int64_t checked_ms; /* when the reader was looked at */
  uint64_t taken;     /* bytes that the client had acknowledged at since_ms */
  char party[64];     /* whose request it is, behind a proxy */
  struct tls *tls;    /* NULL: plain HTTP */
  bool ended;         /* its socket was shut down already */
};

struct connections {
  pthread_mutex_t mutex;
  struct connection_times times;
  struct tls *tls;
  struct connection *first;
};

enum status connections_create(const struct connection_times *times, struct tls *tls,
                               struct connections **connections, struct error *error) {
  struct connections *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the connections.");
  }
  pthread_mutex_init(&made->mutex, NULL);
  made->times = *times;
  made->tls = tls;
  *connections = made;
  return STATUS_OK;
}

void connections_destroy(struct connections *connections) {
  if (!connections) {
    return;
  }
  while (connections->first) {
    connections_remove(connections, connections->first);
  }
  pthread_mutex_destroy(&connections->mutex);
  free(connections);
}

struct connection *connections_add(struct connections *connections, int socket) {
  struct connection *made = calloc(1, sizeof *made);
  if (!made) {
    return NULL;
  }
  made->socket = socket;
  made->tls = connections->tls;
  made->since_ms = clock_monotonic_ms();
  pthread_mutex_lock(&connections->mutex);
  made->next = connections->first;
  if (made->next) {
    made->next->previous = made;
  }
  connections->first = made;
  pthread_mutex_unlock(&connections->mutex);
  return made;
}

void connections_remove(struct connections *connections, struct connection *connection) {
  if (!connection) {
    return;
  }
  pthread_mutex_lock(&connections->mutex);
  if (connection->previous) {
    connection->previous->next = connection->next;
  } else {
    connections->first = connection->next;
  }
  if (connection->next) {
    connection->next->previous = connection->previous;
  }
  pthread_mutex_unlock(&connections->mutex);
  free(connection);
}

void connections_phase(struct connections *connections, struct connection *connection,
                       enum connection_phase phase) {
  if (connection) {
    pthread_mutex_lock(&connections->mutex);
    connection->phase = phase;
    connection->since_ms = clock_monotonic_ms();
    pthread_mutex_unlock(&connections->mutex);
  }
}

/* Whether the client takes too little of what waits for it. While nothing waits, as during a long
 * computation, it is not to blame. */
static bool reader_is_slow(struct connection *at, int64_t now) {
  struct tcp_info info = {0};
  socklen_t size = sizeof info;
  int waiting = 0;
  if (now - at->checked_ms < READER_CHECK_MS) {
    return false;
  }
  at->checked_ms = now;
  if (ioctl(at->socket, SIOCOUTQ, &waiting) != 0 ||
      getsockopt(at->socket, IPPROTO_TCP, TCP_INFO, &info, &size) != 0) {
    return false;
  }
  bool slow = waiting > 0 && now - at->since_ms >= READER_WINDOW_MS &&
              info.tcpi_bytes_acked - at->taken < READER_LEAST_BYTES;
  if (waiting == 0 || now - at->since_ms >= READER_WINDOW_MS) {
    at->since_ms = now;
    at->taken = info.tcpi_bytes_acked;
  }
  return slow;
}

static bool connection_is_late(const struct connections *connections, struct connection *at,
                               int64_t now) {
  switch (at->phase) {
  case CONNECTION_HEADER:
    return now - at->since_ms >= connections->times.header_ms;
  case CONNECTION_BODY:
    return now - at->since_ms >= connections->times.body_ms;
  case CONNECTION_ANSWER:
    return reader_is_slow(at, now);
  case CONNECTION_STREAM:
    return false;
  }
  return false;
}

void connections_expire(struct connections *connections) {
  static const char late[] = "HTTP/1.1 408 Request Timeout\r\nConnection: close\r\n"
                             "Content-Length: 0\r\n\r\n";
  int64_t now = clock_monotonic_ms();
  pthread_mutex_lock(&connections->mutex);
  for (struct connection *at = connections->first; at; at = at->next) {
    if (at->ended || !connection_is_late(connections, at, now)) {
      continue;
    }
    if (at->phase == CONNECTION_ANSWER) { /* the system need not keep what nobody takes */
      struct linger none = {.l_onoff = 1, .l_linger = 0};
      setsockopt(at->socket, SOL_SOCKET, SO_LINGER, &none, sizeof none);
    } else if (!at->tls) {
      send(at->socket, late, sizeof late - 1, MSG_DONTWAIT | MSG_NOSIGNAL);
    }
    shutdown(at->socket, SHUT_RDWR);
    at->ended = true;
  }
  pthread_mutex_unlock(&connections->mutex);
}

unsigned connections_party(struct connections *connections, struct connection *connection,
                           const char *party) {
  unsigned open = 0;
  pthread_mutex_lock(&connections->mutex);
  if (connection) {
    strncpy(connection->party, party, sizeof connection->party - 1);
  }
  for (const struct connection *at = connections->first; at; at = at->next) {
    open += at == connection || (at->phase != CONNECTION_HEADER && strcmp(at->party, party) == 0);
  }
  pthread_mutex_unlock(&connections->mutex);
  return open;
}

struct tls *connection_tls(const struct connection *connection) {
  return connection ? connection->tls : NULL;
}

unsigned connections_busy(struct connections *connections) {
  unsigned busy = 0;
  pthread_mutex_lock(&connections->mutex);
  for (const struct connection *at = connections->first; at; at = at->next) {
    busy += at->phase != CONNECTION_HEADER;
  }
  pthread_mutex_unlock(&connections->mutex);
  return busy;
}

unsigned connections_count(struct connections *connections) {
  unsigned count = 0;
  pthread_mutex_lock(&connections->mutex);
  for (const struct connection *at = connections->first; at; at = at->next) {
    count++;
  }
  pthread_mutex_unlock(&connections->mutex);
  return count;
}
