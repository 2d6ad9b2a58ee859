/* Least-squares fit of the contact pressure by continuous, bilinear functions, weighted by area. */
#include <math.h>
#include <string.h>
#include "solver/fe/obstacle_internal.h"

enum { CORNERS = 4, ITERATIONS = 30 };
static const double residual_share = 1e-8;

/* The system M x = b at the nodes in the corners of the faces that touch wholly. */
struct fit {
  const struct fe_model *model;
  const struct obstacle *object;
  double shape[QUAD9_POINTS][CORNERS];
  double *x, *residual, *direction, *product, *diagonal; /* node_count */
};

static const struct obstacle_point *points_of(const struct fit *fit, int f) {
  return &fit->object->point[QUAD9_POINTS * (size_t)f];
}

static bool touches_wholly(const struct obstacle_point *point) {
  for (int q = 0; q < QUAD9_POINTS; q++) {
    if (!(point[q].pressure > 0)) {
      return false;
    }
  }
  return true;
}

static void corner_nodes(const struct fit *fit, int f, int corner[CORNERS]) {
  static const int local[CORNERS] = {0, 2, 6, 8};
  int nodes[QUAD9_NODES];
  mesh_face_nodes(fit->model->mesh, &fit->model->contact.face[f].face, nodes);
  for (int c = 0; c < CORNERS; c++) {
    corner[c] = nodes[local[c]];
  }
}

/* out += integral of the corner functions times that with the nodal values x or, with x NULL, times
 * the pressure; unless NULL, diagonal += that of M. */
static void integrate(const struct fit *fit, const double *x, double *out, double *diagonal) {
  for (int f = 0; f < fit->model->contact.face_count; f++) {
    const struct obstacle_point *point = points_of(fit, f);
    int corner[CORNERS];
    if (!fit->object->near[f] || !touches_wholly(point)) {
      continue;
    }
    corner_nodes(fit, f, corner);
    for (int q = 0; q < QUAD9_POINTS; q++) {
      double value = x ? 0 : point[q].pressure;
      for (int c = 0; x && c < CORNERS; c++) {
        value += fit->shape[q][c] * x[corner[c]];
      }
      for (int c = 0; c < CORNERS; c++) {
        double weight = point[q].area * fit->shape[q][c];
        out[corner[c]] += weight * value;
        if (diagonal) {
          diagonal[corner[c]] += weight * fit->shape[q][c];
        }
      }
    }
  }
}

/* Conjugate gradients with the diagonal as preconditioner; the mass matrix needs few iterations. */
static void solve(struct fit *fit) {
  int count = fit->model->mesh->node_count;
  double *x = fit->x, *r = fit->residual, *d = fit->direction, *q = fit->product;
  double square = 0, first;
  integrate(fit, NULL, r, fit->diagonal);
  for (int n = 0; n < count; n++) {
    d[n] = fit->diagonal[n] > 0 ? r[n] / fit->diagonal[n] : 0;
    square += r[n] * d[n];
  }
  first = square;
  for (int k = 0; k < ITERATIONS && square > residual_share * residual_share * first; k++) {
    double curvature = 0, last = square;
    memset(q, 0, sizeof *q * (size_t)count);
    integrate(fit, d, q, NULL);
    for (int n = 0; n < count; n++) {
      curvature += d[n] * q[n];
    }
    square = 0;
    for (int n = 0; n < count; n++) {
      x[n] += last / curvature * d[n];
      r[n] -= last / curvature * q[n];
      square += fit->diagonal[n] > 0 ? r[n] * r[n] / fit->diagonal[n] : 0;
    }
    for (int n = 0; n < count; n++) {
      d[n] = (fit->diagonal[n] > 0 ? r[n] / fit->diagonal[n] : 0) + square / last * d[n];
    }
  }
}

/* The fit at the points of a face, scaled so that the face keeps its force; where it falls far
 * below the mean within the face, towards an edge of the contact, the points keep their own. */
static void use_fit(const struct fit *fit, int f, struct obstacle_point *point) {
  double value[QUAD9_POINTS], least = INFINITY, force = 0, fitted = 0, area = 0;
  int corner[CORNERS];
  corner_nodes(fit, f, corner);
  for (int q = 0; q < QUAD9_POINTS; q++) {
    value[q] = 0;
    for (int c = 0; c < CORNERS; c++) {
      value[q] += fit->shape[q][c] * fit->x[corner[c]];
    }
    least = fmin(least, value[q]);
    force += point[q].area * point[q].pressure;
    fitted += point[q].area * value[q];
    area += point[q].area;
  }
  if (!(fitted > 0)) {
    return;
  }
  double share = fmax(0, fmin(1, 4 * least * area / fitted));
  for (int q = 0; q < QUAD9_POINTS; q++) {
    point[q].wanted += share * (force / fitted * value[q] - point[q].wanted);
  }
}

void obstacle_smooth(const struct fe_model *m, struct obstacle *o, double *room) {
  size_t count = (size_t)m->mesh->node_count;
  struct fit fit = {.model = m,
                    .object = o,
                    .x = room,
                    .residual = room + count,
                    .direction = room + 2 * count,
                    .product = room + 3 * count,
                    .diagonal = room + 4 * count};
  bool any = false;
  for (int q = 0; q < QUAD9_POINTS; q++) {
    double s = m->quad9.point[q][0], t = m->quad9.point[q][1];
    for (int c = 0; c < CORNERS; c++) {
      fit.shape[q][c] = 0.25 * (1 + (c / 2 ? s : -s)) * (1 + (c % 2 ? t : -t));
    }
  }
  for (int i = 0; i < QUAD9_POINTS * m->contact.face_count; i++) {
    o->point[i].wanted = o->point[i].pressure;
    any = any || o->point[i].pressure > 0;
  }
  if (!any) {
    return;
  }
  memset(room, 0, OBSTACLE_ROOM * count * sizeof *room);
  solve(&fit);
  for (int f = 0; f < m->contact.face_count; f++) {
    struct obstacle_point *point = &o->point[QUAD9_POINTS * (size_t)f];
    if (o->near[f] && touches_wholly(point)) {
      use_fit(&fit, f, point);
    }
  }
}
