#include "solver/snap/folded.h"

#include <math.h>

/* What is left of the distance to the centre of curvature inside a bend. */
static const double core = 0.3;
/* Distance of folded shells from each other relative to their thickness. */
static const double clearance = 1.05;

/* A part in the guess. */
struct placed {
  double direction[2]; /* of its start and its end */
  double start[2], end[2];
  double pull; /* length of the curve's derivative at both ends */
};

/* Cubic curve with the chord and directions of the part; s from 0 to 1. *curvature is positive
 * where it turns anticlockwise. */
static void hermite(const struct placed *p, double s, double x[2], double normal[2],
                    double *curvature) {
  double first[2], second[2];
  double pull = p->pull;
  for (int i = 0; i < 2; i++) {
    double m0 = pull * (i == 0 ? cos(p->direction[0]) : sin(p->direction[0]));
    double m1 = pull * (i == 0 ? cos(p->direction[1]) : sin(p->direction[1]));
    double c = p->end[i] - p->start[i];
    double a2 = 3.0 * c - 2.0 * m0 - m1, a3 = m0 + m1 - 2.0 * c;
    x[i] = p->start[i] + s * (m0 + s * (a2 + s * a3));
    first[i] = m0 + s * (2.0 * a2 + 3.0 * s * a3);
    second[i] = 2.0 * a2 + 6.0 * s * a3;
  }
  double speed = hypot(first[0], first[1]);
  normal[0] = first[1] / speed;
  normal[1] = -first[0] / speed;
  *curvature = (first[0] * second[1] - first[1] * second[0]) / (speed * speed * speed);
}

/* Distance from the middle line that a point at the distance t keeps. */
static double squeezed(double t, double curvature) {
  double room = (1.0 - core) / fmax(fabs(curvature), 1e-9);
  bool inside = t * curvature < 0.0;
  return inside && fabs(t) > 0.0 ? t / hypot(1.0, t / room) : t;
}

static void place_row(const struct bellows *b, const struct meridian_part *part,
                      const struct placed *placed, int row, double s, double *u) {
  double at[2], natural[2], x[2], normal[2], curvature = 0.0;
  meridian_point(part, s * part->length, at, natural);
  hermite(placed, s, x, normal, &curvature);
  if (part->turn == 0.0) {
    curvature = 0.0;
  }
  for (int j = 0; j < b->column_count; j++) {
    int node = bellows_node(b, row, j);
    const double *before = b->mesh.position + 2 * (size_t)node;
    double t = (before[0] - at[0]) * natural[0] + (before[1] - at[1]) * natural[1];
    double kept = squeezed(t, curvature);
    for (int i = 0; i < 2; i++) {
      u[2 * node + i] = x[i] + kept * normal[i] - before[i];
    }
  }
}

/* Share of the part at a row. */
static double share(const struct bellows *b, int part, int row) {
  int cells = (b->row[part + 1] - b->row[part]) / 2, k = (row - b->row[part]) / 2;
  const struct meridian_part *p = &b->line.part[part];
  double from = bellows_boundary(p, cells, k);
  return (row - b->row[part]) % 2 == 0 ? from : 0.5 * (from + bellows_boundary(p, cells, k + 1));
}

static bool is_turned(const struct meridian *m, int part, int from, int to) {
  const struct meridian_part *p = &m->part[part];
  return part < m->count && p->snapping && p->pair >= from && p->pair < to;
}

/* Height that a hinge rises when its shells lie almost face to face. */
static double folded_rise(const struct snap_spec *spec, const struct meridian_part *part,
                          double outwards) {
  double distance = clearance * spec->wall, angle = spec->supporting_angle;
  (void)part;
  return (distance + outwards * sin(angle)) / cos(angle);
}

void folded_guess(const struct snap_spec *spec, const struct bellows *b, int from, int to,
                  double *u) {
  const struct meridian *m = &b->line;
  double z = 0.0;
  for (int i = 0; i < m->count; i++) {
    const struct meridian_part *p = &m->part[i];
    double end[2], normal[2], rise;
    meridian_point(p, p->length, end, normal);
    bool turned = is_turned(m, i, from, to);
    bool before = i > 0 && is_turned(m, i - 1, from, to), after = is_turned(m, i + 1, from, to);
    struct placed placed = {
        .direction = {p->direction, p->direction + p->turn}, .start = {p->r, z}, .pull = p->length};
    placed.direction[0] = before ? 2.0 * M_PI - p->direction : p->direction;
    placed.direction[1] = after ? 2.0 * M_PI - (p->direction + p->turn) : p->direction + p->turn;
    rise = end[1] - p->z;
    if (turned) {
      placed.direction[0] = placed.direction[1] = 2.0 * M_PI - p->direction;
      rise = -rise;
    } else if (before || after) {
      rise = folded_rise(spec, p, end[0] - p->r);
      placed.pull = 2.0 * clearance * spec->wall;
    }
    z += rise;
    placed.end[0] = end[0];
    placed.end[1] = z;
    for (int row = b->row[i]; row <= b->row[i + 1]; row++) {
      place_row(b, p, &placed, row, share(b, i, row), u);
    }
  }
}
