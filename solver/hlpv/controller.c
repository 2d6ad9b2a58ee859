#include "solver/hlpv/controller.h"

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/hlpv/linear.h"

struct controller {
  const struct hlpv_control *control;
  struct design *design;
  struct target_map map;
  gsl_rng *noise;
  bool started;
  int mode;                 /* that it takes the plant to be in */
  double x[HLPV_STATES];    /* that it takes the state for */
  double plan[HLPV_STATES]; /* the state if everything goes as its model says */
  double integral;          /* of the elongation that is missing to the plan, m s */
  double set_point;         /* given last */
};

/* Plans anew from the present state. */
static void start_plan(struct controller *c) {
  memcpy(c->plan, c->x, sizeof c->plan);
  c->integral = 0.0;
}

enum status controller_create(const struct hlpv_spec *spec, struct controller **controller,
                              struct error *error) {
  const struct hlpv_control *control = spec->control;
  struct controller *c = calloc(1, sizeof *c);
  *controller = c;
  if (!c) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the controller");
  }
  c->control = control;
  c->noise = gsl_rng_alloc(gsl_rng_mt19937);
  if (!c->noise) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the controller");
  }
  gsl_rng_set(c->noise, control->seed);
  enum status status = design_create(spec, &c->design, error);
  if (status != STATUS_OK) {
    return status;
  }
  target_map_fill(&c->map, &c->design->model, control->lowest, control->highest,
                  control->guard_margin);
  c->mode = spec->initial_mode;
  memcpy(c->x, spec->initial, sizeof c->x);
  start_plan(c);
  return STATUS_OK;
}

void controller_destroy(struct controller *c) {
  if (!c) {
    return;
  }
  if (c->noise) {
    gsl_rng_free(c->noise);
  }
  free(c->design);
  free(c);
}

const struct design *controller_design(const struct controller *c) {
  return c->design;
}

/* Takes over the mode that a passed guard leads to; the state as far as it is not measured follows
 * the reset. A reset may lie beyond the next guard, but not for ever. */
static bool change_mode(struct controller *c, const double seen[HLPV_STATES]) {
  const struct hlpv_spec *model = &c->design->model;
  for (int i = 0; i < model->transition_count; i++) {
    const struct hlpv_transition *t = &model->transition[i];
    if (t->from == c->mode && t->direction * (seen[t->quantity] - t->level) > 0.0) {
      const struct hlpv_reset *reset = &t->reset[HLPV_VELOCITY];
      c->mode = t->to;
      c->x[HLPV_H] = seen[HLPV_H];
      c->x[HLPV_VELOCITY] = reset->factor * c->x[HLPV_VELOCITY] + reset->value;
      c->x[HLPV_PRESSURE] = seen[HLPV_PRESSURE];
      start_plan(c);
      return true;
    }
  }
  return false;
}

/* Brings mode and state up to the sample. */
static void observe(struct controller *c, const double y[DESIGN_OUTPUTS]) {
  if (c->started) {
    double step[HLPV_STATES][HLPV_STATES + 1];
    linear_step(&c->design->model, c->mode, c->set_point, c->control->interval, step);
    linear_apply(step, c->x, c->x);
  }
  const double seen[HLPV_STATES] = {y[0], c->x[HLPV_VELOCITY], y[1]};
  if (change_mode(c, seen)) {
    return;
  }
  struct design_region gains;
  design_at(c->design, c->mode, c->set_point, &gains);
  double missing[DESIGN_OUTPUTS] = {y[0] - c->x[HLPV_H], y[1] - c->x[HLPV_PRESSURE]};
  for (int i = 0; i < HLPV_STATES; i++) {
    c->x[i] += gains.observer[i][0] * missing[0] + gains.observer[i][1] * missing[1];
  }
}

/* The set-point that takes x to the state of rest, without its limits. */
static double feedback(const struct design_region *gains, const double rest[HLPV_STATES],
                       const double x[HLPV_STATES], double set_point) {
  for (int i = 0; i < HLPV_STATES; i++) {
    set_point -= gains->gain[i] * (x[i] - rest[i]);
  }
  return set_point;
}

static double limit(const struct controller *c, double set_point) {
  return fmin(fmax(set_point, c->control->lowest), c->control->highest);
}

/* Brings the plan to the next sample. */
static void go_on(struct controller *c, double set_point) {
  double step[HLPV_STATES][HLPV_STATES + 1];
  linear_step(&c->design->model, c->mode, limit(c, set_point), c->control->interval, step);
  linear_apply(step, c->plan, c->plan);
}

/* The set-point that takes the plant to the target, the plan and the integral until the next
 * sample. */
static void regulate(struct controller *c, double h, struct control_action *action) {
  const struct target *target = &action->target;
  double rest[HLPV_STATES] = {0};
  struct design_region gains;
  linear_rest(&c->design->model, c->mode, target->set_point, rest);
  design_at(c->design, c->mode, target->set_point, &gains);
  double u =
      feedback(&gains, rest, c->x, target->set_point) - gains.gain[HLPV_STATES] * c->integral;
  action->set_point = limit(c, u);
  action->saturated = u != action->set_point;
  /* The gain of the integral is negative: a missing elongation raises the set-point. */
  double missing = c->plan[HLPV_H] - h;
  bool further = gains.gain[HLPV_STATES] * missing * (u - action->set_point) < 0.0;
  if (!c->control->anti_windup || !further) {
    c->integral += c->control->interval * missing;
  }
  go_on(c, feedback(&gains, rest, c->plan, target->set_point));
}

void controller_sample(struct controller *c, double time, const double measured[DESIGN_OUTPUTS],
                       struct control_action *action) {
  const struct hlpv_control *control = c->control;
  double y[DESIGN_OUTPUTS] = {measured[0] + gsl_ran_gaussian(c->noise, 1.0) * control->noise_h,
                              measured[1] +
                                  gsl_ran_gaussian(c->noise, 1.0) * control->noise_pressure};
  *action = (struct control_action){.set_point = c->set_point};
  observe(c, y);
  bool found =
      target_find(&c->map, c->mode, hlpv_set_point(&control->reference, time), &action->target);
  if (!found || action->target.through >= 0) {
    start_plan(c);
  }
  if (found && action->target.through < 0) {
    regulate(c, y[0], action);
  } else if (found) {
    const struct hlpv_transition *t = &c->design->model.transition[action->target.through];
    action->set_point = t->direction > 0 ? control->highest : control->lowest;
    action->saturated = true;
  } else {
    action->set_point = limit(c, 0.0);
    action->target.h = NAN;
  }
  c->set_point = action->set_point;
  c->started = true;
}
