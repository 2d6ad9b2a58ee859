#include "solver/fe/sensitivity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A closed contact this much stiffer than its penalty is rigid to more digits than derivatives
 * are given with, and still far from the limits of the factorisation. */
static const double rigid_contact = 3e5;

/* Accuracy of the states that are linearised about: displacements relative to the body's length,
 * contact tractions relative to the pressure and to the shear modulus. */
static const double step_tolerance = 1e-9;
static const double traction_tolerance = 1e-6;
static const double traction_floor = 1e-8;

/* Tractions so many times further from their multipliers are unsettled: some points may be about
 * to part, and the tangent not that of the settled contact. Then the body's response is compared
 * with that for a softer contact, and refused when they differ by more than `doubtful`. */
static const double unsettled = 100;
static const double softer_contact = 1e3;
static const double doubtful = 1e-2;

enum { ATTEMPTS = 8 };

static enum status copy_planes(const struct contact *from, struct fe_model *to,
                               struct error *error) {
  enum status status = STATUS_OK;
  for (int k = 0; status == STATUS_OK && k < from->plane_count; k++) {
    const struct contact_plane *plane = &from->plane[k];
    if (!plane->symmetry) { /* model_create makes that one */
      status = model_add_plane(to, plane->point, plane->normal, error);
    }
  }
  return status;
}

/* The model, its states and its solver. s->mesh has its own nodes. */
static enum status prepare_model(struct sensitivity *s, const struct fe_model *from,
                                 struct error *error) {
  enum status status = model_create(&s->mesh, &from->material, from->use_contact, &s->model, error);
  if (status == STATUS_OK) {
    status = copy_planes(&from->contact, s->model, error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  memcpy(s->model->cavity_share, from->cavity_share, sizeof from->cavity_share);
  model_add_gravity(s->model, s->gravity);
  s->vector = malloc(2 * sizeof *s->vector * ((size_t)s->model->dof_count + 1));
  if (!s->vector || state_create(s->model, &s->state) != STATUS_OK) {
    return STATUS_NO_MEMORY;
  }
  status = equilibrium_create(s->model, &s->solver, error);
  if (status == STATUS_OK) {
    s->length = 4 * s->solver->options.longest_step;
    s->solver->options.step_tolerance = step_tolerance * s->length;
    s->solver->options.overlap_tolerance = 0;
  }
  return status;
}

enum status sensitivity_create(const struct fe_model *model, const double gravity[3],
                               struct sensitivity **out, struct error *error) {
  const struct mesh *mesh = model->mesh;
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
  memcpy(s->gravity, gravity, sizeof s->gravity);
  s->original = (struct variant){s->x, mesh->gap_width, mesh->wall_thickness, &model->material};
  s->stiffness = model->contact.stiffness;
  s->smoothing = model->contact.smoothing;
  s->cap = rigid_contact;
  status = prepare_model(s, model, error);
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
  free(s->vector);
  free(s);
}

/* ---- the linearisation -------------------------------------------------------------------- */

/* Largest difference between traction and multiplier, Pa; renews the tractions. */
static double imbalance(struct sensitivity *s) {
  struct contact *contact = &s->model->contact;
  double most = 0;
  for (int i = 0; i < contact->point_count; i++) {
    contact->point[i].lambda = s->state.lambda[i];
  }
  if (model_evaluate(s->model, &s->state, &s->load, false) != STATUS_OK) {
    return INFINITY;
  }
  for (int i = 0; i < contact->point_count; i++) {
    if (contact->point[i].valid) {
      most = fmax(most, fabs(contact->point[i].traction - contact->point[i].lambda));
    }
  }
  return most;
}

/* Brings a copy of the state closer to equilibrium than the load path needs. *settled tells
 * whether the multipliers have come to rest. */
static enum status settle(struct sensitivity *s, const struct fe_state *state, bool *settled) {
  double mu = material_shear_modulus(&s->model->material);
  double tolerance = fmax(traction_tolerance * s->load.pressure, traction_floor * mu);
  double rest = INFINITY, before = INFINITY;
  enum status status = STATUS_OK;
  state_copy(s->model, &s->state, state);
  s->solver->options.traction_tolerance = tolerance;
  for (int k = 0; status == STATUS_OK && rest > tolerance && k < ATTEMPTS; k++) {
    int iterations;
    s->solver->factor_fits = false;
    status = equilibrium_solve(s->solver, &s->load, s->load.pressure, &s->state, &iterations);
    before = rest;
    rest = imbalance(s);
    if (rest > 0.7 * before) {
      break;
    }
  }
  *settled = rest <= unsettled * tolerance;
  return status;
}

/* Factorises the tangent with closed contact `cap` times as stiff as its penalty. With `response`
 * not NULL: the growth of the enclosed volume per pressure, m3/Pa. */
static enum status factorise(struct sensitivity *s, double cap, double *response) {
  struct fe_model *m = s->model;
  contact_follow(&m->contact, cap);
  enum status status = model_evaluate(m, &s->state, &s->load, true);
  if (status != STATUS_OK) {
    return status;
  }
  model_factor(m);
  if (response) {
    double *z = s->vector + m->dof_count;
    model_volume(m, &s->state, s->vector);
    model_solve(m, s->vector, z);
    *response = 0;
    for (int i = 0; i < m->dof_count; i++) {
      *response += s->vector[i] * z[i];
    }
  }
  return STATUS_OK;
}

enum status sensitivity_linearise(struct sensitivity *s, const struct fe_state *state,
                                  const struct fe_load *load) {
  bool settled = true;
  double soft, rigid;
  contact_follow(&s->model->contact, 0);
  s->load = *load;
  s->load.stiffness_pressure = load->pressure;
  s->doubt = 0;
  enum status status = sensitivity_place(s, &s->original);
  if (status == STATUS_OK) {
    status = settle(s, state, &settled);
  }
  if (status == STATUS_OK && !settled) {
    status = factorise(s, softer_contact, &soft);
  }
  if (status == STATUS_OK) {
    status = factorise(s, s->cap, settled ? NULL : &rigid);
  }
  if (status == STATUS_OK && !settled) {
    s->doubt = fabs(rigid / soft - 1);
    status = s->doubt < doubtful ? STATUS_OK : STATUS_DIVERGED;
  }
  return status;
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
  if (!s->model->use_contact && contact->plane_count == 0) {
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
