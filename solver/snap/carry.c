#include "solver/snap/carry.h"

#include <math.h>
#include <stdlib.h>

/* A bellows with the places of its rows along the middle of the wall. */
struct strip {
  const struct bellows *bellows;
  double *arc;                  /* row_count, from the start of the wall */
  double hinge[SNAP_PAIRS_MAX]; /* where the outer hinge of each pair starts */
  int pair_count;
};

static enum status strip_create(const struct bellows *b, struct strip *strip, struct error *error) {
  *strip = (struct strip){.bellows = b};
  strip->arc = calloc((size_t)b->row_count, sizeof *strip->arc);
  if (!strip->arc) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a guess");
  }
  double start = 0.0, before = 0.0;
  for (int i = 0; i < b->line.count; i++) {
    const struct meridian_part *part = &b->line.part[i];
    int cells = (b->row[i + 1] - b->row[i]) / 2;
    if (part->snapping) {
      strip->hinge[part->pair] = before;
      strip->pair_count++;
    }
    for (int k = 0; k < cells; k++) {
      double low = part->length * bellows_boundary(part, cells, k);
      double high = part->length * bellows_boundary(part, cells, k + 1);
      strip->arc[b->row[i] + 2 * k + 1] = start + 0.5 * (low + high);
      strip->arc[b->row[i] + 2 * k + 2] = start + high;
    }
    before = start;
    start += part->length;
  }
  return STATUS_OK;
}

static double whole(const struct strip *strip) {
  return strip->arc[strip->bellows->row_count - 1];
}

/* ---- places in the pair ------------------------------------------------------------------- */

/* The place in the one pair that a place of the longer body corresponds to, and how many pairs it
 * lies higher. */
static double place_in_pair(const struct strip *pair, const struct strip *body, double arc,
                            int *higher) {
  int k = 0;
  while (k + 1 < body->pair_count && arc >= body->hinge[k + 1]) {
    k++;
  }
  double period = whole(pair);
  double own = k + 1 < body->pair_count ? body->hinge[k + 1] - body->hinge[k] : period;
  double at = pair->hinge[0] + (arc - body->hinge[k]) * period / own;
  int turns = (int)floor(at / period);
  if (arc >= whole(body) * (1.0 - 1e-12) && fabs(at - turns * period) < 1e-6 * period) {
    turns--; /* the upper end of a row belongs to the pair below */
  }
  *higher = k + turns;
  return fmin(fmax(at - turns * period, 0.0), period);
}

/* Column of `from`, as a real number, at the same place through the layers. */
static double place_in_layers(const struct bellows *from, const struct bellows *to, int column) {
  double last = to->column_count - 1;
  if (column <= to->core_from) {
    return (double)from->core_from * column / to->core_from;
  }
  if (column <= to->core_to) {
    double share = (double)(column - to->core_from) / (to->core_to - to->core_from);
    return from->core_from + share * (from->core_to - from->core_from);
  }
  double share = (column - to->core_to) / (last - to->core_to);
  return from->core_to + share * (from->column_count - 1 - from->core_to);
}

static void quadratic(double x, double n[3]) {
  n[0] = 0.5 * x * (x - 1.0);
  n[1] = 1.0 - x * x;
  n[2] = 0.5 * x * (x + 1.0);
}

/* Displacement at a place along the wall and a real column. */
static void interpolate(const struct strip *strip, const double *u, double arc, double column,
                        double value[2]) {
  const struct bellows *b = strip->bellows;
  int row = 0, left = 2 * (int)fmin(floor(0.5 * column), 0.5 * (b->column_count - 3));
  while (row + 4 < b->row_count && strip->arc[row + 2] < arc) {
    row += 2;
  }
  double n[3], m[3], low = strip->arc[row], high = strip->arc[row + 2];
  quadratic(2.0 * (arc - low) / (high - low) - 1.0, n);
  quadratic(column - left - 1.0, m);
  value[0] = value[1] = 0.0;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      const double *at = u + 2 * (size_t)bellows_node(b, row + i, left + j);
      value[0] += n[i] * m[j] * at[0];
      value[1] += n[i] * m[j] * at[1];
    }
  }
}

/* ---- the whole ---------------------------------------------------------------------------- */

enum status carry_pair(const struct bellows *from, const double *from_u, double from_elongation,
                       const struct bellows *to, double *u, double *elongation,
                       struct error *error) {
  struct strip pair = {0}, body = {0};
  enum status status = strip_create(from, &pair, error);
  if (status == STATUS_OK) {
    status = strip_create(to, &body, error);
  }
  if (status != STATUS_OK) {
    goto done;
  }
  for (int i = 0; i < to->row_count; i++) {
    int higher = 0;
    double arc = place_in_pair(&pair, &body, body.arc[i], &higher);
    for (int j = 0; j < to->column_count; j++) {
      double *at = u + 2 * (size_t)bellows_node(to, i, j);
      interpolate(&pair, from_u, arc, place_in_layers(from, to, j), at);
      at[1] += higher * from_elongation;
    }
  }
  int middle = to->column_count / 2;
  double base = u[2 * bellows_node(to, 0, middle) + 1];
  for (int i = 0; i < to->mesh.node_count; i++) {
    u[2 * i + 1] -= base;
  }
  *elongation = u[2 * bellows_node(to, to->row_count - 1, middle) + 1];
done:
  free(pair.arc);
  free(body.arc);
  return status;
}
