#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "solver/base/clock.h"
#include "solver/job/json.h"
#include "solver/mesh/actuator.h"
#include "solver/post/fit.h"
#include "solver/post/result_internal.h"
#include "solver/post/suction.h"

static const double degree = M_PI / 180;

struct result *result_create(const struct job_spec *spec, struct fe_model *model) {
  struct result *r = calloc(1, sizeof *r);
  if (!r) {
    return NULL;
  }
  *r = (struct result){.spec = spec, .model = model, .onset = -1};
  r->sample = calloc((size_t)spec->load.steps + 1, sizeof *r->sample);
  r->midlines = json_array();
  r->artifacts = json_array();
  r->arc = json_array();
  if (!r->sample || !r->midlines || !r->artifacts || state_create(model, &r->first) != STATUS_OK ||
      state_create(model, &r->last) != STATUS_OK) {
    result_destroy(r);
    return NULL;
  }
  return r;
}

void result_destroy(struct result *r) {
  if (!r) {
    return;
  }
  free(r->sample);
  json_decref(r->midlines);
  json_decref(r->artifacts);
  json_decref(r->arc);
  export_destroy(r->export);
  state_release(&r->first);
  state_release(&r->last);
  free(r);
}

/* Pressure at which the gap closed between the last open state and `pressure`: extrapolated
 * from the two last open states, within that interval. */
static double contact_onset(const struct result *r, double pressure) {
  if (r->open_count == 0) {
    return pressure;
  }
  const struct open_state *near = &r->open[0], *far = &r->open[1];
  if (r->open_count < 2 || !(far->gap > near->gap) || !(near->pressure > far->pressure)) {
    return 0.5 * (near->pressure + pressure);
  }
  double rate = (far->gap - near->gap) / (near->pressure - far->pressure);
  return fmin(pressure, near->pressure + near->gap / rate);
}

static void follow_contact(struct result *r, const struct path_point *point,
                           const struct contact_summary *contact) {
  if (!isfinite(contact->min_gap) || r->onset >= 0) {
    return;
  }
  if (contact->active > 0 || contact->min_gap <= 0) {
    r->onset = contact_onset(r, point->pressure);
    return;
  }
  r->open[1] = r->open[0];
  r->open[0] = (struct open_state){point->pressure, contact->min_gap};
  r->open_count += r->open_count < 2;
}

/* Points of the bottom centreline in mm; u is NULL for the body at rest. */
static json_t *centreline(const struct result *r, const double *u) {
  const struct mesh *mesh = r->model->mesh;
  double *x = malloc(sizeof *x * 3 * (size_t)mesh->section_count);
  json_t *points = json_array();
  if (x) {
    shape_midline(mesh, u, x);
    for (int s = 0; s < mesh->section_count; s++) {
      json_array_append_new(
          points, json_pack("[fff]", 1e3 * x[3 * s], 1e3 * x[3 * s + 1], 1e3 * x[3 * s + 2]));
    }
  }
  free(x);
  return points;
}

static json_t *midline(const struct result *r, const double *u, double pressure) {
  return json_pack("{s:f, s:o}", "pressure_kPa", 1e-3 * pressure, "points_mm", centreline(r, u));
}

/* A state where a held load found no equilibrium: one line of the table of the arc. */
static enum status add_arc_point(struct result *r, const struct path_point *point) {
  struct sample s = {.pressure = point->pressure};
  enum status status = sample_measure(r->model, point->state, &s);
  r->arc_stretch = fmax(r->arc_stretch, s.max_stretch);
  if (status == STATUS_OK &&
      json_array_append_new(r->arc,
                            json_pack("{s:f, s:f, s:f, s:f}", "pressure_kPa", 1e-3 * s.pressure,
                                      "bending_angle_deg", s.shape.bending_angle / degree,
                                      "cavity_volume_mm3", 1e9 * s.cavity_volume, "max_stretch",
                                      s.max_stretch)) != 0) {
    status = STATUS_NO_MEMORY;
  }
  return status;
}

enum status result_add(struct result *r, const struct path_point *point) {
  struct fe_model *m = r->model;
  const struct fe_state *state = point->state;
  if (point->arc) {
    return add_arc_point(r, point);
  }
  model_update_gaps(m, state);
  struct contact_summary contact = contact_summarise(&m->contact);
  follow_contact(r, point, &contact);
  if (!point->recorded) {
    r->arc_stretch = fmax(r->arc_stretch, shape_stretch(m, state->u, NULL));
  }
  if (!point->recorded || r->sample_count > (size_t)r->spec->load.steps) {
    return STATUS_OK;
  }
  struct sample *s = &r->sample[r->sample_count];
  *s = (struct sample){.pressure = point->pressure, .iterations = point->iterations};
  enum status status = sample_measure(m, state, s);
  if (status != STATUS_OK) {
    return status;
  }
  r->penetration = fmax(r->penetration, s->penetration);
  if (r->sample_count == 0) {
    state_copy(m, &r->first, state);
  }
  state_copy(m, &r->last, state);
  r->sample_count++;
  if (json_array_append_new(r->midlines, midline(r, state->u, point->pressure)) != 0) {
    return STATUS_NO_MEMORY;
  }
  return r->export ? export_add(r->export, state, point->pressure, &r->failure) : STATUS_OK;
}

/* How the body lies in space. */
static void set_spatial(json_t *o, const struct spatial *s) {
  json_set_finite(o, "twist_angle_deg", s->twist / degree);
  json_set_finite(o, "side_bending_angle_deg", s->side_bending / degree);
  json_set_finite(o, "turn_angle_deg", s->turn / degree);
  json_set_finite(o, "end_bending_angle_deg", s->end_bending / degree);
  json_set_finite(o, "end_twist_angle_deg", s->end_twist / degree);
  json_set_finite(o, "reach_mm", 1e3 * s->reach);
  json_set_finite(o, "contraction_pct", 100 * s->contraction);
}

/* Forces and pressures of contact; for a body that can touch nothing there are none. */
static void set_contact(json_t *o, const struct sample *s) {
  if (!s->touching) {
    return;
  }
  json_set_finite(o, "contact_force_N", s->contact_force);
  json_set_finite(o, "contact_area_mm2", 1e6 * s->contact_area);
  json_set_finite(o, "max_contact_pressure_kPa", 1e-3 * s->contact_traction);
  for (int k = 0; k < s->plane_count; k++) {
    char key[32];
    snprintf(key, sizeof key, "plane_%d_force_N", k + 1);
    json_set_finite(o, key, s->plane_force[k]);
  }
}

static void set_stress(json_t *o, const struct stress_peak *s) {
  json_set_finite(o, "max_von_mises_kPa", 1e-3 * s->von_mises);
  json_set_finite(o, "max_principal_stress_kPa", 1e-3 * s->principal);
}

static json_t *sample_object(const struct sample *s) {
  json_t *o = json_object();
  json_set_finite(o, "pressure_kPa", 1e-3 * s->pressure);
  json_set_finite(o, "bending_angle_deg", s->shape.bending_angle / degree);
  json_set_finite(o, "chord_angle_deg", s->shape.chord_angle / degree);
  json_set_finite(o, "end_face_angle_deg", s->shape.end_face_angle / degree);
  json_set_finite(o, "tip_x_mm", 1e3 * s->shape.tip[0]);
  json_set_finite(o, "tip_y_mm", 1e3 * s->shape.tip[1]);
  json_set_finite(o, "tip_z_mm", 1e3 * s->shape.tip[2]);
  set_spatial(o, &s->spatial);
  json_set_finite(o, "cavity_volume_mm3", 1e9 * s->cavity_volume);
  json_set_finite(o, "min_gap_mm", 1e3 * s->min_gap);
  json_set_finite(o, "max_stretch", s->max_stretch);
  set_stress(o, &s->stress);
  set_contact(o, s);
  json_object_set_new(o, "newton_iterations", json_integer(s->iterations));
  return o;
}

json_t *result_samples(const struct result *r) {
  json_t *samples = json_array();
  for (size_t i = 0; i < r->sample_count; i++) {
    json_array_append_new(samples, sample_object(&r->sample[i]));
  }
  return samples;
}

/* Fit of the bending angle (deg) against the pressure (kPa). */
static bool fit_angle(const struct result *r, double from, double to, struct line_fit *fit) {
  double *x = malloc(sizeof *x * (r->sample_count + 1));
  double *y = malloc(sizeof *y * (r->sample_count + 1));
  bool good = x && y;
  for (size_t i = 0; good && i < r->sample_count; i++) {
    x[i] = 1e-3 * r->sample[i].pressure;
    y[i] = r->sample[i].shape.bending_angle / degree;
  }
  good = good && line_fit(x, y, r->sample_count, 1e-3 * from, 1e-3 * to, fit);
  free(x);
  free(y);
  return good;
}

static void set_suction(json_t *metrics, const struct job_spec *spec) {
  double force = 0;
  for (int k = 0; k < spec->pneunet.sucker_count; k++) {
    force += suction_force(spec, k);
  }
  if (spec->pneunet.sucker_count > 0) {
    json_set_finite(metrics, "suction_force_N", force);
    json_set_finite(metrics, "sucker_count", spec->pneunet.sucker_count);
  }
}

static json_t *metrics_object(const struct result *r) {
  const struct metric_spec *m = &r->spec->metrics;
  const struct mesh *mesh = r->model->mesh;
  json_t *o = json_object();
  double whole = mesh->half ? 2 : 1;
  json_set_finite(o, "mass_g",
                  1e3 * whole * r->model->reference_volume * r->spec->material.density_kg_m3);
  set_suction(o, r->spec);
  if (r->sample_count == 0) {
    return o;
  }
  const struct sample *s = &r->sample[r->sample_count - 1];
  json_set_finite(o, "bending_angle_deg", s->shape.bending_angle / degree);
  json_set_finite(o, "chord_angle_deg", s->shape.chord_angle / degree);
  json_set_finite(o, "end_face_angle_deg", s->shape.end_face_angle / degree);
  struct line_fit fit;
  if (fit_angle(r, m->fit_from, m->fit_to, &fit)) {
    json_set_finite(o, "sensitivity_deg_per_kPa", fit.slope);
    json_set_finite(o, "intercept_deg", fit.intercept);
    json_set_finite(o, "r_squared", fit.r_squared);
  }
  if (fit_angle(r, m->cai_from, m->cai_to, &fit)) {
    json_set_finite(o, "cai_rad_per_m_kPa", fit.slope * degree / actuator_length(r->spec));
  }
  json_set_finite(o, "tip_deflection_mm", 1e3 * s->tip_deflection);
  set_spatial(o, &s->spatial);
  if (r->onset >= 0) {
    json_set_finite(o, "contact_onset_kPa", 1e-3 * r->onset);
  }
  json_set_finite(o, "cavity_volume_mm3", 1e9 * s->cavity_volume);
  json_set_finite(o, "max_stretch", s->max_stretch);
  set_stress(o, &s->stress);
  set_contact(o, s);
  json_set_finite(o, "min_gap_mm", 1e3 * s->min_gap);
  json_set_finite(o, "max_penetration_mm", 1e3 * r->penetration);
  result_set_errors(r, o);
  return o;
}

static json_t *fit_object(const struct result *r) {
  const struct metric_spec *m = &r->spec->metrics;
  struct line_fit fit;
  if (!fit_angle(r, m->fit_from, m->fit_to, &fit)) {
    return json_null();
  }
  return json_pack("{s:f, s:f, s:f, s:f, s:f}", "from_kPa", 1e-3 * m->fit_from, "to_kPa",
                   1e-3 * m->fit_to, "slope_deg_per_kPa", fit.slope, "intercept_deg", fit.intercept,
                   "r_squared", fit.r_squared);
}

static json_t *statistics_object(const struct result *r, double wall_s, double cpu_s) {
  const struct fe_statistics *s = &r->model->statistics;
  struct ldlt_statistics l = r->model->factor;
  return json_pack(
      "{s:i, s:i, s:i, s:i, s:i, s:i, s:b, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}",
      "analyses", s->analyses, "unknowns", r->model->dof_count, "elements",
      r->model->mesh->element_count, "factorizations", s->factorizations, "newton_iterations",
      s->newton_iterations, "solves", s->solves, "warm_start", r->warm, "gflop_per_factorization",
      1e-9 * l.flops, "assembly_s", s->assembly_s, "residual_s", s->residual_s, "factor_s",
      s->factor_s, "solve_s", s->solve_s, "contact_s", s->contact_s, "estimate_s", r->estimate_s,
      "wall_s", wall_s, "cpu_s", cpu_s, "peak_memory_MB", clock_peak_memory_MB());
}

void result_note_start(struct result *r, bool warm) {
  r->warm = warm;
}

/* Highest pressure of the arc, kPa. */
static double arc_top(const struct result *r) {
  double top = 0;
  size_t index;
  json_t *point;
  json_array_foreach(r->arc, index, point) {
    top = fmax(top, json_number_value(json_object_get(point, "pressure_kPa")));
  }
  return top;
}

json_t *result_document(struct result *r, enum status status, const struct error *error,
                        double wall_s, double cpu_s) {
  bool good = status == STATUS_OK;
  json_t *metrics = metrics_object(r);
  if (status == STATUS_LIMIT_POINT) {
    json_set_finite(metrics, "limit_point_kPa", arc_top(r));
  }
  json_t *document =
      json_pack("{s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:O, s:o, s:o, s:O, s:o, s:{s:s, s:s}}",
                "status", good ? "succeeded" : "diverged", "reason",
                good ? "" : status_word(status), "message", good ? "" : error->message, "kind",
                "response", "name", r->spec->name, "metrics", metrics, "samples", result_samples(r),
                "midlines", r->midlines, "fit", fit_object(r), "warnings", result_warnings(r),
                "artifacts", r->artifacts, "statistics", statistics_object(r, wall_s, cpu_s),
                "provenance", "version", PNEULAB_VERSION, "spec_hash", r->spec->hash);
  if (document) {
    json_object_set_new(document, "rest_midline_mm", centreline(r, NULL));
  }
  json_t *suckers = suction_list(r->spec);
  if (document && suckers) {
    json_object_set(document, "suckers", suckers);
  }
  json_decref(suckers);
  if (document && json_array_size(r->arc) > 0) {
    json_object_set(document, "arc", r->arc);
  }
  return document;
}
