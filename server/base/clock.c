#include "server/base/clock.h"

#include <stdio.h>

static int64_t clock_read_ms(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

int64_t clock_unix_ms(void) {
  return clock_read_ms(CLOCK_REALTIME);
}

int64_t clock_monotonic_ms(void) {
  return clock_read_ms(CLOCK_MONOTONIC);
}

int64_t clock_monotonic_us(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

struct timespec clock_deadline(int64_t delay_ms) {
  int64_t at = clock_monotonic_ms() + delay_ms;
  return (struct timespec){.tv_sec = (time_t)(at / 1000), .tv_nsec = (long)(at % 1000) * 1000000L};
}

void clock_condition_init(pthread_cond_t *condition) {
  pthread_condattr_t monotonic;
  pthread_condattr_init(&monotonic);
  pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
  pthread_cond_init(condition, &monotonic);
  pthread_condattr_destroy(&monotonic);
}

void clock_format(int64_t unix_ms, char text[CLOCK_TEXT_SIZE]) {
  time_t seconds = (time_t)(unix_ms / 1000);
  struct tm utc;
  gmtime_r(&seconds, &utc);
  size_t used = strftime(text, CLOCK_TEXT_SIZE, "%Y-%m-%dT%H:%M:%S", &utc);
  snprintf(text + used, CLOCK_TEXT_SIZE - used, ".%03dZ", (int)(unix_ms % 1000));
}
