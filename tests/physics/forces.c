#include "tests/physics/forces.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/vec3.h"

static void place(const struct mesh *mesh, const double *u, int node, double x[3]) {
  for (int i = 0; i < 3; i++) {
    x[i] = mesh->x[3 * node + i] + u[3 * node + i];
  }
}

static void add(struct forces *sum, const double x[3], const double force[3]) {
  double moment[3];
  vec3_cross(x, force, moment);
  for (int i = 0; i < 3; i++) {
    sum->force[i] += force[i];
    sum->moment[i] += moment[i];
    sum->size += fabs(force[i]);
  }
}

/* Adds what pair p puts on its nodes to force[node_count x 3]. */
static void pair_forces(struct fe_model *model, const double *u, int p, double *force) {
  int nodes[CONTACT_NODES];
  double x[CONTACT_NODES][3], r[CONTACT_DOFS];
  contact_nodes(&model->contact, p, nodes);
  for (int a = 0; a < CONTACT_NODES; a++) {
    place(model->mesh, u, nodes[a], x[a]);
  }
  if (contact_evaluate(&model->contact, p, x, r, NULL)) {
    for (int d = 0; d < CONTACT_DOFS; d++) {
      force[3 * nodes[d / 3] + d % 3] -= r[d];
    }
  }
}

static double *all_pairs(struct fe_model *model, const struct fe_state *state) {
  double *force = calloc(3 * (size_t)model->mesh->node_count, sizeof *force);
  ck_assert_ptr_nonnull(force);
  model_use_multipliers(model, state);
  for (int p = 0; model->use_contact && p < model->contact.pair_count; p++) {
    pair_forces(model, state->u, p, force);
  }
  return force;
}

struct forces forces_of_pairs(struct fe_model *model, const struct fe_state *state) {
  struct forces sum = {.size = 0};
  double *force = all_pairs(model, state), x[3];
  for (int n = 0; n < model->mesh->node_count; n++) {
    place(model->mesh, state->u, n, x);
    add(&sum, x, force + 3 * n);
  }
  free(force);
  return sum;
}

struct forces forces_at_base(struct fe_model *model, const struct fe_state *state,
                             double pressure) {
  /* The residual of the same body, held nowhere and touching nothing. */
  struct mesh loose = *model->mesh;
  struct fe_model *free_model;
  struct error error = {0};
  struct fe_load load = {.pressure = pressure};
  struct forces sum = {.size = 0};
  double *contact = all_pairs(model, state), x[3];
  loose.fixed = calloc(3 * (size_t)loose.node_count, 1);
  ck_assert_ptr_nonnull(loose.fixed);
  ck_assert_int_eq(model_create(&loose, &model->material, false, &free_model, &error), STATUS_OK);
  ck_assert_int_eq(model_evaluate(free_model, state, &load, false), STATUS_OK);
  for (int n = 0; n < loose.node_count; n++) {
    if (fabs(loose.x[3 * n]) < 1e-9) {
      double support[3];
      for (int i = 0; i < 3; i++) {
        support[i] = free_model->residual[free_model->equation[3 * n + i]] - contact[3 * n + i];
      }
      place(&loose, state->u, n, x);
      add(&sum, x, support);
    }
  }
  model_destroy(free_model);
  free(loose.fixed);
  free(contact);
  return sum;
}
