#include "solver/rigid/surface.h"

#include <math.h>
#include <stdlib.h>

#include "solver/base/box_tree.h"
#include "solver/base/vec3.h"
#include "solver/rigid/surface_internal.h"

#define SHORTEST 1e-4 /* m */
#define FARTHEST 10.0 /* m */

void surface_release(struct surface *surface) {
  free(surface->x);
  free(surface->triangle);
  free(surface->number);
  free(surface->beside);
  free(surface->sharp);
  free(surface->normal);
  free(surface->pseudo);
  free(surface->bend);
  box_tree_destroy(surface->tree);
  free(surface->flat);
  *surface = (struct surface){0};
}

/* Refuses sizes that a wrong unit gives. */
static enum status check_size(const struct surface *surface, double unit, struct error *error) {
  double longest = 0, farthest = 0;
  for (int i = 0; i < 3; i++) {
    longest = fmax(longest, unit * (surface->high[i] - surface->low[i]));
    farthest = fmax(farthest, unit * fmax(surface->high[i], -surface->low[i]));
  }
  if (longest >= SHORTEST && farthest <= FARTHEST) {
    return STATUS_OK;
  }
  return error_set(error, STATUS_INVALID, "/unit",
                   "the surface is %g mm long and reaches %g mm from its origin, if its unit is "
                   "%g mm\nat least 0.1 mm long, and no farther than 10 m from its origin",
                   1e3 * longest, 1e3 * farthest, 1e3 * unit);
}

enum status surface_create(const struct stl *stl, double unit, double crease,
                           struct surface *surface, struct error *error) {
  double tolerance;
  *surface = (struct surface){0};
  enum status status = surface_weld(stl, surface, &tolerance);
  if (status == STATUS_OK) {
    status = check_size(surface, unit, error);
  }
  if (status == STATUS_OK) {
    status = surface_check(surface, tolerance, error);
  }
  if (status == STATUS_OK) {
    for (int n = 0; n < 3 * surface->vertex_count; n++) {
      surface->x[n] *= unit;
    }
    status = surface_smooth(surface, crease);
  }
  if (status == STATUS_OK) {
    status = surface_plant(surface);
  }
  if (status == STATUS_OK) {
    status = surface_check_crossing(surface, unit, error);
  }
  if (status == STATUS_NO_MEMORY) {
    error_set(error, status, NULL, "no memory for a surface of %d triangles", stl->count);
  }
  if (status != STATUS_OK) {
    surface_release(surface);
  }
  return status;
}

/* ---- volume ----------------------------------------------------------------------------- */

/* Integrals over the body of 1, x_i and x_i x_j, from those over its surface (Gauss). */
struct moments {
  double volume, first[3], second[3][3];
};

static void add_point(const double x[3], const double area[3], struct moments *sum) {
  sum->volume += vec3_dot(x, area) / 3;
  for (int i = 0; i < 3; i++) {
    sum->first[i] += 0.5 * x[i] * x[i] * area[i];
    for (int j = 0; j < 3; j++) {
      sum->second[i][j] += x[i] * x[i] * x[j] * area[i] / (i == j ? 3 : 2);
    }
  }
}

/* Adds a patch: the integrands are polynomials of degree 8, for which five points a direction on
 * the square that collapses into the triangle are exact. */
static void add_patch(const struct patch *patch, const double origin[3], struct moments *sum) {
  static const double node[5] = {0.046910077030668, 0.230765344947158, 0.5, 0.769234655052841,
                                 0.953089922969332},
                      weight[5] = {0.118463442528095, 0.239314335249683, 0.284444444444444,
                                   0.239314335249683, 0.118463442528095};
  for (int n = 0; n < 25; n++) {
    double v = node[n / 5], w = (1 - v) * node[n % 5], x[3], slope[2][3], area[3];
    patch_point(patch, v, w, x, slope);
    vec3_cross(slope[0], slope[1], area);
    for (int i = 0; i < 3; i++) {
      x[i] -= origin[i];
      area[i] *= weight[n / 5] * weight[n % 5] * (1 - v);
    }
    add_point(x, area, sum);
  }
}

void surface_mass(const struct surface *surface, struct rigid_mass *mass) {
  struct moments sum = {0};
  double origin[3], trace = 0, moment[3][3];
  for (int i = 0; i < 3; i++) {
    origin[i] = 0.5 * (surface->low[i] + surface->high[i]);
  }
  for (int t = 0; t < surface->triangle_count; t++) {
    struct patch patch = surface_patch(surface, t);
    add_patch(&patch, origin, &sum);
  }
  *mass = (struct rigid_mass){.volume = sum.volume};
  for (int i = 0; i < 3; i++) {
    mass->centroid[i] = sum.first[i] / sum.volume;
  }
  for (int n = 0; n < 9; n++) {
    int i = n / 3, j = n % 3;
    double mean = i == j ? sum.second[i][i] : 0.5 * (sum.second[i][j] + sum.second[j][i]);
    moment[i][j] = mean / sum.volume - mass->centroid[i] * mass->centroid[j];
    trace += i == j ? moment[i][i] : 0;
  }
  for (int n = 0; n < 9; n++) {
    mass->inertia[n] = (n % 4 == 0 ? trace : 0) - moment[n / 3][n % 3];
  }
  for (int i = 0; i < 3; i++) {
    mass->centroid[i] += origin[i];
  }
}
