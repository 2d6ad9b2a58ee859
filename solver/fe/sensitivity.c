#include "solver/fe/sensitivity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A closed contact this much stiffer than its penalty is rigid to more digits than derivatives
 * are given with, and still far from the limits of the factorisation. */
static const double rigid_contact = 1e5;

/* Accuracy of the states that are linearised about: displacements relative to the body's length,
 * contact tractions relative to the pressure, and to the shear modulus. */
static const double step_tolerance = 1e-9;
static const double traction_tolerance = 1e-6;
static const double traction_floor = 1e-8;

/* A correction of this part of the body's length, found with the multipliers following, tells
 * that contact has not settled: the tangent would be that of points about to part. */
static const double unsettled = 1e-5;

enum { CORRECTIONS = 4 };

enum status sensitivity_create(const struct mesh *mesh, const struct material_spec *material,
                               bool use_contact, const double gravity[3], struct sensitivity **out,
                               struct error *error) {
  size_t size = sizeof(double) * 3 * (size_t)mesh->node_count;
  struct sensitivity *s = calloc(1, sizeof *s);
  enum status status = STATUS_NO_MEMORY;
  *out = NULL;
  if (!s) {
    goto done;
  }
  s->mesh = *mesh;
  s->mesh.x = malloc(size);
  s->x = malloc(size);
  if (!s->mesh.x || !s->x) {
    goto done;
  }
  memcpy(s->mesh.x, mesh->x, size);
  memcpy(s->x, mesh->x, size);
  status = model_create(&s->mesh, material, use_contact, &s->model, error);
  if (status != STATUS_OK) {
    goto done;
  }
  model_add_gravity(s->model, gravity);
  memcpy(s->gravity, gravity, sizeof s->gravity);
  s->original = (struct variant){s->x, mesh->gap_width, mesh->wall_thickness, material};
  s->stiffness = s->model->contact.stiffness;
  s->smoothing = s->model->contact.smoothing;
  s->cap = rigid_contact;
  s->step = malloc(sizeof *s->step * ((size_t)s->model->dof_count + 1));
  status = s->step ? state_create(s->model, &s->state) : STATUS_NO_MEMORY;
  if (status == STATUS_OK) {
    status = equilibrium_create(s->model, &s->solver, error);
  }
  if (status == STATUS_OK) {
    s->length = 4 * s->solver->options.longest_step;
    s->solver->options.step_tolerance = step_tolerance * s->length;
  }
done:
  if (status == STATUS_NO_MEMORY) {
    error_set(error, status, NULL, "no memory for derivatives");
  }
  if (status != STATUS_OK) {
    sensitivity_destroy(s);
    return status;
  }
  *out = s;
  return STATUS_OK;
}

void sensitivity_destroy(struct sensitivity *s) {
  if (!s) {
    return;
  }
  state_release(&s->state);
  equilibrium_destroy(s->solver);
  model_destroy(s->model);
  free(s->mesh.x);
  free(s->x);
  free(s->step);
  free(s);
}

/* ---- the linearisation -------------------------------------------------------------------- */

/* Newton's step about s->state with multipliers that follow, into s->step. Returns its root mean
 * square nodal length, or a negative number when an element is turned inside out. */
static double find_step(struct sensitivity *s) {
  struct fe_model *m = s->model;
  double sum = 0;
  contact_follow(&m->contact, 0);
  if (model_search_contact(m, &s->state) != STATUS_OK ||
      model_evaluate(m, &s->state, &s->load, false) != STATUS_OK) {
    return -1;
  }
  contact_follow(&m->contact, s->cap);
  if (model_evaluate(m, &s->state, &s->load, true) != STATUS_OK) {
    return -1;
  }
  model_factor(m);
  model_solve(m, m->residual, s->step);
  for (int i = 0; i < m->dof_count; i++) {
    s->step[i] = -s->step[i];
    sum += s->step[i] * s->step[i];
  }
  return sqrt(3 * sum / m->dof_count);
}

static void take_step(struct sensitivity *s) {
  struct fe_model *m = s->model;
  model_recover(m, &s->state, s->step, 1);
  for (int d = 0; d < 3 * s->mesh.node_count; d++) {
    s->state.u[d] += m->equation[d] >= 0 ? s->step[m->equation[d]] : 0;
  }
  model_evaluate(m, &s->state, &s->load, false);
  for (int i = 0; i < m->contact.point_count; i++) {
    m->contact.point[i].lambda = fmax(0, m->contact.point[i].traction);
  }
}

/* Brings s->state closer to equilibrium than it came from the load path, first as the path does,
 * with held multipliers, which finds out what touches. Where that fails the state stays. */
static void settle(struct sensitivity *s, const struct fe_state *state) {
  struct fe_model *m = s->model;
  double mu = material_shear_modulus(&m->material);
  int iterations;
  contact_follow(&m->contact, 0);
  s->solver->factor_fits = false;
  s->solver->options.traction_tolerance =
      fmax(traction_tolerance * s->load.pressure, traction_floor * mu);
  state_copy(m, &s->state, state);
  enum status status =
      equilibrium_solve(s->solver, &s->load, s->load.pressure, &s->state, &iterations);
  if (status != STATUS_OK) {
    state_copy(m, &s->state, state);
  }
  for (int i = 0; i < m->contact.point_count; i++) {
    m->contact.point[i].lambda = s->state.lambda[i];
  }
}

enum status sensitivity_linearise(struct sensitivity *s, const struct fe_state *state,
                                  const struct fe_load *load) {
  enum status status = sensitivity_place(s, &s->original);
  if (status != STATUS_OK) {
    return status;
  }
  s->load = *load;
  s->load.stiffness_pressure = load->pressure;
  settle(s, state);
  double size = find_step(s);
  for (int k = 0; size > step_tolerance * s->length && k < CORRECTIONS; k++) {
    take_step(s);
    size = find_step(s);
  }
  if (size < 0) {
    return STATUS_INVERTED;
  }
  return size < unsettled * s->length ? STATUS_OK : STATUS_DIVERGED;
}

void sensitivity_adjoint(struct sensitivity *s, const double *gradient, double *z) {
  model_solve(s->model, gradient, z);
}

/* ---- variants ----------------------------------------------------------------------------- */

/* Moves the nodes and renews the geometry of the elements that they belong to. */
static enum status move_nodes(struct sensitivity *s, const double *x) {
  struct fe_model *m = s->model;
  m->reference_volume = 0;
  for (int e = 0; e < s->mesh.element_count; e++) {
    const int *nodes = s->mesh.element_nodes + (size_t)HEX27_NODES * (size_t)e;
    double corner[HEX27_NODES][3], volume = 0;
    bool moved = false;
    for (int a = 0; a < HEX27_NODES; a++) {
      memcpy(corner[a], x + 3 * nodes[a], sizeof corner[a]);
      moved = moved || memcmp(corner[a], s->mesh.x + 3 * nodes[a], sizeof corner[a]) != 0;
    }
    if (moved && !(element_geometry_fill(&m->hex27, corner, &m->geometry[e]) > 0)) {
      return STATUS_GEOMETRY;
    }
    for (int q = 0; q < HEX27_POINTS; q++) {
      volume += m->geometry[e].weight[q];
    }
    m->reference_volume += volume;
  }
  memcpy(s->mesh.x, x, sizeof *x * 3 * (size_t)s->mesh.node_count);
  return STATUS_OK;
}

/* What the smoothing of the contact is in proportion to. */
static double smoothing_scale(const struct variant *v) {
  return v->gap_width > 0 ? fmin(v->gap_width, v->wall_thickness) : v->wall_thickness;
}

/* Reference areas, and the scales of the law in the proportion in which model_create chose them. */
static enum status renew_contact(struct sensitivity *s, const struct variant *v) {
  struct contact *contact = &s->model->contact, fresh;
  const struct variant *o = &s->original;
  int surface = QUAD9_POINTS * contact->face_count;
  if (!s->model->use_contact) {
    return STATUS_OK;
  }
  enum status status = contact_init(&fresh, &s->mesh, &s->model->quad9, NULL);
  if (status != STATUS_OK) {
    return status;
  }
  for (int i = 0; i < contact->point_count; i++) { /* those of planes repeat the surface */
    contact->point[i].area = fresh.point[i % surface].area;
  }
  contact_release(&fresh);
  double softening = material_shear_modulus(v->material) / material_shear_modulus(o->material);
  contact->stiffness = s->stiffness * softening * o->wall_thickness / v->wall_thickness;
  contact->smoothing = s->smoothing * smoothing_scale(v) / smoothing_scale(o);
  return STATUS_OK;
}

enum status sensitivity_place(struct sensitivity *s, const struct variant *v) {
  struct fe_model *m = s->model;
  enum status status = move_nodes(s, v->x);
  if (status != STATUS_OK) {
    return status;
  }
  s->mesh.gap_width = v->gap_width;
  s->mesh.wall_thickness = v->wall_thickness;
  m->material = *v->material;
  m->bulk_modulus = v->material->bulk_ratio * material_shear_modulus(v->material);
  if (s->gravity[0] != 0 || s->gravity[1] != 0 || s->gravity[2] != 0) {
    memset(m->dead_load, 0, sizeof *m->dead_load * 3 * (size_t)s->mesh.node_count);
    model_add_gravity(m, s->gravity);
  }
  return renew_contact(s, v);
}

enum status sensitivity_residual(struct sensitivity *s) {
  return model_evaluate(s->model, &s->state, &s->load, false);
}
