/* Contact in the residual and the tangent of a model. */
#include "solver/fe/model_internal.h"
#include "solver/fe/obstacle_internal.h"

/* Nodes of a contact pair and their current positions. */
static void pair_positions(const struct fe_model *m, const double *u, int pair,
                           int nodes[CONTACT_NODES], double x[CONTACT_NODES][3]) {
  contact_nodes(&m->contact, pair, nodes);
  for (int a = 0; a < CONTACT_NODES; a++) {
    for (int i = 0; i < 3; i++) {
      x[a][i] = m->mesh->x[3 * nodes[a] + i] + u[3 * nodes[a] + i];
    }
  }
}

static void add_force(struct fe_model *m, const int *nodes, int count, const double *r) {
  for (int d = 0; d < 3 * count; d++) {
    int equation = m->equation[3 * nodes[d / 3] + d % 3];
    if (equation >= 0) {
      m->residual[equation] += r[d];
    }
  }
}

static void evaluate_pairs(struct fe_model *m, const double *u, bool tangent) {
  for (int p = 0; p < m->contact.pair_count; p++) {
    int nodes[CONTACT_NODES];
    double x[CONTACT_NODES][3], r[CONTACT_DOFS];
    pair_positions(m, u, p, nodes, x);
    double *packed = tangent ? m->contact_value + (size_t)p * CONTACT_PACKED : NULL;
    bool touches = contact_evaluate(&m->contact, p, x, r, packed);
    if (tangent) {
      m->pair_touches[p] = touches;
    }
    if (touches) {
      add_force(m, nodes, CONTACT_NODES, r);
    }
  }
}

/* The stiffness of a plane joins the tangent of the face's own element. */
static void add_plane_stiffness(struct fe_model *m, const struct mesh_face *face,
                                const double normal[3],
                                double stiffness[QUAD9_NODES][QUAD9_NODES]) {
  double *packed = m->element_value + (size_t)face->element * ELEMENT_PACKED;
  int local[QUAD9_NODES];
  mesh_face_local_nodes(face->axis, face->side, local);
  for (int r = 0; r < 3 * QUAD9_NODES; r++) {
    for (int c = 0; c < 3 * QUAD9_NODES; c++) {
      int row = HEX27_NODES * (r % 3) + local[r / 3], column = HEX27_NODES * (c % 3) + local[c / 3];
      if (row <= column) {
        packed[model_packed_index(ELEMENT_DOFS, row, column)] +=
            stiffness[r / 3][c / 3] * normal[r % 3] * normal[c % 3];
      }
    }
  }
}

/* Faces that reach the plane of symmetry end on it and do not touch it. */
static bool ends_on_symmetry(const struct mesh *mesh, const int nodes[QUAD9_NODES]) {
  for (int a = 0; a < QUAD9_NODES; a++) {
    if (mesh->x[3 * nodes[a] + 1] < 1e-6 * mesh->wall_thickness) {
      return true;
    }
  }
  return false;
}

/* Current positions of the nodes of face f. False when the face cannot touch plane k. */
static bool plane_positions(const struct fe_model *m, const double *u, int k, int f,
                            double x[QUAD9_NODES][3]) {
  int nodes[QUAD9_NODES];
  mesh_face_nodes(m->mesh, &m->contact.face[f].face, nodes);
  if (m->contact.plane[k].symmetry && ends_on_symmetry(m->mesh, nodes)) {
    return false;
  }
  for (int d = 0; d < 3 * QUAD9_NODES; d++) {
    x[d / 3][d % 3] = m->mesh->x[3 * nodes[d / 3] + d % 3] + u[3 * nodes[d / 3] + d % 3];
  }
  return true;
}

static void evaluate_plane(struct fe_model *m, const double *u, int plane, bool tangent) {
  const struct contact_plane *k = &m->contact.plane[plane];
  for (int f = 0; f < m->contact.face_count; f++) {
    const struct mesh_face *face = &m->contact.face[f].face;
    int nodes[QUAD9_NODES];
    double x[QUAD9_NODES][3], r[3 * QUAD9_NODES], stiffness[QUAD9_NODES][QUAD9_NODES];
    if (plane_positions(m, u, plane, f, x) &&
        contact_plane_evaluate(&m->contact, plane, f, x, r, stiffness)) {
      mesh_face_nodes(m->mesh, face, nodes);
      add_force(m, nodes, QUAD9_NODES, r);
      if (tangent) {
        add_plane_stiffness(m, face, k->normal, stiffness);
      }
    }
  }
}

enum status model_search_contact(struct fe_model *m, const struct fe_state *state) {
  bool changed = false;
  if (!m->use_contact) {
    return STATUS_OK;
  }
  enum status status = contact_search(&m->contact, state->u, &changed);
  m->pattern_stale = m->pattern_stale || changed;
  return status;
}

enum status model_evaluate_contact(struct fe_model *m, const double *u, bool tangent) {
  if (m->use_contact && tangent) {
    struct fe_state state = {.u = (double *)u};
    enum status status = model_search_contact(m, &state);
    if (status != STATUS_OK) {
      return status;
    }
  }
  if (tangent && !model_room_for_pairs(m)) {
    return STATUS_NO_MEMORY;
  }
  if (m->use_contact) {
    evaluate_pairs(m, u, tangent);
  }
  if (tangent) {
    enum status status = model_renew_pattern(m);
    if (status != STATUS_OK) {
      return status;
    }
  }
  for (int k = 0; k < m->contact.plane_count; k++) {
    evaluate_plane(m, u, k, tangent);
  }
  model_evaluate_obstacles(m, u, tangent);
  return STATUS_OK;
}

void model_use_multipliers(struct fe_model *m, const struct fe_state *state) {
  for (int i = 0; i < m->contact.point_count; i++) {
    m->contact.point[i].lambda = state->lambda[i];
  }
  obstacles_use(m, state);
}

void model_update_gaps(struct fe_model *m, const struct fe_state *state) {
  for (int p = 0; p < m->contact.pair_count; p++) {
    int nodes[CONTACT_NODES];
    double x[CONTACT_NODES][3], r[CONTACT_DOFS];
    pair_positions(m, state->u, p, nodes, x);
    contact_evaluate(&m->contact, p, x, r, NULL);
  }
  for (int k = 0; k < m->contact.plane_count; k++) {
    for (int f = 0; f < m->contact.face_count; f++) {
      double x[QUAD9_NODES][3], r[3 * QUAD9_NODES], stiffness[QUAD9_NODES][QUAD9_NODES];
      if (plane_positions(m, state->u, k, f, x)) {
        contact_plane_evaluate(&m->contact, k, f, x, r, stiffness);
      }
    }
  }
  obstacles_look(m, state->u);
}
