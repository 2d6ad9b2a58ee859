#include "solver/hlpv/simulate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/clock.h"
#include "solver/hlpv/accumulation.h"
#include "solver/hlpv/check.h"
#include "solver/hlpv/integrator.h"
#include "solver/hlpv/record.h"
#include "solver/hlpv/tracking.h"

/* Sizes of a state by which its loss to infinity is known. */
#define UNBOUNDED 1e6
/* Part of a state's size that decides nothing. */
#define GRAZING 1e-6
/* Part of the time within which a guard is passed at the time of a corner. */
#define AT_CORNER 1e-11

enum { STEPS_BETWEEN_LOOKS = 256 };

struct simulation {
  const struct hlpv_spec *spec;
  const struct hlpv_options *options;
  struct integrator *integrator;
  struct recorder recorder;
  double size[HLPV_STATES];
  int mode;
  struct hlpv_point now;
  struct set_point set_point;
  double reported_s;                 /* wall clock of the last progress line */
  bool grazed[HLPV_TRANSITIONS_MAX]; /* a near miss has been told of */
  bool checked[HLPV_MODES_MAX];      /* used since the last corner */
  struct controller *controller;     /* that makes the set-point, or NULL */
};

/* ---- one mode ----------------------------------------------------------------------------- */

static void set_point_of_time(struct simulation *s, double time, const double x[HLPV_STATES],
                              struct hlpv_point *point) {
  point->time = time;
  memmove(point->x, x, sizeof point->x);
  hlpv_derivative(s->spec, s->mode, set_point_at(&s->set_point, time), point->x, point->rate);
}

/* How far the quantity will go beyond a guard that it passes now, to second order. */
static double overshoot(const struct simulation *s, int quantity) {
  const double moment = 1e-6;
  double x[HLPV_STATES], rate[HLPV_STATES];
  for (int i = 0; i < HLPV_STATES; i++) {
    x[i] = s->now.x[i] + moment * s->now.rate[i];
  }
  hlpv_derivative(s->spec, s->mode, set_point_at(&s->set_point, s->now.time), x, rate);
  double bend = (rate[quantity] - s->now.rate[quantity]) / moment;
  double speed = s->now.rate[quantity];
  return bend * speed < 0.0 ? 0.5 * speed * speed / fabs(bend) : INFINITY;
}

static enum status restart(struct simulation *s, double stop, struct error *error) {
  if (!s->checked[s->mode]) {
    s->checked[s->mode] = true;
    check_coefficients(&s->recorder, s->mode, s->now.time, &s->set_point, stop);
  }
  set_point_of_time(s, s->now.time, s->now.x, &s->now);
  return integrator_restart(s->integrator, s->mode, &s->set_point, s->now.time, s->now.x, stop,
                            error);
}

/* ---- switches ----------------------------------------------------------------------------- */

static enum status make_switch(struct simulation *s, int index, struct error *error) {
  const struct hlpv_transition *transition = &s->spec->transition[index];
  struct hlpv_event event = {.time = s->now.time, .transition = index};
  event.grazing = overshoot(s, transition->quantity) < s->recorder.small[transition->quantity];
  memcpy(event.before, s->now.x, sizeof event.before);
  for (int i = 0; i < HLPV_STATES; i++) {
    event.after[i] = transition->reset[i].factor * s->now.x[i] + transition->reset[i].value;
  }
  if (event.grazing) {
    recorder_warn(
        &s->recorder,
        "grazing: at %.9g s the guard of transition %d is passed, but hardly: a change in "
        "the sixth digit of the model may undo the switch",
        event.time, index);
  }
  s->mode = transition->to;
  set_point_of_time(s, s->now.time, event.after, &s->now);
  enum status status = recorder_event(&s->recorder, &event, error);
  return status == STATUS_OK ? accumulation_check(s->recorder.out, error) : status;
}

/* Makes the switch of `index`, then those that its reset leads to at the same time. */
static enum status make_switches(struct simulation *s, int index, struct error *error) {
  while (index >= 0) {
    enum status status = make_switch(s, index, error);
    if (status != STATUS_OK) {
      return status;
    }
    double u = set_point_at(&s->set_point, s->now.time);
    index = -1;
    for (int i = 0; i < s->spec->transition_count && index < 0; i++) {
      const struct hlpv_transition *next = &s->spec->transition[i];
      if (next->from == s->mode && hlpv_is_crossed(s->spec, next, u, s->now.x)) {
        index = i;
      }
    }
  }
  return STATUS_OK;
}

/* The first guard that is passed, or -1; tells of those that are only just missed. */
static int passed_guard(struct simulation *s, const int root[HLPV_TRANSITIONS_MAX]) {
  for (int i = 0; i < s->spec->transition_count; i++) {
    if (root[i] & ROOT_GUARD) {
      return i;
    }
  }
  for (int i = 0; i < s->spec->transition_count; i++) {
    const struct hlpv_transition *transition = &s->spec->transition[i];
    double missed = fabs(s->now.x[transition->quantity] - transition->level);
    if ((root[i] & ROOT_EXTREMUM) && missed < s->recorder.small[transition->quantity] &&
        !s->grazed[i]) {
      s->grazed[i] = true;
      recorder_warn(&s->recorder,
                    "grazing: at %.9g s the state turns just before the guard of transition %d, "
                    "which it misses by %.2g of its level",
                    s->now.time, i, missed / fmax(fabs(transition->level), 1e-300));
    }
  }
  return -1;
}

/* The first guard that the state reaches at the corner where it is, or within round-off behind it;
 * or -1. */
static int guard_at_corner(const struct simulation *s) {
  for (int i = 0; i < s->spec->transition_count; i++) {
    const struct hlpv_transition *transition = &s->spec->transition[i];
    double missing = transition->direction * (transition->level - s->now.x[transition->quantity]);
    double speed = transition->direction * s->now.rate[transition->quantity];
    if (transition->from == s->mode && missing >= 0.0 && speed > 0.0 &&
        missing <= speed * AT_CORNER * s->now.time) {
      return i;
    }
  }
  return -1;
}

/* ---- along the time ----------------------------------------------------------------------- */

/* A speed may be far above its size, when a stiff mode rings, as long as the elongation stays. */
static bool is_bounded(const struct simulation *s) {
  return fabs(s->now.x[HLPV_H]) <= UNBOUNDED * s->size[HLPV_H] &&
         fabs(s->now.x[HLPV_PRESSURE]) <= UNBOUNDED * s->size[HLPV_PRESSURE] &&
         isfinite(s->now.x[HLPV_VELOCITY]);
}

static enum status look_around(struct simulation *s, struct error *error) {
  const struct hlpv_options *options = s->options;
  double wall = clock_wall_s();
  if (options->events && wall > s->reported_s + 0.5) {
    fprintf(options->events, "{\"event\":\"progress\",\"fraction\":%.4f,\"time_s\":%.6g}\n",
            s->now.time / s->spec->end, s->now.time);
    fflush(options->events);
    s->reported_s = wall;
  }
  if (options->cancelled && options->cancelled(NULL)) {
    return error_set(error, STATUS_CANCELLED, NULL, "cancelled at %.9g s of %.9g s", s->now.time,
                     s->spec->end);
  }
  if (options->deadline_s > 0.0 && wall > options->deadline_s) {
    return error_set(error, STATUS_TIMEOUT, NULL, "the time limit was reached at %.9g s of %.9g s",
                     s->now.time, s->spec->end);
  }
  return is_bounded(s) ? STATUS_OK
                       : error_set(error, STATUS_DIVERGED, NULL,
                                   "at %.9g s the state has grown to %.3g m: the mode \"%.40s\" is "
                                   "not stable",
                                   s->now.time, s->now.x[HLPV_H], s->spec->mode[s->mode].name);
}

/* The set-point at the next sample; at a corner the one after it. */
static double sample_set_point(const struct simulation *s) {
  return s->controller ? s->set_point.value
                       : hlpv_set_point(&s->spec->input, recorder_next(&s->recorder));
}

/* One step of the integrator with its samples. */
static enum status advance(struct simulation *s, int root[HLPV_TRANSITIONS_MAX],
                           struct error *error) {
  struct hlpv_point before = s->now;
  double time = s->now.time, x[HLPV_STATES];
  memcpy(x, s->now.x, sizeof x);
  enum status status = integrator_step(s->integrator, &time, x, root, error);
  if (status != STATUS_OK) {
    return status;
  }
  while (recorder_next(&s->recorder) <= time) {
    double between[HLPV_STATES];
    memcpy(between, x, sizeof between);
    integrator_interpolate(s->integrator, recorder_next(&s->recorder), between);
    recorder_sample(&s->recorder, s->mode, sample_set_point(s), between);
  }
  set_point_of_time(s, time, x, &s->now);
  recorder_span(&s->recorder, &before, &s->now);
  return STATUS_OK;
}

/* From now to `stop`, a corner of the set-point. */
static enum status run_piece(struct simulation *s, double stop, struct error *error) {
  enum status status = restart(s, stop, error);
  bool counted = false;
  for (long step = 0; status == STATUS_OK && s->now.time < stop; step++) {
    int root[HLPV_TRANSITIONS_MAX];
    status = advance(s, root, error);
    if (status == STATUS_OK && (step % STEPS_BETWEEN_LOOKS == 0 || !is_bounded(s))) {
      status = look_around(s, error);
    }
    int index = status == STATUS_OK ? passed_guard(s, root) : -1;
    if (status == STATUS_OK && index < 0 && s->now.time >= stop) {
      index = guard_at_corner(s);
    }
    if (index >= 0) {
      integrator_count(s->integrator, &s->recorder.out->counts);
      counted = true;
      /* The root is found to round-off: what the reset keeps of the quantity is its level. */
      s->now.x[s->spec->transition[index].quantity] = s->spec->transition[index].level;
      status = make_switches(s, index, error);
      if (status == STATUS_OK && s->now.time < stop) {
        status = restart(s, stop, error);
        counted = false;
      }
    }
  }
  if (!counted) {
    integrator_count(s->integrator, &s->recorder.out->counts);
  }
  return status;
}

/* The piece of the set-point that begins at the corner `index`; returns its end. */
static double open_piece(struct simulation *s, size_t index) {
  const struct hlpv_input *input = &s->spec->input;
  bool sine = input->profile == HLPV_SINE;
  bool last = sine || index + 1 >= input->count;
  double end = last ? s->spec->end : fmin(input->time[index + 1], s->spec->end);
  s->set_point = (struct set_point){.input = input, .start = s->now.time};
  if (!sine) {
    s->set_point.start = input->time[index];
    s->set_point.value = input->value[index];
  }
  if (input->profile == HLPV_LINEAR && !last) {
    s->set_point.slope = (input->value[index + 1] - input->value[index]) /
                         (input->time[index + 1] - input->time[index]);
  }
  memset(s->checked, 0, sizeof s->checked);
  return end;
}

static enum status run_all(struct simulation *s, struct error *error) {
  bool held = s->spec->input.profile == HLPV_HELD;
  enum status status = STATUS_OK;
  for (size_t i = 0; status == STATUS_OK && s->now.time < s->spec->end; i++) {
    double stop = open_piece(s, i);
    if (i == 0) {
      recorder_sample(&s->recorder, s->mode, s->set_point.value, s->now.x);
    }
    if (held) {
      recorder_hold_open(&s->recorder, s->now.time, s->set_point.value, s->mode, s->now.x);
    }
    status = run_piece(s, stop, error);
    recorder_hold_close(&s->recorder, s->now.time, s->mode, s->now.x);
    if (status == STATUS_OK) {
      s->now.time = stop;
      status = look_around(s, error);
    }
  }
  return status;
}

/* ---- position control ---------------------------------------------------------------------- */

/* Warns of what the step that has just ended shows. */
static void judge_step(struct simulation *s, size_t index) {
  const struct tracking_step *step = &s->recorder.tracking->step[index];
  if (!step->reached) {
    recorder_warn(&s->recorder,
                  "no state of rest has the elongation %.6g mm, wanted from %.6g s: it lies in a "
                  "gap between modes, beyond the saturation or too near to a guard; the nearest, "
                  "%.6g mm, is aimed at",
                  1e3 * step->reference, step->start, 1e3 * step->aim);
  }
  if (tracking_cycles(step)) {
    recorder_warn(&s->recorder,
                  "limit cycle: the elongation %.6g mm, wanted from %.6g s, is not held; the mode "
                  "changes %d times until %.6g s, last at %.6g s",
                  1e3 * step->reference, step->start, step->switches, s->now.time,
                  step->last_switch);
  }
}

/* One sample of the controller and the time until the next, `stop`. */
static enum status run_sample(struct simulation *s, double stop, struct error *error) {
  struct tracking *tracking = s->recorder.tracking;
  const double measured[DESIGN_OUTPUTS] = {s->now.x[HLPV_H], s->now.x[HLPV_PRESSURE]};
  struct control_action action;
  size_t steps = tracking->count;
  controller_sample(s->controller, s->now.time, measured, &action);
  s->set_point =
      (struct set_point){.input = &s->spec->input, .start = s->now.time, .value = action.set_point};
  memset(s->checked, 0, sizeof s->checked);
  tracking_sample(tracking, s->now.time, stop - s->now.time, s->now.x[HLPV_H], s->spec->end,
                  &action);
  if (tracking->count > steps && steps > 0) {
    judge_step(s, steps - 1);
  }
  return run_piece(s, stop, error);
}

static enum status run_controlled(struct simulation *s, struct error *error) {
  double interval = s->spec->control->interval;
  struct tracking *tracking = s->recorder.tracking;
  enum status status = STATUS_OK;
  recorder_sample(&s->recorder, s->mode, s->set_point.value, s->now.x);
  for (size_t k = 1; status == STATUS_OK && s->now.time < s->spec->end; k++) {
    double stop = fmin((double)k * interval, s->spec->end);
    status = run_sample(s, stop, error);
    if (status == STATUS_OK) {
      s->now.time = stop;
      status = look_around(s, error);
    }
  }
  if (tracking->count > 0) {
    judge_step(s, tracking->count - 1);
  }
  return status;
}

/* Opens what a position control needs; the trajectory owns it but for the controller. */
static enum status open_control(struct simulation *s, struct error *error) {
  struct hlpv_trajectory *out = s->recorder.out;
  enum status status = controller_create(s->spec, &s->controller, error);
  out->tracking = calloc(1, sizeof *out->tracking);
  out->design = calloc(1, sizeof *out->design);
  if (status == STATUS_OK && (!out->tracking || !out->design)) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the control");
  }
  if (status == STATUS_OK) {
    *out->design = *controller_design(s->controller);
    status = tracking_open(out->tracking, s->spec->control, error);
    s->recorder.tracking = out->tracking;
  }
  return status;
}

enum status hlpv_simulate(const struct hlpv_spec *spec, const struct hlpv_options *options,
                          struct hlpv_trajectory *trajectory, struct error *error) {
  struct simulation s = {.spec = spec, .options = options, .mode = spec->initial_mode};
  *trajectory = (struct hlpv_trajectory){0};
  s.recorder =
      (struct recorder){.spec = spec, .out = trajectory, .no_samples = options->no_samples};
  memcpy(s.now.x, spec->initial, sizeof s.now.x);
  check_sizes(spec, s.size);
  for (int i = 0; i < HLPV_STATES; i++) {
    s.recorder.small[i] = GRAZING * s.size[i];
  }
  enum status status = recorder_open(&s.recorder, error);
  if (status == STATUS_OK) {
    status = integrator_create(spec, s.size, &s.integrator, error);
  }
  if (status == STATUS_OK && spec->control) {
    status = open_control(&s, error);
  }
  if (status == STATUS_OK) {
    check_model(&s.recorder);
    status = spec->control ? run_controlled(&s, error) : run_all(&s, error);
  }
  trajectory->time = s.now.time;
  trajectory->mode = s.mode;
  memcpy(trajectory->x, s.now.x, sizeof trajectory->x);
  integrator_destroy(s.integrator);
  controller_destroy(s.controller);
  return status;
}
