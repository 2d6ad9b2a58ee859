#include "solver/base/clock.h"

#include <sys/resource.h>
#include <time.h>

static double read_clock(clockid_t id) {
  struct timespec t;
  clock_gettime(id, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double clock_cpu_s(void) {
  return read_clock(CLOCK_PROCESS_CPUTIME_ID);
}

double clock_wall_s(void) {
  return read_clock(CLOCK_MONOTONIC);
}

double clock_peak_memory_MB(void) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return 1e-3 * 1.024 * (double)usage.ru_maxrss;
}
