#include "solver/mesh/pneunet_suckers.h"

#include <math.h>
#include <stdlib.h>
#include "solver/mesh/pneunet_map.h"

/* Side of the square of a circle's area, relative to its diameter. */
static const double square = 0.886226925452758;
/* Suckers share their lateral lines when their sizes differ by less than this factor. */
static const double alike = 1.4;

/* Distance from `from`, on side s (-1, +1), of the line of the axis nearest to the distance
 * `wanted` among those from `least` to `most`; one is inserted at `wanted` when there is none.
 * *status is kept unless memory runs out. */
static double take_line(struct grid_axis *axis, double from, int s, double least, double wanted,
                        double most, enum status *status) {
  double best = NAN;
  for (int l = 0; l < axis->line_count; l++) {
    double distance = s * (axis->line[l] - from);
    if (distance >= least && distance <= most &&
        !(fabs(distance - wanted) >= fabs(best - wanted))) {
      best = distance;
    }
  }
  if (isnan(best)) {
    best = wanted;
    if (*status == STATUS_OK) {
      *status = grid_axis_insert(axis, from + s * wanted);
    }
  }
  return best;
}

/* Room between this circle and the next one, or twice that to the body's end, on side s. */
static double room_beside(const struct pneunet_spec *p, int sucker, int s) {
  const struct sucker_spec *own = &p->sucker[sucker];
  double outer = 0.5 * own->diameter + own->wall;
  double room = 2 * ((s > 0 ? p->length - own->position : own->position) - outer);
  for (int k = 0; k < p->sucker_count; k++) {
    double distance = s * (p->sucker[k].position - own->position);
    if (distance > 0) {
      room = fmin(room, distance - outer - 0.5 * p->sucker[k].diameter - p->sucker[k].wall);
    }
  }
  return room;
}

static enum status plan_axial(const struct pneunet_spec *p, int sucker, struct grid_axis *axis,
                              struct sucker_frame *f) {
  const struct sucker_spec *own = &p->sucker[sucker];
  enum status status = STATUS_OK;
  *f = (struct sucker_frame){.centre = own->position,
                             .opening = 0.5 * own->diameter,
                             .outer = 0.5 * own->diameter + own->wall,
                             .depth = own->depth};
  double wall = square * own->wall;
  for (int k = 0; k < 2; k++) {
    int s = 2 * k - 1;
    /* not beyond the circle, so that what is beside it is compressed and never folds */
    double outer =
        take_line(axis, f->centre, s, 0.7 * f->outer, square * f->outer, f->outer, &status);
    double least = fmax(outer - 2 * wall, 0.4 * f->opening);
    f->inner_line[k] =
        take_line(axis, f->centre, s, least, outer - wall, outer - 0.3 * wall, &status);
    f->outer_line[k] = outer;
    f->end[k] = f->outer + fmin(0.5 * room_beside(p, sucker, s), 0.5 * f->outer);
  }
  /* a circle needs a line inside */
  take_line(axis, f->centre - f->inner_line[0], 1, 0.2 * f->opening, f->inner_line[0],
            f->inner_line[0] + f->inner_line[1] - 0.2 * f->opening, &status);
  return status;
}

/* Distance from the middle, in the grid, of the outer line that displaces least. */
static double wanted_line(const struct pneunet_spec *p, const struct sucker_frame *f) {
  double half = 0.5 * f->outer;
  double place = pneunet_lateral(p, half, f->centre) - pneunet_lateral(p, -half, f->centre);
  return fmin(square * f->outer * f->outer / place, 0.5 * p->width - 0.3 * p->side_wall);
}

/* Lateral lines for frame `first` and those after it, without lines yet, that can share them. */
static enum status plan_lateral(const struct pneunet_spec *p, struct grid_axis *axis,
                                struct sucker_plan *plan, int first) {
  enum status status = STATUS_OK;
  double size = wanted_line(p, &plan->frame[first]), outer = 0, share = 0;
  int members[SUCKERS_MAX], count = 0;
  for (int k = first; k < plan->count; k++) {
    const struct sucker_frame *f = &plan->frame[k];
    double wanted = wanted_line(p, f);
    if (f->outer_y == 0 && wanted > size / alike && wanted < size * alike) {
      outer += wanted;
      share += f->opening / f->outer;
      members[count++] = k;
    }
  }
  outer /= count;
  double most = fmin(1.15 * outer, 0.5 * p->width - 0.2 * p->side_wall);
  outer = take_line(axis, 0, 1, 0.85 * outer, outer, most, &status);
  double wall = (1 - share / count) * outer;
  double inner = take_line(axis, 0, 1, fmax(outer - 2 * wall, 0.3 * outer), outer - wall,
                           outer - 0.3 * wall, &status);
  for (int k = 0; k < count; k++) {
    plan->frame[members[k]].outer_y = outer;
    plan->frame[members[k]].inner_y = inner;
  }
  return status;
}

enum status suckers_plan(const struct pneunet_spec *p, struct grid_axis *axial,
                         struct grid_axis *lateral, struct sucker_plan *plan) {
  enum status status = STATUS_OK;
  *plan = (struct sucker_plan){.count = p->sucker_count};
  for (int k = 0; k < plan->count && status == STATUS_OK; k++) {
    status = plan_axial(p, k, axial, &plan->frame[k]);
    plan->depth = fmax(plan->depth, plan->frame[k].depth);
  }
  for (int k = 0; k < plan->count && status == STATUS_OK; k++) {
    if (plan->frame[k].outer_y == 0) {
      status = plan_lateral(p, lateral, plan, k);
    }
  }
  return status;
}

void suckers_release(struct sucker_plan *plan) {
  free(plan->middle_y);
  plan->middle_y = NULL;
}

/* Adds `tag` to the cells between two coordinates. */
static void mark_cells(struct grid_axis *axis, double from, double to, int tag) {
  for (int c = 0; c + 1 < axis->line_count; c++) {
    double middle = 0.5 * (axis->line[c] + axis->line[c + 1]);
    if (middle > from && middle < to) {
      axis->tag[c] += tag * SUCKER_TAG;
    }
  }
}

static enum status insert_frame(const struct sucker_frame *f, struct grid_axis *axial,
                                struct grid_axis *lateral) {
  const double along[4] = {f->centre - f->outer_line[0], f->centre - f->inner_line[0],
                           f->centre + f->inner_line[1], f->centre + f->outer_line[1]};
  const double across[4] = {-f->outer_y, -f->inner_y, f->inner_y, f->outer_y};
  enum status status = STATUS_OK;
  for (int k = 0; k < 4 && status == STATUS_OK; k++) {
    status = grid_axis_insert(axial, along[k]);
    if (status == STATUS_OK) { /* a half model has no lines below 0: nothing happens there */
      status = grid_axis_insert(lateral, across[k]);
    }
  }
  return status;
}

enum status suckers_mark(struct sucker_plan *plan, struct grid_axis *axial,
                         struct grid_axis *lateral) {
  enum status status = STATUS_OK;
  for (int k = 0; k < plan->count && status == STATUS_OK; k++) {
    status = insert_frame(&plan->frame[k], axial, lateral);
  }
  plan->cells_across = lateral->line_count - 1;
  plan->middle_y = malloc(sizeof *plan->middle_y * (size_t)lateral->line_count);
  if (status != STATUS_OK || !plan->middle_y) {
    return STATUS_NO_MEMORY;
  }
  for (int k = 0; k < plan->count; k++) {
    const struct sucker_frame *f = &plan->frame[k];
    double low = f->centre - f->inner_line[0], high = f->centre + f->inner_line[1];
    mark_cells(axial, f->centre - f->outer_line[0], low, 1 + 2 * k);
    mark_cells(axial, low, high, 2 + 2 * k);
    mark_cells(axial, high, f->centre + f->outer_line[1], 1 + 2 * k);
  }
  for (int c = 0; c < plan->cells_across; c++) {
    lateral->tag[c] += c * SUCKER_TAG;
    plan->middle_y[c] = 0.5 * (lateral->line[c] + lateral->line[c + 1]);
  }
  return STATUS_OK;
}

bool suckers_solid(const struct sucker_plan *plan, int axial_tag, int lateral_tag) {
  int mark = axial_tag / SUCKER_TAG;
  if (mark == 0) {
    return false;
  }
  const struct sucker_frame *f = &plan->frame[(mark - 1) / 2];
  double y = fabs(plan->middle_y[lateral_tag / SUCKER_TAG]);
  bool inside = mark % 2 == 0 && y < f->inner_y;
  return y < f->outer_y && !inside;
}

/* Coordinate in which the ring is a square between its two radii, and goes on with the slope 1
 * outside; distances d, inner and outer are those of the point and of the frame's lines. */
static double frame_coordinate(const struct sucker_frame *f, double d, double inner, double outer) {
  if (d <= inner) {
    return f->opening * d / inner;
  }
  if (d <= outer) {
    return f->opening + (f->outer - f->opening) * (d - inner) / (outer - inner);
  }
  return f->outer + d - outer;
}

static double fade(double d, double outer, double end) {
  return d <= outer ? 1 : fmax(0, (end - d) / (end - outer));
}

const struct sucker_frame *suckers_frame(const struct sucker_plan *plan, double x) {
  for (int k = 0; k < plan->count; k++) {
    const struct sucker_frame *f = &plan->frame[k];
    if (x > f->centre - f->end[0] && x < f->centre + f->end[1]) {
      return f;
    }
  }
  return NULL;
}

void suckers_displace(const struct sucker_frame *f, double x, double y, const double line[3],
                      double shift[2]) {
  int k = x > f->centre;
  double along = fabs(x - f->centre), across = fabs(y);
  double u = frame_coordinate(f, along, f->inner_line[k], f->outer_line[k]);
  double v = frame_coordinate(f, across, line[0], line[1]);
  double share = fade(along, f->outer_line[k], f->end[k]) * fade(across, line[1], line[2]);
  /* squares in the middle, circles from the opening outwards */
  double radius = fmax(u, v), distance = hypot(u, v), round = fmin(1, radius / f->opening);
  double scale = distance > 0 ? 1 - round + round * radius / distance : 1;
  shift[0] = share * (scale * u - along) * (x < f->centre ? -1 : 1);
  shift[1] = share * (scale * v - across) * (y < 0 ? -1 : 1);
}
