#include "server/plot/isoline.h"

#include <math.h>
#include <stdlib.h>

/* A grid edge is crossed at most once. Those to the right are 2 (row columns + column), those
 * upwards one more. */
enum { NONE = 0 };

/* How the pieces of lines hang together: each crossed edge has up to two neighbours. */
struct tracer {
  const double *value;
  size_t columns, rows;
  double level;
  size_t (*next)[2]; /* [edges], edge + 1; NONE: no neighbour */
  bool *used;
};

static double at(const struct tracer *t, size_t column, size_t row) {
  return t->value[row * t->columns + column] - t->level;
}

/* Where the line crosses an edge. */
static struct point crossing(const struct tracer *t, size_t edge) {
  size_t node = edge / 2, column = node % t->columns, row = node / t->columns;
  bool up = edge % 2;
  double a = at(t, column, row), b = up ? at(t, column, row + 1) : at(t, column + 1, row);
  double part = a == b ? 0.5 : a / (a - b);
  return (struct point){(double)column + (up ? 0 : part), (double)row + (up ? part : 0)};
}

static void join(struct tracer *t, size_t a, size_t b) {
  t->next[a][t->next[a][0] != NONE] = b + 1;
  t->next[b][t->next[b][0] != NONE] = a + 1;
}

/* Joins the edges that the line crosses around one cell; at a saddle the mean decides which. */
static void join_cell(struct tracer *t, size_t column, size_t row) {
  double corner[4] = {at(t, column, row), at(t, column + 1, row), at(t, column + 1, row + 1),
                      at(t, column, row + 1)};
  size_t node = row * t->columns + column;
  const size_t edge[4] = {2 * node, 2 * (node + 1) + 1, 2 * (node + t->columns), 2 * node + 1};
  size_t crossed[4], count = 0;
  for (int k = 0; k < 4; k++) {
    if (isnan(corner[k])) {
      return;
    }
    if ((corner[k] > 0) != (corner[(k + 1) % 4] > 0)) {
      crossed[count++] = edge[k];
    }
  }
  if (count == 2) {
    join(t, crossed[0], crossed[1]);
  } else if (count == 4) {
    bool high = corner[0] + corner[1] + corner[2] + corner[3] > 0;
    bool apart = (corner[0] > 0) == high;
    join(t, crossed[0], crossed[apart ? 1 : 3]);
    join(t, crossed[2], crossed[apart ? 3 : 1]);
  }
}

/* Follows the line from an edge; count points are written when points is not NULL. */
static size_t follow(struct tracer *t, size_t start, struct point *points, bool *closed) {
  size_t edge = start, before = NONE, count = 0;
  *closed = false;
  for (;;) {
    t->used[edge] = true;
    points[count++] = crossing(t, edge);
    size_t to = t->next[edge][0];
    if (to == NONE || to == before) {
      to = t->next[edge][1];
    }
    if (to == NONE || to == before) {
      return count;
    }
    if (to - 1 == start) {
      points[count++] = crossing(t, start);
      *closed = true;
      return count;
    }
    if (t->used[to - 1]) {
      return count;
    }
    before = edge + 1;
    edge = to - 1;
  }
}

static enum status add_line(struct isolines *lines, const struct point *points, size_t count,
                            bool closed, struct error *error) {
  struct isoline *grown = realloc(lines->line, (lines->count + 1) * sizeof *grown);
  struct point *copy = malloc(count * sizeof *copy);
  lines->line = grown ? grown : lines->line;
  if (!grown || !copy) {
    free(copy);
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for lines of equal value");
  }
  for (size_t i = 0; i < count; i++) {
    copy[i] = points[i];
  }
  lines->line[lines->count++] = (struct isoline){copy, count, closed};
  return STATUS_OK;
}

/* Open lines first, from their ends; what is left is closed. */
static enum status collect(struct tracer *t, struct point *points, struct isolines *lines,
                           struct error *error) {
  enum status status = STATUS_OK;
  size_t edges = 2 * t->columns * t->rows;
  for (int pass = 0; pass < 2; pass++) {
    for (size_t edge = 0; edge < edges && status == STATUS_OK; edge++) {
      bool end = t->next[edge][0] != NONE && t->next[edge][1] == NONE;
      bool closed;
      if (t->used[edge] || t->next[edge][0] == NONE || (pass == 0 && !end)) {
        continue;
      }
      size_t count = follow(t, edge, points, &closed);
      status = add_line(lines, points, count, closed, error);
    }
  }
  return status;
}

enum status isolines_find(const double *value, size_t columns, size_t rows, double level,
                          struct isolines *lines, struct error *error) {
  enum status status = STATUS_OK;
  size_t edges = 2 * columns * rows;
  struct tracer tracer = {.value = value,
                          .columns = columns,
                          .rows = rows,
                          .level = level,
                          .next = calloc(edges + 1, sizeof *tracer.next),
                          .used = calloc(edges + 1, sizeof *tracer.used)};
  struct point *points = malloc((edges + 2) * sizeof *points);
  *lines = (struct isolines){0};
  if (!tracer.next || !tracer.used || !points) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for lines of equal value");
    goto done;
  }
  for (size_t row = 0; row + 1 < rows; row++) {
    for (size_t column = 0; column + 1 < columns; column++) {
      join_cell(&tracer, column, row);
    }
  }
  status = collect(&tracer, points, lines, error);
done:
  free(tracer.next);
  free(tracer.used);
  free(points);
  return status;
}

void isolines_release(struct isolines *lines) {
  for (size_t i = 0; i < lines->count; i++) {
    free(lines->line[i].points);
  }
  free(lines->line);
  *lines = (struct isolines){0};
}
