/* Assembly and solution of the linear system of a model. */
#include <math.h>
#include <string.h>
#include "solver/base/clock.h"
#include "solver/fe/inertia.h"
#include "solver/fe/model_internal.h"
#include "solver/fe/pressure.h"

size_t model_packed_index(int n, int r, int c) {
  return (size_t)r * (size_t)(2 * n - r + 1) / 2 + (size_t)(c - r);
}

/* Current positions of the nodes of a face of an element. */
static void face_positions(const struct fe_model *m, const double *u, const struct mesh_face *face,
                           double x[QUAD9_NODES][3]) {
  int nodes[QUAD9_NODES];
  mesh_face_nodes(m->mesh, face, nodes);
  for (int a = 0; a < QUAD9_NODES; a++) {
    for (int i = 0; i < 3; i++) {
      x[a][i] = m->mesh->x[3 * nodes[a] + i] + u[3 * nodes[a] + i];
    }
  }
}

/* Adds the follower pressure on one cavity face to its element's residual and tangent. */
static void add_pressure(const struct fe_model *m, const double *u, const struct mesh_face *face,
                         const struct fe_load *load, double *residual, double *packed) {
  double x[QUAD9_NODES][3], force[FACE_DOFS], tangent[FACE_DOFS * FACE_DOFS];
  int local[QUAD9_NODES], index[FACE_DOFS];
  mesh_face_local_nodes(face->axis, face->side, local);
  face_positions(m, u, face, x);
  pressure_face(&m->quad9, x, face->side, force);
  double share = m->cavity_share[face->cavity];
  for (int r = 0; r < FACE_DOFS; r++) {
    index[r] = HEX27_NODES * (r % 3) + local[r / 3];
    residual[index[r]] += share * load->pressure * force[r];
  }
  double stiffness_pressure = share * load->stiffness_pressure;
  if (!packed || stiffness_pressure == 0) {
    return;
  }
  pressure_face_tangent(&m->quad9, x, face->side, tangent);
  for (int r = 0; r < FACE_DOFS; r++) {
    for (int c = 0; c < FACE_DOFS; c++) {
      if (index[r] <= index[c]) {
        packed[model_packed_index(ELEMENT_DOFS, index[r], index[c])] +=
            stiffness_pressure * tangent[FACE_DOFS * r + c];
      }
    }
  }
}

static enum status evaluate_elements(struct fe_model *m, const struct fe_state *state,
                                     const struct fe_load *load, bool tangent) {
  const struct mesh *mesh = m->mesh;
  for (int e = 0; e < mesh->element_count; e++) {
    double u[3][HEX27_STRIDE], residual[ELEMENT_DOFS];
    double *packed = tangent ? m->element_value + (size_t)e * ELEMENT_PACKED : NULL;
    model_gather(m, state->u, e, u);
    const struct element_viscosity *viscosity =
        m->inertia ? inertia_viscosity(m->inertia, e) : NULL;
    if (!element_evaluate_damped(&m->geometry[e], &m->material, m->bulk_modulus, viscosity, u,
                                 state->p + ELEMENT_PRESSURES * e, residual, packed,
                                 &m->internal[e])) {
      return STATUS_INVERTED;
    }
    for (int f = m->cavity_start[e]; f < m->cavity_start[e + 1]; f++) {
      add_pressure(m, state->u, &m->cavity_face[f], load, residual, packed);
    }
    if (m->inertia) {
      inertia_add(m->inertia, mesh, e, state->u, residual, packed);
    }
    const int *nodes = mesh->element_nodes + (size_t)HEX27_NODES * (size_t)e;
    for (int r = 0; r < ELEMENT_DOFS; r++) {
      int equation = m->equation[3 * nodes[r % HEX27_NODES] + r / HEX27_NODES];
      if (equation >= 0) {
        m->residual[equation] += residual[r];
      }
    }
    if (tangent) {
      m->clique_value[e] = packed;
    }
  }
  return STATUS_OK;
}

enum status model_evaluate(struct fe_model *m, const struct fe_state *state,
                           const struct fe_load *load, bool tangent) {
  double start = clock_cpu_s();
  memset(m->residual, 0, sizeof *m->residual * (size_t)m->dof_count);
  enum status status = evaluate_elements(m, state, load, tangent);
  if (status == STATUS_OK && load->dead != 0) {
    for (int d = 0; d < 3 * m->mesh->node_count; d++) {
      if (m->equation[d] >= 0) {
        m->residual[m->equation[d]] -= load->dead * m->dead_load[d];
      }
    }
  }
  double middle = clock_cpu_s();
  if (status == STATUS_OK) {
    status = model_evaluate_contact(m, state->u, tangent);
  }
  *(tangent ? &m->statistics.assembly_s : &m->statistics.residual_s) += middle - start;
  *(tangent ? &m->statistics.assemblies : &m->statistics.residuals) += 1;
  m->statistics.contact_s += clock_cpu_s() - middle;
  return status;
}

int model_factor(struct fe_model *m) {
  double start = clock_cpu_s();
  int negative = ldlt_factor(m->ldlt, m->clique_value);
  m->statistics.factor_s += clock_cpu_s() - start;
  m->statistics.factorizations++;
  return negative;
}

void model_solve(struct fe_model *m, const double *b, double *x) {
  double start = clock_cpu_s();
  ldlt_solve(m->ldlt, b, x);
  m->statistics.solve_s += clock_cpu_s() - start;
  m->statistics.solves++;
}

/* y += A x for a packed clique of order n whose unknowns are dofs[]. */
static void multiply_clique(int n, const double *packed, const int *dofs, const double *x,
                            double *y) {
  for (int r = 0; r < n; r++) {
    for (int c = r; c < n; c++) {
      double value = *packed++;
      if (dofs[r] >= 0 && dofs[c] >= 0) {
        y[dofs[r]] += value * x[dofs[c]];
        if (c != r) {
          y[dofs[c]] += value * x[dofs[r]];
        }
      }
    }
  }
}

void model_multiply(const struct fe_model *m, const double *x, double *y) {
  const struct mesh *mesh = m->mesh;
  memset(y, 0, sizeof *y * (size_t)m->dof_count);
  for (int e = 0; e < mesh->element_count; e++) {
    int dofs[ELEMENT_DOFS];
    for (int r = 0; r < ELEMENT_DOFS; r++) {
      int node = mesh->element_nodes[HEX27_NODES * e + r % HEX27_NODES];
      dofs[r] = m->equation[3 * node + r / HEX27_NODES];
    }
    multiply_clique(ELEMENT_DOFS, m->clique_value[e], dofs, x, y);
  }
  for (int p = 0; m->use_contact && p < m->contact.pair_count; p++) {
    int clique = mesh->element_count + m->pair_clique[p];
    if (m->pair_clique[p] < 0 || !m->clique_value[clique]) {
      continue;
    }
    int nodes[CONTACT_NODES], dofs[CONTACT_DOFS];
    contact_nodes(&m->contact, p, nodes);
    for (int r = 0; r < CONTACT_DOFS; r++) {
      dofs[r] = m->equation[3 * nodes[r / 3] + r % 3];
    }
    multiply_clique(CONTACT_DOFS, m->clique_value[clique], dofs, x, y);
  }
}

void model_recover(const struct fe_model *m, struct fe_state *state, const double *du,
                   double share) {
  for (int e = 0; e < m->mesh->element_count; e++) {
    double step[ELEMENT_DOFS], dp[ELEMENT_PRESSURES];
    const int *nodes = m->mesh->element_nodes + (size_t)HEX27_NODES * (size_t)e;
    for (int r = 0; r < ELEMENT_DOFS; r++) {
      int equation = m->equation[3 * nodes[r % HEX27_NODES] + r / HEX27_NODES];
      step[r] = equation >= 0 ? du[equation] : 0;
    }
    element_recover(&m->internal[e], step, share, dp);
    for (int k = 0; k < ELEMENT_PRESSURES; k++) {
      state->p[ELEMENT_PRESSURES * e + k] += dp[k];
    }
  }
}

double model_volume(const struct fe_model *m, const struct fe_state *state, double *gradient) {
  double volume = 0;
  if (gradient) {
    memset(gradient, 0, sizeof *gradient * (size_t)m->dof_count);
  }
  for (int f = 0; f < m->cavity_start[m->mesh->element_count]; f++) {
    const struct mesh_face *face = &m->cavity_face[f];
    double x[QUAD9_NODES][3], force[FACE_DOFS];
    int nodes[QUAD9_NODES];
    face_positions(m, state->u, face, x);
    mesh_face_nodes(m->mesh, face, nodes);
    double share = m->cavity_share[face->cavity];
    volume += share * pressure_face(&m->quad9, x, face->side, force);
    for (int r = 0; gradient && r < FACE_DOFS; r++) {
      int equation = m->equation[3 * nodes[r / 3] + r % 3];
      if (equation >= 0) {
        gradient[equation] -= share * force[r];
      }
    }
  }
  return volume;
}

double model_cavity_volume(const struct fe_model *m, const struct fe_state *state, int cavity) {
  double volume = 0;
  for (int f = 0; f < m->cavity_start[m->mesh->element_count]; f++) {
    double x[QUAD9_NODES][3], force[FACE_DOFS];
    if (m->cavity_face[f].cavity == cavity) {
      face_positions(m, state->u, &m->cavity_face[f], x);
      volume += pressure_face(&m->quad9, x, m->cavity_face[f].side, force);
    }
  }
  return volume;
}
