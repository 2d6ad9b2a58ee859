#include "server/http/connections.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/socket.h>

#include "server/base/clock.h"

enum { ANSWER_MS = 600000 }; /* for a reader that takes its time */

struct connection {
  struct connection *next, *previous;
  int socket;
  enum connection_phase phase;
  int64_t since_ms;
  bool ended; /* its socket was shut down already */
};

struct connections {
  pthread_mutex_t mutex;
  int64_t timeout_ms;
  struct connection *first;
};

enum status connections_create(int64_t timeout_ms, struct connections **connections,
                               struct error *error) {
  struct connections *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the connections.");
  }
  pthread_mutex_init(&made->mutex, NULL);
  made->timeout_ms = timeout_ms;
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

void connections_expire(struct connections *connections) {
  static const char late[] = "HTTP/1.1 408 Request Timeout\r\nConnection: close\r\n"
                             "Content-Length: 0\r\n\r\n";
  int64_t now = clock_monotonic_ms();
  pthread_mutex_lock(&connections->mutex);
  for (struct connection *at = connections->first; at; at = at->next) {
    int64_t limit = at->phase == CONNECTION_ANSWER ? ANSWER_MS : connections->timeout_ms;
    if (at->ended || at->phase == CONNECTION_STREAM || now - at->since_ms < limit) {
      continue;
    }
    if (at->phase != CONNECTION_ANSWER) {
      send(at->socket, late, sizeof late - 1, MSG_DONTWAIT | MSG_NOSIGNAL);
    }
    shutdown(at->socket, SHUT_RDWR);
    at->ended = true;
  }
  pthread_mutex_unlock(&connections->mutex);
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
