#include "solver/bistable/simulate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/clock.h"
#include "solver/bistable/record.h"
#include "solver/bistable/rest.h"
#include "solver/bistable/stepper.h"

/* Ranges of the laws by which the loss of a state to infinity is known. */
#define UNBOUNDED 100.0
/* Speed after an impact below which plate and load stay together, m/s. */
#define CONTACT_SPEED 1e-6

/* Part of the range of volumes by which a table may contradict itself without a warning. */
#define CONSISTENT 0.02

enum { STEPS_BETWEEN_LOOKS = 256 };

/* When a cell left the stable part of its side. */
struct trigger {
  double time, pressure, h;
};

struct simulation {
  struct bistable_system *system;
  const struct bistable_options *options;
  struct stepper *stepper;
  double size[SYSTEM_STATES_MAX], range;
  double time, x[SYSTEM_STATES_MAX];
  struct trigger trigger[BISTABLE_CELLS_MAX];
  struct bistable_recorder recorder;
  double reported_s;
};

/* ---- events ------------------------------------------------------------------------------- */

static void note_trigger(struct simulation *s, int cell) {
  struct bistable_motion motion;
  system_motion(s->system, s->time, s->x, &motion);
  s->trigger[cell] =
      (struct trigger){s->time, motion.pressure[s->system->cell[cell].actuator], s->x[0]};
}

/* The cell goes over to its other side. */
static enum status change_side(struct simulation *s, int i, struct error *error) {
  struct cell *cell = &s->system->cell[i];
  const struct trigger *trigger = &s->trigger[i];
  struct bistable_motion before, after;
  bool stretches = cell->side == LAW_COMPRESSED;
  system_motion(s->system, s->time, s->x, &before);
  cell->side = stretches ? LAW_STRETCHED : LAW_COMPRESSED;
  if (!system_motion(s->system, s->time, s->x, &after)) {
    return error_set(error, STATUS_DIVERGED, NULL,
                     "at %.9g s the air finds no pressure after a cell has snapped", s->time);
  }
  struct bistable_event event = {
      .type = stretches ? EVENT_SNAP : EVENT_RETURN,
      .time = s->time,
      .cell = i,
      .h = s->x[0],
      .velocity = s->x[s->system->positions],
      .before = before.pressure[cell->actuator],
      .after = after.pressure[cell->actuator],
      .lost = before.potential - after.potential,
      .trigger_time = trigger->time,
      .trigger_pressure = trigger->pressure,
      .trigger_h = trigger->h,
  };
  note_trigger(s, i); /* where it begins on its new side */
  return bistable_add_event(&s->recorder, &event, error);
}

/* The roots as they are now. */
static bool find_roots(struct simulation *s, double root[]) {
  return stepper_roots(s->system, s->time, s->x, root);
}

/* Cells beyond the end of their side, but not beyond that of the other, change over: at the start,
 * and after a jump of the pressure. */
static enum status settle_sides(struct simulation *s, struct error *error) {
  enum status status = STATUS_OK;
  for (int changes = 0; changes < 2 * BISTABLE_CELLS_MAX; changes++) {
    double root[SYSTEM_ROOTS_MAX];
    int next = -1;
    if (!find_roots(s, root)) {
      return error_set(error, STATUS_DIVERGED, NULL, "at %.9g s the air finds no pressure",
                       s->time);
    }
    for (int i = 0; i < s->system->spec->cell_count && next < 0; i++) {
      struct cell *cell = &s->system->cell[i];
      if (root[i * ROOTS_PER_CELL + ROOT_END] >= 0.0) {
        continue;
      }
      double p = system_pressure(s->system, cell->actuator, s->time, s->x);
      double e = system_elongation(s->system, i, s->x);
      enum law_side other = cell->side == LAW_COMPRESSED ? LAW_STRETCHED : LAW_COMPRESSED;
      double sign = other == LAW_COMPRESSED ? 1.0 : -1.0;
      next = sign * (system_end(s->system, i, other, p) - e) > 0.0 ? i : -1;
    }
    if (next < 0) {
      return status;
    }
    status = change_side(s, next, error);
    if (status != STATUS_OK) {
      return status;
    }
  }
  return status;
}

/* Plate and load meet: they part again at `restitution` times the speed, or stay together. */
static enum status meet_load(struct simulation *s, struct error *error) {
  struct bistable_system *system = s->system;
  const struct bistable_spec *spec = system->spec;
  double *plate = &s->x[system->positions], *load = &s->x[system->load + 1];
  double heavy = system_plate_mass(system), light = spec->load_mass;
  double closing = *plate - *load, reduced = heavy * light / (heavy + light);
  struct bistable_motion before, after;
  system_motion(system, s->time, s->x, &before);
  bool stays = spec->restitution * closing < CONTACT_SPEED;
  double impulse = reduced * (1.0 + (stays ? 0.0 : spec->restitution)) * closing;
  *plate -= impulse / heavy;
  if (spec->actuator_count > 1) {
    /* a push at the middle also turns a plate whose masses lie to one side */
    plate[1] += impulse / heavy * system->plate[1] / system->plate[2];
  }
  *load += impulse / light;
  s->x[system->load] = s->x[0];
  system->in_contact = stays;
  if (stays) {
    *load = *plate;
  }
  s->x[system->impulse] += impulse;
  s->recorder.out->impact_impulse += impulse;
  system_motion(system, s->time, s->x, &after);
  struct bistable_event event = {
      .type = EVENT_CONTACT,
      .time = s->time,
      .cell = -1,
      .h = s->x[0],
      .velocity = *plate,
      .before = before.pressure[0],
      .after = after.pressure[0],
      .lost = before.kinetic + before.potential - after.kinetic - after.potential,
      .impulse = impulse,
  };
  return bistable_add_event(&s->recorder, &event, error);
}

static enum status part_from_load(struct simulation *s, struct error *error) {
  struct bistable_motion motion;
  s->system->in_contact = false;
  s->x[s->system->load] = s->x[0];
  s->x[s->system->load + 1] = s->x[s->system->positions];
  system_motion(s->system, s->time, s->x, &motion);
  struct bistable_event event = {
      .type = EVENT_SEPARATION,
      .time = s->time,
      .cell = -1,
      .h = s->x[0],
      .velocity = s->x[s->system->positions],
      .before = motion.pressure[0],
      .after = motion.pressure[0],
  };
  return bistable_add_event(&s->recorder, &event, error);
}

static enum status note_stop(struct simulation *s, int cell, struct error *error) {
  double p = system_pressure(s->system, s->system->cell[cell].actuator, s->time, s->x);
  struct bistable_event event = {.type = EVENT_STOP,
                                 .time = s->time,
                                 .cell = cell,
                                 .h = s->x[0],
                                 .velocity = s->x[s->system->positions],
                                 .before = p,
                                 .after = p};
  return bistable_add_event(&s->recorder, &event, error);
}

/* What happens at the roots passed; *anew: the integration must start again. */
static enum status handle(struct simulation *s, const bool passed[SYSTEM_ROOTS_MAX], bool *anew,
                          struct error *error) {
  enum status status = STATUS_OK;
  int cells = s->system->spec->cell_count;
  *anew = false;
  for (int i = 0; i < cells && status == STATUS_OK; i++) {
    const bool *of = passed + i * ROOTS_PER_CELL;
    if (of[ROOT_LIMIT]) {
      note_trigger(s, i);
    }
    if (of[ROOT_END]) {
      *anew = true;
      status = change_side(s, i, error);
    }
    if (status == STATUS_OK && (of[ROOT_STOP_FROM] || of[ROOT_STOP_TO])) {
      status = note_stop(s, i, error);
    }
  }
  if (status == STATUS_OK && passed[cells * ROOTS_PER_CELL]) {
    *anew = true;
    status = s->system->in_contact ? part_from_load(s, error) : meet_load(s, error);
  }
  return status == STATUS_OK && *anew ? settle_sides(s, error) : status;
}

/* ---- along the time ----------------------------------------------------------------------- */

static enum status look_around(struct simulation *s, struct error *error) {
  const struct bistable_options *options = s->options;
  double wall = clock_wall_s(), end = s->system->spec->end;
  if (options->events && wall > s->reported_s + 0.5) {
    fprintf(options->events, "{\"event\":\"progress\",\"fraction\":%.4f,\"time_s\":%.6g}\n",
            s->time / end, s->time);
    fflush(options->events);
    s->reported_s = wall;
  }
  if (options->cancelled && options->cancelled(NULL)) {
    return error_set(error, STATUS_CANCELLED, NULL, "cancelled at %.9g s of %.9g s", s->time, end);
  }
  if (options->deadline_s > 0.0 && wall > options->deadline_s) {
    return error_set(error, STATUS_TIMEOUT, NULL, "the time limit was reached at %.9g s of %.9g s",
                     s->time, end);
  }
  return STATUS_OK;
}

static enum status advance(struct simulation *s, bool passed[SYSTEM_ROOTS_MAX],
                           struct error *error) {
  enum status status = stepper_step(s->stepper, &s->time, s->x, passed, error);
  while (status == STATUS_OK && bistable_sample_time(&s->recorder) <= s->time &&
         s->recorder.out->sample_count < BISTABLE_SAMPLES_MAX) {
    double between[SYSTEM_STATES_MAX];
    memcpy(between, s->x, sizeof between);
    stepper_interpolate(s->stepper, bistable_sample_time(&s->recorder), between);
    status = bistable_add_sample(&s->recorder, bistable_sample_time(&s->recorder), between, error);
  }
  if (status == STATUS_OK) {
    status = bistable_add_moment(&s->recorder, s->time, s->x, error);
  }
  for (int i = 0; i < s->system->positions && status == STATUS_OK; i++) {
    if (!(fabs(s->x[i]) < UNBOUNDED * s->range)) {
      status = error_set(error, STATUS_DIVERGED, NULL,
                         "at %.9g s an elongation has grown to %.3g m: a law lets go of its cell",
                         s->time, s->x[i]);
    }
  }
  return status;
}

static enum status run_piece(struct simulation *s, double stop, struct error *error) {
  enum status status = stepper_restart(s->stepper, s->time, s->x, stop, error);
  bool counted = false;
  for (long step = 0; status == STATUS_OK && s->time < stop; step++) {
    bool passed[SYSTEM_ROOTS_MAX], anew = false;
    status = advance(s, passed, error);
    if (status == STATUS_OK && step % STEPS_BETWEEN_LOOKS == 0) {
      status = look_around(s, error);
    }
    if (status == STATUS_OK) {
      status = handle(s, passed, &anew, error);
    }
    if (status == STATUS_OK && anew) {
      stepper_count(s->stepper, &s->recorder.out->counts);
      counted = true;
      status = bistable_add_moment(&s->recorder, s->time, s->x, error);
      if (status == STATUS_OK && s->time < stop) {
        status = stepper_restart(s->stepper, s->time, s->x, stop, error);
        counted = false;
      }
    }
  }
  if (!counted) {
    stepper_count(s->stepper, &s->recorder.out->counts);
  }
  return status;
}

/* The set-points from now on; returns the time of their next corner. */
static double open_piece(struct simulation *s) {
  const struct bistable_spec *spec = s->system->spec;
  double stop = spec->end;
  for (int a = 0; a < spec->actuator_count; a++) {
    const struct hlpv_input *input = &spec->actuator[a].input;
    struct set_point *set_point = &s->system->set_point[a];
    size_t i = 0;
    *set_point = (struct set_point){.input = input};
    if (input->profile == HLPV_SINE) {
      continue;
    }
    while (i + 1 < input->count && input->time[i + 1] <= s->time) {
      i++;
    }
    set_point->start = input->time[i];
    set_point->value = input->value[i];
    if (i + 1 < input->count) {
      stop = fmin(stop, input->time[i + 1]);
      if (input->profile == HLPV_LINEAR) {
        set_point->slope =
            (input->value[i + 1] - input->value[i]) / (input->time[i + 1] - input->time[i]);
      }
    }
  }
  return stop;
}

/* The sum of the energies, for the work of a supply whose pressure jumps. */
static double energy_now(struct simulation *s) {
  struct bistable_motion motion;
  system_motion(s->system, s->time, s->x, &motion);
  return motion.kinetic + motion.potential;
}

static enum status run_all(struct simulation *s, struct error *error) {
  enum status status = STATUS_OK;
  bool first = true;
  while (status == STATUS_OK && s->time < s->system->spec->end) {
    double before = first ? 0.0 : energy_now(s), stop = open_piece(s);
    if (first) {
      status = rest_state(s->system, s->x, error);
      for (int i = 0; i < s->system->spec->cell_count && status == STATUS_OK; i++) {
        note_trigger(s, i);
      }
    } else {
      s->x[s->system->work] += energy_now(s) - before;
    }
    if (first && status == STATUS_OK) {
      memcpy(s->recorder.out->start, s->x, sizeof s->x);
      status = bistable_add_moment(&s->recorder, s->time, s->x, error);
    }
    status = status == STATUS_OK ? settle_sides(s, error) : status;
    if (first && status == STATUS_OK) {
      status = bistable_add_sample(&s->recorder, 0.0, s->x, error);
    }
    first = false;
    status = status == STATUS_OK ? run_piece(s, stop, error) : status;
    s->time = status == STATUS_OK ? stop : s->time;
    status = status == STATUS_OK ? look_around(s, error) : status;
  }
  return status;
}

/* What the states will be about as large as. */
static void find_sizes(struct simulation *s) {
  const struct bistable_system *system = s->system;
  const struct bistable_spec *spec = system->spec;
  double arm = 0.0;
  for (int i = 0; i < spec->cell_count; i++) {
    double h[2], p[2];
    law_range(system->cell[i].law, h, p);
    s->range += spec->cell[i].size * (h[1] - h[0]);
  }
  for (int a = 0; a < spec->actuator_count; a++) {
    arm = fmax(arm, fabs(spec->actuator[a].offset));
  }
  for (int i = 0; i < system->positions; i++) {
    s->size[i] = s->range;
    s->size[system->positions + i] = 1.0;
  }
  if (spec->actuator_count > 1) {
    s->size[1] = s->range / arm;
    s->size[system->positions + 1] = 1.0 / arm;
  }
  if (system->load >= 0) {
    s->size[system->load] = s->range;
    s->size[system->load + 1] = 1.0;
  }
  for (int a = 0; a < spec->actuator_count; a++) {
    const struct supply_spec *supply = &spec->actuator[a].supply;
    if (system->gas[a] >= 0) {
      s->size[system->gas[a]] =
          supply->model == SUPPLY_LAG
              ? NORMAL_PRESSURE
              : pow(NORMAL_PRESSURE, 1.0 / supply->exponent) * (supply->dead_volume + 1e-6);
    }
  }
  s->size[system->work] = 0.1;
  s->size[system->impulse] = 0.1;
}

/* Warns of tables whose volumes are not those of their forces. */
static void check_laws(struct simulation *s) {
  const struct bistable_spec *spec = s->system->spec;
  for (int i = 0; i < spec->law_count; i++) {
    double difference = spec->law[i].is_table ? law_check(s->system->law[i]).volume : 0.0;
    if (difference > CONSISTENT) {
      bistable_warn(s->recorder.out,
                    "the volumes in the table of the law \"%.40s\" differ by %.2g of their range "
                    "from those that its forces imply (dF/dp = -dV/dh): more pressures, or more "
                    "accurate paths, are wanted",
                    spec->law[i].name, difference);
    }
  }
}

enum status bistable_simulate(struct bistable_system *system,
                              const struct bistable_options *options,
                              struct bistable_trajectory *trajectory, struct error *error) {
  struct simulation s = {.system = system, .options = options};
  s.recorder = (struct bistable_recorder){.system = system, .out = trajectory};
  *trajectory = (struct bistable_trajectory){0};
  find_sizes(&s);
  check_laws(&s);
  enum status status = stepper_create(system, s.size, &s.stepper, error);
  if (status == STATUS_OK) {
    status = run_all(&s, error);
  }
  trajectory->time = s.time;
  memcpy(trajectory->x, s.x, sizeof trajectory->x);
  for (int i = 0; i < system->spec->cell_count; i++) {
    trajectory->side[i] = system->cell[i].side;
  }
  trajectory->in_contact = system->in_contact;
  system_motion(system, s.time, s.x, &trajectory->motion);
  trajectory->taken = -s.x[system->work];
  bistable_measure(trajectory, system);
  stepper_destroy(s.stepper);
  return status;
}
