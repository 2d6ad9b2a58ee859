/* Counters and histograms for /metrics, cheap enough for every request: relaxed atomic additions,
 * no locks. */
#ifndef PNEULAB_SERVER_METER_H
#define PNEULAB_SERVER_METER_H

#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>

enum { METER_BUCKETS_MAX = 16 };

/* Upper bounds of a histogram's buckets, ascending; the one without bound is added. */
struct meter_bounds {
  unsigned count; /* at most METER_BUCKETS_MAX */
  double upper[METER_BUCKETS_MAX];
};

/* Zero is a valid start. */
struct histogram {
  atomic_uint_fast64_t buckets[METER_BUCKETS_MAX + 1];
  atomic_uint_fast64_t sum_micro; /* in millionths of the unit */
};

/* From any thread. Negative values count as 0. */
void histogram_add(struct histogram *histogram, const struct meter_bounds *bounds, double value);

/* Writes "# HELP" and "# TYPE"; type: counter, gauge or histogram. */
void meter_head(FILE *out, const char *name, const char *type, const char *help);

/* Writes buckets, sum and count of a histogram. labels: "" or `kind="snap"`. */
void meter_histogram(FILE *out, const char *name, const char *labels,
                     const struct histogram *histogram, const struct meter_bounds *bounds);

#endif
