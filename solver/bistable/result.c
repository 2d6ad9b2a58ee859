#include "solver/bistable/result.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/base/clock.h"
#include "solver/bistable/computed_law.h"
#include "solver/bistable/simulate.h"
#include "solver/job/json.h"
#include "solver/post/result_hlpv.h"

#define DEGREES (180.0 / 3.14159265358979323846)

enum { KEY_MAX = 40, STEPS_MAX = 12 };

static bool tilts(const struct bistable_spec *spec) {
  return spec->actuator_count > 1;
}

/* The key of an actuator, whose number the first does not have. */
static const char *key_of(char key[KEY_MAX], const char *quantity, int actuator, const char *unit) {
  if (actuator == 0) {
    snprintf(key, KEY_MAX, "%s_%s", quantity, unit);
  } else {
    snprintf(key, KEY_MAX, "%s_%d_%s", quantity, actuator + 1, unit);
  }
  return key;
}

/* ---- states ------------------------------------------------------------------------------- */

static void set_state(json_t *o, const struct bistable_system *system, const double x[],
                      const struct bistable_motion *motion) {
  const struct bistable_spec *spec = system->spec;
  char key[KEY_MAX];
  json_set_finite(o, "h_mm", 1e3 * x[0]);
  json_set_finite(o, "velocity_m_s", x[system->positions]);
  if (spec->rest_length > 0.0) {
    json_set_finite(o, "extension_ratio", x[0] / spec->rest_length);
  }
  for (int a = 0; a < spec->actuator_count; a++) {
    json_set_finite(o, key_of(key, "pressure", a, "kPa"), 1e-3 * motion->pressure[a]);
  }
  if (tilts(spec)) {
    json_set_finite(o, "bending_angle_deg", DEGREES * x[1]);
  }
  for (int i = 0; i < spec->cell_count; i++) {
    snprintf(key, sizeof key, "cell_%d_mm", i + 1);
    json_set_finite(o, key, 1e3 * system_elongation(system, i, x));
  }
  if (system->load >= 0) {
    json_set_finite(o, "load_h_mm", 1e3 * x[system->load]);
    json_set_finite(o, "load_velocity_m_s", x[system->load + 1]);
    json_set_finite(o, "contact_force_N", motion->contact_force);
  }
  json_set_finite(o, "kinetic_mJ", 1e3 * motion->kinetic);
}

static json_t *samples_array(const struct bistable_system *system,
                             const struct bistable_trajectory *t) {
  json_t *samples = json_array();
  char key[KEY_MAX];
  for (size_t i = 0; i < t->sample_count; i++) {
    const struct bistable_sample *sample = &t->sample[i];
    json_t *o = json_object();
    json_set_finite(o, "time_s", sample->time);
    for (int a = 0; a < system->spec->actuator_count; a++) {
      json_set_finite(o, key_of(key, "set_point", a, "kPa"), 1e-3 * sample->set_point[a]);
    }
    set_state(o, system, sample->x, &sample->motion);
    json_object_set_new(o, "stretched_cells", json_integer(sample->stretched));
    json_array_append_new(samples, o);
  }
  return samples;
}

static json_t *final_object(const struct bistable_system *system,
                            const struct bistable_trajectory *t) {
  json_t *o = json_object(), *sides = json_array();
  json_set_finite(o, "time_s", t->time);
  set_state(o, system, t->x, &t->motion);
  for (int i = 0; i < system->spec->cell_count; i++) {
    json_array_append_new(sides,
                          json_string(t->side[i] == LAW_STRETCHED ? "stretched" : "compressed"));
  }
  json_object_set_new(o, "sides", sides);
  return o;
}

/* ---- events ------------------------------------------------------------------------------- */

static json_t *event_object(const struct bistable_event *event, int actuator) {
  static const char *const words[] = {[EVENT_SNAP] = "snap",
                                      [EVENT_RETURN] = "return",
                                      [EVENT_STOP] = "stop",
                                      [EVENT_CONTACT] = "contact",
                                      [EVENT_SEPARATION] = "separation"};
  json_t *o = json_object();
  json_object_set_new(o, "type", json_string(words[event->type]));
  json_set_finite(o, "time_s", event->time);
  if (event->cell >= 0) {
    json_object_set_new(o, "cell", json_integer(event->cell + 1));
    json_object_set_new(o, "actuator", json_integer(actuator + 1));
  }
  json_set_finite(o, "h_mm", 1e3 * event->h);
  json_set_finite(o, "velocity_m_s", event->velocity);
  json_set_finite(o, "pressure_before_kPa", 1e-3 * event->before);
  json_set_finite(o, "pressure_after_kPa", 1e-3 * event->after);
  json_set_finite(o, "lost_mJ", 1e3 * event->lost);
  if (event->type == EVENT_CONTACT) {
    json_set_finite(o, "impulse_N_s", event->impulse);
  }
  if (event->type == EVENT_SNAP || event->type == EVENT_RETURN) {
    json_set_finite(o, "trigger_time_s", event->trigger_time);
    json_set_finite(o, "trigger_pressure_kPa", 1e-3 * event->trigger_pressure);
    json_set_finite(o, "trigger_h_mm", 1e3 * event->trigger_h);
    json_set_finite(o, "peak_speed_m_s", event->peak_speed);
    json_set_finite(o, "peak_time_s", event->peak_time);
    json_set_finite(o, "travel_mm", 1e3 * event->travel);
    json_set_finite(o, "snap_time_s", event->travel_time);
    json_set_finite(o, "least_pressure_kPa", 1e-3 * event->least_pressure);
    json_set_finite(o, "greatest_pressure_kPa", 1e-3 * event->greatest_pressure);
  }
  return o;
}

static json_t *events_array(const struct bistable_system *system,
                            const struct bistable_trajectory *t) {
  json_t *events = json_array();
  for (size_t i = 0; i < t->event_count; i++) {
    int cell = t->event[i].cell, actuator = cell >= 0 ? system->cell[cell].actuator : 0;
    json_array_append_new(events, event_object(&t->event[i], actuator));
  }
  return events;
}

/* ---- plateaus ----------------------------------------------------------------------------- */

/* A stretch of time without snaps, from the end of the travel before it to the next trigger. */
struct plateau {
  double start, end, first_h, last_h;
  int stretched;
};

static double pressure_at(const struct bistable_trajectory *t, double time) {
  size_t low = 0, high = t->moment_count;
  while (low + 1 < high) {
    size_t middle = (low + high) / 2;
    if (t->moment[middle].time <= time) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return t->moment_count ? t->moment[low].pressure[0] : NAN;
}

/* The elongation where the pressure is nearest to none, the last such: the length that the actuator
 * keeps by itself where the set-point passes zero. */
static void set_least_loaded(json_t *o, const struct bistable_trajectory *t,
                             const struct plateau *p) {
  const struct bistable_moment *least = NULL;
  for (size_t i = 0; i < t->moment_count; i++) {
    const struct bistable_moment *moment = &t->moment[i];
    if (moment->time >= p->start && moment->time <= p->end &&
        (!least || fabs(moment->pressure[0]) <= fabs(least->pressure[0]))) {
      least = moment;
    }
  }
  if (least) {
    json_set_finite(o, "h_mm", 1e3 * least->h);
    json_set_finite(o, "pressure_kPa", 1e-3 * least->pressure[0]);
  }
}

static void add_plateau(json_t *plateaus, const struct bistable_trajectory *t,
                        const struct plateau *p) {
  if (!(p->end > p->start)) {
    return;
  }
  json_t *o = json_object();
  json_set_finite(o, "start_s", p->start);
  json_set_finite(o, "end_s", p->end);
  json_object_set_new(o, "stretched_cells", json_integer(p->stretched));
  json_set_finite(o, "first_h_mm", 1e3 * p->first_h);
  json_set_finite(o, "last_h_mm", 1e3 * p->last_h);
  json_set_finite(o, "first_pressure_kPa", 1e-3 * pressure_at(t, p->start));
  json_set_finite(o, "last_pressure_kPa", 1e-3 * pressure_at(t, p->end));
  set_least_loaded(o, t, p);
  json_array_append_new(plateaus, o);
}

/* The staircase of the elongation: what lies between the snaps. */
static json_t *plateaus_array(const struct bistable_spec *spec,
                              const struct bistable_trajectory *t) {
  json_t *plateaus = json_array();
  struct plateau p = {.first_h = t->moment_count ? t->moment[0].h : NAN};
  for (int i = 0; i < spec->cell_count; i++) {
    p.stretched += spec->cell[i].stretched;
  }
  for (size_t i = 0; i < t->event_count; i++) {
    const struct bistable_event *event = &t->event[i];
    if (event->type != EVENT_SNAP && event->type != EVENT_RETURN) {
      continue;
    }
    p.end = event->trigger_time;
    p.last_h = event->trigger_h;
    add_plateau(plateaus, t, &p);
    p.stretched += event->type == EVENT_SNAP ? 1 : -1;
    p.start = isnan(event->travel_end) ? event->time : event->travel_end;
    p.first_h = isnan(event->travel) ? event->h : event->trigger_h + event->travel;
  }
  p.end = t->time;
  p.last_h = t->x[0];
  add_plateau(plateaus, t, &p);
  return plateaus;
}

/* ---- metrics ------------------------------------------------------------------------------ */

static void set_snaps(json_t *o, const struct bistable_trajectory *t) {
  const struct bistable_event *fastest = NULL, *first = NULL, *back = NULL;
  int snaps = 0, returns = 0;
  double drop = 0.0;
  for (size_t i = 0; i < t->event_count; i++) {
    const struct bistable_event *event = &t->event[i];
    if (event->type == EVENT_RETURN) {
      back = back ? back : event;
      returns++;
    }
    if (event->type != EVENT_SNAP) {
      continue;
    }
    first = first ? first : event;
    snaps++;
    drop = fmax(drop, event->trigger_pressure - event->least_pressure);
    if (!isnan(event->peak_speed) && (!fastest || event->peak_speed > fastest->peak_speed)) {
      fastest = event;
    }
  }
  json_object_set_new(o, "snap_count", json_integer(snaps));
  json_object_set_new(o, "return_count", json_integer(returns));
  if (fastest) {
    json_set_finite(o, "snap_speed_m_s", fastest->peak_speed);
    json_set_finite(o, "snap_time_s", fastest->travel_time);
    json_set_finite(o, "snap_travel_mm", 1e3 * fastest->travel);
  }
  if (first) {
    json_set_finite(o, "trigger_pressure_kPa", 1e-3 * first->trigger_pressure);
    json_set_finite(o, "pressure_drop_kPa", 1e-3 * drop);
  }
  if (back) {
    json_set_finite(o, "release_pressure_kPa", 1e-3 * back->trigger_pressure);
  }
}

static void set_load(json_t *o, const struct bistable_spec *spec,
                     const struct bistable_trajectory *t, const struct bistable_system *system) {
  double v = t->x[system->load + 1];
  json_set_finite(o, "load_speed_m_s", t->peak_load_speed);
  json_set_finite(o, "final_load_speed_m_s", v);
  json_set_finite(o, "load_energy_mJ",
                  0.5e3 * spec->load_mass * t->peak_load_speed * t->peak_load_speed);
  json_set_finite(o, "impulse_N_s", t->x[system->impulse]);
  json_set_finite(o, "impact_impulse_N_s", t->impact_impulse);
  json_set_finite(o, "contact_force_peak_N", t->peak_contact_force);
}

json_t *bistable_metrics(const struct bistable_system *system,
                         const struct bistable_trajectory *t) {
  const struct bistable_spec *spec = system->spec;
  json_t *o = json_object();
  set_snaps(o, t);
  json_set_finite(o, "peak_speed_m_s", t->peak_speed);
  json_set_finite(o, "max_h_mm", 1e3 * t->highest_h);
  json_set_finite(o, "min_h_mm", 1e3 * t->lowest_h);
  json_set_finite(o, "final_h_mm", 1e3 * t->x[0]);
  if (spec->rest_length > 0.0) {
    json_set_finite(o, "extension_ratio", t->highest_h / spec->rest_length);
    json_set_finite(o, "final_extension_ratio", t->x[0] / spec->rest_length);
  }
  if (tilts(spec)) {
    json_set_finite(o, "bending_angle_deg", DEGREES * t->highest_tilt);
    json_set_finite(o, "least_bending_angle_deg", DEGREES * t->lowest_tilt);
    json_set_finite(o, "final_bending_angle_deg", DEGREES * t->x[1]);
    json_set_finite(o, "bending_speed_deg_s", DEGREES * t->peak_tilt_rate);
  }
  if (system->load >= 0) {
    set_load(o, spec, t, system);
  }
  json_set_finite(o, "peak_kinetic_mJ", 1e3 * t->peak_kinetic);
  json_set_finite(o, "jump_loss_mJ", 1e3 * t->lost);
  json_set_finite(o, "energy_balance_error_mJ", 1e3 * t->balance_error);
  json_object_set_new(o, "event_count", json_integer((json_int_t)t->event_count));
  return o;
}

/* ---- the document ------------------------------------------------------------------------- */

static json_t *laws_array(const struct bistable_system *system) {
  json_t *laws = json_array();
  for (int i = 0; i < system->spec->law_count; i++) {
    const struct law *law = system->law[i];
    json_t *o = json_pack("{s:s, s:b}", "name", system->spec->law[i].name, "two_branches",
                          law_has_branches(law));
    double h[2], p[2];
    law_range(law, h, p);
    json_set_finite(o, "from_mm", 1e3 * h[0]);
    json_set_finite(o, "to_mm", 1e3 * h[1]);
    json_set_finite(o, "from_kPa", 1e-3 * p[0]);
    json_set_finite(o, "to_kPa", 1e-3 * p[1]);
    if (system->spec->law[i].is_table) {
      struct law_consistency check = law_check(law);
      json_set_finite(o, "volume_difference_pct", 100.0 * check.volume);
      json_set_finite(o, "energy_difference_pct", 100.0 * check.energy);
    }
    json_array_append_new(laws, o);
  }
  return laws;
}

/* The steps of the staircase as metrics, as many as fit a table. */
static void set_steps(json_t *metrics, const json_t *plateaus) {
  size_t index;
  json_t *plateau;
  json_array_foreach((json_t *)plateaus, index, plateau) {
    json_t *h = json_object_get(plateau, "h_mm");
    char key[KEY_MAX];
    snprintf(key, sizeof key, "plateau_%zu_mm", index + 1);
    if (h && index < STEPS_MAX) {
      json_object_set(metrics, key, h);
    }
  }
}

json_t *bistable_parts(const struct bistable_system *system, const struct bistable_trajectory *t) {
  json_t *parts = json_object();
  json_object_set_new(parts, "samples", samples_array(system, t));
  json_object_set_new(parts, "events", events_array(system, t));
  json_object_set_new(parts, "plateaus", plateaus_array(system->spec, t));
  json_object_set_new(parts, "final", final_object(system, t));
  json_object_set_new(parts, "laws", laws_array(system));
  return parts;
}

/* Takes over what the snap jobs that were solved first have come to: their metrics, beside the laws
 * and for the job's own also as "snap", and their warnings, which are about the laws of the cells.
 */
static void add_computed(json_t *document, const json_t *computed) {
  json_t *warnings = json_object_get(document, "warnings"), *law, *warning;
  size_t index, at;
  json_array_foreach(json_object_get(document, "laws"), index, law) {
    const char *name = json_string_value(json_object_get(law, "name"));
    const json_t *snap = json_object_get(computed, name);
    if (!snap) {
      continue;
    }
    json_object_set(law, "snap", json_object_get(snap, "metrics"));
    if (strcmp(name, "snap") == 0) {
      json_object_set(document, "snap", json_object_get(snap, "metrics"));
    }
    json_array_foreach(json_object_get(snap, "warnings"), at, warning) {
      json_array_append_new(warnings, json_sprintf("%s: %s", name, json_string_value(warning)));
    }
  }
}

enum status result_bistable(const struct job_spec *spec,
                            const struct result_bistable_options *options, json_t **document,
                            enum status *ending, struct error *error) {
  double wall = clock_wall_s(), cpu = clock_cpu_s();
  struct bistable_options simulation = {
      .deadline_s = spec->timeout_s > 0 ? wall + spec->timeout_s : 0,
      .cancelled = options->cancelled,
      .events = options->events,
  };
  struct bistable_trajectory t = {0};
  struct bistable_system system;
  struct error end = {.status = STATUS_OK};
  json_t *computed = NULL;
  *document = NULL;
  enum status status = computed_law(spec, options->events, options->cancelled, &computed, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = system_open(spec->bistable, &system, error);
  if (status != STATUS_OK) {
    goto done;
  }
  *ending = bistable_simulate(&system, &simulation, &t, &end);
  double wall_s = clock_wall_s() - wall, cpu_s = clock_cpu_s() - cpu;
  bool good = *ending == STATUS_OK;
  if (*ending == STATUS_NO_MEMORY || *ending == STATUS_INTERNAL || *ending == STATUS_INVALID) {
    *error = end;
    status = *ending;
    goto done;
  }
  *document = json_pack("{s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:[], s:o, s:{s:s, s:s}}", "status",
                        good ? "succeeded" : "diverged", "reason", good ? "" : status_word(*ending),
                        "message", good ? "" : end.message, "kind", "bistable", "name", spec->name,
                        "metrics", bistable_metrics(&system, &t), "warnings",
                        json_texts(t.warning[0], sizeof t.warning[0], t.warning_count), "artifacts",
                        "statistics", result_hlpv_statistics(&t.counts, wall_s, cpu_s),
                        "provenance", "version", PNEULAB_VERSION, "spec_hash", spec->hash);
  if (*document) {
    json_object_update_new(*document, bistable_parts(&system, &t));
    set_steps(json_object_get(*document, "metrics"), json_object_get(*document, "plateaus"));
  }
  if (!*document) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the result document");
    goto done;
  }
  add_computed(*document, computed);
done:
  json_decref(computed);
  bistable_trajectory_release(&t);
  system_close(&system);
  return status;
}
