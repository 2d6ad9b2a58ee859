/* GET /metrics: the text form of Prometheus. Every figure is at hand or one row of the database: a
 * scrape costs the same with a million jobs. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/meter.h"
#include "server/exec/isolation.h"
#include "server/http/connections.h"
#include "server/http/feed.h"
#include "server/http/handlers.h"
#include "server/http/record.h"

static void gauge(FILE *out, const char *name, const char *help, double value) {
  meter_head(out, name, "gauge", help);
  fprintf(out, "%s %.15g\n", name, value);
}

static void jobs_write(FILE *out, const int64_t counts[JOB_STATE_COUNT]) {
  meter_head(out, "pneulab_jobs", "gauge", "Jobs in the database, by state.");
  for (int i = 0; i < JOB_STATE_COUNT; i++) {
    fprintf(out, "pneulab_jobs{state=\"%s\"} %lld\n", job_state_word((enum job_state)i),
            (long long)counts[i]);
  }
}

static void isolation_write(FILE *out, const struct isolation *isolation) {
  meter_head(out, "pneulab_isolation", "gauge",
             "Whether a means of keeping workers apart is in use (1) or not (0).");
  fprintf(out,
          "pneulab_isolation{means=\"landlock\"} %d\npneulab_isolation{means=\"seccomp\"} %d\n"
          "pneulab_isolation{means=\"process_namespace\"} %d\n"
          "pneulab_isolation{means=\"process_count\"} %d\n",
          isolation->landlock > 0, isolation->seccomp, isolation->namespaces, isolation->processes);
}

static void disk_write(FILE *out, const char *data) {
  struct statvfs info;
  if (statvfs(data, &info) == 0) {
    gauge(out, "pneulab_disk_free_bytes", "Free space where the data are, for this user.",
          (double)info.f_bavail * (double)info.f_frsize);
    gauge(out, "pneulab_disk_size_bytes", "Size of the file system where the data are.",
          (double)info.f_blocks * (double)info.f_frsize);
  }
}

static unsigned descriptors_count(void) {
  DIR *directory = opendir("/proc/self/fd");
  unsigned count = 0;
  while (directory && readdir(directory)) {
    count++;
  }
  if (directory) {
    closedir(directory);
  }
  return count > 3 ? count - 3 : 0; /* without . and .. and the directory itself */
}

static void process_write(FILE *out, const struct service *service) {
  unsigned long pages[2] = {0, 0};
  struct rlimit limit = {0, 0};
  struct rusage usage = {0};
  FILE *memory = fopen("/proc/self/statm", "re");
  if (memory) {
    if (fscanf(memory, "%lu %lu", &pages[0], &pages[1]) == 2) {
      double page = (double)sysconf(_SC_PAGESIZE);
      gauge(out, "process_virtual_memory_bytes", "Virtual memory.", page * (double)pages[0]);
      gauge(out, "process_resident_memory_bytes", "Resident memory.", page * (double)pages[1]);
    }
    fclose(memory);
  }
  getrusage(RUSAGE_SELF, &usage);
  meter_head(out, "process_cpu_seconds_total", "counter", "Processor time of the daemon itself.");
  fprintf(out, "process_cpu_seconds_total %.6f\n",
          (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
              1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec));
  gauge(out, "process_open_fds", "Open descriptors.", descriptors_count());
  getrlimit(RLIMIT_NOFILE, &limit);
  gauge(out, "process_max_fds", "Descriptors that may be open.", (double)limit.rlim_cur);
  gauge(out, "process_start_time_seconds", "Start of the daemon since 1970-01-01 UTC.",
        1e-3 * (double)(clock_unix_ms() - clock_monotonic_ms() + service->started_ms));
  gauge(out, "pneulab_uptime_seconds", "Time since the start.",
        1e-3 * (double)(clock_monotonic_ms() - service->started_ms));
  meter_head(out, "pneulab_build_info", "gauge", "The version, as a label.");
  fputs("pneulab_build_info{version=\"" PNEULAB_VERSION "\"} 1\n", out);
}

void metrics_show(struct request *request, struct reply *reply) {
  struct service *service = request->service;
  int64_t counts[JOB_STATE_COUNT];
  struct error error;
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  if (out) {
    if (store_counts(service->store, counts, &error) == STATUS_OK) {
      jobs_write(out, counts); /* the rest is there even when the database is not */
    }
    executor_metrics(service->executor, out);
    isolation_write(out, service->isolation);
    store_metrics(service->store, out);
    http_meter_write(service->meter, out);
    gauge(out, "pneulab_http_connections", "Open connections.",
          connections_count(service->connections));
    gauge(out, "pneulab_event_subscribers", "Clients that follow the events.",
          feed_subscribers(service->feed));
    disk_write(out, service->data);
    process_write(out, service);
    if (fclose(out) != 0) {
      free(text);
      text = NULL;
    }
  }
  reply_text(reply, "text/plain; version=0.0.4; charset=utf-8", text, size);
}
