#include "solver/fe/inertia.h"

#include <stdlib.h>
#include <string.h>
#include "solver/fe/model_internal.h"

static void fill_mass(const struct fe_model *m, double shape[HEX27_POINTS][HEX27_NODES], int e,
                      double mass[INERTIA_PACKED]) {
  for (int q = 0; q < HEX27_POINTS; q++) {
    double weight = m->material.density_kg_m3 * m->geometry[e].weight[q], *to = mass;
    for (int a = 0; a < HEX27_NODES; a++) {
      for (int b = a; b < HEX27_NODES; b++) {
        *to++ += weight * shape[q][a] * shape[q][b];
      }
    }
  }
}

enum status inertia_create(const struct fe_model *m, struct inertia **out, struct error *error) {
  size_t nodes = (size_t)m->mesh->node_count, elements = (size_t)m->mesh->element_count;
  struct inertia *inertia = calloc(1, sizeof *inertia);
  *out = NULL;
  if (!(m->material.density_kg_m3 > 0)) {
    free(inertia);
    return error_set(error, STATUS_INVALID, "/material/density",
                     "motion needs a density above 0, such as \"1080 kg/m3\"");
  }
  if (inertia) {
    inertia->mesh = m->mesh;
    inertia->mass = calloc(elements, sizeof *inertia->mass);
    inertia->start = calloc(3 * nodes, sizeof *inertia->start);
    inertia->offset = calloc(3 * nodes, sizeof *inertia->offset);
    inertia->viscosity = calloc(elements, sizeof *inertia->viscosity);
  }
  if (!inertia || !inertia->mass || !inertia->start || !inertia->offset || !inertia->viscosity) {
    inertia_destroy(inertia);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the mass of %zu elements",
                     elements);
  }
  double shape[HEX27_POINTS][HEX27_NODES];
  for (int q = 0; q < HEX27_POINTS; q++) {
    hex27_shape(m->hex27.point[q], shape[q], NULL);
  }
  for (int e = 0; e < m->mesh->element_count; e++) {
    fill_mass(m, shape, e, inertia->mass[e]);
  }
  inertia->total = m->material.density_kg_m3 * m->reference_volume;
  *out = inertia;
  return STATUS_OK;
}

void inertia_destroy(struct inertia *inertia) {
  if (!inertia) {
    return;
  }
  free(inertia->mass);
  free(inertia->start);
  free(inertia->offset);
  free(inertia->viscosity);
  free(inertia);
}

/* y = M_e x, three directions: index 3 a + i. */
static void multiply_element(const double mass[INERTIA_PACKED], const double x[3 * HEX27_NODES],
                             double y[3 * HEX27_NODES]) {
  memset(y, 0, 3 * HEX27_NODES * sizeof *y);
  for (int a = 0; a < HEX27_NODES; a++) {
    for (int b = a; b < HEX27_NODES; b++) {
      double value = *mass++, other = a == b ? 0 : value;
      for (int i = 0; i < 3; i++) {
        y[3 * a + i] += value * x[3 * b + i];
        y[3 * b + i] += other * x[3 * a + i];
      }
    }
  }
}

void inertia_multiply(const struct inertia *inertia, const double *x, double *y) {
  const struct mesh *mesh = inertia->mesh;
  memset(y, 0, 3 * (size_t)mesh->node_count * sizeof *y);
  for (int e = 0; e < mesh->element_count; e++) {
    const int *nodes = mesh->element_nodes + (size_t)HEX27_NODES * (size_t)e;
    double from[3 * HEX27_NODES], to[3 * HEX27_NODES];
    for (int a = 0; a < HEX27_NODES; a++) {
      memcpy(from + 3 * a, x + 3 * nodes[a], 3 * sizeof *from);
    }
    multiply_element(inertia->mass[e], from, to);
    for (int d = 0; d < 3 * HEX27_NODES; d++) {
      y[3 * nodes[d / 3] + d % 3] += to[d];
    }
  }
}

double inertia_kinetic(const struct inertia *inertia, const double *velocity) {
  const struct mesh *mesh = inertia->mesh;
  double sum = 0;
  for (int e = 0; e < mesh->element_count; e++) {
    const int *nodes = mesh->element_nodes + (size_t)HEX27_NODES * (size_t)e;
    double v[3 * HEX27_NODES], momentum[3 * HEX27_NODES];
    for (int a = 0; a < HEX27_NODES; a++) {
      memcpy(v + 3 * a, velocity + 3 * nodes[a], 3 * sizeof *v);
    }
    multiply_element(inertia->mass[e], v, momentum);
    for (int d = 0; d < 3 * HEX27_NODES; d++) {
      sum += 0.5 * v[d] * momentum[d];
    }
  }
  return sum;
}

/* Adds c M_e to a packed tangent. */
static void add_stiffness(const struct inertia *inertia, int e, double *packed) {
  for (int i = 0; i < 3; i++) {
    const double *mass = inertia->mass[e];
    for (int a = 0; a < HEX27_NODES; a++) {
      int row = HEX27_NODES * i + a;
      double *to = packed + model_packed_index(ELEMENT_DOFS, row, row);
      for (int b = a; b < HEX27_NODES; b++) {
        *to++ += inertia->stiffness * *mass++;
      }
    }
  }
}

void inertia_only(const struct inertia *inertia, struct fe_model *m) {
  size_t elements = (size_t)m->mesh->element_count;
  memset(m->element_value, 0, elements * ELEMENT_PACKED * sizeof *m->element_value);
  for (int e = 0; e < m->mesh->element_count; e++) {
    double *packed = m->element_value + (size_t)e * ELEMENT_PACKED;
    add_stiffness(inertia, e, packed);
    m->clique_value[e] = packed;
  }
  for (int p = 0; p < m->pattern_pairs; p++) {
    m->clique_value[elements + (size_t)p] = NULL;
  }
}

/* history += share C(u) */
static void add_history(const struct fe_model *m, int e, double share, const double *u,
                        struct element_viscosity *viscosity) {
  double local[3][HEX27_STRIDE];
  model_gather(m, u, e, local);
  for (int q = 0; q < HEX27_POINTS; q++) {
    double f[9];
    int row = 0;
    element_gradient(&m->geometry[e], q, local, f);
    for (int j = 0; j < 3; j++) {
      for (int l = j; l < 3; l++) {
        viscosity->history[row++][q] +=
            share * (f[j] * f[l] + f[3 + j] * f[3 + l] + f[6 + j] * f[6 + l]);
      }
    }
  }
}

void inertia_set_viscosity(struct inertia *inertia, const struct fe_model *m, double stiffness,
                           double share_now, const double *now, double share_before,
                           const double *before) {
  inertia->viscous = stiffness > 0;
  for (int e = 0; inertia->viscous && e < m->mesh->element_count; e++) {
    struct element_viscosity *viscosity = &inertia->viscosity[e];
    *viscosity = (struct element_viscosity){.stiffness = stiffness};
    add_history(m, e, share_now, now, viscosity);
    if (before && share_before != 0) {
      add_history(m, e, share_before, before, viscosity);
    }
  }
}

void inertia_add(const struct inertia *inertia, const struct mesh *mesh, int e, const double *u,
                 double residual[ELEMENT_DOFS], double *packed) {
  const int *nodes = mesh->element_nodes + (size_t)HEX27_NODES * (size_t)e;
  double x[3 * HEX27_NODES], force[3 * HEX27_NODES];
  for (int d = 0; d < 3 * HEX27_NODES; d++) {
    int at = 3 * nodes[d / 3] + d % 3;
    x[d] = inertia->stiffness * (u[at] - inertia->start[at]) + inertia->offset[at];
  }
  multiply_element(inertia->mass[e], x, force);
  for (int d = 0; d < 3 * HEX27_NODES; d++) {
    residual[HEX27_NODES * (d % 3) + d / 3] += force[d];
  }
  if (packed) {
    add_stiffness(inertia, e, packed);
  }
}

const struct element_viscosity *inertia_viscosity(const struct inertia *inertia, int e) {
  return inertia->viscous ? &inertia->viscosity[e] : NULL;
}
