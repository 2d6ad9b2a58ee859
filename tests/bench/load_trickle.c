/* Clients that send a request header one byte at a time:
 *   load_trickle HOST PORT COUNT SECONDS [FROM [one]]
 * Each sends a byte every half second, for SECONDS at most. With FROM (as in 127.1.0.0) each comes
 * from an address of its own, counted on from there, or all come from that one. Prints one JSON
 * object: how many were accepted, how many were closed by the server, and when the last of these
 * was closed. */
#include <arpa/inet.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "tests/bench/load_net.h"

struct client {
  int fd;
  size_t sent;
  double closed_ms; /* after the start; 0: open */
};

static void address(char *text, size_t size, const char *first, unsigned number) {
  struct in_addr at = {0};
  inet_pton(AF_INET, first, &at);
  at.s_addr = htonl(ntohl(at.s_addr) + number + 1);
  inet_ntop(AF_INET, &at, text, (socklen_t)size);
}

/* Sends the next byte; notes when the server has ended the connection. */
static void client_step(struct client *client, const char *header, double since) {
  char answer[256];
  ssize_t got;
  while ((got = recv(client->fd, answer, sizeof answer, 0)) > 0) {
  }
  int closed = got == 0 || (errno != EAGAIN && errno != EINTR && errno != ENOTCONN);
  size_t at = client->sent < strlen(header) ? client->sent : strlen(header) - 1;
  if (!closed && send(client->fd, header + at, 1, MSG_NOSIGNAL) < 0) {
    closed = errno != EAGAIN && errno != EINTR;
  }
  client->sent++;
  if (closed) {
    client->closed_ms = load_now_ms() - since;
    close(client->fd);
    client->fd = -1;
  }
}

int main(int argc, char **argv) {
  if (argc < 5) {
    fprintf(stderr, "usage: load_trickle HOST PORT COUNT SECONDS [FROM [one]]\n");
    return 2;
  }
  static const char header[] =
      "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: aaaaaaaaaaaaaaaaaaaaaaa";
  struct timespec pause = {.tv_nsec = 20000000};
  size_t count = (size_t)atol(argv[3]), open = count, accepted = 0, closed = 0;
  double seconds = atof(argv[4]), since = load_now_ms(), last = 0;
  struct client *clients = calloc(count, sizeof *clients);
  if (!clients) {
    return 1;
  }
  load_descriptors(count + 50);
  for (size_t i = 0; i < count; i++) {
    char from[INET_ADDRSTRLEN];
    if (argc > 5) {
      address(from, sizeof from, argv[5], argc > 6 ? 0 : (unsigned)i);
    }
    clients[i].fd = load_connect(argv[1], atoi(argv[2]), argc > 5 ? from : NULL);
    accepted += clients[i].fd >= 0;
    open -= clients[i].fd < 0;
  }
  for (int step = 0; open > 0 && load_now_ms() - since < 1e3 * seconds; step++) {
    nanosleep(&pause, NULL);
    open = 0;
    for (size_t i = 0; i < count; i++) { /* every client has its turn every 25th round */
      if (clients[i].fd >= 0 && i % 25 == (size_t)step % 25) {
        client_step(&clients[i], header, since);
      }
      open += clients[i].fd >= 0;
    }
  }
  for (size_t i = 0; i < count; i++) {
    closed += clients[i].closed_ms > 0;
    last = clients[i].closed_ms > last ? clients[i].closed_ms : last;
  }
  printf("{\"clients\":%zu,\"accepted\":%zu,\"closed\":%zu,\"last_closed_s\":%.2f}\n", count,
         accepted, closed, 1e-3 * last);
  free(clients);
  return 0;
}
