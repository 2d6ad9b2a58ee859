/* How fast a solve gets on, from the fractions it reports. */
#ifndef PNEULAB_EXEC_PACE_H
#define PNEULAB_EXEC_PACE_H

#include <stddef.h>
#include <stdint.h>

enum { PACE_POINTS = 32 };

/* The course so far: moments on the monotonic clock and the fraction reached, oldest first. The
 * first is the start with fraction 0. When it is full every second point is dropped. */
struct pace {
  size_t count;
  struct pace_point {
    int64_t at_ms;
    double fraction;
  } points[PACE_POINTS];
};

void pace_start(struct pace *pace, int64_t now_ms);
void pace_take(struct pace *pace, int64_t now_ms, double fraction);

/* The point from which the rate is to be measured at now_ms: the last one before the middle of the
 * time that has passed. What was slow at the beginning is forgotten, steps that become slower and
 * slower count for what they are, and no single step decides. If nothing was gained since: the
 * start. */
struct pace_point pace_reference(const struct pace *pace, int64_t now_ms);

#endif
