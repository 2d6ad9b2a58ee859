#include "solver/snap/meridian.h"

#include <math.h>
#include <string.h>

static const double vertical = 0.5 * M_PI;

/* ---- evaluation --------------------------------------------------------------------------- */

void meridian_point(const struct meridian_part *p, double s, double point[2], double normal[2]) {
  double share = s / p->length, direction = p->direction + share * p->turn;
  double chord = s, along = p->direction + 0.5 * share * p->turn;
  double half = 0.5 * share * p->turn;
  if (fabs(half) > 1e-9) {
    chord = s * sin(half) / half;
  }
  point[0] = p->r + chord * cos(along);
  point[1] = p->z + chord * sin(along);
  normal[0] = sin(direction);
  normal[1] = -cos(direction);
}

double meridian_wall(const struct snap_spec *spec, const struct meridian_part *p, double s) {
  double at = p->in_hinge[0] + s / p->length * (p->in_hinge[1] - p->in_hinge[0]);
  double bump = p->in_hinge[0] == p->in_hinge[1] ? 0.0 : sin(M_PI * at);
  return spec->wall + (spec->hinge_wall - spec->wall) * bump * bump;
}

double meridian_core(const struct meridian_part *p, double s) {
  double t = s / p->length;
  return p->core[0] + (p->core[1] - p->core[0]) * t * t * (3.0 - 2.0 * t);
}

/* ---- construction ------------------------------------------------------------------------- */

static struct meridian_part *add(struct meridian *m, double direction, double turn, double length) {
  struct meridian_part *p = &m->part[m->count++];
  *p = (struct meridian_part){.direction = direction, .turn = turn, .length = length, .pair = -1};
  return p;
}

/* Hinge between the directions from and to, whole, or from or up to its crest. */
static void add_hinge(struct meridian *m, const struct snap_spec *spec, double snapping, bool outer,
                      const double range[2], const double core[2]) {
  double low = spec->supporting_angle, high = M_PI - snapping;
  double start = outer ? low : high, whole = outer ? high - low : low - high;
  double radius = snap_hinge_radius(spec, snapping);
  struct meridian_part *p = add(m, start + range[0] * whole, (range[1] - range[0]) * whole,
                                (range[1] - range[0]) * fabs(whole) * radius);
  memcpy(p->in_hinge, range, sizeof p->in_hinge);
  memcpy(p->core, core, sizeof p->core);
}

static void add_shell(struct meridian *m, double direction, double length, double core, int pair,
                      bool pet, bool snapping) {
  struct meridian_part *p = add(m, direction, 0.0, length);
  p->core[0] = p->core[1] = core;
  p->pair = pair;
  p->pet = pet;
  p->snapping = snapping;
}

/* The piece of a supporting shell from `from` to `to` along its slant; PET at its upper end. */
static void add_support(struct meridian *m, const struct snap_spec *spec, int pair, double slant,
                        double from, double to) {
  double core = pair < 0 ? spec->given.pet_thickness : spec->pair[pair].pet_thickness;
  double bare = fmax(slant - spec->supporting_pet, 0.0);
  if (bare < 1e-3 * slant) {
    bare = 0.0;
  }
  if (fabs(bare - from) < 1e-3 * slant || fabs(bare - to) < 1e-3 * slant) {
    bare = fabs(bare - from) < fabs(bare - to) ? from : to;
  }
  double split = fmin(fmax(bare, from), to);
  if (split > from) {
    add_shell(m, spec->supporting_angle, split - from, core, pair, false, false);
  }
  if (split < to) {
    add_shell(m, spec->supporting_angle, to - split, core, pair, true, false);
  }
}

/* Pair k from the outer hinge below it to the end of its inner hinge. */
static void add_pair(struct meridian *m, const struct snap_spec *spec, int k, double core_below) {
  static const double whole[2] = {0.0, 1.0};
  const struct snap_pair *p = &spec->pair[k];
  const double outer[2] = {core_below, p->pet_thickness};
  const double inner[2] = {p->pet_thickness, p->pet_thickness};
  add_hinge(m, spec, p->snapping_angle, true, whole, outer);
  add_shell(m, M_PI - p->snapping_angle, p->snapping_slant, p->pet_thickness, k, true, true);
  add_hinge(m, spec, p->snapping_angle, false, whole, inner);
}

static void add_row(struct meridian *m, const struct snap_spec *spec) {
  int last = spec->pair_count - 1;
  const struct snap_pair *top = &spec->pair[last];
  double slant = top->supporting_slant;
  add_support(m, spec, last, slant, 0.5 * slant, slant);
  for (int k = 0; k <= last; k++) {
    const struct snap_pair *p = &spec->pair[k];
    add_pair(m, spec, k, spec->pair[k > 0 ? k - 1 : last].pet_thickness);
    add_support(m, spec, k, p->supporting_slant, 0.0,
                k < last ? p->supporting_slant : 0.5 * p->supporting_slant);
  }
}

static void add_between_plates(struct meridian *m, const struct snap_spec *spec) {
  const struct snap_given *g = &spec->given;
  double turn = M_PI - g->snapping_angle - spec->supporting_angle;
  double core = g->pet_thickness;
  const double lower[2] = {(vertical - g->snapping_angle) / turn, 1.0};
  const double upper[2] = {0.0, (vertical - spec->supporting_angle) / turn};
  add_hinge(m, spec, g->snapping_angle, false, lower, (const double[2]){core, core});
  add_support(m, spec, -1, spec->mounting_slant, 0.0, spec->mounting_slant);
  for (int k = 0; k < spec->pair_count; k++) {
    const struct snap_pair *p = &spec->pair[k];
    add_pair(m, spec, k, core);
    add_support(m, spec, k, p->supporting_slant, 0.0, p->supporting_slant);
    core = p->pet_thickness;
  }
  add_hinge(m, spec, g->snapping_angle, true, upper, (const double[2]){core, core});
}

/* Distance of the first outer crest from the axis when the line starts at r = 0. */
static double crest(const struct meridian *m) {
  double r = 0.0;
  for (int i = 0; i < m->count; i++) {
    const struct meridian_part *p = &m->part[i];
    double share = p->turn > 0.0 ? (vertical - p->direction) / p->turn : -1.0;
    double end[2], normal[2];
    if (share >= 0.0 && share <= 1.0) {
      meridian_point(p, share * p->length, end, normal);
      return r + end[0];
    }
    meridian_point(p, p->length, end, normal);
    r += end[0];
  }
  return r;
}

void meridian_build(const struct snap_spec *spec, struct meridian *m) {
  *m = (struct meridian){.count = 0};
  if (spec->ends == SNAP_PERIODIC) {
    add_row(m, spec);
  } else {
    add_between_plates(m, spec);
  }
  double at[2] = {spec->crest_radius - crest(m), 0.0}, normal[2];
  for (int i = 0; i < m->count; i++) {
    struct meridian_part *p = &m->part[i];
    p->r = at[0];
    p->z = at[1];
    meridian_point(p, p->length, at, normal);
    p->edge[0] = i > 0 && m->part[i - 1].pet != p->pet;
    p->edge[1] = i + 1 < m->count && m->part[i + 1].pet != p->pet;
  }
  m->length = at[1];
}
