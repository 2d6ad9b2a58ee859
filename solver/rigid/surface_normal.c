/* Normals at the vertices of a surface, each side of a crease by itself. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/rigid/surface_internal.h"

#define LEVEL 2e-3     /* rad: neighbours that turn by less are parts of one facet */
#define COMPARABLE 6.0 /* facets count equally while none is larger by more than this */

/* The triangles' own normals, and the areas of their facets. A flat side is a facet far larger than
 * the narrow strips of a rounded rim beside it: it is level up to the rim, and would bulge if the
 * strips, which lean away, had a say in its normals there. */
struct facets {
  const double *normal; /* 3 each */
  const double *area;
};

/* The unit normal of a flat triangle. */
static void flat_normal(const struct surface *surface, int t, double normal[3]) {
  const int *vertex = surface->triangle + 3 * t;
  const double *p[3];
  double a[3], b[3];
  for (int k = 0; k < 3; k++) {
    p[k] = surface->x + 3 * vertex[k];
  }
  for (int i = 0; i < 3; i++) {
    a[i] = p[1][i] - p[0][i];
    b[i] = p[2][i] - p[0][i];
  }
  vec3_cross(a, b, normal);
  double length = vec3_norm(normal);
  for (int i = 0; i < 3; i++) {
    normal[i] /= length;
  }
}

/* The angle of a triangle at a corner. */
static double corner_angle(const struct surface *surface, int corner) {
  int t = corner / 3, k = corner % 3;
  const double *at = surface->x + 3 * surface->triangle[corner],
               *on = surface->x + 3 * surface->triangle[3 * t + (k + 1) % 3],
               *to = surface->x + 3 * surface->triangle[3 * t + (k + 2) % 3];
  double a[3], b[3], cross[3];
  for (int i = 0; i < 3; i++) {
    a[i] = on[i] - at[i];
    b[i] = to[i] - at[i];
  }
  vec3_cross(a, b, cross);
  return atan2(vec3_norm(cross), vec3_dot(a, b));
}

static void normalise(double x[3]) {
  double length = vec3_norm(x);
  for (int i = 0; i < 3 && length > 0; i++) {
    x[i] /= length;
  }
}

/* The angle by which the surface turns at an edge. */
static double turn_at(const struct surface *surface, const double *flat, int half) {
  const double *a = flat + 3 * (half / 3), *b = flat + 3 * (surface->beside[half] / 3);
  double cross[3];
  vec3_cross(a, b, cross);
  return atan2(vec3_norm(cross), vec3_dot(a, b));
}

static double triangle_area(const struct surface *surface, int t) {
  double a[3], b[3], cross[3];
  for (int i = 0; i < 3; i++) {
    const int *vertex = surface->triangle + 3 * t;
    a[i] = surface->x[3 * vertex[1] + i] - surface->x[3 * vertex[0] + i];
    b[i] = surface->x[3 * vertex[2] + i] - surface->x[3 * vertex[0] + i];
  }
  vec3_cross(a, b, cross);
  return 0.5 * vec3_norm(cross);
}

/* The root of the facet of a triangle; ways are shortened as they are gone. */
static int root_of(int *facet, int t) {
  while (facet[t] != t) {
    facet[t] = facet[facet[t]];
    t = facet[t];
  }
  return t;
}

/* The area of the facet of each triangle: of all that lie in one plane with it. */
static void find_facets(const struct surface *surface, const double *flat, int *facet,
                        double *area) {
  for (int t = 0; t < surface->triangle_count; t++) {
    facet[t] = t;
    area[t] = 0;
  }
  for (int h = 0; h < 3 * surface->triangle_count; h++) {
    if (turn_at(surface, flat, h) < LEVEL) {
      facet[root_of(facet, h / 3)] = root_of(facet, surface->beside[h] / 3);
    }
  }
  for (int t = 0; t < surface->triangle_count; t++) {
    area[root_of(facet, t)] += triangle_area(surface, t);
  }
  for (int t = 0; t < surface->triangle_count; t++) {
    area[t] = area[root_of(facet, t)];
  }
}

/* Whether there is a crease between a corner and the next one around its vertex. */
static bool crease_behind(const struct surface *surface, int corner) {
  return surface->sharp[corner % 3 == 0 ? corner + 2 : corner - 1];
}

/* How much a facet says beside the largest one around the vertex: as much while it is not far
 * smaller, then steeply less. */
static double say(double area, double largest) {
  double part = pow(COMPARABLE * area / largest, 4);
  return part / (1 + part);
}

/* The normal of the corners from `begin` to `end` around their vertex, between which there is no
 * crease. */
static void side_normal(struct surface *surface, const struct facets *facets, int begin, int end) {
  double sum[3] = {0}, largest = 0;
  for (int c = begin, last = -1; last != end; c = surface_next_corner(surface, c)) {
    largest = fmax(largest, facets->area[c / 3]);
    last = c;
  }
  for (int c = begin, last = -1; last != end; c = surface_next_corner(surface, c)) {
    double weight = corner_angle(surface, c) * say(facets->area[c / 3], largest);
    for (int i = 0; i < 3; i++) {
      sum[i] += weight * facets->normal[3 * (c / 3) + i];
    }
    last = c;
  }
  normalise(sum);
  for (int c = begin, last = -1; last != end; c = surface_next_corner(surface, c)) {
    memcpy(surface->normal + 3 * c, sum, sizeof sum);
    last = c;
  }
}

/* The normals at the vertex of `corner`: one between each two creases, and for the sign the mean
 * of all triangles, weighted with their angles. */
static void vertex_normals(struct surface *surface, const struct facets *facets, int corner) {
  double *pseudo = surface->pseudo + 3 * surface->triangle[corner];
  int first = corner, at = corner;
  do {
    double angle = corner_angle(surface, at);
    for (int i = 0; i < 3; i++) {
      pseudo[i] += angle * facets->normal[3 * (at / 3) + i];
    }
    int next = surface_next_corner(surface, at);
    first = crease_behind(surface, at) ? next : first;
    at = next;
  } while (at != corner);
  normalise(pseudo);
  int begin = at = first;
  do {
    int next = surface_next_corner(surface, at);
    if (crease_behind(surface, at) || next == first) {
      side_normal(surface, facets, begin, at);
      begin = next;
    }
    at = next;
  } while (at != first);
}

enum status surface_find_normals(struct surface *surface, double crease, double *flat) {
  size_t triangles = (size_t)surface->triangle_count;
  double *area = malloc(triangles * sizeof *area);
  int *facet = malloc(triangles * sizeof *facet);
  bool *done = calloc((size_t)surface->vertex_count, sizeof *done);
  surface->sharp = malloc(3 * triangles * sizeof *surface->sharp);
  surface->normal = calloc(triangles, sizeof(double[9]));
  surface->pseudo = calloc((size_t)surface->vertex_count, sizeof(double[3]));
  bool enough = area && facet && done && surface->sharp && surface->normal && surface->pseudo;
  if (enough) {
    struct facets facets = {flat, area};
    for (int t = 0; t < surface->triangle_count; t++) {
      flat_normal(surface, t, flat + 3 * t);
    }
    find_facets(surface, flat, facet, area);
    for (int h = 0; h < 3 * surface->triangle_count; h++) {
      surface->sharp[h] = turn_at(surface, flat, h) >= crease;
    }
    for (int c = 0; c < 3 * surface->triangle_count; c++) {
      if (!done[surface->triangle[c]]) {
        vertex_normals(surface, &facets, c);
        done[surface->triangle[c]] = true;
      }
    }
  }
  free(area);
  free(facet);
  free(done);
  return enough ? STATUS_OK : STATUS_NO_MEMORY;
}
