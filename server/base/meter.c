#include "server/base/meter.h"

void histogram_add(struct histogram *histogram, const struct meter_bounds *bounds, double value) {
  unsigned bucket = 0;
  while (bucket < bounds->count && value > bounds->upper[bucket]) {
    bucket++;
  }
  atomic_fetch_add_explicit(&histogram->buckets[bucket], 1, memory_order_relaxed);
  atomic_fetch_add_explicit(&histogram->sum_micro, value > 0 ? (uint64_t)(1e6 * value) : 0,
                            memory_order_relaxed);
}

void meter_head(FILE *out, const char *name, const char *type, const char *help) {
  fprintf(out, "# HELP %s %s\n# TYPE %s %s\n", name, help, name, type);
}

void meter_histogram(FILE *out, const char *name, const char *labels,
                     const struct histogram *histogram, const struct meter_bounds *bounds) {
  uint64_t count = 0;
  const char *comma = labels[0] ? "," : "";
  const char *open = labels[0] ? "{" : "", *close = labels[0] ? "}" : "";
  for (unsigned i = 0; i <= bounds->count; i++) {
    char bound[32] = "+Inf";
    if (i < bounds->count) {
      snprintf(bound, sizeof bound, "%g", bounds->upper[i]);
    }
    count += atomic_load_explicit(&histogram->buckets[i], memory_order_relaxed);
    fprintf(out, "%s_bucket{%s%sle=\"%s\"} %llu\n", name, labels, comma, bound,
            (unsigned long long)count);
  }
  fprintf(out, "%s_sum%s%s%s %.6f\n%s_count%s%s%s %llu\n", name, open, labels, close,
          1e-6 * (double)atomic_load_explicit(&histogram->sum_micro, memory_order_relaxed), name,
          open, labels, close, (unsigned long long)count);
}
