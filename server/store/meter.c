#include <limits.h>
#include <stdio.h>
#include <sys/stat.h>

#include "server/base/clock.h"
#include "server/store/connection.h"

static const struct meter_bounds write_bounds = {
    .count = 12, .upper = {1e-4, 2.5e-4, 5e-4, 1e-3, 2.5e-3, 5e-3, 0.01, 0.025, 0.1, 0.5, 2.5, 10}};

void store_meter_wait(struct store *store, int64_t since_us, bool begun) {
  int64_t now = clock_monotonic_us();
  atomic_fetch_add_explicit(&store->meter.wait_micro, (uint64_t)(now - since_us),
                            memory_order_relaxed);
  if (!begun) {
    atomic_fetch_add_explicit(&store->meter.failures, 1, memory_order_relaxed);
  }
  store->meter.begun_us = now;
}

void store_meter_write(struct store *store, enum status status) {
  double seconds = 1e-6 * (double)(clock_monotonic_us() - store->meter.begun_us);
  histogram_add(&store->meter.write, &write_bounds, seconds);
  if (status == STATUS_IO || status == STATUS_NO_MEMORY) {
    atomic_fetch_add_explicit(&store->meter.failures, 1, memory_order_relaxed);
  }
}

static void size_write(FILE *out, const struct store *store, const char *suffix, const char *file) {
  char path[PATH_MAX];
  struct stat info;
  const char *name = sqlite3_db_filename(store->writer, "main");
  int length = snprintf(path, sizeof path, "%s%s", name ? name : "", suffix);
  if (length > 0 && (size_t)length < sizeof path && stat(path, &info) == 0) {
    fprintf(out, "pneulab_database_size_bytes{file=\"%s\"} %lld\n", file, (long long)info.st_size);
  }
}

void store_metrics(struct store *store, FILE *out) {
  meter_head(out, "pneulab_database_write_seconds", "histogram",
             "Duration of write transactions, from their begin to the durable commit.");
  meter_histogram(out, "pneulab_database_write_seconds", "", &store->meter.write, &write_bounds);
  meter_head(out, "pneulab_database_write_wait_seconds_total", "counter",
             "Time that write transactions waited for others and for locks.");
  fprintf(out, "pneulab_database_write_wait_seconds_total %.6f\n",
          1e-6 * (double)atomic_load(&store->meter.wait_micro));
  meter_head(out, "pneulab_database_write_failures_total", "counter",
             "Write transactions that failed with the disk, a lock or memory.");
  fprintf(out, "pneulab_database_write_failures_total %llu\n",
          (unsigned long long)atomic_load(&store->meter.failures));
  meter_head(out, "pneulab_database_size_bytes", "gauge",
             "Size of the database file and of its write-ahead log.");
  size_write(out, store, "", "main");
  size_write(out, store, "-wal", "wal");
}
