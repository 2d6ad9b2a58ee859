#include "solver/bistable/trajectory.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "solver/base/text.h"

/* Part of its peak that the speed has fallen to when a travel is over. */
#define SLOW 0.01

void bistable_trajectory_release(struct bistable_trajectory *t) {
  free(t->sample);
  free(t->event);
  free(t->moment);
  *t = (struct bistable_trajectory){0};
}

void bistable_warn(struct bistable_trajectory *t, const char *format, ...) {
  if (t->warning_count < BISTABLE_WARNINGS_MAX) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(t->warning[t->warning_count], BISTABLE_WARNING_TEXT, format, arguments);
    va_end(arguments);
    text_repair(t->warning[t->warning_count++]); /* a name may be cut within a character */
  }
}

/* ---- travels ------------------------------------------------------------------------------ */

/* The first moment at or after a time. */
static size_t moment_at(const struct bistable_trajectory *t, double time) {
  size_t low = 0, high = t->moment_count;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (t->moment[middle].time < time) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

/* When the plate, going in the direction, passes h between two moments: by the cubic with their
 * speeds. */
static double passage(const struct bistable_moment *a, const struct bistable_moment *b, double h,
                      double direction) {
  double step = b->time - a->time, low = 0.0, high = 1.0;
  for (int n = 0; n < 60; n++) {
    double s = 0.5 * (low + high), r = 1.0 - s;
    double at = r * r * (1.0 + 2.0 * s) * a->h + s * s * (3.0 - 2.0 * s) * b->h +
                step * s * r * (r * a->velocity - s * b->velocity);
    if (direction * (at - h) < 0.0) {
      low = s;
    } else {
      high = s;
    }
  }
  return a->time + 0.5 * (low + high) * step;
}

/* The moment at which the plate has come to rest or turned, from the moment `from` on. */
static size_t travel_end(const struct bistable_trajectory *t, size_t from, size_t passed,
                         double direction, size_t *fastest) {
  size_t i = from;
  double peak = 0.0;
  *fastest = from;
  for (; i + 1 < t->moment_count; i++) {
    double speed = direction * t->moment[i].velocity;
    if (speed > peak) {
      peak = speed;
      *fastest = i;
    }
    if (i > passed && peak > 0.0 && speed <= SLOW * peak) {
      break;
    }
  }
  return i;
}

static void measure(const struct bistable_trajectory *t, int actuator,
                    struct bistable_event *event) {
  double direction = event->type == EVENT_SNAP ? 1.0 : -1.0;
  size_t from = moment_at(t, event->trigger_time), passed = moment_at(t, event->time), fastest;
  size_t end = travel_end(t, from, passed, direction, &fastest);
  event->peak_speed = event->travel = event->travel_time = event->peak_time = NAN;
  event->travel_end = NAN;
  event->least_pressure = event->greatest_pressure = event->trigger_pressure;
  if (from >= end) {
    return;
  }
  double first = event->trigger_h, travel = t->moment[end].h - first, time[2] = {NAN, NAN};
  for (size_t i = from; i <= end; i++) {
    event->least_pressure = fmin(event->least_pressure, t->moment[i].pressure[actuator]);
    event->greatest_pressure = fmax(event->greatest_pressure, t->moment[i].pressure[actuator]);
    for (int k = 0; k < 2 && i > 0; k++) {
      double h = first + (k == 0 ? 0.1 : 0.9) * travel;
      if (isnan(time[k]) && direction * (t->moment[i].h - h) >= 0.0) {
        time[k] = passage(&t->moment[i - 1], &t->moment[i], h, direction);
      }
    }
  }
  if (direction * travel > 0.0) {
    event->peak_speed = fabs(t->moment[fastest].velocity);
    event->peak_time = t->moment[fastest].time;
    event->travel = travel;
    event->travel_end = t->moment[end].time;
    event->travel_time = time[1] - time[0];
  }
}

void bistable_measure(struct bistable_trajectory *t, const struct bistable_system *system) {
  for (size_t i = 0; i < t->event_count; i++) {
    struct bistable_event *event = &t->event[i];
    if (event->type == EVENT_SNAP || event->type == EVENT_RETURN) {
      measure(t, system->cell[event->cell].actuator, event);
    }
  }
}
