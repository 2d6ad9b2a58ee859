#include "solver/hlpv/tracking.h"

#include <math.h>
#include <stdlib.h>

/* Part of a change within which it has settled, and part of a step over which its last error is
 * averaged. */
#define SETTLED 0.02
#define LAST_PART 0.1
/* Distance to its aim, m, within which a step begins where it is to end. */
#define THERE 1e-6

enum { HALVINGS = 40, CYCLE_SWITCHES = 4 };

enum status tracking_open(struct tracking *tracking, const struct hlpv_control *control,
                          struct error *error) {
  bool held = control->reference.profile == HLPV_HELD;
  *tracking = (struct tracking){.control = control};
  tracking->room = held ? control->reference.count : 0;
  tracking->step = calloc(tracking->room + 1, sizeof *tracking->step);
  return tracking->step ? STATUS_OK
                        : error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the steps");
}

void tracking_release(struct tracking *tracking) {
  free(tracking->step);
  *tracking = (struct tracking){0};
}

static struct tracking_step *present(struct tracking *tracking) {
  return tracking->count > 0 ? &tracking->step[tracking->count - 1] : NULL;
}

/* Opens the step of the reference that has begun last by `time`. */
static void open_step(struct tracking *tracking, size_t index, double h, double end,
                      const struct control_action *action) {
  const struct hlpv_input *reference = &tracking->control->reference;
  struct tracking_step *step = &tracking->step[tracking->count++];
  bool again = index > 0 && reference->value[index] == reference->value[index - 1];
  *step = (struct tracking_step){.start = reference->time[index],
                                 .end = end,
                                 .reference = reference->value[index],
                                 .aim = action->target.h,
                                 .reached = action->target.reached,
                                 .changes = !again && !(fabs(action->target.h - h) <= THERE),
                                 .mode = action->target.mode,
                                 .first = h,
                                 .last = h,
                                 .time10 = NAN,
                                 .time90 = NAN};
  if (index + 1 < reference->count) {
    step->end = fmin(end, reference->time[index + 1]);
  }
  step->outside = step->start;
}

void tracking_sample(struct tracking *tracking, double time, double span, double h, double end,
                     const struct control_action *action) {
  const struct hlpv_input *reference = &tracking->control->reference;
  struct tracking_step *step = present(tracking);
  size_t before = tracking->begun;
  while (tracking->begun < tracking->room && reference->time[tracking->begun] <= time) {
    tracking->begun++;
  }
  if (tracking->begun > before) {
    open_step(tracking, tracking->begun - 1, h, end, action);
    step = present(tracking);
  }
  if (action->saturated) {
    tracking->saturated += span;
    if (step) {
      step->saturated += span;
    }
  }
}

/* First time at which the part of the change is there, on the way from a to b. */
static double passage(const struct tracking_step *step, const struct hlpv_point *a,
                      const struct hlpv_point *b, double part) {
  double before = 0.0, after = 1.0, change = step->aim - step->first;
  for (int n = 0; n < HALVINGS; n++) {
    double middle = 0.5 * (before + after);
    bool there = (recorder_between(a, b, HLPV_H, middle) - step->first) / change >= part;
    *(there ? &after : &before) = middle;
  }
  return a->time + after * (b->time - a->time);
}

/* Takes in h at `time`, where it is or has come to. */
static void take_value(struct tracking_step *step, double time, double h) {
  double change = step->aim - step->first;
  if (!step->changes) {
    return;
  }
  step->beyond = fmax(step->beyond, (h - step->aim) / change);
  if (!(fabs(h - step->aim) <= SETTLED * fabs(change))) {
    step->outside = time;
  }
}

/* The last tenth of the step by Simpson's rule. */
static void take_area(struct tracking_step *step, const struct hlpv_point *a,
                      const struct hlpv_point *b) {
  double from = fmax(a->time, step->end - LAST_PART * (step->end - step->start));
  if (!(b->time > from)) {
    return;
  }
  double first = (from - a->time) / (b->time - a->time), missing = 0;
  for (int i = 0; i < 3; i++) {
    double h = recorder_between(a, b, HLPV_H, first + 0.5 * i * (1.0 - first));
    missing += (i == 1 ? 4.0 : 1.0) / 6.0 * (step->reference - h);
  }
  step->area += missing * (b->time - from);
  step->span += b->time - from;
}

static void take_error(struct tracking *tracking, const struct hlpv_point *a,
                       const struct hlpv_point *b) {
  double sum = 0;
  for (int i = 0; i < 3; i++) {
    double time = a->time + 0.5 * i * (b->time - a->time);
    double error = hlpv_set_point(&tracking->control->reference, time) -
                   recorder_between(a, b, HLPV_H, 0.5 * i);
    sum += (i == 1 ? 4.0 : 1.0) / 6.0 * error * error;
    tracking->most = fmax(tracking->most, fabs(error));
  }
  tracking->squares += sum * (b->time - a->time);
}

/* The way into the band about the aim is between a, outside, and b, inside. */
static double entry(const struct tracking_step *step, const struct hlpv_point *a,
                    const struct hlpv_point *b) {
  double out = 0.0, in = 1.0, band = SETTLED * fabs(step->aim - step->first);
  for (int n = 0; n < HALVINGS; n++) {
    double middle = 0.5 * (out + in);
    bool inside = fabs(recorder_between(a, b, HLPV_H, middle) - step->aim) <= band;
    *(inside ? &in : &out) = middle;
  }
  return a->time + in * (b->time - a->time);
}

/* Takes in the way of the change between two states. */
static void take_change(struct tracking_step *step, const struct hlpv_point *a,
                        const struct hlpv_point *b) {
  double change = step->aim - step->first, outside = step->outside;
  double part = (b->x[HLPV_H] - step->first) / change;
  if (isnan(step->time10) && part >= 0.1) {
    step->time10 = passage(step, a, b, 0.1);
  }
  if (isnan(step->time90) && part >= 0.9) {
    step->time90 = passage(step, a, b, 0.9);
  }
  if (a->rate[HLPV_H] * b->rate[HLPV_H] < 0.0) {
    double turn = a->rate[HLPV_H] / (a->rate[HLPV_H] - b->rate[HLPV_H]);
    take_value(step, a->time + turn * (b->time - a->time), recorder_between(a, b, HLPV_H, turn));
  }
  take_value(step, b->time, b->x[HLPV_H]);
  bool was_out = fabs(a->x[HLPV_H] - step->aim) > SETTLED * fabs(change);
  if (was_out && step->outside == outside) {
    step->outside = entry(step, a, b);
  }
}

void tracking_span(struct tracking *tracking, const struct hlpv_point *a,
                   const struct hlpv_point *b) {
  struct tracking_step *step = present(tracking);
  if (!(b->time > a->time)) {
    return;
  }
  take_error(tracking, a, b);
  if (!step) {
    return;
  }
  if (step->changes) {
    take_change(step, a, b);
  }
  take_area(step, a, b);
  step->last = b->x[HLPV_H];
}

void tracking_switch(struct tracking *tracking, const struct hlpv_event *event, int mode) {
  struct tracking_step *step = present(tracking);
  if (!step) {
    return;
  }
  double part =
      step->changes ? (event->after[HLPV_H] - step->first) / (step->aim - step->first) : NAN;
  step->switches++;
  step->mode = mode;
  step->last_switch = event->time;
  step->last = event->after[HLPV_H];
  step->time10 = isnan(step->time10) && part >= 0.1 ? event->time : step->time10;
  step->time90 = isnan(step->time90) && part >= 0.9 ? event->time : step->time90;
  take_value(step, event->time, event->after[HLPV_H]);
}

double tracking_rise(const struct tracking_step *step) {
  return step->time90 - step->time10;
}

double tracking_settling(const struct tracking_step *step) {
  bool inside = fabs(step->last - step->aim) <= SETTLED * fabs(step->aim - step->first);
  return inside && step->changes ? step->outside - step->start : NAN;
}

double tracking_steady_error(const struct tracking_step *step) {
  return step->span > 0.0 ? step->area / step->span : NAN;
}

bool tracking_cycles(const struct tracking_step *step) {
  return step->switches >= CYCLE_SWITCHES &&
         step->last_switch > step->end - 0.25 * (step->end - step->start);
}
