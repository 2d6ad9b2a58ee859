#include "tests/physics/inside.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include "solver/base/box_tree.h"
#include "solver/base/vec3.h"

static void node_position(const struct mesh *mesh, const double *u, int node, double x[3]) {
  for (int i = 0; i < 3; i++) {
    x[i] = mesh->x[3 * node + i] + u[3 * node + i];
  }
}

static bool box_holds(const struct box *box, const double x[3]) {
  struct box point = {{x[0], x[1], x[2]}, {x[0], x[1], x[2]}};
  return box_overlaps(box, &point);
}

/* Newton's method for the parent coordinates of x. */
static bool holds(double nodes[HEX27_NODES][3], const double x[3]) {
  double xi[3] = {0, 0, 0};
  for (int iteration = 0; iteration < 30; iteration++) {
    double n[HEX27_NODES], dn[3][HEX27_NODES], d[3] = {x[0], x[1], x[2]}, j[3][3] = {{0}};
    hex27_shape(xi, n, dn);
    for (int a = 0; a < HEX27_NODES; a++) {
      for (int i = 0; i < 3; i++) {
        d[i] -= n[a] * nodes[a][i];
        for (int k = 0; k < 3; k++) {
          j[k][i] += dn[k][a] * nodes[a][i]; /* row k: the tangent along xi_k */
        }
      }
    }
    double normal[3], size = 0;
    vec3_cross(j[1], j[2], normal);
    double determinant = vec3_dot(j[0], normal);
    for (int k = 0; k < 3; k++) {
      vec3_cross(j[(k + 1) % 3], j[(k + 2) % 3], normal);
      double step = vec3_dot(d, normal) / determinant;
      xi[k] = fmax(-2, fmin(2, xi[k] + step));
      size = fmax(size, fabs(step));
    }
    if (size < 1e-10) {
      return fabs(xi[0]) <= 1 && fabs(xi[1]) <= 1 && fabs(xi[2]) <= 1;
    }
  }
  return false;
}

static bool inside_element(const struct mesh *mesh, const double *u, int element, int node,
                           const double x[3]) {
  double nodes[HEX27_NODES][3];
  for (int a = 0; a < HEX27_NODES; a++) {
    int n = mesh->element_nodes[HEX27_NODES * element + a];
    if (n == node) {
      return false;
    }
    node_position(mesh, u, n, nodes[a]);
  }
  return holds(nodes, x);
}

/* Boxes around the nodes of every element; an element does not reach far beyond its nodes. */
static struct box *element_boxes(const struct mesh *mesh, const double *u) {
  struct box *boxes = malloc(sizeof *boxes * ((size_t)mesh->element_count + 1));
  ck_assert_ptr_nonnull(boxes);
  for (int e = 0; e < mesh->element_count; e++) {
    boxes[e] = box_empty();
    for (int a = 0; a < HEX27_NODES; a++) {
      double x[3];
      node_position(mesh, u, mesh->element_nodes[HEX27_NODES * e + a], x);
      box_include(&boxes[e], x);
    }
  }
  return boxes;
}

/* Distance of x from a face: the nearest of a raster of points, in a window that shrinks. */
static double face_distance(const struct mesh *mesh, const double *u, const struct mesh_face *face,
                            const double x[3]) {
  enum { RASTER = 4 };
  int nodes[QUAD9_NODES];
  double middle[2] = {0, 0}, best = INFINITY;
  mesh_face_nodes(mesh, face, nodes);
  for (double window = 1; window > 1e-3; window *= 0.5) {
    double centre[2] = {middle[0], middle[1]};
    for (int k = 0; k < (2 * RASTER + 1) * (2 * RASTER + 1); k++) {
      double s = centre[0] + window * (k / (2 * RASTER + 1) - RASTER) / RASTER;
      double t = centre[1] + window * (k % (2 * RASTER + 1) - RASTER) / RASTER;
      double n[QUAD9_NODES], dn[2][QUAD9_NODES], d[3] = {x[0], x[1], x[2]}, y[3];
      s = fmax(-1, fmin(1, s));
      t = fmax(-1, fmin(1, t));
      quad9_shape(s, t, n, dn, NULL);
      for (int m = 0; m < QUAD9_NODES; m++) {
        node_position(mesh, u, nodes[m], y);
        for (int i = 0; i < 3; i++) {
          d[i] -= n[m] * y[i];
        }
      }
      if (vec3_norm(d) < best) {
        best = vec3_norm(d);
        middle[0] = s;
        middle[1] = t;
      }
    }
  }
  return best;
}

static bool is_outside(const struct mesh_face *face) {
  return face->kind == FACE_OUTER || face->kind == FACE_BASE;
}

static bool has_node(const struct mesh *mesh, const struct mesh_face *face, int node) {
  int nodes[QUAD9_NODES];
  bool found = false;
  mesh_face_nodes(mesh, face, nodes);
  for (int a = 0; a < QUAD9_NODES; a++) {
    found = found || nodes[a] == node;
  }
  return found;
}

/* Depth of x below the surface, 0 outside. Elements that contain `node` (-1: none), and `element`
 * (-1: none), do not count. */
static double depth_of(const struct mesh *mesh, const double *u, const struct box *boxes,
                       const double x[3], int node, int element) {
  bool inside = false;
  for (int e = 0; e < mesh->element_count && !inside; e++) {
    inside = e != element && box_holds(&boxes[e], x) && inside_element(mesh, u, e, node, x);
  }
  double depth = inside ? INFINITY : 0;
  for (int f = 0; f < mesh->face_count && inside; f++) {
    const struct mesh_face *face = &mesh->faces[f];
    if (is_outside(face) && face->element != element && !has_node(mesh, face, node)) {
      depth = fmin(depth, face_distance(mesh, u, face, x));
    }
  }
  return depth;
}

/* Bodies without sections are watched as a whole. */
static bool in_sections(const struct mesh *mesh, int node, int from, int to) {
  return mesh->section_count == 0 ||
         (mesh->node_section[node] >= from && mesh->node_section[node] <= to);
}

double inside_nodes(const struct mesh *mesh, const double *u, int from, int to) {
  unsigned char *seen = calloc((size_t)mesh->node_count, 1);
  struct box *boxes = element_boxes(mesh, u);
  double deepest = 0;
  ck_assert_ptr_nonnull(seen);
  for (int f = 0; f < mesh->face_count; f++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(mesh, &mesh->faces[f], nodes);
    for (int a = 0; a < QUAD9_NODES && is_outside(&mesh->faces[f]); a++) {
      int n = nodes[a];
      if (!seen[n] && in_sections(mesh, n, from, to)) {
        double x[3];
        node_position(mesh, u, n, x);
        deepest = fmax(deepest, depth_of(mesh, u, boxes, x, n, -1));
        seen[n] = 1;
      }
    }
  }
  free(boxes);
  free(seen);
  return deepest;
}

double inside_points(const struct fe_model *model, const double *u, int from, int to) {
  const struct mesh *mesh = model->mesh;
  struct box *boxes = element_boxes(mesh, u);
  double deepest = 0;
  for (int f = 0; f < mesh->face_count; f++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(mesh, &mesh->faces[f], nodes);
    bool watched = is_outside(&mesh->faces[f]) && in_sections(mesh, nodes[4], from, to);
    for (int q = 0; q < QUAD9_POINTS && watched; q++) {
      double x[3] = {0}, y[3];
      for (int a = 0; a < QUAD9_NODES; a++) {
        node_position(mesh, u, nodes[a], y);
        for (int i = 0; i < 3; i++) {
          x[i] += model->quad9.n[q][a] * y[i];
        }
      }
      deepest = fmax(deepest, depth_of(mesh, u, boxes, x, -1, mesh->faces[f].element));
    }
  }
  free(boxes);
  return deepest;
}
