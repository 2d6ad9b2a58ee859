/* The least that libmicrohttpd can do, to compare the daemon with:
 *   bare_http THREADS HEADERS BODY
 * Answers every request with the bytes of the file BODY and the header lines of the file HEADERS
 * ("Name: value"), from one response made at the start. Listens on a free port of 127.0.0.1, prints
 * it, and ends with its standard input. */
#include <arpa/inet.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static enum MHD_Result answer(void *context, struct MHD_Connection *connection, const char *url,
                              const char *method, const char *version, const char *data,
                              size_t *size, void **state) {
  static int seen;
  (void)url;
  (void)method;
  (void)version;
  (void)data;
  (void)size;
  if (!*state) { /* the header has arrived; the request is complete with the next call */
    *state = &seen;
    return MHD_YES;
  }
  *state = NULL;
  return MHD_queue_response(connection, MHD_HTTP_OK, context);
}

/* The response of a body and its header lines; Date, Connection and lengths are left to the
 * library. */
static struct MHD_Response *response_make(const char *headers, const char *body) {
  static char bytes[1 << 20];
  char line[2048];
  FILE *file = fopen(body, "rb");
  if (!file) {
    return NULL;
  }
  size_t size = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  struct MHD_Response *response =
      MHD_create_response_from_buffer(size, bytes, MHD_RESPMEM_PERSISTENT);
  file = fopen(headers, "r");
  while (response && file && fgets(line, sizeof line, file)) {
    line[strcspn(line, "\r\n")] = '\0';
    char *value = strstr(line, ": ");
    if (value && strncasecmp(line, "Date:", 5) != 0 &&
        strncasecmp(line, "Content-Length:", 15) != 0 &&
        strncasecmp(line, "Connection:", 11) != 0) {
      *value = '\0';
      MHD_add_response_header(response, line, value + 2);
    }
  }
  if (file) {
    fclose(file);
  }
  return response;
}

int main(int argc, char **argv) {
  if (argc != 4) {
    fprintf(stderr, "usage: bare_http THREADS HEADERS BODY\n");
    return 2;
  }
  struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  struct MHD_Response *response = response_make(argv[2], argv[3]);
  struct MHD_Daemon *daemon =
      response ? MHD_start_daemon(MHD_USE_EPOLL_INTERNAL_THREAD, 0, NULL, NULL, answer, response,
                                  MHD_OPTION_SOCK_ADDR, &address, MHD_OPTION_THREAD_POOL_SIZE,
                                  (unsigned)atoi(argv[1]), MHD_OPTION_END)
               : NULL;
  if (!daemon) {
    return 1;
  }
  printf("%u\n", MHD_get_daemon_info(daemon, MHD_DAEMON_INFO_BIND_PORT)->port);
  fflush(stdout);
  while (getchar() != EOF) {
  }
  MHD_stop_daemon(daemon);
  MHD_destroy_response(response);
  return 0;
}
