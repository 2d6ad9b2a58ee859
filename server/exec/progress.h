/* Follows the events file of a running solve. */
#ifndef PNEULAB_EXEC_PROGRESS_H
#define PNEULAB_EXEC_PROGRESS_H

#include <limits.h>
#include <stdbool.h>
#include <sys/types.h>

struct progress {
  double fraction;     /* 0 .. 1, -1 before the first report */
  double pressure_kPa; /* of the last converged step, -1 when not reported */
};

struct progress_reader {
  char path[PATH_MAX];
  off_t offset; /* of the first byte not yet taken in */
};

/* Takes one line of the file into *progress: an event of another kind, a damaged line or a number
 * out of range changes nothing. size: without the line's end. */
void progress_take_line(const char *line, size_t size, struct progress *progress);

/* Reads the complete lines added since the last call; true when *progress changed. At most 64 KiB
 * are read a call; a longer line is skipped. */
bool progress_poll(struct progress_reader *reader, struct progress *progress);

#endif
