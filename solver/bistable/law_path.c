#include "solver/bistable/law_path.h"

#include <math.h>

/* Part of the range of forces by which a fall is more than a ripple of the computation. */
#define RIPPLE 2e-3
/* Part of the range of h by which a return is a fold. */
#define FOLD 1e-3

size_t law_path_index(const struct law_path *path, size_t i) {
  return path->backward ? path->level->count - 1 - i : i;
}

double law_path_h(const struct law_path *path, size_t i) {
  return path->level->h[law_path_index(path, i)];
}

double law_path_force(const struct law_path *path, size_t i) {
  return path->level->force[law_path_index(path, i)];
}

/* The extremum of y over x of the parabola through three points, the middle one extreme in y. */
static void refine(const double x[3], const double y[3], double *at, double *extreme) {
  double a = x[0] - x[1], b = x[2] - x[1];
  *at = x[1];
  *extreme = y[1];
  if (!(a * b < 0.0)) {
    return;
  }
  double u = (y[0] - y[1]) / a, v = (y[2] - y[1]) / b;
  double bend = (u - v) / (a - b), slope = u - bend * a;
  double shift = bend != 0.0 ? -0.5 * slope / bend : 0.0;
  if (shift > fmin(a, b) && shift < fmax(a, b)) {
    *at += shift;
    *extreme += shift * (slope + bend * shift);
  }
}

/* The turning point of h at the point i. */
static void turn_at(const struct law_path *path, size_t i, double *h, double *force) {
  double x[3], y[3];
  for (size_t k = 0; k < 3; k++) {
    x[k] = law_path_force(path, i + k - 1);
    y[k] = law_path_h(path, i + k - 1);
  }
  refine(x, y, force, h);
}

/* The turning point of the force at the point i. */
static double limit_at(const struct law_path *path, size_t i) {
  double x[3], y[3], h, force;
  for (size_t k = 0; k < 3; k++) {
    x[k] = law_path_h(path, i + k - 1);
    y[k] = law_path_force(path, i + k - 1);
  }
  refine(x, y, &h, &force);
  return h;
}

/* Without a turning point of h: both sides meet in the middle of the steepest fall of the force. */
static void meet(struct law_path *path) {
  double steepest = INFINITY;
  size_t count = path->level->count, at = count / 2;
  for (size_t i = 1; i + 2 < count; i++) {
    double rise = law_path_h(path, i + 1) - law_path_h(path, i);
    double slope = (law_path_force(path, i + 1) - law_path_force(path, i)) / rise;
    if (rise > 0.0 && slope < steepest) {
      steepest = slope;
      at = i;
    }
  }
  path->last = at;
  path->first = at + 1;
  for (int side = 0; side < 2; side++) {
    path->turn[side] = 0.5 * (law_path_h(path, at) + law_path_h(path, at + 1));
    path->force[side] = 0.5 * (law_path_force(path, at) + law_path_force(path, at + 1));
  }
}

/* The two points between which h falls furthest along the path: the fold between the sides. Smaller
 * folds, as of walls that touch, belong to the sides. */
static void find_turns(struct law_path *path) {
  size_t end = path->level->count - 1, top = 0;
  double least = law_path_h(path, 0), most = least, furthest = 0.0;
  for (size_t i = 1; i <= end; i++) {
    double h = law_path_h(path, i);
    least = fmin(least, h);
    most = fmax(most, h);
    if (h > law_path_h(path, top)) {
      top = i;
    }
    if (law_path_h(path, top) - h > furthest) {
      furthest = law_path_h(path, top) - h;
      path->last = top;
      path->first = i;
    }
  }
  path->folds = furthest > FOLD * (most - least);
  if (!path->folds) {
    meet(path);
  } else if (path->last > 0 && path->first < end) {
    turn_at(path, path->last, &path->turn[0], &path->force[0]);
    turn_at(path, path->first, &path->turn[1], &path->force[1]);
  }
}

/* From the point `from` towards `to`: the extremum of sign * force that is met first, ups and downs
 * below `small` not counted. */
static size_t first_extremum(const struct law_path *path, size_t from, size_t to, double sign,
                             double small) {
  size_t best = from;
  for (size_t i = from; i != to;) {
    i += to > from ? 1 : (size_t)-1;
    double rise = sign * (law_path_force(path, i) - law_path_force(path, best));
    if (rise > 0.0) {
      best = i;
    } else if (rise < -small) {
      break;
    }
  }
  return best;
}

/* The first greatest force of the compressed side and the first least one of the stretched side. */
static void find_limits(struct law_path *path) {
  size_t end = path->level->count - 1;
  size_t until = path->folds ? path->last : end, from = path->folds ? path->first : 0;
  double least = INFINITY, most = -INFINITY;
  for (size_t i = 0; i <= end; i++) {
    least = fmin(least, law_path_force(path, i));
    most = fmax(most, law_path_force(path, i));
  }
  double small = RIPPLE * (most - least);
  size_t high = first_extremum(path, 0, until, 1.0, small);
  size_t low = first_extremum(path, end, from, -1.0, small);
  path->falls = path->folds || high < end;
  path->limit[0] = !path->falls    ? NAN
                   : high == until ? path->turn[0]
                   : high == 0     ? law_path_h(path, 0)
                                   : limit_at(path, high);
  path->limit[1] = !path->falls  ? NAN
                   : low == from ? path->turn[1]
                   : low == end  ? law_path_h(path, end)
                                 : limit_at(path, low);
}

enum status law_path_divide(const struct law_level *level, struct law_path *path,
                            struct error *error) {
  size_t end = level->count - 1;
  *path = (struct law_path){.level = level, .backward = level->h[end] < level->h[0]};
  find_turns(path);
  if (path->last < 2 || end - path->first < 2) {
    return error_set(error, STATUS_INVALID, NULL,
                     "at %.6g kPa the path turns back in h at its point %zu of %zu: from the "
                     "compressed side on, h has to rise over three points at least, and likewise "
                     "up to the stretched one",
                     1e-3 * level->pressure, law_path_index(path, path->last) + 1, level->count);
  }
  find_limits(path);
  return STATUS_OK;
}
