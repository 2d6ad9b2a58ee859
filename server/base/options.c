#include "server/base/options.h"

#include <arpa/inet.h>
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
  OPTION_DATA = 'd',
  OPTION_LISTEN = 'l',
  OPTION_WORKERS = 'w',
  OPTION_HELP = 'h',
  OPTION_VERSION = 'V',
  OPTION_EXECUTOR = 256,
  OPTION_SOLVER,
  OPTION_MEMORY,
  OPTION_DRAIN,
  OPTION_TIME,
  OPTION_MARGIN,
  OPTION_HEADER,
  OPTION_RETRY,
  OPTION_CONNECTIONS
};

static const struct option option_table[] = {
    {"data", required_argument, NULL, OPTION_DATA},
    {"listen", required_argument, NULL, OPTION_LISTEN},
    {"workers", required_argument, NULL, OPTION_WORKERS},
    {"executor", required_argument, NULL, OPTION_EXECUTOR},
    {"solver", required_argument, NULL, OPTION_SOLVER},
    {"memory-limit", required_argument, NULL, OPTION_MEMORY},
    {"drain-timeout", required_argument, NULL, OPTION_DRAIN},
    {"time-limit", required_argument, NULL, OPTION_TIME},
    {"timeout-margin", required_argument, NULL, OPTION_MARGIN},
    {"header-timeout", required_argument, NULL, OPTION_HEADER},
    {"retry-delay", required_argument, NULL, OPTION_RETRY},
    {"connections-per-address", required_argument, NULL, OPTION_CONNECTIONS},
    {"help", no_argument, NULL, OPTION_HELP},
    {"version", no_argument, NULL, OPTION_VERSION},
    {NULL, 0, NULL, 0},
};

const char *options_help(void) {
  return "usage: pneulabd [OPTION]...\n"
         "Accepts simulation jobs over HTTP, runs pneulab-solve and keeps the results.\n\n"
         "  -d, --data DIR           database, attempts and results (default: var)\n"
         "  -l, --listen ADDR:PORT   default 127.0.0.1:8080; port 0 picks a free one\n"
         "  -w, --workers N          jobs at a time (default: number of cores)\n"
         "      --executor local     how jobs are run\n"
         "      --solver PATH        pneulab-solve (default: beside pneulabd, else in PATH)\n"
         "      --memory-limit MIB   of one worker, 0 for none (default: 2048)\n"
         "      --time-limit S       of a job without a timeout (default: 86400)\n"
         "      --timeout-margin S   by which a worker may overrun it (default: 10)\n"
         "      --drain-timeout S    for running jobs after SIGTERM (default: 30)\n"
         "      --retry-delay S      before an attempt is repeated (default: 1)\n"
         "      --header-timeout S   for a request to arrive (default: 20)\n"
         "      --connections-per-address N   (default: 20)\n"
         "  -h, --help\n"
         "  -V, --version\n";
}

/* Copies text into a field of `size` bytes. */
static enum status option_text(const char *name, const char *text, char *field, size_t size,
                               struct error *error) {
  size_t length = strlen(text);
  if (length == 0 || length >= size) {
    return error_set(error, STATUS_INVALID, NULL, "--%s takes 1 to %zu characters.", name,
                     size - 1);
  }
  memcpy(field, text, length + 1);
  return STATUS_OK;
}

static enum status option_number(const char *name, const char *text, double low, double high,
                                 double *value, struct error *error) {
  char *end;
  errno = 0;
  double number = strtod(text, &end);
  if (end == text || *end != '\0' || errno != 0 || !isfinite(number) || number < low ||
      number > high) {
    return error_set(error, STATUS_INVALID, NULL,
                     "--%s %s: expected a number from %g to %g, for example --%s %g.", name, text,
                     low, high, name, low > 1 ? low : 1.0);
  }
  *value = number;
  return STATUS_OK;
}

static enum status option_count(const char *name, const char *text, double low, double high,
                                double *value, struct error *error) {
  enum status status = option_number(name, text, low, high, value, error);
  if (status == STATUS_OK && floor(*value) != *value) {
    status =
        error_set(error, STATUS_INVALID, NULL, "--%s %s: expected a whole number.", name, text);
  }
  return status;
}

/* Splits "127.0.0.1:8080" or "[::1]:8080". */
static enum status option_listen(const char *text, struct options *options, struct error *error) {
  const char *colon = strrchr(text, ':');
  size_t length = colon ? (size_t)(colon - text) : 0;
  char address[sizeof options->address];
  double port = 0;
  if (length > 0 && length < sizeof address) {
    memcpy(address, text, length);
    address[length] = '\0';
    if (address[0] == '[' && address[length - 1] == ']') {
      memmove(address, address + 1, length - 2);
      address[length - 2] = '\0';
    }
    unsigned char raw[16];
    if ((inet_pton(AF_INET, address, raw) == 1 || inet_pton(AF_INET6, address, raw) == 1) &&
        option_count("listen", colon + 1, 0, 65535, &port, NULL) == STATUS_OK) {
      memcpy(options->address, address, sizeof address);
      options->port = (uint16_t)port;
      return STATUS_OK;
    }
  }
  return error_set(error, STATUS_INVALID, NULL,
                   "--listen %s: expected a numeric address and a port, for example "
                   "127.0.0.1:8080 or [::1]:8080.",
                   text);
}

static enum status option_take(int code, const char *text, struct options *options,
                               struct error *error) {
  double value = 0;
  enum status status = STATUS_OK;
  switch (code) {
  case OPTION_DATA:
    return option_text("data", text, options->data, sizeof options->data, error);
  case OPTION_SOLVER:
    return option_text("solver", text, options->solver, sizeof options->solver, error);
  case OPTION_LISTEN:
    return option_listen(text, options, error);
  case OPTION_EXECUTOR:
    if (strcmp(text, "local") != 0) {
      status = error_set(error, STATUS_INVALID, NULL, "--executor %s: only local is known.", text);
    }
    return status;
  case OPTION_WORKERS:
    status = option_count("workers", text, 1, 256, &value, error);
    options->workers = (unsigned)value;
    return status;
  case OPTION_CONNECTIONS:
    status = option_count("connections-per-address", text, 1, 10000, &value, error);
    options->connections_per_address = (unsigned)value;
    return status;
  case OPTION_MEMORY:
    status = option_count("memory-limit", text, 0, 1e7, &value, error);
    options->memory_limit_bytes = (uint64_t)value << 20;
    return status;
  case OPTION_DRAIN:
    return option_number("drain-timeout", text, 0, 86400, &options->drain_timeout_s, error);
  case OPTION_TIME:
    return option_number("time-limit", text, 0.1, 1e7, &options->time_limit_s, error);
  case OPTION_MARGIN:
    return option_number("timeout-margin", text, 0, 3600, &options->timeout_margin_s, error);
  case OPTION_RETRY:
    return option_number("retry-delay", text, 0, 3600, &options->retry_delay_s, error);
  case OPTION_HEADER:
    return option_number("header-timeout", text, 0.1, 3600, &options->header_timeout_s, error);
  default:
    return error_set(error, STATUS_INVALID, NULL,
                     "Unknown option or missing value; see pneulabd --help.");
  }
}

/* The solver beside our own executable if there is one, else its bare name. */
static void options_find_solver(struct options *options) {
  char own[PATH_MAX];
  ssize_t length = readlink("/proc/self/exe", own, sizeof own - 1);
  snprintf(options->solver, sizeof options->solver, "pneulab-solve");
  if (length <= 0) {
    return;
  }
  own[length] = '\0';
  char *slash = strrchr(own, '/');
  if (!slash || (size_t)(slash - own) + sizeof "/pneulab-solve" > sizeof own) {
    return;
  }
  memcpy(slash, "/pneulab-solve", sizeof "/pneulab-solve");
  if (access(own, X_OK) == 0) {
    memcpy(options->solver, own, sizeof own);
  }
}

enum status options_read(int argc, char **argv, struct options *options, struct error *error) {
  long cores = sysconf(_SC_NPROCESSORS_ONLN);
  *options = (struct options){.data = "var",
                              .address = "127.0.0.1",
                              .port = 8080,
                              .workers = cores > 0 && cores <= 256 ? (unsigned)cores : 1,
                              .connections_per_address = 20,
                              .memory_limit_bytes = (uint64_t)2 << 30,
                              .drain_timeout_s = 30,
                              .time_limit_s = 86400,
                              .timeout_margin_s = 10,
                              .header_timeout_s = 20,
                              .retry_delay_s = 1};
  options_find_solver(options);
  opterr = 0;
  int code;
  while ((code = getopt_long(argc, argv, "d:l:w:hV", option_table, NULL)) != -1) {
    if (code == OPTION_HELP || code == OPTION_VERSION) {
      options->action = code == OPTION_HELP ? OPTIONS_HELP : OPTIONS_VERSION;
      return STATUS_OK;
    }
    enum status status = option_take(code, optarg, options, error);
    if (status != STATUS_OK) {
      return status;
    }
  }
  if (optind < argc) {
    return error_set(error, STATUS_INVALID, NULL, "Unexpected argument %s; see pneulabd --help.",
                     argv[optind]);
  }
  return STATUS_OK;
}
