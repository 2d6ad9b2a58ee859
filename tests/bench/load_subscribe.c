/* Many clients that follow /api/v1/events:
 *   load_subscribe HOST PORT COUNT SECONDS
 * Connects COUNT clients at once, reads for SECONDS or until all streams have ended, and prints one
 * JSON object: how many were answered with a stream, how many ended whole, events in all, ids that
 * were skipped or came twice ("gaps"), and the least and greatest of the last ids. Every client
 * starts at the present; the id that opens its stream is where it counts from. Prints "ready" on
 * standard error when every client has its first lines. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/bench/load_net.h"

enum { LINE_MAX_BYTES = 1024, EVENTS_AT_A_TIME = 256 };

struct client {
  int fd;
  enum { CLIENT_CONNECTING, CLIENT_HEADER, CLIENT_STREAM, CLIENT_ENDED, CLIENT_BROKEN } phase;
  char line[LINE_MAX_BYTES];
  size_t line_size;
  char size[16]; /* of the next chunk, in digits */
  size_t size_digits;
  long chunk_left; /* bytes of the chunk not yet read; -1: its size comes next; -2: its end */
  long long last_id, events, gaps, reports;
  int opened; /* the stream's own id was read */
};

static char request[256];

/* A line of the stream: ids must follow one another. */
static void take_line(struct client *client) {
  long long id;
  client->line[client->line_size] = '\0';
  if (sscanf(client->line, "id: %lld", &id) == 1) {
    if (!client->opened) {
      client->opened = 1;
    } else {
      client->events++;
      client->gaps += id != client->last_id + 1;
    }
    client->last_id = id;
  } else if (strcmp(client->line, "event: progress") == 0) {
    client->reports++;
  }
  client->line_size = 0;
}

static void take_byte(struct client *client, char c) {
  if (c == '\n') {
    take_line(client);
  } else if (c != '\r' && client->line_size < LINE_MAX_BYTES - 1) {
    client->line[client->line_size++] = c;
  }
}

/* The header, a line at a time; its end is an empty line. */
static void take_header(struct client *client, char c) {
  if (c != '\n') {
    if (c != '\r' && client->line_size < LINE_MAX_BYTES - 1) {
      client->line[client->line_size++] = c;
    }
    return;
  }
  client->line[client->line_size] = '\0';
  if (strncmp(client->line, "HTTP/1.1 ", 9) == 0 && strncmp(client->line + 9, "200", 3) != 0) {
    client->phase = CLIENT_BROKEN;
  } else if (client->line_size == 0) {
    client->phase = CLIENT_STREAM;
    client->chunk_left = -1;
  }
  client->line_size = 0;
}

/* Sizes of chunks have a buffer of their own: a line may go on in the next chunk. */
static void take_stream(struct client *client, char c) {
  if (client->chunk_left > 0) {
    take_byte(client, c);
    client->chunk_left = client->chunk_left == 1 ? -2 : client->chunk_left - 1;
  } else if (client->chunk_left == -2) {
    client->chunk_left = c == '\n' ? -1 : -2;
  } else if (c != '\n') {
    client->size_digits = client->size_digits < sizeof client->size - 1 ? client->size_digits : 0;
    client->size[client->size_digits++] = c;
  } else {
    client->size[client->size_digits] = '\0';
    client->size_digits = 0;
    client->chunk_left = strtol(client->size, NULL, 16);
    if (client->chunk_left == 0) {
      client->phase = CLIENT_ENDED;
    }
  }
}

static void client_read(struct client *client) {
  char buffer[16384];
  ssize_t got;
  while ((got = recv(client->fd, buffer, sizeof buffer, 0)) > 0) {
    for (ssize_t i = 0; i < got && client->phase < CLIENT_ENDED; i++) {
      if (client->phase == CLIENT_HEADER) {
        take_header(client, buffer[i]);
      } else {
        take_stream(client, buffer[i]);
      }
    }
  }
  if ((got == 0 || (errno != EAGAIN && errno != EINTR)) && client->phase < CLIENT_ENDED) {
    client->phase = CLIENT_BROKEN;
  }
}

static void client_step(struct client *client, int epoll) {
  if (client->phase == CLIENT_CONNECTING) {
    if (send(client->fd, request, strlen(request), MSG_NOSIGNAL) < 0) {
      client->phase = CLIENT_BROKEN;
    } else {
      client->phase = CLIENT_HEADER;
      struct epoll_event wanted = {.events = EPOLLIN, .data.ptr = client};
      epoll_ctl(epoll, EPOLL_CTL_MOD, client->fd, &wanted);
    }
  } else {
    client_read(client);
  }
  if (client->phase >= CLIENT_ENDED) {
    close(client->fd);
    client->fd = -1;
  }
}

static void report(const struct client *clients, size_t count) {
  long long events = 0, gaps = 0, reports = 0, low = -1, high = -1;
  size_t opened = 0, ended = 0, broken = 0;
  for (size_t i = 0; i < count; i++) {
    const struct client *at = &clients[i];
    events += at->events;
    reports += at->reports;
    gaps += at->gaps;
    opened += at->opened != 0;
    ended += at->phase == CLIENT_ENDED;
    broken += at->phase == CLIENT_BROKEN;
    low = at->opened && (low < 0 || at->last_id < low) ? at->last_id : low;
    high = at->opened && at->last_id > high ? at->last_id : high;
  }
  printf("{\"clients\":%zu,\"opened\":%zu,\"ended\":%zu,\"broken\":%zu,\"events\":%lld,"
         "\"reports\":%lld,\"gaps\":%lld,\"last_least\":%lld,\"last_greatest\":%lld}\n",
         count, opened, ended, broken, events, reports, gaps, low, high);
}

static size_t count_phase(const struct client *clients, size_t count, int opened) {
  size_t found = 0;
  for (size_t i = 0; i < count; i++) {
    found += opened ? clients[i].opened || clients[i].phase == CLIENT_BROKEN
                    : clients[i].phase >= CLIENT_ENDED;
  }
  return found;
}

int main(int argc, char **argv) {
  if (argc != 5) {
    fprintf(stderr, "usage: load_subscribe HOST PORT COUNT SECONDS\n");
    return 2;
  }
  int port = atoi(argv[2]), epoll = epoll_create1(EPOLL_CLOEXEC), said = 0;
  size_t count = (size_t)atol(argv[3]);
  double until = load_now_ms() + 1e3 * atof(argv[4]);
  struct client *clients = calloc(count, sizeof *clients);
  if (!clients || epoll < 0) {
    return 1;
  }
  snprintf(request, sizeof request,
           "GET /api/v1/events HTTP/1.1\r\nHost: %s:%d\r\nAccept: text/event-stream\r\n\r\n",
           argv[1], port);
  load_descriptors(count + 50);
  for (size_t i = 0; i < count; i++) {
    clients[i].fd = load_connect(argv[1], port, NULL);
    struct epoll_event wanted = {.events = EPOLLOUT, .data.ptr = &clients[i]};
    if (clients[i].fd < 0 || epoll_ctl(epoll, EPOLL_CTL_ADD, clients[i].fd, &wanted) != 0) {
      clients[i].phase = CLIENT_BROKEN;
    }
  }
  double looked = 0;
  for (double now = load_now_ms(); now < until; now = load_now_ms()) {
    struct epoll_event events[EVENTS_AT_A_TIME];
    int got = epoll_wait(epoll, events, EVENTS_AT_A_TIME, 100);
    for (int i = 0; i < got; i++) {
      client_step(events[i].data.ptr, epoll);
    }
    if (now - looked >= 100) {
      looked = now;
      if (!said && count_phase(clients, count, 1) == count) {
        said = fprintf(stderr, "ready\n");
      }
      if (count_phase(clients, count, 0) == count) {
        break;
      }
    }
  }
  report(clients, count);
  free(clients);
  return 0;
}
