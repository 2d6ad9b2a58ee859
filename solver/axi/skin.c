#include "solver/axi/skin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Tangents at the start and at the end of an edge, over start, end, middle. */
static const double at_start[AXI_EDGE_NODES] = {-1.5, -0.5, 2};
static const double at_end[AXI_EDGE_NODES] = {0.5, 1.5, -2};

/* ---- one turning ------------------------------------------------------------------------- */

static void tangent_of(const double *coefficient, int count, double x[SKIN_NODES][2], double v[2]) {
  v[0] = v[1] = 0;
  for (int a = 0; a < count; a++) {
    v[0] += coefficient[a] * x[a][0];
    v[1] += coefficient[a] * x[a][1];
  }
}

/* theta = arg(to) - arg(from), in (-pi, pi). */
static double turning_angle(const struct axi_turning *t, double x[SKIN_NODES][2], double from[2],
                            double to[2]) {
  tangent_of(t->from, t->count, x, from);
  tangent_of(t->to, t->count, x, to);
  return atan2(from[0] * to[1] - from[1] * to[0], from[0] * to[0] + from[1] * to[1]);
}

/* d2 arg(v) = 1/|v|^4 [[2 r z, z^2 - r^2], [z^2 - r^2, -2 r z]] over v = (r, z). */
static void second_of_argument(const double v[2], double h[2][2]) {
  double square = v[0] * v[0] + v[1] * v[1], scale = 1 / (square * square);
  h[0][0] = 2 * v[0] * v[1] * scale;
  h[0][1] = h[1][0] = (v[1] * v[1] - v[0] * v[0]) * scale;
  h[1][1] = -h[0][0];
}

bool axi_skin_evaluate(const struct axi_turning *t, double x[SKIN_NODES][2], double *energy,
                       double force[SKIN_DOFS], double *tangent) {
  double from[2], to[2], grad[SKIN_DOFS], before[2][2], after[2][2];
  double half = 0.5 * turning_angle(t, x, from, to), c = cos(half);
  if (!(c > 1e-3)) {
    return false;
  }
  double q = 2 * tan(half), first = 1 / (c * c), second = first * tan(half);
  double slope = t->stiffness * (q - t->rest);
  double a = from[0] * from[0] + from[1] * from[1], b = to[0] * to[0] + to[1] * to[1];
  *energy = 0.5 * slope * (q - t->rest);
  for (int k = 0; k < 2 * t->count; k++) {
    int n = k / 2, other = 1 - k % 2;
    double sign = k % 2 ? 1 : -1;
    grad[k] = sign * (t->to[n] * to[other] / b - t->from[n] * from[other] / a);
    force[k] = slope * first * grad[k];
  }
  if (!tangent) {
    return true;
  }
  second_of_argument(from, before);
  second_of_argument(to, after);
  double outer = t->stiffness * first * first + slope * second, along = slope * first;
  for (int k = 0; k < 2 * t->count; k++) {
    for (int l = k; l < 2 * t->count; l++) {
      int m = k / 2, n = l / 2, i = k % 2, j = l % 2;
      double bend = t->to[m] * t->to[n] * after[i][j] - t->from[m] * t->from[n] * before[i][j];
      *tangent++ = outer * grad[k] * grad[l] + along * bend;
    }
  }
  return true;
}

/* ---- the skin ---------------------------------------------------------------------------- */

static const int *edge_nodes(const struct axi_mesh *mesh, int k) {
  return k < mesh->inner_count ? mesh->inner[k].node : mesh->outer[k - mesh->inner_count].node;
}

static double edge_length(const struct axi_mesh *mesh, const int *node) {
  const double *a = &mesh->position[2 * node[0]], *b = &mesh->position[2 * node[1]];
  const double *m = &mesh->position[2 * node[2]];
  return hypot(m[0] - a[0], m[1] - a[1]) + hypot(b[0] - m[0], b[1] - m[1]);
}

/* From edge k to edge `next`, or inside of it when they are one. */
static void turning_init(const struct axi_mesh *mesh, int k, int next, double bending,
                         struct axi_turning *t) {
  const int *one = edge_nodes(mesh, k), *two = edge_nodes(mesh, next);
  bool inside = k == next;
  double x[SKIN_NODES][2], from[2], to[2];
  *t = (struct axi_turning){.count = inside ? AXI_EDGE_NODES : SKIN_NODES};
  for (int a = 0; a < AXI_EDGE_NODES; a++) {
    t->node[a] = one[a];
    t->from[a] = inside ? at_start[a] : at_end[a];
    if (inside) {
      t->to[a] = at_end[a];
    } else {
      t->node[AXI_EDGE_NODES + a] = two[a];
      t->to[AXI_EDGE_NODES + a] = at_start[a];
    }
  }
  double length = 0.5 * (edge_length(mesh, one) + edge_length(mesh, two));
  double radius = mesh->position[2 * one[inside ? 2 : 1]];
  t->stiffness = 2 * M_PI * radius * bending / (inside ? length : 0.25 * length);
  for (int a = 0; a < t->count; a++) {
    memcpy(x[a], &mesh->position[2 * t->node[a]], sizeof x[a]);
  }
  t->rest = 2 * tan(0.5 * turning_angle(t, x, from, to));
}

/* The edge that follows, also across the end of a body that repeats along z; -1. */
static int follower(const struct axi_mesh *mesh, int k, const int *by_start) {
  int end = edge_nodes(mesh, k)[1];
  if (by_start[end] >= 0 || mesh->master[end] < 0) {
    return by_start[end];
  }
  return mesh->hold[2 * end + 1] == AXI_AHEAD ? by_start[mesh->master[end]] : -1;
}

static enum status fill(const struct axi_mesh *mesh, double thickness, int *by_start, int *owner,
                        struct axi_skin *skin, struct error *error) {
  int edges = mesh->inner_count + mesh->outer_count;
  for (int i = 0; i < mesh->node_count; i++) {
    by_start[i] = owner[i] = -1;
  }
  for (int e = 0; e < mesh->element_count; e++) {
    for (int a = 0; a < AXI_NODES; a++) {
      owner[mesh->element[e].node[a]] = e;
    }
  }
  for (int k = 0; k < edges; k++) {
    int start = edge_nodes(mesh, k)[0];
    by_start[start] = k;
    /* The way down begins where the copy of the lower end is: that one is followed by it. */
    if (mesh->hold[2 * start + 1] == AXI_AHEAD && mesh->master[start] >= 0) {
      by_start[mesh->master[start]] = k;
    }
  }
  for (int k = 0; k < edges; k++) {
    int element = owner[edge_nodes(mesh, k)[2]], next = follower(mesh, k, by_start);
    if (element < 0) {
      return error_set(error, STATUS_INVALID, NULL, "edge %d of the mesh has no element", k);
    }
    double modulus = material_shear_modulus(&mesh->region[mesh->element[element].region]);
    double bending = modulus * thickness * thickness * thickness / 3;
    turning_init(mesh, k, k, bending, &skin->turning[skin->count++]);
    if (next >= 0) {
      turning_init(mesh, k, next, bending, &skin->turning[skin->count++]);
    }
  }
  return STATUS_OK;
}

enum status axi_skin_create(const struct axi_mesh *mesh, double thickness, struct axi_skin *skin,
                            struct error *error) {
  size_t edges = (size_t)(mesh->inner_count + mesh->outer_count), nodes = (size_t)mesh->node_count;
  int *by_start = malloc(sizeof *by_start * (2 * nodes + 1));
  *skin = (struct axi_skin){.turning = calloc(2 * edges + 1, sizeof *skin->turning)};
  enum status status = STATUS_NO_MEMORY;
  if (by_start && skin->turning) {
    status = fill(mesh, thickness, by_start, by_start + nodes, skin, error);
  } else {
    error_set(error, status, NULL, "no memory for a skin of %zu edges", edges);
  }
  free(by_start);
  if (status != STATUS_OK) {
    axi_skin_release(skin);
  }
  return status;
}

void axi_skin_release(struct axi_skin *skin) {
  free(skin->turning);
  *skin = (struct axi_skin){.count = 0};
}
