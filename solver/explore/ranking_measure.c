/* Bending, slope and deflection of a centreline at stations. */
#include <math.h>
#include <stdlib.h>
#include "solver/explore/ranking.h"

/* Part of the body's length over which the direction at a station is taken: about a chamber of the
 * actuators that are ranked, so that the waves of the single chambers do not count. */
static const double window = 1.0 / 12;

static const double degree = M_PI / 180;

/* Centreline with what belongs to each point. */
struct line {
  size_t count;
  const double *x;   /* 3 a point, mm */
  const double *arc; /* of the body at rest, mm */
};

/* The point at arc length s, between two points of the line; *segment is the one it lies in. */
static void place(const struct line *line, double s, double x[3], size_t *segment) {
  size_t k = 0;
  while (k + 2 < line->count && line->arc[k + 1] < s) {
    k++;
  }
  double length = line->arc[k + 1] - line->arc[k];
  double t = length > 0 ? fmin(1, fmax(0, (s - line->arc[k]) / length)) : 0;
  for (int i = 0; i < 3; i++) {
    x[i] = (1 - t) * line->x[3 * k + (size_t)i] + t * line->x[3 * (k + 1) + (size_t)i];
  }
  *segment = k;
}

/* Angle of a direction in the x-z plane towards -z, plus whole turns, nearest to `near`. */
static double direction(const double a[3], const double b[3], double near) {
  double angle = atan2(a[2] - b[2], b[0] - a[0]);
  return angle + 2 * M_PI * round((near - angle) / (2 * M_PI));
}

/* Direction at arc length s, accumulated from the base on. */
static double direction_at(const struct line *line, double s) {
  double half = 0.5 * window * line->arc[line->count - 1];
  double end = line->arc[line->count - 1], turn = 0;
  double before[3], after[3], here[3];
  size_t segment, ignored;
  place(line, s, here, &segment);
  for (size_t k = 0; k <= segment; k++) {
    turn = direction(&line->x[3 * k], &line->x[3 * (k + 1)], turn);
  }
  place(line, fmax(0, s - half), before, &ignored);
  place(line, fmin(end, s + half), after, &ignored);
  return direction(before, after, turn);
}

bool ranking_measure(const double *rest, const double *now, size_t points, const double *station,
                     int count, struct ranking_measures *measures) {
  double *arc = points >= 2 ? calloc(points, sizeof *arc) : NULL;
  if (!arc) {
    return false;
  }
  for (size_t p = 1; p < points; p++) {
    const double *a = &rest[3 * (p - 1)], *b = &rest[3 * p];
    arc[p] = arc[p - 1] + hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
  }
  struct line before = {points, rest, arc}, after = {points, now, arc};
  bool good = true;
  for (int k = 0; k < count && good; k++) {
    double s = 1e3 * station[k], a[3], b[3];
    size_t ignored;
    good = s <= arc[points - 1] * (1 + 1e-6) && s > 0;
    place(&before, s, a, &ignored);
    place(&after, s, b, &ignored);
    measures->bending[k] = (direction_at(&after, s) - direction_at(&before, s)) / degree;
    measures->slope[k] = measures->bending[k] / s;
    measures->deflection[k] = a[2] - b[2];
  }
  free(arc);
  return good;
}
