/* Follows the events file of a running solve. */
#ifndef PNEULAB_EXEC_PROGRESS_H
#define PNEULAB_EXEC_PROGRESS_H

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "server/exec/pace.h"

/* The newest report of a solve. */
struct progress {
  double fraction;         /* 0 .. 1, -1 before the first report */
  double pressure_kPa;     /* of the last converged step, NAN when not reported */
  int64_t step, steps;     /* done and in all: load steps, members, trials; 0 when not reported */
  int64_t iteration;       /* of Newton's method, since the start; 0 when not reported */
  struct pace_point since; /* from where to measure the rate */
};

struct progress_reader {
  char path[PATH_MAX];
  off_t offset; /* of the first byte not yet taken in */
  struct pace pace;
};

/* A progress of which nothing is known. */
struct progress progress_none(void);

/* Seconds that are left at now_ms on the monotonic clock; -1 when that cannot be told yet. */
double progress_left_s(const struct progress *progress, int64_t now_ms);

/* Takes one line of the file into *progress: an event of another kind, a damaged line or a number
 * out of range changes nothing. size: without the line's end. */
void progress_take_line(const char *line, size_t size, struct progress *progress);

/* Reads the complete lines added since the last call; true when *progress changed. At most 64 KiB
 * are read a call; a longer line is skipped. */
bool progress_poll(struct progress_reader *reader, struct progress *progress);

#endif
