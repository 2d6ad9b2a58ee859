#include "server/base/options.h"

#include <stddef.h>
#include <string.h>
#include <unistd.h>

#define ROW(KIND, LETTER, NAME, VALUE, MEMBER, LOW, HIGH, PRESET, HELP)                            \
  {                                                                                                \
    .kind = OPTION_##KIND, .letter = LETTER, .name = NAME, .value = VALUE,                         \
    .offset = offsetof(struct options, MEMBER), .size = sizeof(((struct options *)0)->MEMBER),     \
    .low = LOW, .high = HIGH, .preset = PRESET, .help = HELP                                       \
  }

/* One row an option, in the order of --help and of the manual page. */
static const struct option_row rows[] = {
    ROW(TEXT, 'd', "data", "DIR", data, 0, 0, "var", "database, attempts and results"),
    ROW(ADDRESS, 'l', "listen", "ADDR:PORT", listen, 0, 0, "127.0.0.1:8080",
        "where to listen; port 0 picks a free one"),
    ROW(TEXT, 0, "tls-certificate", "FILE", tls_certificate, 0, 0, NULL,
        "PEM chain; then HTTPS is spoken (reread on SIGHUP)"),
    ROW(TEXT, 0, "tls-key", "FILE", tls_key, 0, 0, NULL, "PEM key that belongs to it"),
    ROW(FLAG, 0, "behind-proxy", NULL, behind_proxy, 0, 0, NULL,
        "a proxy is in front: believe its X-Forwarded headers"),
    ROW(LIST, 0, "host", "NAME", hosts, 0, 0, NULL,
        "name that requests may be for; repeat or use commas"),
    ROW(COUNT, 'w', "workers", "N", workers, 1, 256, NULL,
        "jobs at a time (default: number of cores)"),
    ROW(WORD, 0, "executor", "local|slurm|local+slurm", executor, 0, 0, "local",
        "who solves jobs; a job's label executor chooses among both"),
    ROW(TEXT, 0, "slurm-partition", "NAME", slurm_partition, 0, 0, NULL,
        "of the cluster (default: the cluster's; a label overrides it)"),
    ROW(TEXT, 0, "slurm-account", "NAME", slurm_account, 0, 0, NULL,
        "that is charged on the cluster"),
    ROW(TEXT, 0, "slurm-solver", "PATH", slurm_solver, 0, 0, NULL,
        "pneulab-solve on the nodes (default: as --solver)"),
    ROW(COUNT, 0, "slurm-queue", "N", slurm_queue, 1, 100000, "1000",
        "tasks at most that wait on the cluster at a time"),
    ROW(NUMBER, 0, "slurm-bundle-seconds", "S", slurm_bundle_s, 0, 86400, "30",
        "that small jobs bundled into one task take together"),
    ROW(COUNT, 0, "slurm-nice", "N", slurm_nice, 0, 100000, "0",
        "by which tasks stand back on the cluster"),
    ROW(TEXT, 0, "solver", "PATH", solver, 0, 0, NULL,
        "pneulab-solve (default: beside pneulabd, else in PATH)"),
    ROW(MIB, 0, "memory-limit", "MIB", memory_limit_bytes, 0, 1e7, "2048",
        "of one worker, 0 for none"),
    ROW(MIB, 0, "files-limit", "MIB", files_limit_bytes, 0, 1e7, "4096",
        "of all files of one job, 0 for none"),
    ROW(WORD, 0, "isolation", "auto|require|off", isolation, 0, 0, "auto",
        "of workers: what the kernel offers, all or nothing"),
    ROW(LIST, 0, "worker-read", "PATH", worker_read, 0, 0, NULL,
        "further file or folder that workers may read (repeatable)"),
    ROW(LIST, 0, "worker-write", "DIR", worker_write, 0, 0, NULL,
        "further folder that workers may write (repeatable)"),
    ROW(COUNT, 0, "worker-nice", "N", worker_nice, 0, 19, "10", "priority of workers"),
    ROW(TEXT, 0, "launcher", "PATH", launcher, 0, 0, NULL,
        "pneulab-launch (default: beside pneulabd or as installed)"),
    ROW(NUMBER, 0, "time-limit", "S", time_limit_s, 0.1, 1e7, "86400",
        "of a job without a timeout"),
    ROW(NUMBER, 0, "timeout-margin", "S", timeout_margin_s, 0, 3600, "10",
        "by which a worker may overrun it"),
    ROW(NUMBER, 0, "drain-timeout", "S", drain_timeout_s, 0, 86400, "30",
        "for running jobs after SIGTERM"),
    ROW(NUMBER, 0, "retry-delay", "S", retry_delay_s, 0, 3600, "1",
        "before an attempt is repeated"),
    ROW(NUMBER, 0, "header-timeout", "S", header_timeout_s, 0.1, 3600, "8",
        "for the header of a request to arrive"),
    ROW(NUMBER, 0, "body-timeout", "S", body_timeout_s, 0.1, 3600, "30", "for its body"),
    ROW(NUMBER, 0, "request-rate", "HZ", request_rate_hz, 0, 1e6, NULL,
        "requests a second of one token or address, 0 for any\n                           number "
        "(default: 0 on loopback, else 100)"),
    ROW(COUNT, 0, "connections", "N", connections, 1, 100000, "500", "open at the same time"),
    ROW(COUNT, 0, "connections-per-address", "N", connections_per_address, 1, 10000, "20",
        "of them from one address"),
    ROW(COUNT, 0, "subscribers", "N", subscribers, 0, 10000, "200",
        "clients that follow the events at the same time"),
    ROW(WORD, 0, "log-level", "error|warning|info|request", log_level, 0, 0, "info",
        "what is logged; request: every request too"),
    ROW(WORD, 0, "log-format", "text|json", log_format, 0, 0, "text", "of the log"),
    ROW(MIB, 0, "disk-reserve", "MIB", disk_reserve_bytes, 0, 1e7, "64",
        "free space kept for results; 0 for none"),
    ROW(NUMBER, 0, "keep-files-days", "D", keep_files_days, 0, 36500, "0",
        "files of finished jobs; 0 for ever"),
    ROW(MIB, 0, "keep-files-size", "MIB", keep_files_bytes, 0, 1e9, "0",
        "of all files of finished jobs; 0 for no limit"),
    ROW(TEXT, 0, "backup", "FILE", backup, 0, 0, NULL,
        "copy the database to FILE instead of serving"),
    ROW(TEXT, 0, "restore", "FILE", restore, 0, 0, NULL,
        "put a backup in the place of the database instead"),
    ROW(FLAG, 0, "check", NULL, check, 0, 0, NULL, "check all of the database instead"),
    ROW(FLAG, 0, "force", NULL, force, 0, 0, NULL, "--backup, --restore: replace what is there"),
    ROW(ACTION, 'h', "help", NULL, action, OPTIONS_HELP, 0, NULL, "print this text"),
    ROW(ACTION, 'V', "version", NULL, action, OPTIONS_VERSION, 0, NULL, "print the version"),
};

enum { ROW_COUNT = sizeof rows / sizeof *rows };

const struct option_row *options_rows(size_t *count) {
  *count = ROW_COUNT;
  return rows;
}

void options_help(FILE *out) {
  fputs("usage: pneulabd [OPTION]...\n"
        "Accepts simulation jobs over HTTP, runs pneulab-solve and keeps the results.\n\n",
        out);
  option_help(rows, ROW_COUNT, out);
}

/* The solver beside our own executable if there is one, else its bare name. */
static void options_find_solver(struct options *options) {
  char own[PATH_MAX];
  ssize_t length = readlink("/proc/self/exe", own, sizeof own - 1);
  strcpy(options->solver, "pneulab-solve");
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
  int used = 0;
  bool stopped = false;
  *options = (struct options){.workers = cores > 0 && cores <= 256 ? (unsigned)cores : 1,
                              .request_rate_hz = -1};
  options_find_solver(options);
  enum status status = option_preset(rows, ROW_COUNT, options, error);
  if (status == STATUS_OK) {
    status = option_read(rows, ROW_COUNT, "pneulabd", argc, argv, options, &used, &stopped, error);
  }
  if (status == STATUS_OK && !stopped && used < argc) {
    status = error_set(error, STATUS_INVALID, NULL, "Unexpected argument %s; see pneulabd --help.",
                       argv[used]);
  }
  return status;
}
