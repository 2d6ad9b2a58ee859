#include "solver/verify/body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/vec3.h"
#include "solver/mesh/grid.h"

/* Number of the node at x, among the nodes before `limit` or a new one. */
static int join_node(struct mesh *mesh, const double x[3], int limit) {
  for (int n = 0; n < limit; n++) {
    const double *y = mesh->x + 3 * n;
    double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
    if (vec3_dot(d, d) <= 1e-18 * vec3_dot(x, x)) {
      return n;
    }
  }
  memcpy(mesh->x + 3 * mesh->node_count, x, 3 * sizeof *x);
  return mesh->node_count++;
}

static void add_faces(const struct body *body, int element, const int cell[3], struct mesh *mesh) {
  for (int axis = 0; axis < 3; axis++) {
    for (int side = -1; side <= 1; side += 2) {
      if (cell[axis] == (side < 0 ? 0 : body->cells[axis] - 1)) {
        bool cavity = body->cavity && axis == 0 && side < 0;
        mesh->faces[mesh->face_count++] = (struct mesh_face){
            element, (signed char)axis, (signed char)side, cavity ? FACE_CAVITY : FACE_OUTER, 0};
      }
    }
  }
}

static void add_block(const struct body *body, int block, int *number, struct mesh *mesh) {
  const int *c = body->cells;
  int size[3] = {2 * c[0] + 1, 2 * c[1] + 1, 2 * c[2] + 1}, limit = mesh->node_count;
  for (int i = 0; i < size[0] * size[1] * size[2]; i++) {
    int at[3] = {i / (size[1] * size[2]), i / size[2] % size[1], i % size[2]};
    double s[3], x[3];
    for (int d = 0; d < 3; d++) {
      s[d] = at[d] / (2.0 * c[d]);
    }
    body->map(body->context, block, s, x);
    number[i] = join_node(mesh, x, limit);
  }
  for (int e = 0; e < c[0] * c[1] * c[2]; e++) {
    int cell[3] = {e / (c[1] * c[2]), e / c[2] % c[1], e % c[2]};
    int *nodes = mesh->element_nodes + HEX27_NODES * mesh->element_count;
    for (int a = 0; a < HEX27_NODES; a++) {
      int i = 2 * cell[0] + a / 9, j = 2 * cell[1] + a / 3 % 3, k = 2 * cell[2] + a % 3;
      nodes[a] = number[(i * size[1] + j) * size[2] + k];
    }
    add_faces(body, mesh->element_count++, cell, mesh);
  }
}

enum status body_build(const struct body *body, struct mesh *mesh) {
  size_t elements = 1, nodes = 1, blocks = (size_t)body->blocks;
  for (int d = 0; d < 3; d++) {
    elements *= (size_t)body->cells[d];
    nodes *= 2 * (size_t)body->cells[d] + 1;
  }
  *mesh = (struct mesh){.wall_thickness = 1};
  mesh->x = calloc(3 * blocks * nodes, sizeof *mesh->x);
  mesh->element_nodes = calloc(blocks * elements * HEX27_NODES, sizeof *mesh->element_nodes);
  mesh->fixed = calloc(3 * blocks * nodes, 1);
  mesh->faces = calloc(6 * blocks * elements, sizeof *mesh->faces);
  int *number = calloc(nodes, sizeof *number);
  bool good = mesh->x && mesh->element_nodes && mesh->fixed && mesh->faces && number;
  for (int block = 0; good && block < body->blocks; block++) {
    add_block(body, block, number, mesh);
  }
  free(number);
  return good ? STATUS_OK : STATUS_NO_MEMORY;
}

void body_hold(struct mesh *mesh, int axis, double at, int components) {
  for (int n = 0; n < mesh->node_count; n++) {
    const double *x = mesh->x + 3 * n;
    if (axis < 0 || fabs(x[axis] - at) < 1e-9 * (1e-3 + fabs(at))) {
      for (int i = 0; i < 3; i++) {
        if ((components >> i) & 1) {
          mesh->fixed[3 * n + i] = 1;
        }
      }
    }
  }
}

void body_mark_boundary(const struct mesh *mesh, unsigned char *on_boundary) {
  memset(on_boundary, 0, (size_t)mesh->node_count);
  for (int f = 0; f < mesh->face_count; f++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(mesh, &mesh->faces[f], nodes);
    for (int a = 0; a < QUAD9_NODES; a++) {
      on_boundary[nodes[a]] = 1;
    }
  }
}

static bool face_lies_at(const struct mesh *mesh, const int nodes[QUAD9_NODES], int axis, double at,
                         double limit) {
  for (int m = 0; m < QUAD9_NODES; m++) {
    const double *x = mesh->x + 3 * nodes[m];
    if (fabs(x[axis] - at) > 1e-9 * (1e-3 + fabs(at)) || x[(axis + 1) % 3] > limit ||
        x[(axis + 2) % 3] > limit) {
      return false;
    }
  }
  return true;
}

void body_add_traction(struct fe_model *model, int axis, double at, const double traction[3]) {
  body_add_traction_within(model, axis, at, INFINITY, traction);
}

void body_add_traction_within(struct fe_model *model, int axis, double at, double limit,
                              const double traction[3]) {
  const struct mesh *mesh = model->mesh;
  const struct quad9_tables *t = &model->quad9;
  for (int f = 0; f < mesh->face_count; f++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(mesh, &mesh->faces[f], nodes);
    if (!face_lies_at(mesh, nodes, axis, at, limit)) {
      continue;
    }
    for (int q = 0; q < QUAD9_POINTS; q++) {
      double a[3] = {0}, b[3] = {0}, normal[3];
      for (int m = 0; m < QUAD9_NODES; m++) {
        for (int i = 0; i < 3; i++) {
          a[i] += t->dn[q][0][m] * mesh->x[3 * nodes[m] + i];
          b[i] += t->dn[q][1][m] * mesh->x[3 * nodes[m] + i];
        }
      }
      vec3_cross(a, b, normal);
      double area = t->weight[q] * vec3_norm(normal);
      for (int m = 0; m < QUAD9_NODES; m++) {
        for (int i = 0; i < 3; i++) {
          model->dead_load[3 * nodes[m] + i] += area * t->n[q][m] * traction[i];
        }
      }
    }
  }
}

int body_node(const struct mesh *mesh, double x, double y, double z) {
  return grid_find_node(mesh, (double[3]){x, y, z}, -1);
}

double body_random(unsigned *seed) {
  *seed = *seed * 1664525u + 1013904223u;
  return (*seed >> 8) / (double)(1u << 23) - 1;
}
