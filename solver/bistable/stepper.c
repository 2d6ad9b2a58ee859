#include "solver/bistable/stepper.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/hlpv/ode.h"

/* Acceleration in m/s2 by which the plate may pull at the load before they part: less is round-off
 * of a state at rest. */
#define ADHESION 1e-4

/* Part of a state's size by which it is moved for its derivatives. */
#define DIFFERENCE 1e-8

struct stepper {
  struct bistable_system *system;
  double size[SYSTEM_STATES_MAX];
  struct ode *ode;
};

/* ---- the motion as an initial value problem ----------------------------------------------- */

static bool derivative(void *context, double time, const double x[], double rate[]) {
  struct stepper *s = context;
  return system_derivative(s->system, time, x, rate);
}

/* Forward differences by steps of the size of each state: those that CVODE takes by itself drown in
 * round-off where a state is 0, as speeds are at the start, and Newton's method then seems to
 * converge at once. */
static bool jacobian(void *context, double time, const double x[], const double rate[],
                     double *const column[]) {
  struct stepper *s = context;
  double state[SYSTEM_STATES_MAX], moved[SYSTEM_STATES_MAX];
  memcpy(state, x, (size_t)s->system->states * sizeof *x);
  for (int j = 0; j < s->system->states; j++) {
    state[j] = x[j] + DIFFERENCE * fmax(fabs(x[j]), s->size[j]);
    double step = state[j] - x[j];
    if (!system_derivative(s->system, time, state, moved)) {
      return false;
    }
    state[j] = x[j];
    for (int i = 0; i < s->system->states; i++) {
      column[j][i] = (moved[i] - rate[i]) / step;
    }
  }
  return true;
}

static double or_one(double value) {
  return isfinite(value) ? value : 1.0;
}

bool stepper_roots(struct bistable_system *system, double time, const double x[], double root[]) {
  struct bistable_motion motion;
  int cells = system->spec->cell_count;
  if (!system_motion(system, time, x, &motion)) {
    return false;
  }
  for (int i = 0; i < cells; i++) {
    const struct cell *cell = &system->cell[i];
    double e = system_elongation(system, i, x), p = motion.pressure[cell->actuator];
    double sign = cell->side == LAW_COMPRESSED ? 1.0 : -1.0;
    double *r = root + i * ROOTS_PER_CELL;
    r[ROOT_LIMIT] = or_one(sign * (system_limit(system, i, cell->side, p) - e));
    r[ROOT_END] = or_one(sign * (system_end(system, i, cell->side, p) - e));
    r[ROOT_STOP_FROM] = or_one(e - cell->spec->stop_from);
    r[ROOT_STOP_TO] = or_one(cell->spec->stop_to - e);
  }
  root[cells * ROOTS_PER_CELL] = system->load < 0 ? 1.0
                                 : system->in_contact
                                     ? motion.contact_force + ADHESION * system->spec->load_mass
                                     : x[system->load] - x[0];
  return true;
}

static bool roots(void *context, double time, const double x[], double root[]) {
  struct stepper *s = context;
  return stepper_roots(s->system, time, x, root);
}

/* ---- creation ----------------------------------------------------------------------------- */

enum status stepper_create(struct bistable_system *system, const double size[],
                           struct stepper **stepper, struct error *error) {
  int direction[SYSTEM_ROOTS_MAX], count = system->spec->cell_count * ROOTS_PER_CELL + 1;
  struct stepper *s = calloc(1, sizeof *s);
  *stepper = NULL;
  if (!s) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the integrator");
  }
  s->system = system;
  memcpy(s->size, size, (size_t)system->states * sizeof *size);
  for (int i = 0; i < count; i++) {
    direction[i] = -1;
  }
  struct ode_problem problem = {.states = system->states,
                                .method = ODE_BDF,
                                .tolerance = system->spec->tolerance,
                                .size = size,
                                .root_count = count,
                                .direction = direction,
                                .derivative = derivative,
                                .jacobian = jacobian,
                                .roots = roots,
                                .context = s};
  enum status status = ode_create(&problem, &s->ode, error);
  if (status != STATUS_OK) {
    free(s);
    return status;
  }
  *stepper = s;
  return STATUS_OK;
}

void stepper_destroy(struct stepper *s) {
  if (s) {
    ode_destroy(s->ode);
    free(s);
  }
}

/* ---- integration -------------------------------------------------------------------------- */

enum status stepper_restart(struct stepper *s, double time, const double x[], double stop,
                            struct error *error) {
  return ode_restart(s->ode, time, x, stop, error);
}

enum status stepper_step(struct stepper *s, double *time, double x[], bool passed[SYSTEM_ROOTS_MAX],
                         struct error *error) {
  int found[SYSTEM_ROOTS_MAX] = {0};
  enum status status = ode_step(s->ode, time, x, found, error);
  for (int i = 0; i < SYSTEM_ROOTS_MAX; i++) {
    passed[i] = found[i] != 0;
  }
  return status;
}

void stepper_interpolate(struct stepper *s, double time, double x[]) {
  ode_interpolate(s->ode, time, x);
}

void stepper_count(struct stepper *s, struct hlpv_counts *counts) {
  ode_count(s->ode, counts);
}
