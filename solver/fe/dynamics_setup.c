/* Making and unmaking of what moves. */
#include "solver/fe/dynamics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t stress_count(const struct fe_model *m) {
  return ENERGY_STRESS * (size_t)m->mesh->element_count;
}

enum status motion_create(const struct fe_model *m, struct motion *motion) {
  size_t count = 3 * (size_t)m->mesh->node_count, stresses = stress_count(m);
  *motion = (struct motion){.velocity = calloc(count, sizeof(double)),
                            .acceleration = calloc(count, sizeof(double)),
                            .balanced = calloc(count, sizeof(double)),
                            .before = calloc(count, sizeof(double)),
                            .viscous = calloc(stresses, sizeof(double))};
  if (!motion->velocity || !motion->acceleration || !motion->balanced || !motion->before ||
      !motion->viscous) {
    motion_release(motion);
    return STATUS_NO_MEMORY;
  }
  return STATUS_OK;
}

void motion_release(struct motion *motion) {
  free(motion->velocity);
  free(motion->acceleration);
  free(motion->balanced);
  free(motion->before);
  free(motion->viscous);
  *motion = (struct motion){.time = 0};
}

void motion_clear(const struct fe_model *m, struct motion *motion) {
  size_t bytes = 3 * (size_t)m->mesh->node_count * sizeof(double);
  motion->time = motion->last = motion->kinetic = 0;
  motion->object = (struct object_motion){.velocity = {0}};
  memset(motion->velocity, 0, bytes);
  memset(motion->acceleration, 0, bytes);
  memset(motion->balanced, 0, bytes);
  memset(motion->before, 0, bytes);
  memset(motion->viscous, 0, stress_count(m) * sizeof *motion->viscous);
}

void motion_copy(const struct fe_model *m, struct motion *to, const struct motion *from) {
  size_t bytes = 3 * (size_t)m->mesh->node_count * sizeof(double);
  memcpy(to->velocity, from->velocity, bytes);
  memcpy(to->acceleration, from->acceleration, bytes);
  memcpy(to->balanced, from->balanced, bytes);
  memcpy(to->before, from->before, bytes);
  memcpy(to->viscous, from->viscous, stress_count(m) * sizeof *to->viscous);
  to->time = from->time;
  to->step = from->step;
  to->last = from->last;
  to->kinetic = from->kinetic;
  to->object = from->object;
}

double dynamics_scale(const struct dynamics *d) {
  const struct material_spec *material = &d->model->material;
  return d->solver->length * sqrt(material->density_kg_m3 / material_shear_modulus(material));
}

enum status dynamics_create(struct equilibrium *solver, struct dynamics **out,
                            struct error *error) {
  struct fe_model *m = solver->model;
  struct dynamics *d = calloc(1, sizeof *d);
  *out = NULL;
  if (!d) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the motion");
  }
  d->model = m;
  d->solver = solver;
  enum status status = inertia_create(m, &d->inertia, error);
  if (status == STATUS_OK) {
    d->work = calloc(3 * (size_t)m->mesh->node_count, sizeof *d->work);
    if (!d->work || state_create(m, &d->saved) != STATUS_OK ||
        state_create(m, &d->rest) != STATUS_OK) {
      status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the motion");
    }
  }
  if (status != STATUS_OK) {
    dynamics_destroy(d);
    return status;
  }
  double scale = dynamics_scale(d);
  d->options = (struct dynamics_options){.fast = 0.8,
                                         .viscosity = material_shear_modulus(&m->material) * scale,
                                         .tolerance = 2e-4 * solver->length,
                                         .shortest = 1e-6 * scale,
                                         .longest = 20 * scale};
  *out = d;
  return STATUS_OK;
}

void dynamics_destroy(struct dynamics *d) {
  if (!d) {
    return;
  }
  inertia_destroy(d->inertia);
  state_release(&d->saved);
  state_release(&d->rest);
  free(d->work);
  free(d);
}
