/* Corners that are one vertex, by a grid of cells as wide as the tolerance. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "solver/rigid/surface_internal.h"

/* Vertices by the cell that holds them: chains in a table of 2^bits. */
struct grid {
  double width, low[3];
  int bits;
  int *head, *next; /* vertex + 1, 0 at the end */
};

static void cell_of(const struct grid *grid, const double x[3], int64_t cell[3]) {
  for (int i = 0; i < 3; i++) {
    cell[i] = (int64_t)floor((x[i] - grid->low[i]) / grid->width);
  }
}

static size_t slot_of(const struct grid *grid, const int64_t cell[3]) {
  uint64_t hash = (uint64_t)cell[0] * 0x9E3779B97F4A7C15u ^
                  (uint64_t)cell[1] * 0xC2B2AE3D27D4EB4Fu ^ (uint64_t)cell[2] * 0x165667B19E3779F9u;
  return (size_t)((hash ^ hash >> 29) * 0xBF58476D1CE4E5B9u >> (64 - grid->bits));
}

static int find_in_cell(const struct grid *grid, const struct surface *surface,
                        const int64_t cell[3], const double x[3]) {
  for (int at = grid->head[slot_of(grid, cell)]; at > 0; at = grid->next[at - 1]) {
    const double *y = surface->x + 3 * (at - 1);
    if (fabs(y[0] - x[0]) <= grid->width && fabs(y[1] - x[1]) <= grid->width &&
        fabs(y[2] - x[2]) <= grid->width) {
      return at - 1;
    }
  }
  return -1;
}

/* The vertex at x, a new one where there is none. */
static int vertex_at(struct grid *grid, struct surface *surface, const double x[3]) {
  int64_t cell[3];
  cell_of(grid, x, cell);
  int found = find_in_cell(grid, surface, cell, x);
  for (int n = 0; n < 27 && found < 0; n++) {
    int64_t near[3] = {cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1};
    found = n == 13 ? -1 : find_in_cell(grid, surface, near, x);
  }
  if (found < 0) {
    size_t slot = slot_of(grid, cell);
    found = surface->vertex_count++;
    memcpy(surface->x + 3 * found, x, sizeof(double[3]));
    grid->next[found] = grid->head[slot];
    grid->head[slot] = found + 1;
  }
  return found;
}

static void bound(const struct stl *stl, double low[3], double high[3], double *largest) {
  *largest = 0;
  for (int i = 0; i < 3; i++) {
    low[i] = INFINITY;
    high[i] = -INFINITY;
  }
  for (int n = 0; n < 9 * stl->count; n++) {
    low[n % 3] = fmin(low[n % 3], stl->corner[n]);
    high[n % 3] = fmax(high[n % 3], stl->corner[n]);
    *largest = fmax(*largest, fabs(stl->corner[n]));
  }
}

enum status surface_weld(const struct stl *stl, struct surface *surface, double *tolerance) {
  size_t corners = 3 * (size_t)stl->count;
  struct grid grid = {.bits = 4};
  double largest, square = 0;
  bound(stl, surface->low, surface->high, &largest);
  for (int i = 0; i < 3; i++) {
    double side = surface->high[i] - surface->low[i];
    square += side * side;
    grid.low[i] = surface->low[i];
  }
  /* Neighbours in single precision are 1.2e-7 of the coordinate apart. */
  *tolerance = grid.width = fmax(1e-6 * sqrt(square), fmax(2.5e-7 * largest, 1e-300));
  while ((size_t)1 << grid.bits < corners) {
    grid.bits++;
  }
  grid.head = calloc((size_t)1 << grid.bits, sizeof *grid.head);
  grid.next = malloc(corners * sizeof *grid.next);
  surface->x = malloc(corners * sizeof(double[3]));
  surface->triangle = malloc(corners * sizeof *surface->triangle);
  surface->number = malloc((size_t)stl->count * sizeof *surface->number);
  bool enough = grid.head && grid.next && surface->x && surface->triangle && surface->number;
  for (int t = 0; t < stl->count && enough; t++) {
    int *vertex = surface->triangle + 3 * surface->triangle_count;
    for (int k = 0; k < 3; k++) {
      vertex[k] = vertex_at(&grid, surface, stl->corner + 9 * t + 3 * k);
    }
    if (vertex[0] != vertex[1] && vertex[1] != vertex[2] && vertex[2] != vertex[0]) {
      surface->number[surface->triangle_count++] = t + 1;
    }
  }
  free(grid.head);
  free(grid.next);
  return enough ? STATUS_OK : STATUS_NO_MEMORY;
}
