/* A steady load of GET requests on connections that stay open, and how long answers take:
 *   load_probe HOST PORT PATH CONNECTIONS RATE SECONDS
 * RATE requests a second in all, at even times: an answer that is late does not keep the next
 * request back, whose time counts from when it was due. Prints one JSON object. */
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/bench/load_net.h"

enum { ANSWER_MAX = 1 << 20, LAST_ANSWER_MS = 10000 };

struct link {
  int fd;
  int waiting; /* a request is under way */
  double due_ms;
  char *answer;
  size_t size;
};

struct probe {
  const char *host;
  int port;
  char request[512];
  struct link *links;
  size_t link_count;
  double *taken_ms;
  size_t taken, failed, sent, limit;
};

/* Whether the whole answer has arrived: its header names the length. */
static int answer_complete(const struct link *link) {
  link->answer[link->size] = '\0';
  const char *end = strstr(link->answer, "\r\n\r\n");
  const char *length = strcasestr(link->answer, "Content-Length:");
  return end && length && length < end &&
         link->size >= (size_t)(end + 4 - link->answer) + strtoul(length + 15, NULL, 10);
}

static void link_fail(struct probe *probe, struct link *link) {
  probe->failed += link->waiting != 0;
  close(link->fd);
  link->fd = -1;
  link->waiting = 0;
}

static void link_read(struct probe *probe, struct link *link) {
  ssize_t got = recv(link->fd, link->answer + link->size, ANSWER_MAX - 1 - link->size, 0);
  if (got <= 0) {
    if (got == 0 || (errno != EAGAIN && errno != EINTR)) {
      link_fail(probe, link);
    }
    return;
  }
  link->size += (size_t)got;
  if (link->waiting && answer_complete(link)) {
    if (strncmp(link->answer, "HTTP/1.1 200", 12) == 0 && probe->taken < probe->limit) {
      probe->taken_ms[probe->taken++] = load_now_ms() - link->due_ms;
    } else {
      probe->failed++;
    }
    link->waiting = 0;
  }
}

/* Sends a request that was due at due_ms on a free connection, if there is one. */
static int probe_send(struct probe *probe, double due_ms) {
  for (size_t i = 0; i < probe->link_count; i++) {
    struct link *link = &probe->links[i];
    if (link->waiting) {
      continue;
    }
    if (link->fd < 0 || recv(link->fd, link->answer, 1, MSG_PEEK) >= 0) {
      /* not open yet, or the server has closed it for having been idle */
      if (link->fd >= 0) {
        close(link->fd);
      }
      link->fd = load_connect(probe->host, probe->port, NULL);
      struct pollfd connected = {.fd = link->fd, .events = POLLOUT};
      poll(&connected, 1, 1000);
    }
    link->waiting = 1;
    link->due_ms = due_ms;
    link->size = 0;
    if (link->fd < 0 || send(link->fd, probe->request, strlen(probe->request), MSG_NOSIGNAL) < 0) {
      link_fail(probe, link);
    }
    probe->sent++;
    return 1;
  }
  return 0;
}

static void probe_wait(struct probe *probe, double wait_ms) {
  struct pollfd watched[256];
  for (size_t i = 0; i < probe->link_count; i++) {
    watched[i] = (struct pollfd){.fd = probe->links[i].fd, .events = POLLIN};
  }
  struct timespec pause = {.tv_nsec = (long)(1e6 * fmax(0, fmin(wait_ms, 900)))};
  ppoll(watched, probe->link_count, &pause, NULL);
  for (size_t i = 0; i < probe->link_count; i++) {
    if (watched[i].revents != 0 && probe->links[i].fd >= 0) {
      link_read(probe, &probe->links[i]);
    }
  }
}

static void probe_run(struct probe *probe, double rate, double seconds) {
  double since = load_now_ms(), until = since + 1e3 * seconds, due = since;
  for (double now = since; now < until + LAST_ANSWER_MS; now = load_now_ms()) {
    size_t waiting = 0;
    while (due <= now && due < until && probe_send(probe, due)) {
      due += 1e3 / rate;
    }
    for (size_t i = 0; i < probe->link_count; i++) {
      waiting += probe->links[i].waiting != 0;
    }
    if (due >= until && waiting == 0) {
      break;
    }
    probe_wait(probe, due > now && due < until ? due - now : 10);
  }
  for (size_t i = 0; i < probe->link_count; i++) {
    probe->failed += probe->links[i].waiting != 0;
  }
}

int main(int argc, char **argv) {
  if (argc != 7) {
    fprintf(stderr, "usage: load_probe HOST PORT PATH CONNECTIONS RATE SECONDS\n");
    return 2;
  }
  double rate = atof(argv[5]), seconds = atof(argv[6]);
  struct probe probe = {
      .host = argv[1], .port = atoi(argv[2]), .link_count = (size_t)atol(argv[4])};
  probe.limit = (size_t)(rate * seconds) + 16;
  probe.links = calloc(probe.link_count, sizeof *probe.links);
  probe.taken_ms = calloc(probe.limit, sizeof *probe.taken_ms);
  if (!probe.links || !probe.taken_ms || probe.link_count > 256) {
    return 1;
  }
  for (size_t i = 0; i < probe.link_count; i++) {
    probe.links[i].fd = -1;
    probe.links[i].answer = malloc(ANSWER_MAX);
    if (!probe.links[i].answer) {
      return 1;
    }
  }
  snprintf(probe.request, sizeof probe.request, "GET %s HTTP/1.1\r\nHost: %s:%d\r\n\r\n", argv[3],
           probe.host, probe.port);
  probe_run(&probe, rate, seconds);
  double p50 = load_percentile(probe.taken_ms, probe.taken, 0.5);
  double p99 = load_percentile(probe.taken_ms, probe.taken, 0.99);
  double most = load_percentile(probe.taken_ms, probe.taken, 1);
  printf("{\"sent\":%zu,\"answered\":%zu,\"failed\":%zu,\"p50_ms\":%.3f,\"p99_ms\":%.3f,"
         "\"max_ms\":%.3f}\n",
         probe.sent, probe.taken, probe.failed, p50, p99, most);
  for (size_t i = 0; i < probe.link_count; i++) {
    if (probe.links[i].fd >= 0) {
      close(probe.links[i].fd);
    }
    free(probe.links[i].answer);
  }
  free(probe.links);
  free(probe.taken_ms);
  return 0;
}
