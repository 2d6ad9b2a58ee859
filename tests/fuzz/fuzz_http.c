/* Any bytes over a connection of the running daemon, which is a thread of this program: answered
 * with HTTP or closed, never with an internal error, never worse. A byte 0xFF parts what is sent
 * at once. The daemon's workers end without a result. */
#include <arpa/inet.h>
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <ftw.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/daemon.h"
#include "tests/fuzz/fuzz.h"

enum { IDLE_MS = 40, ANSWER_MAX = 1 << 16 };

static char directory[] = "/tmp/fuzz-http-XXXXXX";
static struct sockaddr_in address = {.sin_family = AF_INET};

static int remove_one(const char *path, const struct stat *info, int kind, struct FTW *walk) {
  (void)info, (void)kind, (void)walk;
  return remove(path);
}

static void remove_directory(void) {
  nftw(directory, remove_one, 16, FTW_DEPTH | FTW_PHYS);
}

static void *run_daemon(void *argument) {
  (void)argument;
  char *arguments[] = {"pneulabd",    "--data",
                       directory,     "--listen",
                       "127.0.0.1:0", "--workers",
                       "1",           "--solver",
                       "/bin/true",   "--launcher",
                       "/bin/true",   "--isolation",
                       "off",         "--retry-delay",
                       "3600",        "--connections-per-address",
                       "1000",        NULL};
  daemon_run(sizeof arguments / sizeof *arguments - 1, arguments);
  abort(); /* it could not start */
}

/* Starts the daemon and learns its port from the line that it prints. */
static void start(void) {
  int ends[2], own = dup(STDOUT_FILENO);
  char line[200] = "";
  pthread_t thread;
  if (own < 0 || !mkdtemp(directory) || pipe(ends) != 0 || dup2(ends[1], STDOUT_FILENO) < 0) {
    abort();
  }
  atexit(remove_directory);
  if (pthread_create(&thread, NULL, run_daemon, NULL) != 0) {
    abort();
  }
  for (size_t length = 0; !strchr(line, '\n');) { /* a timer's signal may interrupt the reading */
    ssize_t got = read(ends[0], line + length, sizeof line - 1 - length);
    length += got > 0 ? (size_t)got : 0;
    if (got == 0 || (got < 0 && errno != EINTR) || length == sizeof line - 1) {
      abort();
    }
  }
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons((uint16_t)strtoul(strrchr(line, ':') + 1, NULL, 10));
  dup2(own, STDOUT_FILENO);
  close(own);
  close(ends[1]);
  close(ends[0]);
}

/* Sends the pieces; a daemon that has seen enough may close before. */
static void send_pieces(int connection, const uint8_t *data, size_t size) {
  const uint8_t *end = data + size;
  while (data < end) {
    const uint8_t *stop = memchr(data, 0xFF, (size_t)(end - data));
    size_t length = (size_t)((stop ? stop : end) - data);
    if (length > 0 && send(connection, data, length, MSG_NOSIGNAL) < 0) {
      return;
    }
    data += length + 1;
  }
}

/* What comes back begins with a status line, and with none of 500. */
static void check_answer(const char *answer, size_t size) {
  static const char protocol[] = "HTTP/1.";
  if (size == 0) {
    return;
  }
  if (size < 12 || memcmp(answer, protocol, sizeof protocol - 1) != 0 ||
      !isdigit((unsigned char)answer[9]) || memcmp(answer + 9, "500", 3) == 0) {
    fprintf(stderr, "answer: %.*s\n", (int)size, answer);
    abort();
  }
}

/* A new connection to the daemon. A timer's signal may interrupt connect(), which then goes on by
 * itself. */
static int connection_open(void) {
  int connection = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  struct pollfd made = {.fd = connection, .events = POLLOUT};
  if (connection >= 0 &&
      connect(connection, (const struct sockaddr *)&address, sizeof address) == 0) {
    return connection;
  }
  while (connection >= 0 && errno == EINTR) {
    int reason = 0;
    if (poll(&made, 1, -1) == 1) {
      getsockopt(connection, SOL_SOCKET, SO_ERROR, &reason, &(socklen_t){sizeof reason});
      if (reason == 0) {
        return connection;
      }
      errno = reason;
    }
  }
  perror("fuzz_http: cannot connect");
  abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static bool started;
  static char answer[ANSWER_MAX];
  if (!started) {
    start();
    started = true;
  }
  int connection = connection_open();
  setsockopt(connection, IPPROTO_TCP, TCP_NODELAY, &(int){1}, sizeof(int));
  send_pieces(connection, data, size);
  shutdown(connection, SHUT_WR);
  struct pollfd wait = {.fd = connection, .events = POLLIN};
  size_t length = 0;
  ssize_t got = 1;
  while (got > 0 && length < sizeof answer && poll(&wait, 1, IDLE_MS) > 0) {
    got = recv(connection, answer + length, sizeof answer - length, 0);
    length += got > 0 ? (size_t)got : 0;
  }
  close(connection);
  check_answer(answer, length);
  return 0;
}
