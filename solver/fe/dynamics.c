#include "solver/fe/dynamics.h"

#include <math.h>
#include <string.h>

enum { ATTEMPTS = 30, EASY_ITERATIONS = 6, PASSING_PATIENCE = 2 };

/* Step control: after a failure; least and most change; changes put up with, so that the factor
 * serves several steps; error at which a step is repeated, in tolerances. */
static const double cut_factor = 0.4, least_change = 0.4, most_change = 2;
static const double steady_low = 0.8, steady_high = 1.4, too_much = 2;
/* The corrections of a step stop this far below its error, in tolerances; against rigid objects
 * that are led, whose forces do not settle that far. */
static const double solved = 1e-4, solved_against = 5e-3;
/* Forces of rigid objects settle by so much less in a step than at rest, and swinging ones are put
 * up with after so many updates: the next step goes on. */
static const double passing_forces = 5;
/* Largest ratio of steps for differences of second order (they are stable up to 2.4). */
static const double difference_ratio = 2.2;

/* Coefficients of the method; see dynamics.h. */
struct method {
  double alpha, beta, gamma;
};

static struct method method_of(const struct dynamics *d) {
  double alpha = (d->options.fast - 1) / (d->options.fast + 1);
  return (struct method){alpha, 0.25 * (1 - alpha) * (1 - alpha), 0.5 - alpha};
}

/* The acceleration of the method is that of a moment (-alpha) steps before the state's. For a step
 * of another length it is wanted at another moment: on the line through that and the balanced one,
 * which is the state's own. */
static double move_moment(const struct motion *motion, double h, double own, double balanced) {
  double ratio = motion->last > 0 ? h / motion->last : 1;
  return own + (1 - ratio) * (balanced - own);
}

static double start_acceleration(const struct motion *motion, double h, int i) {
  return move_moment(motion, h, motion->acceleration[i], motion->balanced[i]);
}

/* Viscous stress by differences of second order (of first order at the start): dC/dt = k1 (C -
 * history) at the end of the step. */
static void prepare_viscosity(struct dynamics *d, const struct fe_state *state,
                              const struct motion *motion, double h) {
  double ratio = motion->last > 0 ? h / motion->last : 0;
  double w = ratio <= difference_ratio ? ratio : 0;
  double rate = (1 + 2 * w) / ((1 + w) * h);
  inertia_set_viscosity(d->inertia, d->model, d->options.viscosity * rate,
                        (1 + w) * (1 + w) / (1 + 2 * w), state->u, -w * w / (1 + 2 * w),
                        motion->before);
}

/* What the step adds to the equilibrium at its end. */
static void prepare(struct dynamics *d, const struct fe_state *state, const struct motion *motion,
                    double h) {
  struct method k = method_of(d);
  struct inertia *inertia = d->inertia;
  double drag = d->options.drag;
  double by_velocity = -(1 - k.alpha) / (k.beta * h) - drag * (k.gamma / k.beta - 1);
  double by_acceleration =
      k.alpha - (1 - k.alpha) * (0.5 / k.beta - 1) + drag * h * (1 - 0.5 * k.gamma / k.beta);
  inertia->stiffness = (1 - k.alpha) / (k.beta * h * h) + drag * k.gamma / (k.beta * h);
  for (int i = 0; i < 3 * d->model->mesh->node_count; i++) {
    inertia->start[i] = state->u[i];
    inertia->offset[i] =
        by_velocity * motion->velocity[i] + by_acceleration * start_acceleration(motion, h, i);
  }
  prepare_viscosity(d, state, motion, h);
}

/* The step as the free object takes it. */
static void prepare_object(struct dynamics *d, const struct motion *motion, double h) {
  struct method k = method_of(d);
  const struct object_motion *m = &motion->object;
  struct object_step step = {h, k.alpha, k.beta, k.gamma, d->options.drag, {0}, {0}, {0}, {0}};
  for (int i = 0; i < 3; i++) {
    step.velocity[i] = m->velocity[i];
    step.spin[i] = m->spin[i];
    step.acceleration[i] = move_moment(motion, h, m->acceleration[i], m->balanced[i]);
    step.turning[i] = move_moment(motion, h, m->turning[i], m->balanced_turning[i]);
  }
  d->object->step = step;
  free_object_begin(d->object);
}

/* The state before the step that did not do. */
static void take_back(struct dynamics *d, struct fe_state *state) {
  state_copy(d->model, state, &d->saved);
  if (d->object) {
    free_object_return(d->object);
    d->object->step.h = 0;
  }
}

/* How much the accelerations of the free object change in the step, m/s2. */
static double object_change(const struct free_object *o) {
  double a[3], turning[3], shift = 0, turn = 0;
  free_motion_end(o, a, turning);
  for (int i = 0; i < 3; i++) {
    shift += pow(a[i] - o->step.acceleration[i], 2);
    turn += pow(turning[i] - o->step.turning[i], 2);
  }
  return sqrt(shift) + o->size * sqrt(turn);
}

/* Accelerations of the method at the end of a step, into d->work, and the step's error. */
static void measure(struct dynamics *d, const struct fe_state *state, const struct motion *motion,
                    double h) {
  struct method k = method_of(d);
  double sum = 0;
  for (int i = 0; i < 3 * d->model->mesh->node_count; i++) {
    double start = start_acceleration(motion, h, i);
    double moved = state->u[i] - d->saved.u[i] - h * motion->velocity[i];
    d->work[i] = moved / (k.beta * h * h) - (0.5 / k.beta - 1) * start;
    sum += (d->work[i] - start) * (d->work[i] - start);
  }
  double change = sqrt(3 * sum / d->model->dof_count);
  if (d->object) {
    change = fmax(change, object_change(d->object));
  }
  d->error = fabs(0.5 * k.alpha + k.beta - 1.0 / 6) * h * h * change;
}

/* What a step in time asks of its equilibrium. */
static void loosen(struct dynamics *d) {
  struct equilibrium_options *o = &d->solver->options;
  double part = d->model->obstacle_count > 0 && !d->object ? solved_against : solved;
  o->step_tolerance = fmin(o->step_tolerance, part * d->options.tolerance);
  o->force_tolerance *= passing_forces;
  o->force_patience = PASSING_PATIENCE;
}

/* Solves for the state at the end of a step; on failure the state is that at its start. */
static enum status solve(struct dynamics *d, const struct fe_load *load, double pressure_before,
                         double h, struct fe_state *state, const struct motion *motion) {
  struct equilibrium *solver = d->solver;
  const struct equilibrium_options at_rest = solver->options;
  int iterations = 0;
  state_copy(d->model, &d->saved, state);
  prepare(d, state, motion, h);
  if (d->object) {
    prepare_object(d, motion, h);
  }
  solver->factor_fits =
      d->factor_step == h && d->factorizations == d->model->statistics.factorizations;
  solver->pressure_step = 0;
  loosen(d);
  d->model->inertia = d->inertia;
  enum status status = equilibrium_solve(solver, load, pressure_before, state, &iterations);
  d->model->inertia = NULL;
  solver->options = at_rest;
  d->factor_step = solver->factor_fits ? h : 0;
  d->factorizations = d->model->statistics.factorizations;
  solver->factor_fits = false;
  solver->pressure_step = 0;
  d->statistics.iterations += iterations;
  d->last_iterations = iterations;
  if (status != STATUS_OK) {
    take_back(d, state);
    return status;
  }
  measure(d, state, motion, h);
  return STATUS_OK;
}

static void measure_kinetic(const struct dynamics *d, struct motion *motion) {
  motion->kinetic = inertia_kinetic(d->inertia, motion->velocity);
  if (d->object) {
    motion->kinetic += free_motion_kinetic(d->object, &motion->object);
  }
}

/* Commits the obstacles; what they have done, the free object's weight among it. */
void dynamics_commit(struct dynamics *d, struct fe_state *state, struct energy_step *step) {
  const struct fe_model *m = d->model;
  model_commit_obstacles(d->model, state);
  for (int k = 0; k < m->obstacle_count; k++) {
    step->friction += m->obstacle[k]->friction_work;
    step->obstacle_work += d->object && d->object->index == k ? 0 : m->obstacle[k]->motion_work;
  }
  step->weight_work += d->object ? free_object_weight_work(d->object) : 0;
}

/* The motion and the ledger take over what `solve` has found. */
static void accept(struct dynamics *d, const struct fe_load *load, double h, struct fe_state *state,
                   struct motion *motion, struct energy *energy) {
  struct method k = method_of(d);
  struct energy_step step = {.kinetic = 0};
  double kinetic = motion->kinetic;
  dynamics_commit(d, state, &step);
  for (int i = 0; i < 3 * d->model->mesh->node_count; i++) {
    double start = start_acceleration(motion, h, i), end = d->work[i];
    motion->velocity[i] += h * ((1 - k.gamma) * start + k.gamma * end);
    motion->balanced[i] = (1 - k.alpha) * end + k.alpha * start;
    motion->acceleration[i] = end;
    motion->before[i] = d->saved.u[i];
  }
  if (d->object) {
    free_motion_accept(d->object, &motion->object);
    d->object->step.h = 0;
  }
  measure_kinetic(d, motion);
  step.kinetic = motion->kinetic;
  step.damping = energy_viscous(d->model, d->inertia, d->saved.u, state->u, motion->viscous) +
                 h * d->options.drag * (kinetic + motion->kinetic);
  motion->time += h;
  motion->last = h;
  d->statistics.steps++;
  if (energy) {
    energy_record(energy, d->model, state, load, &step);
  }
}

enum status dynamics_step(struct dynamics *d, const struct fe_load *load, double pressure_before,
                          struct fe_state *state, struct motion *motion, struct energy *energy) {
  enum status status = solve(d, load, pressure_before, motion->step, state, motion);
  if (status == STATUS_OK) {
    accept(d, load, motion->step, state, motion, energy);
  }
  return status;
}

/* Length of the step to try: one that would leave a sliver before `until` ends on it. */
static double next_step(const struct dynamics *d, const struct motion *motion, double until) {
  double h = fmin(motion->step, d->options.longest), left = until - motion->time;
  return left < 1.05 * h ? left : left < 1.9 * h ? 0.5 * left : h;
}

/* The change of the step that brings its error, of third order, to the tolerance. */
static double wanted_change(const struct dynamics *d) {
  double ratio = 0.9 * cbrt(d->options.tolerance / fmax(d->error, 1e-12 * d->options.tolerance));
  return fmax(least_change, fmin(most_change, ratio));
}

/* The length to go on with after an accepted step of length h. */
static double following_step(const struct dynamics *d, const struct motion *motion, double h) {
  double change = wanted_change(d);
  bool hard = d->last_iterations > EASY_ITERATIONS;
  if ((change > steady_low && change < steady_high) || (change > 1 && hard)) {
    change = 1;
  }
  double next = change * h;
  /* A step cut short by the end says nothing against longer ones. */
  return change >= 1 ? fmax(next, motion->step) : next;
}

/* One attempt with length h. *again: it did not do, motion->step is shorter. */
static enum status attempt(struct dynamics *d, const struct dynamics_drive *drive, double h,
                           struct fe_load *load, struct fe_state *state, struct motion *motion,
                           struct energy *energy, bool *again) {
  struct fe_load end = *load;
  enum status status = equilibrium_check_limits(d->solver);
  *again = false;
  if (status == STATUS_OK && drive && drive->drive) {
    status = drive->drive(drive->context, motion->time + h, &end);
  }
  if (status != STATUS_OK) {
    return status;
  }
  status = solve(d, &end, load->pressure, h, state, motion);
  if (status != STATUS_OK) {
    *again = !status_is_final(status);
    motion->step = cut_factor * h;
    return status;
  }
  if (d->error > too_much * d->options.tolerance && h > d->options.shortest) {
    *again = true;
    motion->step = fmax(wanted_change(d) * h, d->options.shortest);
    take_back(d, state);
    return STATUS_DIVERGED;
  }
  accept(d, &end, h, state, motion, energy);
  motion->step = following_step(d, motion, h);
  *load = end;
  return STATUS_OK;
}

enum status dynamics_advance(struct dynamics *d, const struct dynamics_drive *drive, double until,
                             struct fe_load *load, struct fe_state *state, struct motion *motion,
                             struct energy *energy, enum status *reason) {
  *reason = STATUS_OK;
  for (int k = 0; k < ATTEMPTS; k++) {
    bool again;
    double h = next_step(d, motion, until);
    enum status status = attempt(d, drive, h, load, state, motion, energy, &again);
    if (status == STATUS_OK && drive && drive->visit) {
      status = drive->visit(drive->context, motion, state, load);
    }
    if (!again) {
      return status;
    }
    d->statistics.rejected++;
    *reason = status;
    if (motion->step < d->options.shortest) {
      break;
    }
  }
  return STATUS_STEP_MINIMUM;
}

/* Residual at the state with viscous forces by its velocity, but without inertia. */
static enum status unbalanced(struct dynamics *d, const struct fe_load *load,
                              const struct fe_state *state, struct motion *motion) {
  struct fe_model *m = d->model;
  double instant = 1e-5 * dynamics_scale(d);
  struct fe_load now = {load->pressure, load->pressure, load->dead};
  for (int i = 0; i < 3 * m->mesh->node_count; i++) {
    d->work[i] = state->u[i] - instant * motion->velocity[i];
  }
  inertia_set_viscosity(d->inertia, m, d->options.viscosity / instant, 1, d->work, 0, NULL);
  d->inertia->stiffness = 0;
  memset(d->inertia->offset, 0, 3 * (size_t)m->mesh->node_count * sizeof *d->inertia->offset);
  model_use_multipliers(m, state);
  m->inertia = d->inertia;
  enum status status = model_evaluate(m, state, &now, true);
  m->inertia = NULL;
  measure_kinetic(d, motion);
  energy_viscous(m, d->inertia, state->u, state->u, motion->viscous);
  return status;
}

enum status dynamics_balance(struct dynamics *d, const struct fe_load *load,
                             const struct fe_state *state, struct motion *motion) {
  struct fe_model *m = d->model;
  enum status status = unbalanced(d, load, state, motion);
  if (status != STATUS_OK) {
    return status;
  }
  if (d->object) {
    free_motion_balance(d->object, d->options.drag, &motion->object);
  }
  d->inertia->stiffness = 1;
  inertia_only(d->inertia, m);
  model_factor(m);
  model_solve(m, m->residual, d->solver->step);
  for (int i = 0; i < 3 * m->mesh->node_count; i++) {
    double force = m->equation[i] >= 0 ? -d->solver->step[m->equation[i]] : 0;
    motion->balanced[i] = force - d->options.drag * motion->velocity[i];
    motion->acceleration[i] = motion->balanced[i];
  }
  d->solver->factor_fits = false;
  return STATUS_OK;
}
