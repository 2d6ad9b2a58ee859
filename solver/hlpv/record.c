#include "solver/hlpv/record.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/text.h"
#include "solver/hlpv/linear.h"
#include "solver/hlpv/tracking.h"

/* Part of a step's change within which h has settled. */
#define SETTLED 0.02

enum { EVENTS_FIRST = 16, HALVINGS = 50 };

void hlpv_trajectory_release(struct hlpv_trajectory *trajectory) {
  free(trajectory->sample);
  free(trajectory->event);
  free(trajectory->hold);
  if (trajectory->tracking) {
    tracking_release(trajectory->tracking);
  }
  free(trajectory->tracking);
  free(trajectory->design);
  *trajectory = (struct hlpv_trajectory){0};
}

enum status recorder_open(struct recorder *recorder, struct error *error) {
  const struct hlpv_spec *spec = recorder->spec;
  struct hlpv_trajectory *out = recorder->out;
  bool held = spec->input.profile == HLPV_HELD && !spec->control;
  /* One more than the product, which may fall below a whole number by round-off. */
  recorder->sample_room = recorder->no_samples ? 0 : (size_t)(spec->end * spec->sample_rate) + 2;
  recorder->event_room = EVENTS_FIRST;
  out->sample = calloc(recorder->sample_room + 1, sizeof *out->sample);
  out->event = calloc(recorder->event_room, sizeof *out->event);
  out->hold = calloc(held ? spec->input.count : 1, sizeof *out->hold);
  if (!out->sample || !out->event || !out->hold) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the samples");
  }
  for (int i = 0; i < HLPV_STATES; i++) {
    out->lowest[i] = out->highest[i] = spec->initial[i];
  }
  out->peak_speed = fabs(spec->initial[HLPV_VELOCITY]);
  return STATUS_OK;
}

void recorder_warn(struct recorder *recorder, const char *format, ...) {
  struct hlpv_trajectory *out = recorder->out;
  if (out->warning_count == HLPV_WARNINGS_MAX) {
    return;
  }
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(out->warning[out->warning_count], HLPV_WARNING_TEXT, format, arguments);
  va_end(arguments);
  text_repair(out->warning[out->warning_count++]); /* a name may be cut within a character */
}

/* ---- samples and extremes ----------------------------------------------------------------- */

double recorder_next(const struct recorder *recorder) {
  double time = (double)recorder->out->sample_count / recorder->spec->sample_rate;
  /* The last sample belongs to the end even where the division leaves it a digit beyond. */
  double end = recorder->spec->end;
  bool last = recorder->out->sample_count < recorder->sample_room && time <= end * (1.0 + 1e-12);
  return last ? fmin(time, end) : INFINITY;
}

void recorder_sample(struct recorder *recorder, int mode, double set_point,
                     const double x[HLPV_STATES]) {
  if (recorder->out->sample_count == recorder->sample_room) {
    return;
  }
  struct hlpv_sample sample = {.time = recorder_next(recorder), .mode = mode};
  sample.set_point = set_point;
  memcpy(sample.x, x, sizeof sample.x);
  recorder->out->sample[recorder->out->sample_count++] = sample;
}

static void widen(struct hlpv_trajectory *out, int i, double value) {
  out->lowest[i] = fmin(out->lowest[i], value);
  out->highest[i] = fmax(out->highest[i], value);
}

double recorder_between(const struct hlpv_point *a, const struct hlpv_point *b, int i, double s) {
  double step = b->time - a->time, r = 1.0 - s;
  return r * r * (1.0 + 2.0 * s) * a->x[i] + s * s * (1.0 + 2.0 * r) * b->x[i] +
         s * r * step * (r * a->rate[i] - s * b->rate[i]);
}

/* Where the cubic's derivative vanishes between ends of opposite slope: the secant of the slopes,
 * whose error in the value is of higher order since the value is stationary there. */
static double extreme_value(const struct hlpv_point *a, const struct hlpv_point *b, int i) {
  return recorder_between(a, b, i, a->rate[i] / (a->rate[i] - b->rate[i]));
}

static void take_speed(struct recorder *recorder, double velocity) {
  struct hlpv_trajectory *out = recorder->out;
  out->peak_speed = fmax(out->peak_speed, fabs(velocity));
  if (recorder->holding) {
    struct hlpv_hold *hold = &out->hold[out->hold_count - 1];
    hold->peak_speed = fmax(hold->peak_speed, fabs(velocity));
  }
}

/* ---- settling ----------------------------------------------------------------------------- */

static void find_steady(const struct recorder *recorder, int mode, struct hlpv_hold *hold) {
  const struct hlpv_spec *spec = recorder->spec;
  double u = hold->set_point, x[HLPV_STATES] = {0};
  hold->steady_h = hold->steady_pressure = NAN;
  if (!(hlpv_polynomial_value(&spec->mode[mode].damping, u) > 0.0) ||
      !linear_rest(spec, mode, u, x)) {
    return;
  }
  for (int i = 0; i < spec->transition_count; i++) {
    const struct hlpv_transition *t = &spec->transition[i];
    if (t->from == mode && t->direction * (x[t->quantity] - t->level) > 0.0) {
      return;
    }
  }
  hold->steady_h = x[HLPV_H];
  hold->steady_pressure = x[HLPV_PRESSURE];
}

static double settled_band(const struct recorder *recorder, const struct hlpv_hold *hold) {
  return fmax(SETTLED * fabs(hold->steady_h - hold->first[HLPV_H]), recorder->small[HLPV_H]);
}

static void follow_settling(struct recorder *recorder, const struct hlpv_point *a,
                            const struct hlpv_point *b) {
  const struct hlpv_hold *hold = &recorder->out->hold[recorder->out->hold_count - 1];
  double steady = hold->steady_h, band = settled_band(recorder, hold);
  if (!(fabs(b->x[HLPV_H] - steady) <= band)) {
    recorder->outside = b->time;
  } else if (!(fabs(a->x[HLPV_H] - steady) <= band)) {
    double out = 0.0, in = 1.0;
    for (int n = 0; n < HALVINGS; n++) {
      double middle = 0.5 * (out + in);
      bool inside = fabs(recorder_between(a, b, HLPV_H, middle) - steady) <= band;
      *(inside ? &in : &out) = middle;
    }
    recorder->outside = a->time + in * (b->time - a->time);
  }
}

void recorder_hold_open(struct recorder *recorder, double time, double set_point, int mode,
                        const double x[HLPV_STATES]) {
  struct hlpv_trajectory *out = recorder->out;
  struct hlpv_hold *hold = &out->hold[out->hold_count++];
  *hold = (struct hlpv_hold){.start = time, .set_point = set_point, .mode = mode};
  hold->peak_speed = fabs(x[HLPV_VELOCITY]);
  memcpy(hold->first, x, sizeof hold->first);
  find_steady(recorder, mode, hold);
  recorder->holding = true;
  recorder->outside = time;
}

void recorder_hold_close(struct recorder *recorder, double time, int mode,
                         const double x[HLPV_STATES]) {
  if (!recorder->holding) {
    return;
  }
  struct hlpv_hold *hold = &recorder->out->hold[recorder->out->hold_count - 1];
  hold->end = time;
  hold->mode = mode;
  memcpy(hold->last, x, sizeof hold->last);
  bool inside = fabs(x[HLPV_H] - hold->steady_h) <= settled_band(recorder, hold);
  hold->settling = inside ? recorder->outside - hold->start : NAN;
  recorder->holding = false;
}

/* ---- spans and switches ------------------------------------------------------------------- */

void recorder_span(struct recorder *recorder, const struct hlpv_point *a,
                   const struct hlpv_point *b) {
  for (int i = 0; i < HLPV_STATES; i++) {
    widen(recorder->out, i, b->x[i]);
    if (a->rate[i] * b->rate[i] < 0.0) {
      widen(recorder->out, i, extreme_value(a, b, i));
    }
  }
  take_speed(recorder, b->x[HLPV_VELOCITY]);
  if (a->rate[HLPV_VELOCITY] * b->rate[HLPV_VELOCITY] < 0.0) {
    take_speed(recorder, extreme_value(a, b, HLPV_VELOCITY));
  }
  if (recorder->holding) {
    follow_settling(recorder, a, b);
  }
  if (recorder->tracking) {
    tracking_span(recorder->tracking, a, b);
  }
}

enum status recorder_event(struct recorder *recorder, const struct hlpv_event *event,
                           struct error *error) {
  struct hlpv_trajectory *out = recorder->out;
  if (out->event_count == recorder->event_room) {
    size_t room = 2 * recorder->event_room;
    struct hlpv_event *more = realloc(out->event, room * sizeof *more);
    if (!more) {
      return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %zu switches", room);
    }
    out->event = more;
    recorder->event_room = room;
  }
  out->event[out->event_count++] = *event;
  for (int i = 0; i < HLPV_STATES; i++) {
    widen(out, i, event->after[i]);
  }
  take_speed(recorder, event->after[HLPV_VELOCITY]);
  if (recorder->holding) {
    struct hlpv_hold *hold = &out->hold[out->hold_count - 1];
    hold->switches++;
    find_steady(recorder, recorder->spec->transition[event->transition].to, hold);
    recorder->outside = event->time;
  }
  if (recorder->tracking) {
    tracking_switch(recorder->tracking, event, recorder->spec->transition[event->transition].to);
  }
  return STATUS_OK;
}
