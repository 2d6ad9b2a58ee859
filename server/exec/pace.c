#include "server/exec/pace.h"

void pace_start(struct pace *pace, int64_t now_ms) {
  pace->count = 1;
  pace->points[0] = (struct pace_point){now_ms, 0};
}

void pace_take(struct pace *pace, int64_t now_ms, double fraction) {
  if (pace->count == PACE_POINTS) {
    for (size_t i = 1; 2 * i < PACE_POINTS; i++) {
      pace->points[i] = pace->points[2 * i];
    }
    pace->count = PACE_POINTS / 2;
  }
  pace->points[pace->count++] = (struct pace_point){now_ms, fraction};
}

struct pace_point pace_reference(const struct pace *pace, int64_t now_ms) {
  const struct pace_point *start = pace->points, *last = &pace->points[pace->count - 1];
  int64_t middle_ms = start->at_ms + (now_ms - start->at_ms) / 2;
  const struct pace_point *found = start;
  for (const struct pace_point *at = start; at < last && at->at_ms <= middle_ms; at++) {
    found = at;
  }
  return found->fraction < last->fraction ? *found : *start;
}
