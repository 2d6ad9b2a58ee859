#include "server/auth/limiter.h"

#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"

/* A party is looked for in one set of a few buckets, so that the time is bounded. */
enum { SETS = 1024, WAYS = 8 };

struct bucket {
  char party[80];  /* "" when unused */
  double level;    /* what may be taken now */
  int64_t seen_ms; /* when `level` was true */
  uint64_t turn;   /* of its last use among all uses: many come in one millisecond */
};

struct limiter {
  pthread_mutex_t mutex;
  double rate_hz, burst;
  uint64_t turns;
  struct bucket buckets[SETS][WAYS];
};

enum status limiter_create(double rate_hz, double burst, struct limiter **limiter,
                           struct error *error) {
  struct limiter *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the limits of rates.");
  }
  pthread_mutex_init(&made->mutex, NULL);
  made->rate_hz = rate_hz;
  made->burst = fmax(burst, 1);
  *limiter = made;
  return STATUS_OK;
}

void limiter_destroy(struct limiter *limiter) {
  if (limiter) {
    pthread_mutex_destroy(&limiter->mutex);
    free(limiter);
  }
}

static uint64_t party_hash(const char *party) {
  uint64_t hash = 14695981039346656037u; /* FNV-1a */
  for (; *party; party++) {
    hash = (hash ^ (unsigned char)*party) * 1099511628211u;
  }
  return hash ^ hash >> 32;
}

static struct bucket *bucket_find(struct limiter *limiter, const char *party, int64_t now) {
  struct bucket *set = limiter->buckets[party_hash(party) % SETS], *oldest = set;
  for (size_t i = 0; i < WAYS; i++) {
    if (strcmp(set[i].party, party) == 0) {
      return &set[i];
    }
    oldest = set[i].turn < oldest->turn ? &set[i] : oldest;
  }
  *oldest = (struct bucket){.level = limiter->burst, .seen_ms = now};
  strncpy(oldest->party, party, sizeof oldest->party - 1);
  return oldest;
}

bool limiter_take(struct limiter *limiter, const char *party, double *wait_s) {
  *wait_s = 0;
  if (limiter->rate_hz <= 0) {
    return true;
  }
  int64_t now = clock_monotonic_ms();
  pthread_mutex_lock(&limiter->mutex);
  struct bucket *bucket = bucket_find(limiter, party, now);
  double gained = limiter->rate_hz * (double)(now - bucket->seen_ms) / 1000;
  bucket->level = fmin(bucket->level + gained, limiter->burst);
  bucket->seen_ms = now;
  bucket->turn = ++limiter->turns;
  bool may = bucket->level >= 1;
  if (may) {
    bucket->level -= 1;
  } else {
    *wait_s = (1 - bucket->level) / limiter->rate_hz;
  }
  pthread_mutex_unlock(&limiter->mutex);
  return may;
}
