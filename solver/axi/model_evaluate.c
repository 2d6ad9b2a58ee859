/* Energy, volume, forces and tangent of a model, and its factors. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/axi/model_internal.h"

static int packed_index(int n, int i, int j) {
  return i <= j ? i * n - i * (i - 1) / 2 + j - i : j * n - j * (j - 1) / 2 + i - j;
}

void axi_clique_add_force(const struct axi_model *m, const struct axi_clique *c,
                          const double *local, double *force) {
  for (int i = 0; i < c->locals; i++) {
    if (c->place[i].base >= 0) {
      force[c->place[i].base] += local[i];
    }
    if (c->place[i].plus != 0) {
      force[m->size - 1] += c->place[i].plus * local[i];
    }
  }
}

static int packed_count(int n) {
  return n * (n + 1) / 2;
}

/* With u = T x for the components, T^T K T: row i of T is 1 at its base and `plus` at h. */
void axi_clique_add(struct axi_clique *c, const double *local) {
  if (c->plain) {
    for (int i = 0; i < packed_count(c->locals); i++) {
      c->value[i] += local[i];
    }
    return;
  }
  for (int i = 0; i < c->locals; i++) {
    const int row[2] = {c->at[i], c->elongation}, by[2] = {1, c->place[i].plus};
    for (int j = i; j < c->locals; j++, local++) {
      const int column[2] = {c->at[j], c->elongation}, other[2] = {1, c->place[j].plus};
      for (int k = 0; k < 4; k++) {
        int a = row[k / 2], b = column[k % 2], times = by[k / 2] * other[k % 2];
        bool mirrored = i == j && k == 2;
        if (a >= 0 && b >= 0 && times != 0 && !mirrored) {
          /* An entry off the diagonal stands for its mirror image, too. */
          times *= a == b && i != j ? 2 : 1;
          c->value[packed_index(c->count, a, b)] += times * *local;
        }
      }
    }
  }
}

static void clear(struct axi_clique *c) {
  memset(c->value, 0, sizeof *c->value * (size_t)packed_count(c->count));
}

/* Over the displacements of the nodes, or the unknowns of a shell's rows. */
static bool evaluate_element(const struct axi_model *m, int e, double *energy, double *force,
                             double *matrix) {
  double u[AXI_DOFS];
  if (m->shell) {
    const double *q = m->q + SHELL_ROW * axi_shell_element_row(m->shell, e);
    return axi_shell_element(m->shell, e, q, energy, force, matrix);
  }
  axi_element_displacements(m->mesh, e, m->u, u);
  return axi_element_evaluate(&m->geometry[e], &m->mesh->region[m->mesh->element[e].region], u,
                              energy, force, matrix);
}

static double evaluate_edge(const struct axi_model *m, int k, double *gradient, double *matrix) {
  double x[AXI_EDGE_NODES][2];
  if (m->shell) {
    const double *q = m->q + SHELL_ROW * axi_shell_edge_row(m->shell, k);
    return axi_shell_volume(m->shell, k, q, gradient, matrix);
  }
  for (int i = 0; i < AXI_EDGE_DOFS; i++) {
    int at = 2 * m->mesh->inner[k].node[i / 2] + i % 2;
    x[i / 2][i % 2] = m->mesh->position[at] + m->u[at];
  }
  return axi_edge_volume(x, gradient, matrix);
}

static enum status add_elements(struct axi_model *m, bool tangent, struct error *error) {
  const struct axi_mesh *mesh = m->mesh;
  for (int e = 0; e < mesh->element_count; e++) {
    struct axi_clique *c = &m->clique[e];
    double force[AXI_DOFS], packed[AXI_PACKED], energy = 0;
    double *matrix = !tangent ? NULL : c->plain ? c->value : packed;
    if (!evaluate_element(m, e, &energy, force, matrix)) {
      return error_set(error, STATUS_INVERTED, NULL, "element %d turned inside out", e);
    }
    m->energy += energy;
    axi_clique_add_force(m, c, force, m->force);
    if (tangent && !c->plain) {
      clear(c);
      axi_clique_add(c, packed);
    }
  }
  return STATUS_OK;
}

static void add_volume(struct axi_model *m, double pressure, bool tangent) {
  const struct axi_mesh *mesh = m->mesh;
  for (int k = 0; k < mesh->inner_count; k++) {
    struct axi_clique *c = &m->clique[mesh->element_count + k];
    double gradient[SHELL_DOFS], packed[SHELL_PACKED];
    m->volume += evaluate_edge(m, k, gradient, tangent ? packed : NULL);
    axi_clique_add_force(m, c, gradient, m->volume_gradient);
    for (int i = 0; tangent && i < packed_count(c->locals); i++) {
      packed[i] *= -pressure;
    }
    if (tangent) {
      clear(c);
      axi_clique_add(c, packed);
    }
  }
}

static enum status add_skin(struct axi_model *m, bool tangent, struct error *error) {
  int first = m->mesh->element_count + m->mesh->inner_count;
  for (int k = 0; k < m->skin.count; k++) {
    const struct axi_turning *t = &m->skin.turning[k];
    struct axi_clique *c = &m->clique[first + k];
    double x[SKIN_NODES][2], force[SKIN_DOFS], packed[SKIN_PACKED], energy = 0;
    for (int i = 0; i < 2 * t->count; i++) {
      int at = 2 * t->node[i / 2] + i % 2;
      x[i / 2][i % 2] = m->mesh->position[at] + m->u[at];
    }
    if (!axi_skin_evaluate(t, x, &energy, force, tangent ? packed : NULL)) {
      return error_set(error, STATUS_INVERTED, NULL, "the surface at node %d folded back",
                       t->node[0]);
    }
    m->energy += energy;
    axi_clique_add_force(m, c, force, m->force);
    if (tangent) {
      clear(c);
      axi_clique_add(c, packed);
    }
  }
  return STATUS_OK;
}

enum status axi_model_evaluate(struct axi_model *m, const double *x, double pressure, bool tangent,
                               struct error *error) {
  size_t bytes = sizeof *m->force * (size_t)m->size;
  memset(m->force, 0, bytes);
  memset(m->volume_gradient, 0, bytes);
  m->energy = m->volume = m->contact_energy = 0;
  axi_model_expand(m, x, m->u);
  for (int row = 0; m->shell && row < m->mesh->node_count / m->options.row_nodes; row++) {
    axi_model_row(m, x, row, m->q + SHELL_ROW * row);
  }
  add_volume(m, pressure, tangent);
  enum status status = add_elements(m, tangent, error);
  if (status == STATUS_OK) {
    status = add_skin(m, tangent, error);
  }
  if (status == STATUS_OK && m->contact) {
    status = axi_model_add_contact(m, x, tangent, error);
  }
  return status;
}

/* ---- factors ----------------------------------------------------------------------------- */

static enum status make_factor(struct axi_model *m, bool held, struct error *error) {
  int most = m->clique_count * CLIQUE_DOFS, count = 0, last = held ? m->size - 1 : m->size;
  int *start = malloc(((size_t)m->clique_count + 1) * sizeof *start);
  int *dofs = malloc(((size_t)most + 1) * sizeof *dofs);
  enum status status = STATUS_NO_MEMORY;
  if (!start || !dofs) {
    error_set(error, status, NULL, "no memory for a pattern of %d cliques", m->clique_count);
    goto done;
  }
  for (int k = 0; k < m->clique_count; k++) {
    start[k] = count;
    for (int i = 0; i < m->clique[k].count; i++) {
      int dof = m->clique[k].dof[i];
      dofs[count++] = dof < last ? dof : -1;
    }
  }
  start[m->clique_count] = count;
  struct ldlt_pattern pattern = {.dof_count = last,
                                 .node_count = m->mesh->node_count + 1,
                                 .node_of = m->node_of,
                                 .clique_count = m->clique_count,
                                 .start = start,
                                 .dofs = dofs};
  status = ldlt_create(&pattern, &m->factor[held], error);
done:
  free(start);
  free(dofs);
  return status;
}

enum status axi_model_factor(struct axi_model *m, bool held, int *negative, struct error *error) {
  if (!m->factor[held]) {
    enum status status = make_factor(m, held, error);
    if (status != STATUS_OK) {
      return status;
    }
  }
  *negative = ldlt_factor(m->factor[held], m->value);
  return STATUS_OK;
}

void axi_model_product(const struct axi_model *m, const double *v, double *product) {
  memset(product, 0, sizeof *product * (size_t)m->size);
  for (int k = 0; k < m->clique_count; k++) {
    const struct axi_clique *c = &m->clique[k];
    const double *a = m->value[k];
    for (int i = 0; a && i < c->count; i++) {
      int p = c->dof[i];
      for (int j = i; j < c->count; j++, a++) {
        int q = c->dof[j];
        if (p >= 0 && q >= 0) {
          product[p] += *a * v[q];
          product[q] += p != q ? *a * v[p] : 0;
        }
      }
    }
  }
}
