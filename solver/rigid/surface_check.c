/* Whether triangles are the closed, oriented surface of one body, and what they lack. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/rigid/surface_internal.h"

/* A side of a triangle, sorted by its two vertices. */
struct side {
  uint64_t vertices; /* the lower number in the upper half */
  int half;          /* 3 t + e */
};

static int start_of(const struct surface *surface, int half) {
  return surface->triangle[half];
}

static int end_of(const struct surface *surface, int half) {
  return surface->triangle[half % 3 == 2 ? half - 2 : half + 1];
}

static int compare_sides(const void *a, const void *b) {
  const struct side *p = a, *q = b;
  if (p->vertices != q->vertices) {
    return p->vertices < q->vertices ? -1 : 1;
  }
  return p->half < q->half ? -1 : p->half > q->half;
}

/* ---- faults ----------------------------------------------------------------------------- */

/* "fault: the edge from (..) to (..) of triangle N ..., and M more such edges". */
static enum status refuse_edge(const struct surface *surface, int half, int faults,
                               const char *fault, const char *detail, struct error *error) {
  const double *a = surface->x + 3 * start_of(surface, half),
               *b = surface->x + 3 * end_of(surface, half);
  char more[60] = "";
  if (faults > 1) {
    snprintf(more, sizeof more, ", and so are %d more edges", faults - 1);
  }
  return error_set(error, STATUS_INVALID, "/stl",
                   "the surface is %s: the edge from (%g, %g, %g) to (%g, %g, %g) of triangle %d "
                   "%s%s\na closed surface of one body, every edge of which joins two triangles, "
                   "whose corners go counter-clockwise seen from outside",
                   fault, a[0], a[1], a[2], b[0], b[1], b[2], surface->number[half / 3], detail,
                   more);
}

static enum status check_areas(const struct surface *surface, double tolerance,
                               struct error *error) {
  for (int t = 0; t < surface->triangle_count; t++) {
    const double *p[3];
    double side[3][3], cross[3], longest = 0;
    for (int k = 0; k < 3; k++) {
      p[k] = surface->x + 3 * surface->triangle[3 * t + k];
    }
    for (int k = 0; k < 3; k++) {
      for (int i = 0; i < 3; i++) {
        side[k][i] = p[(k + 1) % 3][i] - p[k][i];
      }
      longest = fmax(longest, vec3_norm(side[k]));
    }
    vec3_cross(side[0], side[1], cross);
    if (!(vec3_norm(cross) > tolerance * longest)) {
      return error_set(error, STATUS_INVALID, "/stl",
                       "triangle %d of the surface has no area: (%g, %g, %g), (%g, %g, %g) and "
                       "(%g, %g, %g) are on a line\ntriangles with an area",
                       surface->number[t], p[0][0], p[0][1], p[0][2], p[1][0], p[1][1], p[1][2],
                       p[2][0], p[2][1], p[2][2]);
    }
  }
  return STATUS_OK;
}

/* ---- neighbours ------------------------------------------------------------------------- */

/* What is wrong with the sides of one edge. */
enum fault { FAULT_NONE, FAULT_OPEN, FAULT_SHARED, FAULT_TURNED };

static enum fault fault_of(const struct surface *surface, const struct side *side, int count) {
  if (count == 1) {
    return FAULT_OPEN;
  }
  if (count > 2) {
    return FAULT_SHARED;
  }
  return start_of(surface, side[0].half) == start_of(surface, side[1].half) ? FAULT_TURNED
                                                                            : FAULT_NONE;
}

/* Joins the sides that two triangles share; counts the faults of each kind and notes the first. */
static void join_sides(struct surface *surface, const struct side *side, int faults[4],
                       int first[4]) {
  int sides = 3 * surface->triangle_count;
  for (int at = 0, next; at < sides; at = next) {
    next = at + 1;
    while (next < sides && side[next].vertices == side[at].vertices) {
      next++;
    }
    enum fault fault = fault_of(surface, side + at, next - at);
    first[fault] = faults[fault]++ == 0 ? side[at].half : first[fault];
    if (fault == FAULT_NONE) {
      surface->beside[side[at].half] = side[at + 1].half;
      surface->beside[side[at + 1].half] = side[at].half;
    }
  }
}

static enum status find_neighbours(struct surface *surface, struct error *error) {
  static const char *const words[4][2] = {
      {"", ""},
      {"open", "belongs to no other"},
      {"no boundary of a body", "belongs to more than two triangles"},
      {"not oriented", "runs the same way in its neighbour, so that one of them is turned over"}};
  int sides = 3 * surface->triangle_count, faults[4] = {0}, first[4] = {0};
  struct side *side = malloc(sizeof *side * (size_t)sides);
  if (!side) {
    return STATUS_NO_MEMORY;
  }
  for (int h = 0; h < sides; h++) {
    uint64_t a = (uint64_t)start_of(surface, h), b = (uint64_t)end_of(surface, h);
    side[h] = (struct side){a < b ? a << 32 | b : b << 32 | a, h};
  }
  qsort(side, (size_t)sides, sizeof *side, compare_sides);
  join_sides(surface, side, faults, first);
  free(side);
  for (int fault = FAULT_OPEN; fault <= FAULT_TURNED; fault++) {
    if (faults[fault] > 0) {
      return refuse_edge(surface, first[fault], faults[fault], words[fault][0], words[fault][1],
                         error);
    }
  }
  return STATUS_OK;
}

int surface_next_corner(const struct surface *surface, int corner) {
  /* The twin of the edge that ends in this corner begins there. */
  return surface->beside[corner % 3 == 0 ? corner + 2 : corner - 1];
}

/* ---- vertices and bodies ---------------------------------------------------------------- */

/* All triangles of a vertex are met by going around it once, or two parts touch there. */
static enum status check_vertices(const struct surface *surface, int *seen, struct error *error) {
  int corners = 3 * surface->triangle_count;
  memset(seen, 0, sizeof *seen * (size_t)surface->vertex_count);
  for (int c = 0; c < corners; c++) {
    seen[surface->triangle[c]]++;
  }
  for (int c = 0; c < corners; c++) {
    int vertex = surface->triangle[c], around = 0;
    if (seen[vertex] == 0) {
      continue;
    }
    for (int at = c; around == 0 || at != c; around++) {
      at = surface_next_corner(surface, at);
    }
    if (around != seen[vertex]) {
      const double *x = surface->x + 3 * vertex;
      return error_set(error, STATUS_INVALID, "/stl",
                       "two parts of the surface touch in the point (%g, %g, %g) alone\na body "
                       "that is joined along edges",
                       x[0], x[1], x[2]);
    }
    seen[vertex] = 0;
  }
  return STATUS_OK;
}

/* Triangles that can be reached from the first one over edges, marked in `seen`. */
static int count_joined(const struct surface *surface, int *seen, int *stack) {
  int waiting = 1, count = 0;
  memset(seen, 0, sizeof *seen * (size_t)surface->triangle_count);
  stack[0] = 0;
  seen[0] = 1;
  while (waiting > 0) {
    int t = stack[--waiting];
    count++;
    for (int e = 0; e < 3; e++) {
      int other = surface->beside[3 * t + e] / 3;
      if (!seen[other]) {
        seen[other] = 1;
        stack[waiting++] = other;
      }
    }
  }
  return count;
}

static enum status check_one_body(const struct surface *surface, int *seen, int *stack,
                                  struct error *error) {
  int joined = count_joined(surface, seen, stack), t = 0;
  if (joined == surface->triangle_count) {
    return STATUS_OK;
  }
  while (seen[t]) {
    t++;
  }
  const double *x = surface->x + 3 * surface->triangle[3 * t];
  return error_set(error, STATUS_INVALID, "/stl",
                   "the surface has several shells: %d of its %d triangles hang together, and "
                   "triangle %d at (%g, %g, %g) is of another one\none body without holes inside",
                   joined, surface->triangle_count, surface->number[t], x[0], x[1], x[2]);
}

static enum status check_outside(const struct surface *surface, struct error *error) {
  double volume = 0;
  const double *base = surface->x;
  for (int t = 0; t < surface->triangle_count; t++) {
    double p[3][3], cross[3];
    for (int k = 0; k < 9; k++) {
      p[k / 3][k % 3] = surface->x[3 * surface->triangle[3 * t + k / 3] + k % 3] - base[k % 3];
    }
    vec3_cross(p[0], p[1], cross);
    volume += vec3_dot(cross, p[2]) / 6;
  }
  if (volume > 0) {
    return STATUS_OK;
  }
  return error_set(error, STATUS_INVALID, "/stl",
                   "the surface is inside out: it encloses a volume of %g in its unit cubed\n"
                   "triangles whose corners go counter-clockwise seen from outside",
                   volume);
}

enum status surface_check(struct surface *surface, double tolerance, struct error *error) {
  size_t halves = 3 * (size_t)surface->triangle_count;
  if (surface->triangle_count < 4) {
    return error_set(error, STATUS_INVALID, "/stl",
                     "the surface has %d triangles with three different corners\na closed surface "
                     "has at least 4",
                     surface->triangle_count);
  }
  size_t most = halves + (size_t)surface->vertex_count;
  int *seen = malloc(most * sizeof *seen), *stack = malloc(halves * sizeof *stack);
  surface->beside = malloc(halves * sizeof *surface->beside);
  enum status status = seen && stack && surface->beside ? STATUS_OK : STATUS_NO_MEMORY;
  if (status == STATUS_OK) {
    status = check_areas(surface, tolerance, error);
  }
  if (status == STATUS_OK) {
    status = find_neighbours(surface, error);
  }
  if (status == STATUS_OK) {
    status = check_vertices(surface, seen, error);
  }
  if (status == STATUS_OK) {
    status = check_one_body(surface, seen, stack, error);
  }
  if (status == STATUS_OK) {
    status = check_outside(surface, error);
  }
  free(seen);
  free(stack);
  return status;
}
