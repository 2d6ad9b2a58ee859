#include "server/daemon.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/auth/token_command.h"
#include "server/base/clock.h"
#include "server/base/lock.h"
#include "server/base/log.h"
#include "server/base/notify.h"
#include "server/base/options.h"
#include "server/exec/disk.h"
#include "server/exec/janitor.h"
#include "server/exec/pool.h"
#include "server/exec/share.h"
#include "server/http/access.h"
#include "server/http/analyst.h"
#include "server/http/answers.h"
#include "server/http/feed.h"
#include "server/http/record.h"
#include "server/http/server.h"
#include "server/http/snapshots.h"
#include "server/http/waiters.h"
#include "server/maintenance.h"
#include "server/slurm/slurm.h"
#include "server/store/store.h"
#include "server/study/conductor.h"
#include "server/study/model.h"
#include "server/study/tables.h"
#include "solver/job/spec.h"

enum { SIGNAL_POLL_MS = 100 };

/* The parts of the daemon in the order of their making. */
struct parts {
  int lock; /* keeps a second daemon away from the data directory */
  struct isolation isolation;
  struct service service;
  struct janitor *janitor;
  struct server *server;
  enum exit_code exit_code; /* when they could not be made */
};

static void job_changed(void *context, int64_t job_id) {
  struct service *service = context;
  server_job_changed(service, job_id);
  conductor_wake(service->conductor);
}

static void job_progressed(void *context, int64_t job_id, int64_t attempt,
                           const struct progress *progress) {
  struct service *service = context;
  feed_progress(service->feed, job_id, attempt, progress);
}

static void copy_made(void *context, int64_t ticket) {
  const struct service *service = context;
  waiters_job_ended(service->waiters, -ticket);
}

static void analysis_made(void *context, int64_t waited) {
  const struct service *service = context;
  waiters_job_ended(service->waiters, waited);
}

static enum status isolate(const struct options *options, struct isolation *isolation,
                           struct error *error) {
  struct isolation_settings settings = {.mode = (enum isolation_mode)options->isolation,
                                        .launcher = options->launcher,
                                        .read = options->worker_read,
                                        .write = options->worker_write,
                                        .nice = options->worker_nice};
  return isolation_open(&settings, isolation, error);
}

/* The database, and what only asks it. */
static enum status parts_open_store(const struct options *options, struct parts *parts,
                                    struct error *error) {
  struct service *service = &parts->service;
  int64_t recovered = 0;
  service->data = options->data;
  service->isolation = &parts->isolation;
  service->memory_limit_bytes = options->memory_limit_bytes;
  service->started_ms = clock_monotonic_ms();
  enum status status = access_create(options, &service->access, error);
  parts->exit_code = EXIT_FAILED;
  if (status == STATUS_OK) {
    status = lock_take(options->data, &parts->lock, error);
    parts->exit_code = status == STATUS_CONFLICT ? EXIT_IN_USE : EXIT_FAILED;
  }
  if (status == STATUS_OK) {
    status = store_open(options->data, &service->store, error);
    parts->exit_code = maintenance_exit_code(status);
  }
  if (status == STATUS_OK) {
    store_set_sharing(service->store, share_files, (void *)options->data);
    status = store_recover(service->store, options->executor != EXECUTOR_LOCAL, &recovered, error);
  }
  if (status == STATUS_OK) {
    status = job_reader_create(&service->reader, error);
  }
  if (status == STATUS_OK) {
    status = waiters_create(&service->waiters, error);
  }
  if (status == STATUS_OK) {
    status = http_meter_create(&service->meter, error);
  }
  if (status == STATUS_OK) {
    status = answers_create(service->store, &service->answers, error);
  }
  if (status == STATUS_OK) {
    status = tables_create(service->store, &service->tables, error);
  }
  if (status == STATUS_OK) {
    status = models_create(&service->models, error);
  }
  if (status == STATUS_OK) {
    status = feed_create(service->store, options->subscribers, &service->feed, error);
  }
  if (recovered > 0) {
    log_line("%lld jobs were left open by an earlier run", (long long)recovered);
  }
  return status;
}

/* The engines that run jobs. */
static enum status executor_open(const struct options *options, struct parts *parts,
                                 struct error *error) {
  struct service *service = &parts->service;
  enum status status = executor_create(&service->executor, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct engine engine;
  struct pool_settings local = {
      .engine = {.store = service->store,
                 .disk = service->disk,
                 .tally = executor_tally(service->executor),
                 .data = options->data,
                 .solver = options->solver,
                 .memory_limit_bytes = options->memory_limit_bytes,
                 .files_limit_bytes = options->files_limit_bytes,
                 .time_limit_s = options->time_limit_s,
                 .timeout_margin_s = options->timeout_margin_s,
                 .retry_delay_s = options->retry_delay_s,
                 .changed = job_changed,
                 .progressed = job_progressed,
                 .context = service},
      .taste = {.engine = options->executor == EXECUTOR_LOCAL ? ENGINE_NONE : ENGINE_LOCAL,
                .others = options->executor == EXECUTOR_BOTH},
      .isolation = &parts->isolation,
      .workers = options->workers};
  status = pool_create(&local, &engine, error);
  if (status == STATUS_OK) {
    executor_add(service->executor, engine);
  }
  if (status == STATUS_OK && options->executor != EXECUTOR_LOCAL) {
    struct slurm_settings slurm = {
        .engine = local.engine,
        .taste = {.engine = ENGINE_SLURM, .others = options->executor == EXECUTOR_SLURM},
        .partition = options->slurm_partition,
        .account = options->slurm_account,
        .queue = options->slurm_queue,
        .bundle_s = options->slurm_bundle_s,
        .nice = (int)options->slurm_nice};
    if (options->slurm_solver[0]) {
      slurm.engine.solver = options->slurm_solver;
    }
    status = slurm_create(&slurm, &engine, error);
    if (status == STATUS_OK) {
      executor_add(service->executor, engine);
    }
  }
  return status;
}

static enum status parts_open(const struct options *options, struct parts *parts,
                              struct error *error) {
  struct service *service = &parts->service;
  enum status status = parts_open_store(options, parts, error);
  if (status == STATUS_OK) {
    status = isolate(options, &parts->isolation, error);
  }
  if (status == STATUS_OK) {
    status = disk_create(service->store, options->data, options->disk_reserve_bytes, &service->disk,
                         error);
  }
  if (status == STATUS_OK) {
    struct janitor_settings settings = {
        .store = service->store,
        .disk = service->disk,
        .data = options->data,
        .limits = {.keep_ms = (int64_t)(86400e3 * options->keep_files_days),
                   .keep_bytes = (int64_t)options->keep_files_bytes}};
    status = janitor_create(&settings, &parts->janitor, error);
  }
  if (status == STATUS_OK) {
    struct conductor_settings settings = {.store = service->store,
                                          .data = options->data,
                                          .disk = service->disk,
                                          .reader = service->reader,
                                          .changed = job_changed,
                                          .progressed = job_progressed,
                                          .context = service};
    status = conductor_create(&settings, &service->conductor, error);
  }
  if (status == STATUS_OK) {
    status = executor_open(options, parts, error);
  }
  if (status == STATUS_OK) {
    status = conductor_start(service->conductor, service->executor, error);
  }
  if (status == STATUS_OK) {
    status = snapshots_create(service->store, options->data, copy_made, service,
                              &service->snapshots, error);
  }
  if (status == STATUS_OK) {
    status = analyst_create(analysis_made, service, &service->analyst, error);
  }
  if (status == STATUS_OK) {
    status = server_create(options, service, &parts->server, error);
  }
  return status;
}

static void parts_close(struct parts *parts) {
  analyst_stop(parts->service.analyst); /* it uses requests of the server */
  server_destroy(parts->server);        /* its handlers ask the executor */
  analyst_destroy(parts->service.analyst);
  snapshots_destroy(parts->service.snapshots);
  conductor_stop(parts->service.conductor); /* it asks the executor, */
  executor_destroy(parts->service.executor);
  conductor_destroy(parts->service.conductor); /* which wakes it */
  feed_destroy(parts->service.feed);
  http_meter_destroy(parts->service.meter);
  tables_destroy(parts->service.tables);
  models_destroy(parts->service.models);
  answers_destroy(parts->service.answers);
  isolation_release(&parts->isolation);
  janitor_destroy(parts->janitor);
  disk_destroy(parts->service.disk);
  waiters_destroy(parts->service.waiters);
  job_reader_destroy(parts->service.reader);
  store_close(parts->service.store);
  access_destroy(parts->service.access);
  if (parts->lock >= 0) {
    close(parts->lock);
  }
}

/* Running jobs may finish for a while; then they are put back into the queue. A second signal
 * shortens this. */
static void drain(struct parts *parts, const sigset_t *signals, double timeout_s) {
  struct executor *executor = parts->service.executor;
  struct timespec poll = {.tv_nsec = SIGNAL_POLL_MS * 1000000L};
  int64_t until = clock_monotonic_ms() + (int64_t)(1000 * timeout_s);
  atomic_store(&parts->service.draining, true);
  log_line("shutting down: running jobs have %g s to finish", timeout_s);
  server_stop_accepting(parts->server);
  executor_drain(executor);
  while (!executor_idle(executor)) {
    if (clock_monotonic_ms() >= until) {
      executor_stop(executor, false);
    }
    int received = sigtimedwait(signals, NULL, &poll);
    if (received > 0 && received != SIGHUP) {
      log_line("shutting down at once");
      executor_stop(executor, true);
    }
  }
}

/* Waits for the signal to end, telling a watchdog meanwhile that the database answers. */
static int await_signal(struct parts *parts, const sigset_t *signals) {
  int64_t pace_ms = notify_watchdog_ms();
  struct timespec pace = {.tv_sec = (time_t)(pace_ms / 1000),
                          .tv_nsec = (long)(pace_ms % 1000) * 1000000L};
  int64_t counts[JOB_STATE_COUNT];
  int received;
  while ((received = sigtimedwait(signals, NULL, pace_ms > 0 ? &pace : NULL)) <= 0) {
    store_counts(parts->service.store, counts, NULL); /* hangs when the store does */
    notify_send("WATCHDOG=1");
  }
  return received;
}

static enum exit_code serve(const struct options *options) {
  struct parts parts = {.lock = -1};
  struct error error;
  sigset_t signals;
  int received = 0;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGHUP);
  sigprocmask(SIG_BLOCK, &signals, NULL); /* in all threads: they are taken here */
  signal(SIGPIPE, SIG_IGN);
  setenv("OPENBLAS_NUM_THREADS", "1", 1); /* for the workers: one core each */
  enum status status = parts_open(options, &parts, &error);
  if (status != STATUS_OK) {
    fprintf(stderr, "pneulabd: %s\n", error.message);
  } else {
    bool six = strchr(options->listen.host, ':') != NULL;
    printf("listening on http%s://%s%s%s:%u\n", options->tls_certificate[0] ? "s" : "",
           six ? "[" : "", options->listen.host, six ? "]" : "", server_port(parts.server));
    fflush(stdout);
    notify_send("READY=1");
    while ((received = await_signal(&parts, &signals)) == SIGHUP) {
      access_reload(parts.service.access);
    }
    log_event(LOG_LEVEL_INFO, "signal", LOG_TEXT("name", sigabbrev_np(received)));
    notify_send("STOPPING=1");
    drain(&parts, &signals, options->drain_timeout_s);
  }
  parts_close(&parts);
  if (status == STATUS_OK) {
    return EXIT_FINE;
  }
  return parts.exit_code == EXIT_FINE ? EXIT_FAILED : parts.exit_code;
}

int daemon_run(int argc, char **argv) {
  struct options options;
  struct error error;
  umask(0077); /* the data are of the daemon's user alone */
  if (argc > 1 && strcmp(argv[1], "token") == 0) {
    return token_command(argc - 1, argv + 1);
  }
  if (options_read(argc, argv, &options, &error) != STATUS_OK) {
    fprintf(stderr, "pneulabd: %s\n", error.message);
    return EXIT_COMMAND_LINE;
  }
  if (options.action == OPTIONS_HELP) {
    options_help(stdout);
    return EXIT_FINE;
  }
  if (options.action == OPTIONS_VERSION) {
    puts("pneulabd " PNEULAB_VERSION);
    return EXIT_FINE;
  }
  log_configure((enum log_level)options.log_level, (enum log_format)options.log_format);
  return maintenance_wanted(&options) ? (int)maintenance_run(&options) : (int)serve(&options);
}
