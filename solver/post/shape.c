#include "solver/post/shape.h"

#include <math.h>
#include <stdlib.h>
#include "solver/base/vec3.h"

/* Angle of a direction in the x-z plane, positive towards -z. */
static double direction(const double a[3], const double b[3]) {
  return atan2(a[2] - b[2], b[0] - a[0]);
}

/* The value of `angle` plus whole turns that lies nearest to `near`. */
static double unwrap(double angle, double near) {
  return angle + 2 * M_PI * round((near - angle) / (2 * M_PI));
}

static void place(const struct mesh *mesh, const double *u, int section, double x[3]) {
  int node = mesh->centreline[section];
  for (int i = 0; i < 3; i++) {
    x[i] = mesh->x[3 * node + i] + (u ? u[3 * node + i] : 0);
  }
}

/* Bending and chord angle of a configuration, accumulated from station to station. */
static void centreline_angles(const struct mesh *mesh, const double *u, double *bending,
                              double *chord) {
  double base[3], previous[3];
  place(mesh, u, mesh->station[0], base);
  place(mesh, u, mesh->station[0], previous);
  *bending = *chord = 0;
  for (int s = 1; s < mesh->station_count; s++) {
    double x[3];
    place(mesh, u, mesh->station[s], x);
    *bending = unwrap(direction(previous, x), *bending);
    *chord = unwrap(direction(base, x), *chord);
    for (int i = 0; i < 3; i++) {
      previous[i] = x[i];
    }
  }
}

/* Area of a face, from its diagonals. */
static double face_area(const struct mesh *mesh, const int nodes[QUAD9_NODES]) {
  double first[3], second[3], normal[3];
  for (int i = 0; i < 3; i++) {
    first[i] = mesh->x[3 * nodes[8] + i] - mesh->x[3 * nodes[0] + i];
    second[i] = mesh->x[3 * nodes[6] + i] - mesh->x[3 * nodes[2] + i];
  }
  vec3_cross(first, second, normal);
  return 0.5 * vec3_norm(normal);
}

static bool in_end_face(const struct mesh *mesh, const struct mesh_face *face,
                        const int nodes[QUAD9_NODES]) {
  bool inside = face->axis == 0 && face->side > 0;
  for (int m = 0; m < QUAD9_NODES; m++) {
    inside = inside && mesh->node_core[nodes[m]] &&
             mesh->node_section[nodes[m]] == mesh->section_count - 1;
  }
  return inside;
}

/* Rotation about y, towards -z, that carries the bottom layer's end face best to where it is now:
 * least squares over its area, so that it does not depend on where the nodes are. */
static double end_face_angle(const struct mesh *mesh, const double *u) {
  static const double simpson[3] = {1.0 / 6, 4.0 / 6, 1.0 / 6};
  double area = 0, mean[4] = {0}, across = 0, along = 0;
  for (int f = 0; f < mesh->face_count; f++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(mesh, &mesh->faces[f], nodes);
    if (!in_end_face(mesh, &mesh->faces[f], nodes)) {
      continue;
    }
    double whole = face_area(mesh, nodes);
    for (int m = 0; m < QUAD9_NODES; m++) {
      const double *x = mesh->x + 3 * (size_t)nodes[m], *d = u + 3 * (size_t)nodes[m];
      double weight = whole * simpson[m / 3] * simpson[m % 3];
      double value[4] = {x[0], x[2], x[0] + d[0], x[2] + d[2]};
      area += weight;
      across += weight * (value[1] * value[2] - value[0] * value[3]);
      along += weight * (value[0] * value[2] + value[1] * value[3]);
      for (int k = 0; k < 4; k++) {
        mean[k] += weight * value[k];
      }
    }
  }
  across -= (mean[1] * mean[2] - mean[0] * mean[3]) / area;
  along -= (mean[0] * mean[2] + mean[1] * mean[3]) / area;
  return atan2(across, along);
}

void shape_measure(const struct mesh *mesh, const double *u, struct shape *shape) {
  double bending, chord;
  centreline_angles(mesh, NULL, &bending, &chord);
  centreline_angles(mesh, u, &shape->bending_angle, &shape->chord_angle);
  shape->bending_angle -= bending;
  shape->chord_angle -= chord;
  shape->end_face_angle = unwrap(end_face_angle(mesh, u), shape->bending_angle);
  place(mesh, u, mesh->section_count - 1, shape->tip);
}

void shape_midline(const struct mesh *mesh, const double *u, double *out) {
  for (int s = 0; s < mesh->section_count; s++) {
    place(mesh, u, s, out + 3 * s);
  }
}

static double largest_stretch(const double f[9]) {
  double c[9];
  for (int i = 0; i < 9; i++) {
    c[i] = f[i / 3] * f[i % 3] + f[3 + i / 3] * f[3 + i % 3] + f[6 + i / 3] * f[6 + i % 3];
  }
  return sqrt(symmetric3_largest(c));
}

double shape_stretch(const struct fe_model *model, const double *u, double *node_stretch) {
  const struct mesh *mesh = model->mesh;
  double most = 0;
  int *count = calloc((size_t)mesh->node_count, sizeof *count);
  if (!count) {
    return -1;
  }
  for (int n = 0; node_stretch && n < mesh->node_count; n++) {
    node_stretch[n] = 0;
  }
  for (int e = 0; e < mesh->element_count; e++) {
    double local[3][HEX27_STRIDE], f[9];
    model_gather(model, u, e, local);
    for (int q = 0; q < HEX27_POINTS; q++) {
      element_gradient(&model->geometry[e], q, local, f);
      double stretch = largest_stretch(f);
      most = fmax(most, stretch);
      if (node_stretch) { /* Gauss points are numbered like the nodes */
        int node = mesh->element_nodes[HEX27_NODES * e + q];
        node_stretch[node] += stretch;
        count[node]++;
      }
    }
  }
  for (int n = 0; node_stretch && n < mesh->node_count; n++) {
    node_stretch[n] /= count[n] > 0 ? count[n] : 1;
  }
  free(count);
  return most;
}
