#include "solver/job/grasp.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Differences of directions, and of places in m, that are rounding. */
static const double same_direction = 1e-9, same_place = 1e-9;

void grasp_spec_destroy(struct grasp_spec *spec) {
  if (spec) {
    free(spec->object.shape.stl);
    free(spec);
  }
}

static bool near(const double a[3], const double b[3], double most) {
  return fabs(a[0] - b[0]) <= most && fabs(a[1] - b[1]) <= most && fabs(a[2] - b[2]) <= most;
}

/* v <- R v. */
static void turn(double rotation[3][3], double v[3]) {
  double turned[3];
  for (int i = 0; i < 3; i++) {
    turned[i] = rotation[i][0] * v[0] + rotation[i][1] * v[1] + rotation[i][2] * v[2];
  }
  memcpy(v, turned, sizeof turned);
}

static void turn_columns(double rotation[3][3], double columns[3][3]) {
  for (int j = 0; j < 3; j++) {
    double column[3] = {columns[0][j], columns[1][j], columns[2][j]};
    turn(rotation, column);
    for (int i = 0; i < 3; i++) {
      columns[i][j] = column[i];
    }
  }
}

/* ---- fingers ------------------------------------------------------------------------------ */

/* From the gripper's frame to that of a finger: turned back about x, then shifted, then turned back
 * by the tilt about the y axis through the base. A positive tilt lifts the finger's tip to +z. */
struct grasp_spec grasp_of_finger(const struct grasp_spec *spec, int finger) {
  const struct grasp_fingers *f = &spec->fingers;
  struct grasp_spec seen = *spec;
  if (f->count < 2) {
    return seen;
  }
  double angle = 2 * M_PI * finger / f->count, c = cos(angle), s = sin(angle);
  double around[3][3] = {{1, 0, 0}, {0, c, s}, {0, -s, c}};
  c = cos(f->tilt);
  s = sin(f->tilt);
  double back[3][3] = {{c, 0, s}, {0, 1, 0}, {-s, 0, c}};
  double *const vectors[] = {seen.object.place, seen.approach.from, seen.pull.direction,
                             seen.gravity};
  for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) {
    turn(around, vectors[i]);
    vectors[i][2] -= i == 0 ? f->radius : 0;
    turn(back, vectors[i]);
  }
  for (int i = 0; i < seen.pull.leg_count; i++) {
    turn(around, seen.pull.leg[i].move);
    turn(around, seen.pull.leg[i].turn);
    turn(back, seen.pull.leg[i].move);
    turn(back, seen.pull.leg[i].turn);
  }
  turn_columns(around, seen.object.rotation);
  turn_columns(back, seen.object.rotation);
  return seen;
}

/* ---- symmetries --------------------------------------------------------------------------- */

static void column_of(const double m[3][3], int j, double out[3]) {
  for (int i = 0; i < 3; i++) {
    out[i] = m[i][j];
  }
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whether the box of these extents is the same in both rotations, of which one may mirror. */
static bool same_box(const double size[3], const double a[3][3], const double b[3][3]) {
  for (int j = 0; j < 3; j++) {
    double column[3], other[3];
    bool found = false;
    column_of(a, j, column);
    for (int k = 0; k < 3; k++) {
      column_of(b, k, other);
      found = found || (fabs(fabs(dot(column, other)) - 1) < same_direction &&
                        fabs(size[j] - size[k]) < same_place);
    }
    if (!found) {
      return false;
    }
  }
  return true;
}

/* Whether the profile is its own mirror image about z = 0. */
static bool is_even(const struct grasp_shape *shape) {
  bool even = true;
  for (int k = 0; k < shape->profile_count; k++) {
    const double *a = shape->profile[k], *b = shape->profile[shape->profile_count - 1 - k];
    even = even && fabs(a[0] + b[0]) <= same_place && fabs(a[1] - b[1]) <= same_place;
  }
  return even;
}

/* Whether one shape is the same in both poses. That of b may mirror: its rotation then has the
 * determinant -1. */
static bool same_pose(const struct grasp_object *a, const struct grasp_object *b) {
  double axis_a[3], axis_b[3], back[3], apart[3];
  column_of(a->rotation, 2, axis_a);
  column_of(b->rotation, 2, axis_b);
  for (int i = 0; i < 3; i++) {
    back[i] = -axis_b[i];
    apart[i] = b->place[i] - a->place[i];
  }
  bool along = near(axis_a, axis_b, same_direction);
  bool placed = near(a->place, b->place, same_place);
  switch (a->shape.form) {
  case GRASP_SPHERE:
    return placed;
  case GRASP_CYLINDER:
    return placed && (along || near(axis_a, back, same_direction));
  case GRASP_FRUSTUM:
    return placed && along;
  case GRASP_REVOLUTION:
    return placed && (along || (is_even(&a->shape) && near(axis_a, back, same_direction)));
  case GRASP_BOX:
    return placed && same_box(a->shape.size, a->rotation, b->rotation);
  case GRASP_PLANE:
    return along && fabs(dot(apart, axis_a)) <= same_place;
  case GRASP_SURFACE:
    break;
  }
  bool same = placed;
  for (int i = 0; i < 3; i++) {
    same = same && near(a->rotation[i], b->rotation[i], same_direction);
  }
  return same;
}

bool grasp_pulls(const struct grasp_spec *spec) {
  return spec->pull.leg_count > 0 || spec->pull.force > 0;
}

static bool same_way(const struct grasp_pull *a, const struct grasp_pull *b) {
  bool same = near(a->direction, b->direction, same_direction);
  for (int i = 0; i < a->leg_count; i++) {
    same = same && near(a->leg[i].move, b->leg[i].move, same_place) &&
           near(a->leg[i].turn, b->leg[i].turn, same_direction);
  }
  return same;
}

/* A mirror image about y = 0 turns the other way, but for turns about y. */
static bool symmetric_way(const struct grasp_pull *pull) {
  bool symmetric = fabs(pull->direction[1]) <= same_direction;
  for (int i = 0; i < pull->leg_count; i++) {
    const struct grasp_leg *leg = &pull->leg[i];
    symmetric = symmetric && fabs(leg->move[1]) <= same_place &&
                hypot(leg->turn[0], leg->turn[2]) <= same_direction;
  }
  return symmetric;
}

bool grasp_same(const struct grasp_spec *a, const struct grasp_spec *b) {
  return near(a->approach.from, b->approach.from, same_place) && same_way(&a->pull, &b->pull) &&
         near(a->gravity, b->gravity, same_direction) && same_pose(&a->object, &b->object);
}

bool grasp_symmetric(const struct grasp_spec *spec) {
  struct grasp_object mirrored = spec->object;
  mirrored.place[1] = -mirrored.place[1];
  for (int j = 0; j < 3; j++) {
    mirrored.rotation[1][j] = -mirrored.rotation[1][j];
  }
  return fabs(spec->approach.from[1]) <= same_place && symmetric_way(&spec->pull) &&
         fabs(spec->gravity[1]) <= same_direction && same_pose(&spec->object, &mirrored);
}
