#include "solver/bistable/rest.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multiroots.h>
#include <math.h>
#include <string.h>

/* Accelerations of a state of rest, m/s2. */
#define STILL 1e-8

enum { ITERATIONS = 300 };

/* The pressure at the start. */
static double first_pressure(const struct bistable_system *s, int a) {
  double given = s->spec->initial_pressure;
  return isnan(given) ? set_point_at(&s->set_point[a], 0.0) : given;
}

/* The weight above a cell, of its actuator's share. */
static double weight_above(const struct bistable_system *s, int i) {
  const struct bistable_spec *spec = s->spec;
  const struct bistable_actuator *actuator = &spec->actuator[s->cell[i].actuator];
  double shared = spec->plate_mass + (s->in_contact ? spec->load_mass : 0.0);
  double mass = shared / spec->actuator_count + 0.5 * s->cell[i].spec->mass;
  for (int k = i + 1; k < actuator->first_cell + actuator->cell_count; k++) {
    mass += s->cell[k].spec->mass;
  }
  return mass * spec->gravity;
}

static enum status place_cells(const struct bistable_system *s, double e[], struct error *error) {
  for (int i = 0; i < s->spec->cell_count; i++) {
    const struct cell *cell = &s->cell[i];
    double p = first_pressure(s, cell->actuator);
    e[i] = cell->spec->elongation;
    if (isnan(e[i])) {
      e[i] = system_rest(s, i, cell->side, p, -weight_above(s, i));
    }
    if (isnan(e[i])) {
      return error_set(
          error, STATUS_INVALID, "/initial",
          "cell %d has no state of rest on its %s side at %.6g kPa: start at another "
          "pressure, for example \"initial\": { \"pressure\": \"0 kPa\" }, or from the "
          "other side",
          i + 1, cell->side == LAW_COMPRESSED ? "compressed" : "stretched", 1e-3 * p);
    }
  }
  return STATUS_OK;
}

/* Positions from elongations; the plate by least squares over the tops of the actuators. Returns
 * the largest distance of a top from it. */
static double place_masses(const struct bistable_system *s, const double e[], double x[]) {
  const struct bistable_spec *spec = s->spec;
  double top[BISTABLE_ACTUATORS_MAX] = {0}, mean = 0.0, centre = 0.0, square = 0.0, product = 0.0;
  int n = spec->actuator_count;
  for (int i = 0; i < spec->cell_count; i++) {
    const struct cell *cell = &s->cell[i];
    top[cell->actuator] += e[i];
    if (cell->top >= 0) {
      x[cell->top] = top[cell->actuator];
    }
  }
  for (int a = 0; a < n; a++) {
    mean += top[a] / n;
    centre += spec->actuator[a].offset / n;
  }
  for (int a = 0; a < n; a++) {
    double arm = spec->actuator[a].offset - centre;
    square += arm * arm;
    product += arm * (top[a] - mean);
  }
  double tilt = n > 1 ? product / square : 0.0, worst = 0.0;
  x[0] = mean - tilt * centre;
  if (n > 1) {
    x[1] = tilt;
  }
  for (int a = 0; a < n; a++) {
    worst = fmax(worst, fabs(top[a] - x[0] - tilt * spec->actuator[a].offset));
  }
  return worst;
}

/* Air at the first pressures. */
static void fill(struct bistable_system *s, double x[]) {
  for (int a = 0; a < s->spec->actuator_count; a++) {
    double p = first_pressure(s, a);
    s->guess[a] = p;
    s->held[a] = p;
    if (s->gas[a] >= 0) {
      x[s->gas[a]] = system_gas(s, a, x, p);
    }
  }
}

/* ---- equilibrium of several actuators ----------------------------------------------------- */

static int accelerations(const gsl_vector *positions, void *context, gsl_vector *residual) {
  struct bistable_system *s = context;
  double x[SYSTEM_STATES_MAX] = {0};
  struct bistable_motion motion;
  for (int i = 0; i < s->positions; i++) {
    x[i] = 1e-3 * gsl_vector_get(positions, (size_t)i);
  }
  if (s->load >= 0) {
    x[s->load] = x[0];
  }
  fill(s, x);
  if (!system_motion(s, 0.0, x, &motion)) {
    return GSL_EFAILED;
  }
  for (int i = 0; i < s->positions; i++) {
    gsl_vector_set(residual, (size_t)i, motion.acceleration[i]);
  }
  return GSL_SUCCESS;
}

static double largest(const gsl_vector *v) {
  double most = 0.0;
  for (size_t i = 0; i < v->size; i++) {
    most = fmax(most, fabs(gsl_vector_get(v, i)));
  }
  return most;
}

static enum status balance(struct bistable_system *s, double x[], struct error *error) {
  size_t n = (size_t)s->positions;
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  gsl_multiroot_fsolver *solver = gsl_multiroot_fsolver_alloc(gsl_multiroot_fsolver_hybrids, n);
  gsl_vector *start = gsl_vector_alloc(n);
  gsl_multiroot_function function = {accelerations, n, s};
  enum status status = STATUS_OK;
  if (!solver || !start) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the state of rest");
    goto done;
  }
  for (size_t i = 0; i < n; i++) {
    gsl_vector_set(start, i, 1e3 * x[i]);
  }
  int flag = gsl_multiroot_fsolver_set(solver, &function, start);
  for (int i = 0; flag == GSL_SUCCESS && i < ITERATIONS && largest(solver->f) > STILL; i++) {
    flag = gsl_multiroot_fsolver_iterate(solver);
  }
  /* the solver may stop for lack of progress in the last digits */
  if (!(largest(solver->f) < 1e3 * STILL)) {
    status = error_set(error, STATUS_INVALID, "/initial",
                       "no state of rest was found in which the actuators hold the plate (%.3g "
                       "m/s2 are left): give elongations of the cells",
                       largest(solver->f));
  }
  for (size_t i = 0; i < n; i++) {
    x[i] = 1e-3 * gsl_vector_get(solver->x, i);
  }
done:
  gsl_multiroot_fsolver_free(solver);
  gsl_vector_free(start);
  gsl_set_error_handler(handler);
  return status;
}

enum status rest_state(struct bistable_system *s, double x[], struct error *error) {
  const struct bistable_spec *spec = s->spec;
  double e[BISTABLE_CELLS_MAX], apart;
  bool given = false;
  memset(x, 0, SYSTEM_STATES_MAX * sizeof *x);
  enum status status = place_cells(s, e, error);
  for (int i = 0; i < spec->cell_count; i++) {
    given = given || !isnan(spec->cell[i].elongation);
  }
  if (status != STATUS_OK) {
    return status;
  }
  apart = place_masses(s, e, x);
  if (given && apart > 1e-9) {
    return error_set(error, STATUS_INVALID, "/actuators",
                     "the elongations of the actuators do not fit to one plate: a top is %.3g mm "
                     "off it",
                     1e3 * apart);
  }
  if (!given && spec->actuator_count > 1) {
    s->is_held = true;
    status = balance(s, x, error);
    s->is_held = false;
  }
  x[s->positions] = spec->velocity;
  if (spec->actuator_count > 1) {
    x[s->positions + 1] = spec->tilt_rate;
  }
  if (s->load >= 0) {
    x[s->load] = x[0] + spec->load_gap;
    x[s->load + 1] = s->in_contact ? spec->velocity : 0.0;
  }
  fill(s, x);
  return status;
}
