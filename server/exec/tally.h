/* Counts of what workers did, for /metrics. */
#ifndef PNEULAB_EXEC_TALLY_H
#define PNEULAB_EXEC_TALLY_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "server/store/store.h"

struct tally;

/* The caller owns *tally. */
enum status tally_create(struct tally **tally, struct error *error);
void tally_destroy(struct tally *tally);

/* One attempt that has ended. Strings of any length and number: what is beyond the table counts as
 * "other". */
struct tally_attempt {
  const char *kind;   /* of the job */
  const char *state;  /* the job's after it */
  const char *reason; /* reason_code, "" for success */
  bool final;         /* the job has ended with it */
  double wall_s;
  double peak_memory_MB;
};

/* From any thread. */
void tally_ended(struct tally *tally, const struct tally_attempt *attempt);

/* Attempts have begun; one has ended so, after that much processor time. From any thread. */
void tally_attempts_started(struct tally *tally, unsigned count);
void tally_attempt_ended(struct tally *tally, enum attempt_end end, double cpu_s);

/* A job was taken out of the queue after so many seconds. */
void tally_waited(struct tally *tally, double seconds);

/* Writes attempts, jobs finished, solve times, waiting times and memory in the text form of
 * Prometheus. */
void tally_write(struct tally *tally, FILE *out);

#endif
