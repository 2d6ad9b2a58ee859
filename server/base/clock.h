/* Times in milliseconds. */
#ifndef PNEULAB_SERVER_CLOCK_H
#define PNEULAB_SERVER_CLOCK_H

#include <pthread.h>
#include <stdint.h>
#include <time.h>

enum { CLOCK_TEXT_SIZE = 32 };

/* Milliseconds since 1970-01-01 UTC. */
int64_t clock_unix_ms(void);

/* Milliseconds of a clock that never jumps; only differences mean something. */
int64_t clock_monotonic_ms(void);

/* The same clock in microseconds. */
int64_t clock_monotonic_us(void);

/* The moment `delay_ms` from now on the monotonic clock, for timed waits. */
struct timespec clock_deadline(int64_t delay_ms);

/* Makes a condition whose timed waits end at such a moment; the caller destroys it. */
void clock_condition_init(pthread_cond_t *condition);

/* Writes unix_ms as "2026-11-22T07:33:26.123Z" into text. */
void clock_format(int64_t unix_ms, char text[CLOCK_TEXT_SIZE]);

#endif
