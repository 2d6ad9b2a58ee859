/* Edges of a surface that pass through its triangles. */
#include <math.h>

#include "solver/base/box_tree.h"
#include "solver/base/vec3.h"
#include "solver/rigid/surface_internal.h"

#define BOXES_MAX 300000000L /* some seconds; even surfaces need a hundred a triangle */

/* Six times the volume of a tetrahedron. */
static double volume(const double a[3], const double b[3], const double c[3], const double d[3]) {
  double p[3], q[3], r[3], cross[3];
  for (int i = 0; i < 3; i++) {
    p[i] = a[i] - d[i];
    q[i] = b[i] - d[i];
    r[i] = c[i] - d[i];
  }
  vec3_cross(p, q, cross);
  return vec3_dot(cross, r);
}

/* Whether the segment a b passes through the inside of a triangle. */
static bool passes(const struct surface *surface, const double a[3], const double b[3], int t) {
  const int *vertex = surface->triangle + 3 * t;
  const double *p = surface->x + 3 * vertex[0], *q = surface->x + 3 * vertex[1],
               *r = surface->x + 3 * vertex[2];
  double above = volume(p, q, r, a), below = volume(p, q, r, b);
  if (above * below >= 0) {
    return false;
  }
  double u = volume(a, b, p, q), v = volume(a, b, q, r), w = volume(a, b, r, p);
  return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

/* Whether a segment from `a` by `way` meets a box. */
static bool meets(const struct box *box, const double a[3], const double way[3]) {
  double enter = 0, leave = 1;
  for (int i = 0; i < 3; i++) {
    if (way[i] == 0) {
      if (a[i] < box->low[i] || a[i] > box->high[i]) {
        return false;
      }
      continue;
    }
    double s = (box->low[i] - a[i]) / way[i], t = (box->high[i] - a[i]) / way[i];
    enter = fmax(enter, fmin(s, t));
    leave = fmin(leave, fmax(s, t));
  }
  return enter <= leave;
}

static bool has_vertex(const struct surface *surface, int t, int vertex) {
  const int *own = surface->triangle + 3 * t;
  return own[0] == vertex || own[1] == vertex || own[2] == vertex;
}

/* A triangle through which the edge from vertex v to vertex w passes, -1 when there is none. Takes
 * the boxes that it looks at from *budget; ends with -1 when that is used up. */
static int find_passed(const struct surface *surface, int v, int w, long *budget) {
  const double *a = surface->x + 3 * v, *b = surface->x + 3 * w;
  double way[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const struct box_branch *all = box_tree_branches(surface->tree);
  int stack[BOX_TREE_DEPTH], waiting = 0;
  stack[waiting++] = 0;
  while (waiting > 0 && --*budget >= 0) {
    const struct box_branch *branch = &all[stack[--waiting]];
    if (!meets(&branch->box, a, way)) {
      continue;
    }
    if (branch->child > 0) {
      stack[waiting++] = branch->child;
      stack[waiting++] = branch->child + 1;
      continue;
    }
    for (int n = 0; n < branch->count; n++) {
      int t = surface->flat[branch->first + n].triangle;
      if (!has_vertex(surface, t, v) && !has_vertex(surface, t, w) && passes(surface, a, b, t)) {
        return t;
      }
    }
  }
  return -1;
}

enum status surface_check_crossing(const struct surface *surface, double unit,
                                   struct error *error) {
  long budget = BOXES_MAX;
  for (int h = 0; h < 3 * surface->triangle_count; h++) {
    int v = surface->triangle[h], w = surface->triangle[h % 3 == 2 ? h - 2 : h + 1];
    int passed = h < surface->beside[h] ? find_passed(surface, v, w, &budget) : -1;
    if (passed >= 0) {
      const double *a = surface->x + 3 * v, *b = surface->x + 3 * w;
      return error_set(error, STATUS_INVALID, "/stl",
                       "the surface passes through itself: the edge from (%g, %g, %g) to (%g, %g, "
                       "%g) of triangle %d goes through triangle %d\na surface that does not cross "
                       "itself",
                       a[0] / unit, a[1] / unit, a[2] / unit, b[0] / unit, b[1] / unit, b[2] / unit,
                       surface->number[h / 3], surface->number[passed]);
    }
  }
  if (budget < 0) {
    return error_set(error, STATUS_TOO_LARGE, "/stl",
                     "the surface has too many long thin triangles, %d in all, to be checked\n"
                     "fewer triangles, or such of more equal sides",
                     surface->triangle_count);
  }
  return STATUS_OK;
}
