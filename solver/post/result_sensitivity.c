#include "solver/post/result_sensitivity.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/job/json.h"
#include "solver/post/fit.h"
#include "solver/post/shape.h"
#include "solver/post/variation.h"

/* Displacement of one node, relative to the body's length, from which the change of an angle is
 * taken. */
static const double probe = 1e-5;

/* Doubt about the contact that is mentioned. */
static const double doubt_worth_a_word = 1e-4;

/* What is differentiated at every recorded pressure, in the units of the result. */
enum quantity {
  BENDING_ANGLE,
  CHORD_ANGLE,
  END_FACE_ANGLE,
  TIP_DEFLECTION,
  TIP_X,
  TIP_Y,
  TIP_Z,
  CAVITY_VOLUME,
  QUANTITIES
};

static const char *const quantity_key[QUANTITIES] = {
    "bending_angle_deg", "chord_angle_deg", "end_face_angle_deg", "tip_deflection_mm",
    "tip_x_mm",          "tip_y_mm",        "tip_z_mm",           "cavity_volume_mm3"};

/* One recorded state. */
struct derivatives {
  double pressure;            /* Pa */
  bool known;                 /* false when the tangent there could not be found */
  double doubt;               /* relative, from contact that has not settled */
  double (*row)[QUANTITIES];  /* per unit of each parameter */
  double to_load[QUANTITIES]; /* per kPa */
  double *midline;            /* count x section_count x 3, mm per unit; NULL unless asked for */
};

struct result_sensitivity {
  const struct job_spec *spec;
  struct sensitivity *linear;
  struct variation *variation; /* one a parameter */
  double *mass;                /* derivative of the mass, g per unit of each parameter */
  int count;
  double *gradient;        /* QUANTITIES x dof_count: derivatives to u, then adjoint solutions */
  double *residual;        /* dof_count */
  double *u;               /* node_count x 3 */
  unsigned char *measured; /* node_count: 1 where a position enters an angle or the tip */
  struct derivatives *state;
  int state_count;
};

/* ---- the quantities of the body in place --------------------------------------------------- */

static double whole(const struct result_sensitivity *r) {
  return r->linear->mesh.half ? 2 : 1;
}

/* Angles and tip with displacements u. */
static void measure_shape(const struct result_sensitivity *r, const double *u,
                          double out[QUANTITIES]) {
  const double degree = M_PI / 180;
  const struct mesh *mesh = &r->linear->mesh;
  struct shape shape;
  shape_measure(mesh, u, &shape);
  double rest = mesh->x[3 * mesh->centreline[mesh->section_count - 1] + 2];
  out[BENDING_ANGLE] = shape.bending_angle / degree;
  out[CHORD_ANGLE] = shape.chord_angle / degree;
  out[END_FACE_ANGLE] = shape.end_face_angle / degree;
  out[TIP_DEFLECTION] = 1e3 * (rest - shape.tip[2]);
  out[TIP_X] = 1e3 * shape.tip[0];
  out[TIP_Y] = 1e3 * shape.tip[1];
  out[TIP_Z] = 1e3 * shape.tip[2];
}

static void measure_all(const struct result_sensitivity *r, double out[QUANTITIES]) {
  const struct sensitivity *s = r->linear;
  measure_shape(r, s->state.u, out);
  out[CAVITY_VOLUME] = 1e9 * whole(r) * model_volume(s->model, &s->state, NULL);
}

static double measure_mass(const struct result_sensitivity *r) {
  const struct fe_model *m = r->linear->model;
  return 1e3 * whole(r) * m->reference_volume * m->material.density_kg_m3;
}

/* Angles and tip depend on the stations, and on the bottom layer of the last section. */
static void mark_measured(struct result_sensitivity *r) {
  const struct mesh *mesh = &r->linear->mesh;
  for (int n = 0; n < mesh->node_count; n++) {
    r->measured[n] = mesh->node_core[n] && mesh->node_section[n] == mesh->section_count - 1;
  }
  for (int s = 0; s < mesh->station_count; s++) {
    r->measured[mesh->centreline[mesh->station[s]]] = 1;
  }
  r->measured[mesh->centreline[mesh->section_count - 1]] = 1;
}

/* Derivatives of all quantities to the displacements. */
static void find_gradients(struct result_sensitivity *r) {
  const struct sensitivity *s = r->linear;
  const struct fe_model *m = s->model;
  size_t dofs = (size_t)m->dof_count;
  double step = probe * s->length, *volume = r->gradient + dofs * CAVITY_VOLUME;
  memset(r->gradient, 0, sizeof *r->gradient * dofs * QUANTITIES);
  memcpy(r->u, s->state.u, sizeof *r->u * 3 * (size_t)s->mesh.node_count);
  for (int d = 0; d < 3 * s->mesh.node_count; d++) {
    if (!r->measured[d / 3] || m->equation[d] < 0) {
      continue;
    }
    double low[QUANTITIES], high[QUANTITIES], kept = r->u[d];
    r->u[d] = kept - step;
    measure_shape(r, r->u, low);
    r->u[d] = kept + step;
    measure_shape(r, r->u, high);
    r->u[d] = kept;
    for (int k = 0; k < CAVITY_VOLUME; k++) {
      r->gradient[dofs * (size_t)k + (size_t)m->equation[d]] = (high[k] - low[k]) / (2 * step);
    }
  }
  model_volume(m, &s->state, volume);
  for (size_t i = 0; i < dofs; i++) {
    volume[i] *= 1e9 * whole(r);
  }
}

/* ---- derivatives of one state -------------------------------------------------------------- */

static double dot(int n, const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < n; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

/* To the pressure: the residual grows by the force of unit pressure, minus the gradient of the
 * volume. */
static void differentiate_by_pressure(struct result_sensitivity *r, double out[QUANTITIES]) {
  const struct sensitivity *s = r->linear;
  int dofs = s->model->dof_count;
  model_volume(s->model, &s->state, r->residual);
  for (int k = 0; k < QUANTITIES; k++) {
    out[k] = 1e3 * dot(dofs, r->gradient + (size_t)dofs * (size_t)k, r->residual);
  }
}

/* dm/dtheta = m,theta - z . R,theta from the two sides of the variation. Returns false when one of
 * them cannot be evaluated. */
static bool differentiate_by(struct result_sensitivity *r, int parameter, double out[QUANTITIES]) {
  const struct variation *v = &r->variation[parameter];
  struct sensitivity *s = r->linear;
  int dofs = s->model->dof_count;
  double value[2][QUANTITIES], mass[2];
  for (int k = 0; k < 2; k++) {
    if (sensitivity_place(s, &v->side[k]) != STATUS_OK || sensitivity_residual(s) != STATUS_OK) {
      return false;
    }
    measure_all(r, value[k]);
    mass[k] = measure_mass(r);
    for (int i = 0; i < dofs; i++) {
      r->residual[i] = s->model->residual[i] - (k ? r->residual[i] : 0);
    }
  }
  r->mass[parameter] = v->scale * (mass[1] - mass[0]);
  for (int k = 0; k < QUANTITIES; k++) {
    const double *adjoint = r->gradient + (size_t)dofs * (size_t)k;
    out[k] = v->scale * (value[1][k] - value[0][k] - dot(dofs, adjoint, r->residual));
  }
  return true;
}

/* The points of the midline by the direct method: what moves is the body at rest and, by
 * K du/dtheta = -R,theta, the displacements. r->residual holds the difference of the residuals of
 * the two sides; it is used up. */
static void differentiate_midline(struct result_sensitivity *r, int parameter, double *out) {
  const struct variation *v = &r->variation[parameter];
  const struct sensitivity *s = r->linear;
  sensitivity_adjoint(r->linear, r->residual, r->residual);
  for (int k = 0; k < 3 * s->mesh.section_count; k++) {
    int d = 3 * s->mesh.centreline[k / 3] + k % 3, equation = s->model->equation[d];
    double moved = equation >= 0 ? -r->residual[equation] : 0;
    out[k] = 1e3 * v->scale * (v->side[1].x[d] - v->side[0].x[d] + moved);
  }
}

static size_t midline_size(const struct result_sensitivity *r) {
  return 3 * (size_t)r->linear->mesh.section_count;
}

static void differentiate(struct result_sensitivity *r, struct derivatives *d) {
  struct sensitivity *s = r->linear;
  size_t dofs = (size_t)s->model->dof_count;
  find_gradients(r);
  for (int k = 0; k < QUANTITIES; k++) {
    sensitivity_adjoint(s, r->gradient + dofs * (size_t)k, r->gradient + dofs * (size_t)k);
  }
  differentiate_by_pressure(r, d->to_load);
  d->known = true;
  d->doubt = s->doubt;
  for (int p = 0; p < r->count; p++) {
    if (r->variation[p].scale > 0) {
      d->known = d->known && differentiate_by(r, p, d->row[p]);
      if (d->known && d->midline) {
        differentiate_midline(r, p, d->midline + midline_size(r) * (size_t)p);
      }
    }
  }
}

enum status result_sensitivity_add(struct result_sensitivity *r, const struct path_point *point) {
  if (!point->recorded || r->state_count > r->spec->load.steps) {
    return STATUS_OK;
  }
  struct derivatives *d = &r->state[r->state_count];
  d->pressure = point->pressure;
  d->row = calloc((size_t)r->count, sizeof *d->row);
  if (r->spec->sensitivity.midline) {
    d->midline = calloc((size_t)r->count * midline_size(r) + 1, sizeof *d->midline);
  }
  r->state_count++;
  if (!d->row || (r->spec->sensitivity.midline && !d->midline)) {
    return STATUS_NO_MEMORY;
  }
  struct fe_load load = {point->pressure, point->pressure, point->dead};
  enum status status = sensitivity_linearise(r->linear, point->state, &load);
  if (status == STATUS_OK) {
    differentiate(r, d);
  }
  return status == STATUS_NO_MEMORY ? status : STATUS_OK;
}

/* ---- creation ------------------------------------------------------------------------------ */

enum status result_sensitivity_create(const struct job_spec *spec, const struct fe_model *model,
                                      struct result_sensitivity **out, struct error *error) {
  struct result_sensitivity *r = calloc(1, sizeof *r);
  const size_t nodes = (size_t)model->mesh->node_count,
               parameters = (size_t)spec->sensitivity.count;
  *out = NULL;
  if (!r) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for derivatives");
  }
  r->spec = spec;
  enum status status = sensitivity_create(model, spec->load.gravity, &r->linear, error);
  if (status != STATUS_OK) {
    goto done;
  }
  r->variation = calloc(parameters + 1, sizeof *r->variation);
  r->mass = calloc(parameters + 1, sizeof *r->mass);
  r->gradient = calloc((size_t)r->linear->model->dof_count * QUANTITIES, sizeof *r->gradient);
  r->residual = calloc((size_t)r->linear->model->dof_count, sizeof *r->residual);
  r->u = calloc(3 * nodes, sizeof *r->u);
  r->measured = calloc(nodes, 1);
  r->state = calloc((size_t)spec->load.steps + 1, sizeof *r->state);
  bool enough =
      r->variation && r->mass && r->gradient && r->residual && r->u && r->measured && r->state;
  status = enough ? STATUS_OK : STATUS_NO_MEMORY;
  for (size_t p = 0; status == STATUS_OK && p < parameters; p++) {
    status = variation_create(spec, model->mesh, &r->linear->original,
                              &spec->sensitivity.parameter[p], &r->variation[r->count++]);
  }
  if (status == STATUS_OK) {
    mark_measured(r);
  } else {
    error_set(error, status, NULL, "no memory for derivatives");
  }
done:
  if (status != STATUS_OK) {
    result_sensitivity_destroy(r);
    return status;
  }
  *out = r;
  return STATUS_OK;
}

void result_sensitivity_destroy(struct result_sensitivity *r) {
  if (!r) {
    return;
  }
  for (int p = 0; p < r->count; p++) {
    variation_release(&r->variation[p]);
  }
  for (int i = 0; i < r->state_count; i++) {
    free(r->state[i].row);
    free(r->state[i].midline);
  }
  sensitivity_destroy(r->linear);
  free(r->variation);
  free(r->mass);
  free(r->gradient);
  free(r->residual);
  free(r->u);
  free(r->measured);
  free(r->state);
  free(r);
}

/* ---- the block ----------------------------------------------------------------------------- */

/* Row of a state: that of a parameter, or of the pressure for a negative one. */
static const double *row_of(const struct derivatives *d, int parameter) {
  return parameter < 0 ? d->to_load : d->row[parameter];
}

/* Whether quantity k is what samples hold under its name: the bending of a spatial body is that of
 * its sections, not of the stations, and cavities of unequal pressures count unequally here. */
static bool is_sampled(const struct result_sensitivity *r, int k) {
  const double *share = r->linear->model->cavity_share;
  return k == BENDING_ANGLE   ? !r->linear->mesh.spatial
         : k == CAVITY_VOLUME ? share[0] == share[1]
                              : true;
}

static void set_row(const struct result_sensitivity *r, json_t *object, int parameter,
                    const double row[QUANTITIES]) {
  /* Half a model cannot tell which way a body of unequal sides turns. */
  bool lopsided = parameter >= 0 && variation_one_sided(r->spec, r->variation[parameter].parameter);
  for (int k = 0; k < QUANTITIES; k++) {
    if ((k != TIP_Y || !lopsided) && is_sampled(r, k)) {
      json_set_finite(object, quantity_key[k], row[k]);
    }
  }
}

/* Sets the derivatives of the midline's points, which half a model cannot tell to a taper of one
 * side. */
static void set_midline(const struct result_sensitivity *r, json_t *object, int parameter,
                        const struct derivatives *d) {
  if (!d->midline || parameter < 0 ||
      variation_one_sided(r->spec, r->variation[parameter].parameter)) {
    return;
  }
  const double *point = d->midline + midline_size(r) * (size_t)parameter;
  json_t *points = json_array();
  for (int s = 0; s < r->linear->mesh.section_count; s++, point += 3) {
    json_array_append_new(points, json_pack("[f, f, f]", point[0], point[1], point[2]));
  }
  json_object_set_new(object, "midline_mm", points);
}

static json_t *sample_rows(const struct result_sensitivity *r, int parameter) {
  json_t *samples = json_array();
  for (int i = 0; i < r->state_count; i++) {
    json_t *sample = json_pack("{s:f}", "pressure_kPa", 1e-3 * r->state[i].pressure);
    if (r->state[i].known) {
      set_row(r, sample, parameter, row_of(&r->state[i], parameter));
      set_midline(r, sample, parameter, &r->state[i]);
    }
    json_array_append_new(samples, sample);
  }
  return samples;
}

/* The slope of the straight line is linear in the angles, so its derivative is the slope of their
 * derivatives. */
static double slope_derivative(const struct result_sensitivity *r, int parameter) {
  const struct metric_spec *m = &r->spec->metrics;
  double *x = malloc(sizeof *x * ((size_t)r->state_count + 1));
  double *y = malloc(sizeof *y * ((size_t)r->state_count + 1));
  struct line_fit fit = {.slope = NAN};
  for (int i = 0; x && y && i < r->state_count; i++) {
    x[i] = 1e-3 * r->state[i].pressure;
    y[i] = r->state[i].known ? r->state[i].row[parameter][BENDING_ANGLE] : NAN;
  }
  bool good =
      x && y && line_fit(x, y, (size_t)r->state_count, 1e-3 * m->fit_from, 1e-3 * m->fit_to, &fit);
  free(x);
  free(y);
  return good ? fit.slope : NAN;
}

static json_t *metric_row(const struct result_sensitivity *r, int parameter) {
  json_t *metrics = json_object();
  if (r->state_count > 0 && r->state[r->state_count - 1].known) {
    set_row(r, metrics, parameter, r->state[r->state_count - 1].row[parameter]);
    json_object_del(metrics, quantity_key[TIP_X]);
    json_object_del(metrics, quantity_key[TIP_Y]);
    json_object_del(metrics, quantity_key[TIP_Z]);
    json_set_finite(metrics, "mass_g", r->mass[parameter]);
  }
  if (is_sampled(r, BENDING_ANGLE)) {
    json_set_finite(metrics, "sensitivity_deg_per_kPa", slope_derivative(r, parameter));
  }
  return metrics;
}

json_t *result_sensitivity_block(const struct result_sensitivity *r) {
  json_t *parameters = json_array();
  for (int p = 0; p < r->count; p++) {
    const struct variation *v = &r->variation[p];
    json_t *entry =
        json_pack("{s:s, s:s, s:f}", "parameter", v->parameter->pointer, "unit", v->parameter->unit,
                  "value", parameter_value(r->spec, v->parameter) / v->parameter->unit_si);
    if (v->scale > 0) {
      json_object_set_new(entry, "metrics", metric_row(r, p));
      json_object_set_new(entry, "samples", sample_rows(r, p));
    }
    json_array_append_new(parameters, entry);
  }
  return json_pack("{s:o, s:{s:s, s:o}}", "parameters", parameters, "pressure", "unit", "kPa",
                   "samples", sample_rows(r, -1));
}

/* Appends a sentence to the warnings. */
static void warn(json_t *warnings, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void warn(json_t *warnings, const char *format, ...) {
  char sentence[200];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(sentence, sizeof sentence, format, arguments);
  va_end(arguments);
  json_array_append_new(warnings, json_string(sentence));
}

enum status result_sensitivity_store(const struct result_sensitivity *r, json_t *document) {
  json_t *warnings = json_object_get(document, "warnings");
  for (int p = 0; p < r->count; p++) {
    if (r->variation[p].scale == 0) {
      warn(warnings, "no derivatives to %s: at this value the body changes its layout",
           r->variation[p].parameter->pointer);
    }
  }
  for (int i = 0; i < r->state_count; i++) {
    if (!r->state[i].known) {
      warn(warnings, "no derivatives at %.6g kPa: the contact does not settle there",
           1e-3 * r->state[i].pressure);
    } else if (r->state[i].doubt > doubt_worth_a_word) {
      warn(warnings,
           "the contact at %.6g kPa settles slowly: the derivatives there may be off by "
           "%.1g %%",
           1e-3 * r->state[i].pressure, 100 * r->state[i].doubt);
    }
  }
  json_t *block = result_sensitivity_block(r);
  return json_object_set_new(document, "sensitivity", block) == 0 ? STATUS_OK : STATUS_NO_MEMORY;
}
