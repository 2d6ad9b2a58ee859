/* Sends bytes from standard input to a server as they are and prints what comes back, until the
 * server closes the connection or is silent for a while.
 * usage: raw_client PORT [MILLISECONDS_BETWEEN_BYTES [MILLISECONDS_OF_SILENCE]] */
#include <arpa/inet.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

enum { SILENCE_MS = 1000, REQUEST_MAX = 1 << 20 };

/* Prints what has arrived; 0 once the server has closed, -1 when nothing came in time. */
static long receive(int fd, int timeout_ms) {
  char buffer[4096];
  struct pollfd ready = {.fd = fd, .events = POLLIN};
  if (poll(&ready, 1, timeout_ms) <= 0) {
    return -1;
  }
  ssize_t got = recv(fd, buffer, sizeof buffer, 0);
  if (got > 0) {
    fwrite(buffer, 1, (size_t)got, stdout);
  }
  return got > 0 ? got : 0;
}

int main(int argc, char **argv) {
  static char request[REQUEST_MAX];
  struct sockaddr_in address = {.sin_family = AF_INET,
                                .sin_port = htons((uint16_t)atoi(argc > 1 ? argv[1] : "0")),
                                .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)}};
  int delay_ms = argc > 2 ? atoi(argv[2]) : 0;
  int silence_ms = argc > 3 ? atoi(argv[3]) : SILENCE_MS;
  int fd = socket(AF_INET, SOCK_STREAM, 0);
  signal(SIGPIPE, SIG_IGN);
  if (fd < 0 || connect(fd, (struct sockaddr *)&address, sizeof address) != 0) {
    perror("connect");
    return 1;
  }
  size_t size = fread(request, 1, sizeof request, stdin), sent = 0;
  while (sent < size) {
    ssize_t put = send(fd, request + sent, delay_ms > 0 ? 1 : size - sent, 0);
    if (put < 0) {
      break; /* refused before all was sent: the answer may still be there */
    }
    sent += (size_t)put;
    if (delay_ms > 0 && receive(fd, delay_ms) >= 0) {
      break;
    }
  }
  long got;
  while ((got = receive(fd, silence_ms)) > 0) {
  }
  printf("\n[%s]\n", got == 0 ? "closed" : "open");
  close(fd);
  return 0;
}
