#include "solver/bistable/system.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/job/json.h"

/* Part of the absolute pressure by which a step towards it may change it. */
#define STRIDE 0.2

enum { PRESSURE_STEPS = 120 };

/* ---- creation ----------------------------------------------------------------------------- */

/* Numbers of positions and states. */
static void lay_out(struct bistable_system *s) {
  const struct bistable_spec *spec = s->spec;
  s->positions = spec->actuator_count > 1 ? 2 : 1;
  for (int a = 0; a < spec->actuator_count; a++) {
    const struct bistable_actuator *actuator = &spec->actuator[a];
    for (int i = 0; i < actuator->cell_count; i++) {
      struct cell *cell = &s->cell[actuator->first_cell + i];
      bool last = i + 1 == actuator->cell_count;
      cell->actuator = a;
      cell->bottom = i == 0 ? END_GROUND : s->positions - 1;
      cell->top = last ? END_PLATE : s->positions;
      s->positions += !last;
    }
  }
  s->states = 2 * s->positions;
  s->load = spec->has_load ? s->states : -1;
  s->states += spec->has_load ? 2 : 0;
  for (int a = 0; a < spec->actuator_count; a++) {
    bool direct = spec->actuator[a].supply.model == SUPPLY_DIRECT;
    s->gas[a] = direct ? -1 : s->states++;
  }
  s->work = s->states++;
  s->impulse = s->states++;
  s->in_contact = spec->has_load && spec->load_gap == 0.0;
}

/* Half of every cell at either end of it. */
static void lump(struct bistable_system *s) {
  s->plate[0] = s->spec->plate_mass;
  s->plate[2] = s->spec->plate_inertia;
  for (int i = 0; i < s->spec->cell_count; i++) {
    const struct cell *cell = &s->cell[i];
    double half = 0.5 * cell->spec->mass, x = s->spec->actuator[cell->actuator].offset;
    if (cell->bottom >= 0) {
      s->mass[cell->bottom] += half;
    }
    if (cell->top >= 0) {
      s->mass[cell->top] += half;
    } else {
      s->plate[0] += half;
      s->plate[1] += half * x;
      s->plate[2] += half * x * x;
    }
  }
}

enum status system_open(const struct bistable_spec *spec, struct bistable_system *s,
                        struct error *error) {
  *s = (struct bistable_system){.spec = spec};
  for (int i = 0; i < spec->law_count; i++) {
    const struct law_spec *law = &spec->law[i];
    enum status status = law_create(law, &s->law[i], error);
    if (status != STATUS_OK) {
      snprintf(error->pointer, sizeof error->pointer, "%s", law->pointer);
      return status;
    }
  }
  for (int i = 0; i < spec->cell_count; i++) {
    const struct cell_spec *cell = &spec->cell[i];
    s->cell[i].spec = cell;
    s->cell[i].law = s->law[cell->law];
    s->cell[i].side = cell->stretched ? LAW_STRETCHED : LAW_COMPRESSED;
  }
  lay_out(s);
  lump(s);
  return STATUS_OK;
}

void system_close(struct bistable_system *s) {
  for (int i = 0; i < BISTABLE_LAWS_MAX; i++) {
    law_destroy(s->law[i]);
    s->law[i] = NULL;
  }
}

/* ---- cells -------------------------------------------------------------------------------- */

/* The displacement (or velocity) of an end of a cell; x: positions or velocities. */
static double end_of(const struct bistable_system *s, const struct cell *cell, int end,
                     const double x[]) {
  if (end == END_GROUND) {
    return 0.0;
  }
  if (end == END_PLATE) {
    bool tilts = s->spec->actuator_count > 1;
    return x[0] + (tilts ? s->spec->actuator[cell->actuator].offset * x[1] : 0.0);
  }
  return x[end];
}

static double stretch_of(const struct bistable_system *s, int i, const double x[]) {
  const struct cell *cell = &s->cell[i];
  return end_of(s, cell, cell->top, x) - end_of(s, cell, cell->bottom, x);
}

double system_elongation(const struct bistable_system *s, int cell, const double x[]) {
  return stretch_of(s, cell, x);
}

void system_cell(const struct bistable_system *s, int i, double e, double p,
                 struct law_value *value) {
  const struct cell *cell = &s->cell[i];
  double c = cell->spec->stiffness, size = cell->spec->size;
  law_evaluate(cell->law, cell->side, e / size, p / c, value);
  value->force *= c * size * size;
  value->volume *= size * size * size;
  value->potential *= c * size * size * size;
}

double system_end(const struct bistable_system *s, int i, enum law_side side, double p) {
  const struct cell_spec *spec = s->cell[i].spec;
  return spec->size * law_end(s->cell[i].law, side, p / spec->stiffness);
}

double system_limit(const struct bistable_system *s, int i, enum law_side side, double p) {
  const struct cell_spec *spec = s->cell[i].spec;
  return spec->size * law_limit(s->cell[i].law, side, p / spec->stiffness);
}

double system_rest(const struct bistable_system *s, int i, enum law_side side, double p,
                   double force) {
  const struct cell_spec *spec = s->cell[i].spec;
  double factor = spec->stiffness * spec->size * spec->size;
  return spec->size * law_rest(s->cell[i].law, side, p / spec->stiffness, force / factor);
}

/* Beyond a stop, and 0 between them. */
static double beyond_stops(const struct cell_spec *spec, double e) {
  return e < spec->stop_from ? e - spec->stop_from : e > spec->stop_to ? e - spec->stop_to : 0.0;
}

/* ---- air ---------------------------------------------------------------------------------- */

double system_volume(const struct bistable_system *s, int a, const double x[], double p) {
  const struct bistable_actuator *actuator = &s->spec->actuator[a];
  double volume = actuator->supply.dead_volume;
  for (int i = actuator->first_cell; i < actuator->first_cell + actuator->cell_count; i++) {
    struct law_value value;
    system_cell(s, i, stretch_of(s, i, x), p, &value);
    volume += value.volume;
  }
  return volume;
}

double system_gas(const struct bistable_system *s, int a, const double x[], double p) {
  const struct supply_spec *supply = &s->spec->actuator[a].supply;
  return supply->model == SUPPLY_CHAMBER
             ? pow(supply->atmosphere + p, 1.0 / supply->exponent) * system_volume(s, a, x, p)
             : p;
}

/* Secants from a first step that takes the volume as given, kept within the signs seen. */
static double solve_pressure(const struct bistable_system *s, int a, const double x[],
                             double amount, double guess) {
  const struct supply_spec *supply = &s->spec->actuator[a].supply;
  double floor = -supply->atmosphere, low = floor, high = INFINITY;
  double p = guess > floor ? guess : 0.0, last = NAN, last_excess = NAN;
  for (int n = 0; n < PRESSURE_STEPS; n++) {
    double gas = system_gas(s, a, x, p), excess = gas - amount;
    if (!isfinite(excess)) {
      return NAN;
    }
    if (excess > 0.0) {
      high = p;
    } else {
      low = p;
    }
    double slope = gas / (supply->exponent * (p - floor));
    if (n > 0 && (excess - last_excess) * (p - last) > 0.0) {
      slope = (excess - last_excess) / (p - last);
    }
    double next = p - excess / slope;
    double most = STRIDE * (p - floor); /* not to leave the nearest of several pressures */
    next = fmin(fmax(next, p - most), p + most);
    if (!(next > low && next < high)) {
      next = isinf(high) ? p + most : 0.5 * (low + high);
    }
    last = p;
    last_excess = excess;
    p = next;
    if (fabs(p - last) <= 4e-15 * (p - floor)) {
      return p;
    }
  }
  return high - low < 1e-9 * (high - floor) ? p : NAN;
}

double system_pressure(struct bistable_system *s, int a, double time, const double x[]) {
  enum supply_model model = s->spec->actuator[a].supply.model;
  if (s->is_held) {
    return s->held[a];
  }
  if (model == SUPPLY_DIRECT) {
    return set_point_at(&s->set_point[a], time);
  }
  if (model == SUPPLY_LAG) {
    return x[s->gas[a]];
  }
  double p = solve_pressure(s, a, x, x[s->gas[a]], s->guess[a]);
  s->guess[a] = isfinite(p) ? p : s->guess[a];
  return p;
}

/* Rate of the state of the air, and the power that comes with it. */
static double supply_rate(const struct bistable_system *s, int a, double time, double p,
                          double volume, double *power) {
  const struct supply_spec *supply = &s->spec->actuator[a].supply;
  double u = set_point_at(&s->set_point[a], time);
  double cells = volume - supply->dead_volume;
  if (supply->model == SUPPLY_LAG) {
    double rate = (u - p) / supply->time_constant;
    *power = -cells * rate;
    return rate;
  }
  if (supply->model == SUPPLY_DIRECT) {
    const struct hlpv_input *input = s->set_point[a].input;
    double turn = 2.0 * 3.14159265358979323846 * input->frequency;
    double rate = input->profile == HLPV_SINE
                      ? input->amplitude * turn * cos(turn * time + input->phase)
                      : s->set_point[a].slope;
    *power = -cells * rate;
    return 0.0;
  }
  double n = supply->exponent, absolute = supply->atmosphere + p, k = 1.0 - 1.0 / n;
  double flow = NORMAL_PRESSURE * supply->conductance * (u - p);
  double rate = pow(absolute, 1.0 / n - 1.0) * flow, base = pow(NORMAL_PRESSURE, k);
  double ratio = log(absolute / NORMAL_PRESSURE);
  *power = rate * base * (1.0 + (k > 0.0 ? expm1(k * ratio) / k : ratio));
  return rate;
}

/* Energy of the air of a chamber, from a state at 101.325 kPa on, with the work on the atmosphere:
 * N (P^k - P0^k) / (n k), k = 1 - 1/n, in the isothermal limit N log(P / P0). */
static double gas_energy(const struct supply_spec *supply, double p, double volume) {
  double n = supply->exponent, absolute = supply->atmosphere + p, k = 1.0 - 1.0 / n;
  double ratio = log(absolute / NORMAL_PRESSURE), base = pow(NORMAL_PRESSURE, k);
  double amount = pow(absolute, 1.0 / n) * volume;
  return amount * base * (k > 0.0 ? expm1(k * ratio) / k : ratio) / n +
         supply->atmosphere * (volume - supply->dead_volume);
}

/* ---- motion ------------------------------------------------------------------------------- */

/* Forces on positions and the potential of the cells; power: what dashpots take. */
static void add_cells(const struct bistable_system *s, const double x[], double force[],
                      struct bistable_motion *motion, double volume[], double *power) {
  const double *v = x + s->positions;
  for (int i = 0; i < s->spec->cell_count; i++) {
    const struct cell *cell = &s->cell[i];
    int a = cell->actuator;
    double e = stretch_of(s, i, x), rate = stretch_of(s, i, v), p = motion->pressure[a];
    double past = beyond_stops(cell->spec, e), stop = cell->spec->stop_stiffness * past;
    struct law_value value;
    system_cell(s, i, e, p, &value);
    double pull = value.force + cell->spec->damping * rate + stop;
    bool chamber = s->spec->actuator[a].supply.model == SUPPLY_CHAMBER;
    motion->potential += value.potential + (chamber ? p * value.volume : 0.0) + 0.5 * stop * past;
    volume[a] += value.volume;
    *power -= cell->spec->damping * rate * rate;
    if (cell->bottom >= 0) {
      force[cell->bottom] += pull;
    }
    if (cell->top >= 0) {
      force[cell->top] -= pull;
    } else {
      force[0] -= pull;
      if (s->spec->actuator_count > 1) {
        force[1] -= pull * s->spec->actuator[a].offset;
      }
    }
  }
}

/* What acts on the plate besides cells, and on the masses. */
static void add_outer(const struct bistable_system *s, const double x[], double force[],
                      struct bistable_motion *motion, double *power) {
  const struct bistable_spec *spec = s->spec;
  const double *v = x + s->positions;
  int first = spec->actuator_count > 1 ? 2 : 1;
  double g = spec->gravity, carried = s->in_contact ? spec->load_mass : 0.0;
  force[0] -= (s->plate[0] + carried) * g + spec->plate_damping * v[0];
  motion->potential += (s->plate[0] + carried) * g * x[0];
  motion->kinetic += 0.5 * (s->plate[0] + carried) * v[0] * v[0];
  *power -= spec->plate_damping * v[0] * v[0];
  if (first == 2) {
    force[1] -= s->plate[1] * g + spec->bending_stiffness * x[1];
    motion->potential += s->plate[1] * g * x[1] + 0.5 * spec->bending_stiffness * x[1] * x[1];
    motion->kinetic += v[1] * (s->plate[1] * v[0] + 0.5 * s->plate[2] * v[1]);
  }
  for (int i = first; i < s->positions; i++) {
    force[i] -= s->mass[i] * g;
    motion->potential += s->mass[i] * g * x[i];
    motion->kinetic += 0.5 * s->mass[i] * v[i] * v[i];
  }
  if (s->load >= 0 && !s->in_contact) {
    motion->potential += spec->load_mass * g * x[s->load];
    motion->kinetic += 0.5 * spec->load_mass * x[s->load + 1] * x[s->load + 1];
  }
}

static void accelerate(const struct bistable_system *s, const double force[],
                       struct bistable_motion *motion) {
  double *acceleration = motion->acceleration;
  double carried = s->in_contact ? s->spec->load_mass : 0.0, mass = s->plate[0] + carried;
  int first = 1;
  if (s->spec->actuator_count > 1) {
    double determinant = mass * s->plate[2] - s->plate[1] * s->plate[1];
    acceleration[0] = (s->plate[2] * force[0] - s->plate[1] * force[1]) / determinant;
    acceleration[1] = (mass * force[1] - s->plate[1] * force[0]) / determinant;
    first = 2;
  } else {
    acceleration[0] = force[0] / mass;
  }
  for (int i = first; i < s->positions; i++) {
    acceleration[i] = force[i] / s->mass[i];
  }
  motion->contact_force = carried * (acceleration[0] + s->spec->gravity);
}

double system_plate_mass(const struct bistable_system *s) {
  return s->spec->actuator_count > 1 ? s->plate[0] - s->plate[1] * s->plate[1] / s->plate[2]
                                     : s->plate[0];
}

/* Both looks at a state; power and gas_rate are of the derivative. */
static bool look(struct bistable_system *s, double time, const double x[],
                 struct bistable_motion *motion, double gas_rate[], double *power) {
  double force[SYSTEM_POSITIONS_MAX] = {0}, volume[BISTABLE_ACTUATORS_MAX] = {0};
  *motion = (struct bistable_motion){0};
  *power = 0.0;
  for (int a = 0; a < s->spec->actuator_count; a++) {
    motion->pressure[a] = system_pressure(s, a, time, x);
    if (!isfinite(motion->pressure[a])) {
      return false;
    }
  }
  add_cells(s, x, force, motion, volume, power);
  add_outer(s, x, force, motion, power);
  accelerate(s, force, motion);
  for (int a = 0; a < s->spec->actuator_count; a++) {
    const struct supply_spec *supply = &s->spec->actuator[a].supply;
    double supplied, all = volume[a] + supply->dead_volume;
    gas_rate[a] = supply_rate(s, a, time, motion->pressure[a], all, &supplied);
    *power += supplied;
    if (supply->model == SUPPLY_CHAMBER) {
      motion->potential += gas_energy(supply, motion->pressure[a], all);
    }
  }
  return true;
}

bool system_motion(struct bistable_system *s, double time, const double x[],
                   struct bistable_motion *motion) {
  double gas_rate[BISTABLE_ACTUATORS_MAX], power;
  return look(s, time, x, motion, gas_rate, &power);
}

bool system_derivative(struct bistable_system *s, double time, const double x[], double rate[]) {
  double gas_rate[BISTABLE_ACTUATORS_MAX], power;
  struct bistable_motion motion;
  if (!look(s, time, x, &motion, gas_rate, &power)) {
    return false;
  }
  for (int i = 0; i < s->positions; i++) {
    rate[i] = x[s->positions + i];
    rate[s->positions + i] = motion.acceleration[i];
  }
  if (s->load >= 0) {
    rate[s->load] = s->in_contact ? rate[0] : x[s->load + 1];
    rate[s->load + 1] = s->in_contact ? motion.acceleration[0] : -s->spec->gravity;
  }
  for (int a = 0; a < s->spec->actuator_count; a++) {
    if (s->gas[a] >= 0) {
      rate[s->gas[a]] = gas_rate[a];
    }
  }
  rate[s->work] = power;
  rate[s->impulse] = motion.contact_force;
  return true;
}
