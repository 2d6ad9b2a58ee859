/* Quadratic patches over triangles: normals of vertices, curved edges. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/rigid/surface_internal.h"

#define DAMPING 1e-4    /* of the least squares: normals that are nearly equal say nothing across */
#define BEND_MAX 0.6    /* of an edge: that of an arc of 67 degrees */
#define UPRIGHT_MIN 0.3 /* cosine of the angle between a patch and its triangle */

/* ---- evaluation ------------------------------------------------------------------------- */

struct patch surface_patch(const struct surface *surface, int triangle) {
  const int *vertex = surface->triangle + 3 * triangle;
  return (struct patch){
      {surface->x + 3 * vertex[0], surface->x + 3 * vertex[1], surface->x + 3 * vertex[2]},
      surface->bend + 9 * triangle};
}

void patch_point(const struct patch *patch, double v, double w, double point[3],
                 double slope[2][3]) {
  const double *a = patch->bend, *b = a + 3, *c = a + 6, u = 1 - v - w;
  for (int i = 0; i < 3; i++) {
    double x0 = patch->x[0][i], x1 = patch->x[1][i], x2 = patch->x[2][i];
    point[i] = u * x0 + v * x1 + w * x2 - u * v * a[i] - v * w * b[i] - w * u * c[i];
    if (slope) {
      slope[0][i] = x1 - x0 - (u - v) * a[i] - w * b[i] + w * c[i];
      slope[1][i] = x2 - x0 + v * a[i] - v * b[i] - (u - w) * c[i];
    }
  }
}

void patch_curvature(const struct patch *patch, double second[3][3]) {
  const double *a = patch->bend, *b = a + 3, *c = a + 6;
  for (int i = 0; i < 3; i++) {
    second[0][i] = 2 * a[i];
    second[1][i] = a[i] - b[i] + c[i];
    second[2][i] = 2 * c[i];
  }
}

void patch_normal(const struct patch *patch, double v, double w, double normal[3]) {
  double point[3], slope[2][3];
  patch_point(patch, v, w, point, slope);
  vec3_cross(slope[0], slope[1], normal);
  double length = vec3_norm(normal);
  for (int i = 0; i < 3; i++) {
    normal[i] /= length;
  }
}

/* ---- edges ------------------------------------------------------------------------------ */

/* Solves the symmetric positive definite system m c = r. */
static void solve(double m[3][3], const double r[3], double c[3]) {
  double l10 = m[1][0] / m[0][0], l20 = m[2][0] / m[0][0];
  double d1 = m[1][1] - l10 * m[1][0];
  double l21 = (m[2][1] - l20 * m[1][0]) / d1;
  double d2 = m[2][2] - l20 * m[2][0] - l21 * l21 * d1;
  double y1 = r[1] - l10 * r[0], y2 = r[2] - l20 * r[0] - l21 * y1;
  c[2] = y2 / d2;
  c[1] = y1 / d1 - l21 * c[2];
  c[0] = r[0] / m[0][0] - l10 * c[1] - l20 * c[2];
}

/* The bend of an edge that is normal to all normals of both sides, as nearly as it can be. */
static void bend_edge(const struct surface *surface, int half, double bend[3]) {
  int next = half % 3 == 2 ? half - 2 : half + 1, twin = surface->beside[half];
  int twin_next = twin % 3 == 2 ? twin - 2 : twin + 1;
  /* At the start the normals of corners `half` and `twin_next`, at the end the others. */
  const double *normal[4] = {surface->normal + 3 * half, surface->normal + 3 * twin_next,
                             surface->normal + 3 * next, surface->normal + 3 * twin};
  const double *a = surface->x + 3 * surface->triangle[half],
               *b = surface->x + 3 * surface->triangle[next];
  double m[3][3] = {{DAMPING, 0, 0}, {0, DAMPING, 0}, {0, 0, DAMPING}}, r[3] = {0}, edge[3];
  for (int i = 0; i < 3; i++) {
    edge[i] = b[i] - a[i];
  }
  for (int n = 0; n < 4; n++) {
    double wanted = (n < 2 ? 1 : -1) * vec3_dot(normal[n], edge);
    for (int i = 0; i < 3; i++) {
      r[i] += wanted * normal[n][i];
      for (int j = 0; j < 3; j++) {
        m[i][j] += normal[n][i] * normal[n][j];
      }
    }
  }
  solve(m, r, bend);
  double scale = BEND_MAX * vec3_norm(edge) / fmax(vec3_norm(bend), 1e-300);
  for (int i = 0; i < 3 && scale < 1; i++) {
    bend[i] *= scale;
  }
}

static void straighten(struct surface *surface, int half) {
  memset(surface->bend + 3 * half, 0, sizeof(double[3]));
  memset(surface->bend + 3 * surface->beside[half], 0, sizeof(double[3]));
}

/* Makes the edges of patches that lean too far from their triangles straight; returns how many. */
static int straighten_folds(struct surface *surface, const double *flat) {
  static const double places[7][2] = {{0, 0},   {1, 0},     {0, 1},          {0.5, 0},
                                      {0, 0.5}, {0.5, 0.5}, {1 / 3., 1 / 3.}};
  int folds = 0;
  for (int t = 0; t < surface->triangle_count; t++) {
    struct patch patch = surface_patch(surface, t);
    bool upright = true;
    for (int n = 0; n < 7; n++) {
      double normal[3];
      patch_normal(&patch, places[n][0], places[n][1], normal);
      upright = upright && vec3_dot(normal, flat + 3 * t) > UPRIGHT_MIN;
    }
    for (int e = 0; e < 3 && !upright; e++) {
      straighten(surface, 3 * t + e);
    }
    folds += !upright;
  }
  return folds;
}

enum status surface_smooth(struct surface *surface, double crease) {
  size_t triangles = (size_t)surface->triangle_count;
  double *flat = malloc(triangles * sizeof(double[3]));
  surface->bend = calloc(triangles, sizeof(double[9]));
  enum status status =
      flat && surface->bend ? surface_find_normals(surface, crease, flat) : STATUS_NO_MEMORY;
  for (int h = 0; h < 3 * surface->triangle_count && crease > 0 && status == STATUS_OK; h++) {
    if (h < surface->beside[h]) {
      bend_edge(surface, h, surface->bend + 3 * h);
      memcpy(surface->bend + 3 * surface->beside[h], surface->bend + 3 * h, sizeof(double[3]));
    }
  }
  /* Ends, since straight edges only become more, and a patch of three of them is its triangle. */
  while (crease > 0 && status == STATUS_OK && straighten_folds(surface, flat) > 0) {
  }
  free(flat);
  return status;
}
