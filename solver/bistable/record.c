#include "solver/bistable/record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Part of the range of a table beyond which a state is outside it. */
#define BEYOND 1e-3

enum { MOMENTS_MAX = 2000000 };

/* Room for one more of `size` bytes. */
static enum status reserve(void **array, size_t count, size_t *room, size_t size,
                           struct error *error) {
  if (count < *room) {
    return STATUS_OK;
  }
  size_t wanted = *room ? 2 * *room : 64;
  void *grown = realloc(*array, wanted * size);
  if (!grown) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the motion");
  }
  *array = grown;
  *room = wanted;
  return STATUS_OK;
}

double bistable_sample_time(const struct bistable_recorder *s) {
  return (double)s->out->sample_count / s->system->spec->sample_rate;
}

enum status bistable_add_sample(struct bistable_recorder *s, double time, const double x[],
                                struct error *error) {
  struct bistable_trajectory *t = s->out;
  enum status status =
      reserve((void **)&t->sample, t->sample_count, &s->sample_room, sizeof *t->sample, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct bistable_sample *sample = &t->sample[t->sample_count++];
  *sample = (struct bistable_sample){.time = time};
  memcpy(sample->x, x, sizeof sample->x);
  for (int i = 0; i < s->system->spec->cell_count; i++) {
    sample->stretched += s->system->cell[i].side == LAW_STRETCHED;
  }
  for (int a = 0; a < s->system->spec->actuator_count; a++) {
    sample->set_point[a] = set_point_at(&s->system->set_point[a], time);
  }
  system_motion(s->system, time, x, &sample->motion);
  return STATUS_OK;
}

/* Warns once of every law that is used outside its table. */
static void look_outside(struct bistable_recorder *s, double time, const double x[],
                         const struct bistable_motion *motion) {
  for (int i = 0; i < s->system->spec->cell_count; i++) {
    const struct cell *cell = &s->system->cell[i];
    const struct cell_spec *spec = cell->spec;
    const char *name = s->system->spec->law[spec->law].name;
    double h[2], p[2], e = system_elongation(s->system, i, x) / spec->size;
    double pressure = motion->pressure[cell->actuator] / spec->stiffness;
    law_range(cell->law, h, p);
    if (!s->system->spec->law[spec->law].is_table) {
      continue;
    }
    double near_h = BEYOND * (h[1] - h[0]), near_p = BEYOND * (p[1] - p[0]);
    if ((e < h[0] - near_h || e > h[1] + near_h) && !s->outside_h[spec->law]) {
      s->outside_h[spec->law] = true;
      bistable_warn(s->out,
                    "at %.6g s a cell of the law \"%.40s\" is at %.4g mm, outside its table, %.4g "
                    "to %.4g mm: the force is carried on straight",
                    time, name, 1e3 * e, 1e3 * h[0], 1e3 * h[1]);
    }
    if ((pressure < p[0] - near_p || pressure > p[1] + near_p) && !s->outside_p[spec->law]) {
      s->outside_p[spec->law] = true;
      bistable_warn(s->out,
                    "at %.6g s the pressure on the law \"%.40s\" is %.4g kPa, outside its table, "
                    "%.4g to %.4g kPa: the force is carried on straight",
                    time, name, 1e-3 * pressure, 1e-3 * p[0], 1e-3 * p[1]);
    }
  }
}

/* Takes in the state now. */
enum status bistable_add_moment(struct bistable_recorder *s, double time, const double x[],
                                struct error *error) {
  struct bistable_trajectory *t = s->out;
  const struct bistable_system *system = s->system;
  struct bistable_motion motion;
  if (t->moment_count >= MOMENTS_MAX) {
    return error_set(error, STATUS_DIVERGED, NULL,
                     "%d steps were made until %.9g s: a shorter simulation, a larger tolerance or "
                     "more damping is wanted",
                     MOMENTS_MAX, time);
  }
  enum status status =
      reserve((void **)&t->moment, t->moment_count, &s->moment_room, sizeof *t->moment, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct bistable_moment *moment = &t->moment[t->moment_count++];
  bool tilts = system->spec->actuator_count > 1;
  double v = x[system->positions];
  system_motion(s->system, time, x, &motion);
  *moment = (struct bistable_moment){time, x[0], v, tilts ? x[1] : 0.0, {0}};
  memcpy(moment->pressure, motion.pressure, sizeof moment->pressure);
  double energy = motion.kinetic + motion.potential;
  if (t->moment_count == 1) {
    t->first_energy = energy;
    t->lowest_h = t->highest_h = moment->h;
    t->lowest_tilt = t->highest_tilt = moment->tilt;
  }
  double balance = energy - t->first_energy - x[system->work] + t->lost;
  t->balance_error = fmax(t->balance_error, fabs(balance));
  t->peak_kinetic = fmax(t->peak_kinetic, motion.kinetic);
  t->peak_speed = fmax(t->peak_speed, fabs(v));
  t->lowest_h = fmin(t->lowest_h, moment->h);
  t->highest_h = fmax(t->highest_h, moment->h);
  t->lowest_tilt = fmin(t->lowest_tilt, moment->tilt);
  t->highest_tilt = fmax(t->highest_tilt, moment->tilt);
  if (tilts) {
    t->peak_tilt_rate = fmax(t->peak_tilt_rate, fabs(x[system->positions + 1]));
  }
  if (system->load >= 0) {
    t->peak_load_speed = fmax(t->peak_load_speed, x[system->load + 1]);
    t->peak_contact_force = fmax(t->peak_contact_force, motion.contact_force);
  }
  look_outside(s, time, x, &motion);
  return STATUS_OK;
}

enum status bistable_add_event(struct bistable_recorder *s, const struct bistable_event *event,
                               struct error *error) {
  struct bistable_trajectory *t = s->out;
  if (t->event_count >= BISTABLE_EVENTS_MAX) {
    return error_set(error, STATUS_EVENTS, NULL, "%d events until %.9g s: more are not followed",
                     BISTABLE_EVENTS_MAX, event->time);
  }
  enum status status =
      reserve((void **)&t->event, t->event_count, &s->event_room, sizeof *t->event, error);
  if (status == STATUS_OK) {
    t->event[t->event_count++] = *event;
    t->lost += event->lost;
  }
  return status;
}
