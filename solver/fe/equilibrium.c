#include "solver/fe/equilibrium_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "solver/fe/obstacle_internal.h"

enum {
  STALL_ITERATIONS = 5, /* give up after so many without a smaller correction */
  BACKTRACKS = 5,
  LINE_SEARCHES = 3,
  CHORD_STEPS = 12,
  CHORDS_WORTH = 5 /* chords that take as long as a factorisation with its tangent */
};

/* Steps of which less than this part can be taken are cut short by far. */
static const double rough_share = 0.25;
/* A step overshoots when so much of the force along it comes back; least part to go on with. */
static const double overshot = 0.5, least_share = 0.1;
/* Part of the unbalanced forces that a rough polishing may leave. */
static const double rough_force = 0.1;

/* Root mean square nodal length of a vector of unknowns. */
static double rms(const struct equilibrium *s, const double *v) {
  double sum = 0;
  for (int i = 0; i < s->model->dof_count; i++) {
    sum += v[i] * v[i];
  }
  return sqrt(3 * sum / s->model->dof_count);
}

static double largest(const struct equilibrium *s, const double *v) {
  double most = 0;
  for (int i = 0; i < s->model->dof_count; i++) {
    most = fmax(most, fabs(v[i]));
  }
  return most;
}

static double dot(const struct equilibrium *s, const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < s->model->dof_count; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

/* d residual / d load parameter at the state. */
static void load_force(struct equilibrium *s, const struct fe_state *state, double *force) {
  struct fe_model *m = s->model;
  if (!s->control.dead) {
    model_volume(m, state, force);
  }
  for (int d = 0; d < 3 * m->mesh->node_count; d++) {
    if (m->equation[d] >= 0) {
      double *f = &force[m->equation[d]];
      *f = s->control.dead ? -m->dead_load[d] : -*f;
    }
  }
}

static double *load_parameter(const struct equilibrium *s, struct fe_load *load) {
  return s->control.dead ? &load->dead : &load->pressure;
}

/* After a factorisation: under control the response to the load parameter, else the guest's. */
static void renew_response(struct equilibrium *s, const struct fe_state *state) {
  if (s->control.active) {
    load_force(s, state, s->control.force);
    model_solve(s->model, s->control.force, s->control.response);
  } else if (s->guest) {
    s->guest->factored(s->guest->context);
  }
}

static const struct equilibrium_guest *guest_of(const struct equilibrium *s) {
  return s->control.active ? NULL : s->guest;
}

/* The correction that belongs to the residual: K^-1 r; under control, together with the change of
 * the load parameter that keeps it normal to the control's normal, else with that of the guest.
 * Returns that change. */
static double correction(struct equilibrium *s, double *step) {
  const struct equilibrium_guest *guest = guest_of(s);
  model_solve(s->model, s->model->residual, step);
  s->guest_step = guest ? guest->correct(guest->context, step) : 0;
  if (!s->control.active) {
    return 0;
  }
  double change = -dot(s, s->control.normal, step) / dot(s, s->control.normal, s->control.response);
  for (int i = 0; i < s->model->dof_count; i++) {
    step[i] += change * s->control.response[i];
  }
  return change;
}

/* Size of the correction that has just been found, and its largest entry; the guest's included. */
static double size_of(const struct equilibrium *s, const double *step) {
  return s->guest_step > 0 ? rms(s, step) + s->guest_step : rms(s, step);
}

static double reach_of(const struct equilibrium *s, const double *step) {
  return fmax(largest(s, step), s->guest_step);
}

/* The state before a trial, and back. */
static void keep_state(struct equilibrium *s, const struct fe_state *state) {
  const struct equilibrium_guest *guest = guest_of(s);
  state_copy(s->model, &s->saved, state);
  if (guest) {
    guest->keep(guest->context);
  }
}

static void take_back(struct equilibrium *s, struct fe_state *state) {
  const struct equilibrium_guest *guest = guest_of(s);
  state_copy(s->model, state, &s->saved);
  if (guest) {
    guest->restore(guest->context);
  }
}

/* state <- state (+) (-share * correction), pressures recovered alongside; the guest moves, too. */
static void apply(struct equilibrium *s, struct fe_state *state, double *correction, double share) {
  const struct equilibrium_guest *guest = guest_of(s);
  struct fe_model *m = s->model;
  if (guest) {
    guest->move(guest->context, share);
  }
  for (int d = 0; d < 3 * m->mesh->node_count; d++) {
    int equation = m->equation[d];
    s->increment[d] = equation >= 0 ? -share * correction[equation] : 0;
  }
  for (int i = 0; i < m->dof_count; i++) {
    correction[i] *= -share;
  }
  model_recover(m, state, correction, share);
  retraction_apply(s->retraction, state->u, s->increment);
}

/* Residual at a trial state reached by a correction of at most `most`. When that is far the
 * partners of the contact are found anew: a part of the body that has passed into another, where
 * no closest point pushes it back, makes the trial as useless as an inverted element; so does one
 * that lies deeper in a rigid object than `allowed`. */
static enum status evaluate_trial(struct equilibrium *s, struct fe_load *load,
                                  const struct fe_state *state, double most, double allowed) {
  struct fe_model *m = s->model;
  if (m->use_contact && most > 0.25 * m->contact.reach) {
    enum status status = model_search_contact(m, state);
    if (status != STATUS_OK) {
      return status;
    }
    if (contact_intrusion(&m->contact) > 0.5 * m->contact.reach) {
      return STATUS_CONTACT;
    }
  }
  enum status status = model_evaluate(m, state, load, false);
  return status == STATUS_OK && obstacles_intrusion(m) > allowed ? STATUS_CONTACT : status;
}

/* Applies the Newton step, of largest entry `most`, and `change` to the load parameter, shortened
 * until no element is inverted and no part of the body has passed into another; the residual is
 * evaluated at the new state. *share is the part applied. */
static enum status take_step(struct equilibrium *s, struct fe_load *load, double change,
                             struct fe_state *state, double most, double *share) {
  struct fe_model *m = s->model;
  double *trial = s->chord, start = *load_parameter(s, load);
  double allowed = fmax(0.5 * m->contact.reach, 1.01 * obstacles_intrusion(m));
  enum status status = STATUS_OK;
  keep_state(s, state);
  for (int attempt = 0; attempt < BACKTRACKS; attempt++) {
    memcpy(trial, s->step, sizeof *trial * (size_t)m->dof_count);
    apply(s, state, trial, *share);
    *load_parameter(s, load) = start + *share * change;
    status = evaluate_trial(s, load, state, *share * most, allowed);
    if (status == STATUS_OK) {
      return STATUS_OK;
    }
    if (s->verbose) {
      fprintf(stderr, "    part %.2f of a step: %s\n", *share, status_word(status));
    }
    *share *= 0.4;
    take_back(s, state);
    *load_parameter(s, load) = start;
    /* The recovery needs the pressure residuals of this state again. */
    if (model_evaluate(m, state, load, false) != STATUS_OK) {
      break;
    }
  }
  return status;
}

/* Whether, at the rate from `size` to `next`, chords converge in less time than a factorisation
 * takes. */
static bool worth_going_on(const struct equilibrium *s, double next, double size) {
  double rate = next / size, left = s->options.step_tolerance * (1 - rate);
  return s->options.hasty && rate > 0 && rate < 0.7 && next * pow(rate, CHORDS_WORTH) < left;
}

bool equilibrium_polish(struct equilibrium *s, struct fe_load *load, struct fe_state *state,
                        const struct polishing *polishing) {
  struct fe_model *m = s->model;
  double limit = polishing->contraction, size = polishing->size;
  double tolerance = s->options.step_tolerance, force = rms(s, m->residual);
  for (int k = 0; k < CHORD_STEPS; k++) {
    double change = correction(s, s->chord), *parameter = load_parameter(s, load);
    double next = size_of(s, s->chord);
    if (!(next <= limit * size) && !(next < 0.1 * tolerance) && !worth_going_on(s, next, size)) {
      return false;
    }
    keep_state(s, state);
    apply(s, state, s->chord, 1);
    *parameter += change;
    if (model_evaluate(m, state, load, false) != STATUS_OK) {
      take_back(s, state);
      *parameter -= change;
      model_evaluate(m, state, load, false);
      return false;
    }
    s->moved += next;
    /* With a contraction rate the error left is rate / (1 - rate) times the last correction. */
    double rate = isfinite(size) ? fmin(next / size, 0.5) : 0.5;
    if (next * rate / (1 - rate) < tolerance ||
        (polishing->roughly && rms(s, m->residual) < rough_force * force)) {
      return true;
    }
    size = next;
    limit = 0.3;
  }
  return false;
}

/* take_step, and with rigid objects less of the step where it overshoots: where the forces along it
 * that it was to remove come back with the other sign. Points that touch and leave in turn, or
 * stick and slip, would make Newton's method go to and fro for ever; with the multipliers held
 * there is a potential, which the tangent's steps descend. */
static enum status take_measured_step(struct equilibrium *s, struct fe_load *load, double change,
                                      struct fe_state *state, double most, double *share) {
  struct fe_model *m = s->model;
  double before = dot(s, m->residual, s->step), start = *load_parameter(s, load);
  bool watched = s->settling && !s->guest && !s->control.active && before > 0 &&
                 most > s->options.step_tolerance;
  enum status status = take_step(s, load, change, state, most, share);
  for (int k = 0; k < LINE_SEARCHES && status == STATUS_OK && watched; k++) {
    double after = dot(s, m->residual, s->step);
    if (after > -overshot * before) {
      break;
    }
    take_back(s, state);
    *load_parameter(s, load) = start;
    status = model_evaluate(m, state, load, false);
    *share *= fmax(least_share, before / (before - after));
    if (status == STATUS_OK) {
      status = take_step(s, load, change, state, most, share);
    }
  }
  return status;
}

/* Takes s->step, of rms `size`, and the change of the load parameter, no further than the longest
 * step, and polishes what a whole step reached. *converged tells whether that is the equilibrium.
 */
static enum status step_and_polish(struct equilibrium *s, struct fe_load *load, double change,
                                   struct fe_state *state, double size, bool *converged) {
  double most = reach_of(s, s->step);
  double share = most > s->options.longest_step ? s->options.longest_step / most : 1;
  enum status status = take_measured_step(s, load, change, state, most, &share);
  if (s->verbose) {
    struct contact_summary c = contact_summarise(&s->model->contact);
    fprintf(stderr, "    step %.2e share %.2f negative %d active %d gap %.3e load %.6g\n", size,
            share, s->negative_pivots, c.active, c.min_gap, *load_parameter(s, load));
  }
  s->moved += size;
  s->share = share;
  *converged = status == STATUS_OK && share == 1 &&
               equilibrium_polish(s, load, state, &(struct polishing){size, 0.1, false});
  return status;
}

/* Whether the corrections have stopped shrinking. */
struct progress {
  double best;
  int since; /* iterations without a clearly smaller correction */
};

static bool stalled(struct progress *progress, double size) {
  if (size < 0.7 * progress->best) {
    *progress = (struct progress){size, 0};
  } else {
    progress->since++;
  }
  return progress->since >= STALL_ITERATIONS;
}

enum status equilibrium_newton(struct equilibrium *s, struct fe_load *load,
                               double stiffness_pressure, struct fe_state *state, int *iterations) {
  struct fe_model *m = s->model;
  struct progress progress = {INFINITY, 0};
  int rough = 0;
  s->fewest_negative = m->dof_count;
  s->most_negative = 0;
  for (int it = 0; it < s->options.max_iterations; it++) {
    load->stiffness_pressure = it == 0 ? stiffness_pressure : load->pressure;
    enum status status = equilibrium_check_limits(s);
    if (status == STATUS_OK) {
      status = model_evaluate(m, state, load, true);
    }
    if (status != STATUS_OK) {
      return status;
    }
    s->negative_pivots = model_factor(m);
    s->fewest_negative =
        s->negative_pivots < s->fewest_negative ? s->negative_pivots : s->fewest_negative;
    s->most_negative =
        s->negative_pivots > s->most_negative ? s->negative_pivots : s->most_negative;
    renew_response(s, state);
    double change = correction(s, s->step);
    ++*iterations;
    m->statistics.newton_iterations++;
    double size = size_of(s, s->step);
    if (!isfinite(size) || stalled(&progress, size)) {
      return STATUS_DIVERGED;
    }
    bool converged;
    status = step_and_polish(s, load, change, state, size, &converged);
    if (status != STATUS_OK || converged) {
      return status;
    }
    rough += s->share < rough_share;
    if (s->options.rough_steps > 0 && rough >= s->options.rough_steps) {
      return STATUS_DIVERGED;
    }
  }
  return STATUS_DIVERGED;
}

/* Tangent predictor with the factor that the last equilibrium left behind: it belongs to a state
 * so close to that equilibrium that factorising there anew would gain nothing. Returns OK when
 * the prediction, polished, is already the new equilibrium, DIVERGED when Newton's method has to
 * go on from it, or from the old state if the prediction was no good. */
static enum status predict(struct equilibrium *s, struct fe_load *load, struct fe_state *state) {
  struct fe_model *m = s->model;
  if (model_evaluate(m, state, load, false) != STATUS_OK) {
    return STATUS_DIVERGED;
  }
  correction(s, s->step);
  double size = size_of(s, s->step);
  bool converged = false;
  if (isfinite(size) && reach_of(s, s->step) < s->options.longest_step) {
    step_and_polish(s, load, 0, state, size, &converged);
  }
  return converged ? STATUS_OK : STATUS_DIVERGED;
}

enum status equilibrium_solve(struct equilibrium *s, const struct fe_load *target,
                              double previous_pressure, struct fe_state *state, int *iterations) {
  enum status status = STATUS_DIVERGED;
  struct fe_load load = *target;
  double pressure_step = load.pressure - previous_pressure;
  bool continues = s->factor_fits && s->pressure_step != 0;
  equilibrium_start_multipliers(s, state, continues ? pressure_step / s->pressure_step : 0);
  *iterations = 0;
  if (s->factor_fits) {
    status = predict(s, &load, state);
    previous_pressure = load.pressure;
  }
  s->factor_fits = false;
  if (status != STATUS_OK) {
    status = equilibrium_newton(s, &load, previous_pressure, state, iterations);
  }
  if (status == STATUS_OK && equilibrium_touches(s->model)) {
    status = equilibrium_augment(s, &load, state, iterations);
  }
  equilibrium_keep_multipliers(s, state);
  s->pressure_step = pressure_step;
  s->factor_fits = status == STATUS_OK;
  return status;
}

void equilibrium_direction(struct equilibrium *s, const struct fe_state *state, double *direction) {
  load_force(s, state, s->control.force);
  model_solve(s->model, s->control.force, direction);
  for (int i = 0; i < s->model->dof_count; i++) {
    direction[i] = -direction[i];
  }
}

enum status equilibrium_tangent(struct equilibrium *s, const struct fe_load *target, bool dead,
                                const struct fe_state *state, double *direction) {
  struct fe_load load = *target;
  load.stiffness_pressure = load.pressure;
  equilibrium_start_multipliers(s, state, 0);
  enum status status = model_evaluate(s->model, state, &load, true);
  if (status != STATUS_OK) {
    return status;
  }
  s->negative_pivots = model_factor(s->model);
  s->control.dead = dead;
  equilibrium_direction(s, state, direction);
  return isfinite(rms(s, direction)) ? STATUS_OK : STATUS_DIVERGED;
}

enum status equilibrium_follow(struct equilibrium *s, struct fe_load *load, bool dead,
                               const double *direction, double change, struct fe_state *state,
                               int *iterations) {
  struct equilibrium_control *c = &s->control;
  double size = rms(s, direction);
  *iterations = 0;
  equilibrium_start_multipliers(s, state, 0);
  c->dead = dead;
  c->active = true;
  for (int i = 0; i < s->model->dof_count; i++) {
    c->normal[i] = direction[i] / size;
    s->step[i] = -change * direction[i];
  }
  /* The pressures of the elements follow in the first correction. */
  apply(s, state, s->step, 1);
  *load_parameter(s, load) += change;
  enum status status = equilibrium_newton(s, load, load->pressure, state, iterations);
  if (status == STATUS_OK && equilibrium_touches(s->model)) {
    status = equilibrium_augment(s, load, state, iterations);
  }
  c->active = false;
  equilibrium_keep_multipliers(s, state);
  s->pressure_step = 0;
  s->factor_fits = false;
  return status;
}
