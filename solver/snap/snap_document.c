#include "solver/snap/snap_document.h"

#include <math.h>
#include <string.h>

#include "solver/job/json.h"

/* h of results: from the compressed state. */
static double h_mm(const struct snap_study *study, double elongation) {
  double from = study->metrics.compressed;
  return 1e3 * (elongation - (isfinite(from) ? from : 0.0));
}

static double rest_length(const struct snap_study *study) {
  double from = study->metrics.compressed;
  double computed = isfinite(from) ? study->body.length + from : NAN;
  return study->spec->rest_length > 0.0 ? study->spec->rest_length : computed;
}

/* ---- metrics ------------------------------------------------------------------------------ */

json_t *snap_document_metrics(const struct snap_study *study) {
  const struct snap_metrics *m = &study->metrics;
  double travel = -1e3 * m->compressed, rest = rest_length(study);
  json_t *o = json_object();
  json_set_finite(o, "trigger_pressure_kPa", 1e-3 * m->trigger_pressure);
  json_set_finite(o, "release_pressure_kPa", 1e-3 * m->release_pressure);
  json_object_set_new(o, "stable_states", json_integer(m->stable_states));
  json_set_finite(o, "travel_mm", travel);
  json_set_finite(o, "travel_per_pair_mm", travel / study->spec->pair_count);
  json_set_finite(o, "natural_length_mm", 1e3 * study->body.length);
  json_set_finite(o, "compressed_length_mm", 1e3 * (study->body.length + m->compressed));
  json_set_finite(o, "energy_barrier_mJ", 1e3 * m->barrier);
  json_set_finite(o, "return_barrier_mJ", 1e3 * m->return_barrier);
  json_set_finite(o, "energy_released_mJ", 1e3 * m->released);
  json_set_finite(o, "snap_force_N", m->snap_force);
  json_set_finite(o, "return_force_N", m->return_force);
  json_set_finite(o, "extension_ratio", 1e-3 * h_mm(study, m->stretched) / rest);
  json_set_finite(o, "held_force_N", m->held_force);
  json_set_finite(o, "force_per_pressure_N_per_kPa", 1e3 * m->force_per_pressure);
  json_set_finite(o, "pet_strain_max_pct", 100.0 * m->pet_strain);
  json_set_finite(o, "contact_onset_kPa", 1e-3 * m->contact_onset);
  json_set_finite(o, "axisymmetric_to_kPa", 1e-3 * m->axisymmetric_to);
  if (m->critical_harmonic >= 0) {
    json_object_set_new(o, "critical_harmonic", json_integer(m->critical_harmonic));
  }
  return o;
}

/* ---- paths -------------------------------------------------------------------------------- */

static json_t *point_object(const struct snap_study *study, const struct snap_path *path,
                            const struct snap_point *p) {
  json_t *o = json_object();
  int negative = path->control == SNAP_BY_PRESSURE_HELD ? p->negative_held : p->negative_free;
  json_set_finite(o, "pressure_kPa", 1e-3 * p->pressure);
  json_set_finite(o, "force_N", p->force);
  json_set_finite(o, "h_mm", h_mm(study, p->elongation));
  json_set_finite(o, "extension_ratio", 1e-3 * h_mm(study, p->elongation) / rest_length(study));
  json_set_finite(o, "volume_mm3", 1e9 * p->volume);
  json_set_finite(o, "energy_mJ", 1e3 * p->energy);
  json_set_finite(o, "stiffness_N_per_mm", 1e-3 * p->stiffness);
  json_object_set_new(o, "stable", json_boolean(negative == 0));
  json_object_set_new(o, "stable_in_length", json_boolean(p->negative_held == 0));
  json_object_set_new(o, "negative_pivots", json_integer(negative));
  json_object_set_new(o, "inverted_shells", json_integer(p->inverted));
  json_set_finite(o, "pet_strain_pct", 100.0 * p->pet_strain);
  json_object_set_new(o, "touching", json_boolean(p->touching));
  return o;
}

static json_t *points_array(const struct snap_study *study, const struct snap_path *path) {
  json_t *points = json_array();
  for (int i = 0; i < path->count; i++) {
    json_array_append_new(points, point_object(study, path, &path->point[i]));
  }
  return points;
}

json_t *snap_document_paths(const struct snap_study *study) {
  json_t *paths = json_array();
  for (int i = 0; i < study->path_count; i++) {
    const struct snap_path *path = &study->path[i];
    json_array_append_new(
        paths, json_pack("{s:s, s:o}", "name", path->name, "points", points_array(study, path)));
  }
  return paths;
}

json_t *snap_document_events(const struct snap_study *study) {
  static const char *const types[] = {[SNAP_LIMIT_POINT] = "limit point",
                                      [SNAP_STABLE_STATE] = "stable state",
                                      [SNAP_LOSS_OF_AXISYMMETRY] = "loss of axisymmetry",
                                      [SNAP_TOUCH] = "contact",
                                      [SNAP_YIELD] = "yield"};
  json_t *events = json_array();
  for (int i = 0; i < study->event_count; i++) {
    const struct snap_event *event = &study->event[i];
    json_t *o = json_pack("{s:s, s:s}", "path", event->path, "type", types[event->type]);
    json_set_finite(o, "pressure_kPa", 1e-3 * event->pressure);
    json_set_finite(o, "force_N", event->force);
    json_set_finite(o, "h_mm", h_mm(study, event->elongation));
    if (event->harmonic >= 0) {
      json_object_set_new(o, "harmonic", json_integer(event->harmonic));
    }
    json_array_append_new(events, o);
  }
  return events;
}

json_t *snap_document_held(const struct snap_study *study) {
  json_t *held = json_array();
  for (int i = 0; i < study->held.count; i++) {
    const struct snap_point *p = &study->held.point[i];
    json_array_append_new(held, json_pack("{s:f, s:f}", "pressure_kPa", 1e-3 * p->pressure,
                                          "force_N", 0.0 - p->force));
  }
  return held;
}

json_t *snap_document_stairs(const struct snap_study *study) {
  json_t *stairs = json_array();
  for (int k = study->spec->pair_count - 1; k >= 0; k--) {
    const struct snap_stair *stair = &study->stair[k];
    if (stair->known) {
      json_t *o = json_pack("{s:i, s:f}", "folded_pairs", k + 1, "h_mm",
                            h_mm(study, stair->state.elongation));
      json_set_finite(o, "trigger_pressure_kPa", 1e-3 * stair->trigger);
      json_array_append_new(stairs, o);
    }
  }
  return stairs;
}

json_t *snap_document_shapes(const struct snap_study *study) {
  static const char *const names[SNAP_MARKS] = {"natural",        "compressed", "at the trigger",
                                                "after the snap", "stretched",  "at the release"};
  static const enum snap_mark order[SNAP_MARKS] = {SNAP_COMPRESSED, SNAP_TRIGGER, SNAP_SNAPPED,
                                                   SNAP_STRETCHED,  SNAP_NATURAL, SNAP_RELEASE};
  json_t *shapes = json_array();
  for (int i = 0; i < SNAP_MARKS; i++) {
    enum snap_mark m = order[i];
    const struct axi_state *state = &study->state[m];
    if (study->has[m]) {
      json_array_append_new(shapes,
                            json_pack("{s:s, s:f, s:f, s:f, s:o}", "name", names[m], "pressure_kPa",
                                      1e-3 * state->pressure, "force_N", state->force, "h_mm",
                                      h_mm(study, state->elongation), "regions",
                                      study->body.outlines(study->body.self, state->u)));
    }
  }
  return shapes;
}

json_t *snap_document_law(const struct snap_study *study) {
  json_t *law = json_array();
  for (int i = 0; i < study->law_count; i++) {
    const struct snap_path *path = &study->law[i];
    json_t *points = json_array();
    for (int k = 0; k < path->count; k++) {
      const struct snap_point *p = &path->point[k];
      json_array_append_new(
          points, json_pack("{s:f, s:f, s:f, s:f, s:b}", "h_mm", h_mm(study, p->elongation),
                            "force_N", p->force, "volume_mm3", 1e9 * p->volume, "energy_mJ",
                            1e3 * p->energy, "stable_in_length", p->negative_held == 0));
    }
    json_array_append_new(
        law, json_pack("{s:f, s:o}", "pressure_kPa", 1e-3 * study->spec->law[i], "points", points));
  }
  return law;
}

json_t *snap_document_harmonics(const struct snap_study *study) {
  json_t *harmonics = json_array();
  for (int i = 0; i < study->waves_count; i++) {
    const struct snap_waves *waves = &study->waves[i];
    json_t *negative = json_array();
    for (int n = 0; n <= study->spec->harmonics_to; n++) {
      json_array_append_new(negative, json_integer(waves->negative[n]));
    }
    json_array_append_new(harmonics,
                          json_pack("{s:s, s:f, s:f, s:o}", "path", waves->path, "pressure_kPa",
                                    1e-3 * waves->pressure, "h_mm", h_mm(study, waves->elongation),
                                    "negative", negative));
  }
  return harmonics;
}

json_t *snap_document_warnings(const struct snap_study *study) {
  json_t *warnings = json_array();
  for (int i = 0; i < study->warning_count; i++) {
    json_array_append_new(warnings, json_string(study->warning[i]));
  }
  return warnings;
}

json_t *snap_document_calibration(const struct snap_spec *spec,
                                  const struct calibrate_result *result) {
  const struct snap_calibrate *c = &spec->calibrate;
  double unit = strstr(c->metric, "_kPa") ? 1e3 : 1e-3;
  char key[40];
  snprintf(key, sizeof key, "number_%s", c->unit);
  json_t *tried = json_array();
  for (int i = 0; i < result->count; i++) {
    json_t *o = json_object();
    json_set_finite(o, key, result->number[i] / c->unit_si);
    json_set_finite(o, c->metric, result->metric[i] / unit);
    json_array_append_new(tried, o);
  }
  double found;
  memcpy(&found, (const char *)&spec->given + c->offset, sizeof found);
  json_t *o = json_pack("{s:s, s:s, s:f, s:o}", "pointer", c->pointer, "metric", c->metric,
                        "target", c->target / unit, "tried", tried);
  json_set_finite(o, key, found / c->unit_si);
  return o;
}
