#include "tests/unit/rigid_probe.h"

#include <check.h>
#include <math.h>

#include "solver/base/vec3.h"

double probe_random(unsigned *state, double low, double high) {
  *state = *state * 1664525u + 1013904223u;
  return low + (high - low) * (*state >> 8) / 16777216.0;
}

/* A point whose distance from the surface is at most `depth`. */
static void point_near(const struct rigid_shape *shape, double depth, unsigned *state, double x[3],
                       struct rigid_nearest *nearest) {
  double low[3], high[3];
  rigid_shape_bounds(shape, low, high);
  for (;;) {
    for (int i = 0; i < 3; i++) {
      x[i] = probe_random(state, fmax(low[i], -0.1) - depth, fmin(high[i], 0.1) + depth);
    }
    if (rigid_shape_nearest(shape, x, depth, nearest) && nearest->distance >= -depth) {
      return;
    }
  }
}

static void apply(const struct rigid_nearest *at, const double x[3], double out[3]) {
  for (int i = 0; i < 3; i++) {
    out[i] = vec3_dot(at->curvature[i], x);
  }
}

static double curvature_gap(const struct rigid_nearest *a, const struct rigid_nearest *b) {
  double gap = 0;
  for (int i = 0; i < 9; i++) {
    gap = fmax(gap, fabs(a->curvature[i / 3][i % 3] - b->curvature[i / 3][i % 3]));
  }
  return gap;
}

static void check_tensor(const struct rigid_nearest *at, double scale) {
  double image[3];
  ck_assert_double_eq_tol(vec3_norm(at->normal), 1, 1e-12);
  apply(at, at->normal, image);
  ck_assert_double_le(vec3_norm(image), 1e-9 * scale);
  for (int i = 0; i < 9; i++) {
    ck_assert_double_eq_tol(at->curvature[i / 3][i % 3], at->curvature[i % 3][i / 3], 1e-9 * scale);
  }
}

/* The point of the surface under x: there the distance is 0. */
static void check_foot(const struct rigid_shape *shape, const double x[3],
                       const struct rigid_nearest *at, double depth) {
  struct rigid_nearest foot;
  double y[3];
  for (int i = 0; i < 3; i++) {
    y[i] = x[i] - at->distance * at->normal[i];
  }
  ck_assert(rigid_shape_nearest(shape, y, INFINITY, &foot));
  ck_assert_double_le(fabs(foot.distance), 1e-9 * depth);
}

/* Differences along each axis; false where the curvature jumps between the points they need. */
static bool check_differences(const struct rigid_shape *shape, const double x[3],
                              const struct rigid_nearest *at, double step, double limit) {
  struct rigid_nearest side[3][2];
  for (int k = 0; k < 6; k++) {
    double y[3] = {x[0], x[1], x[2]};
    y[k / 2] += k % 2 ? step : -step;
    ck_assert(rigid_shape_nearest(shape, y, INFINITY, &side[k / 2][k % 2]));
    if (curvature_gap(&side[k / 2][k % 2], at) > limit ||
        vec3_dot(side[k / 2][k % 2].normal, at->normal) < 0.5) {
      return false;
    }
  }
  for (int k = 0; k < 3; k++) {
    double slope = (side[k][1].distance - side[k][0].distance) / (2 * step);
    ck_assert_double_eq_tol(slope, at->normal[k], fmax(step * limit, 1e-16 / step));
    for (int i = 0; i < 3; i++) {
      double change = (side[k][1].normal[i] - side[k][0].normal[i]) / (2 * step);
      ck_assert_msg(fabs(change - at->curvature[i][k]) <= limit,
                    "curvature %d %d at (%g, %g, %g): %g, differences %g", i, k, x[0], x[1], x[2],
                    at->curvature[i][k], change);
    }
  }
  return true;
}

void probe_derivatives(const struct rigid_shape *shape, double depth, int count, double step,
                       double tolerance) {
  unsigned state = 7;
  int left_out = 0;
  for (int n = 0; n < count; n++) {
    struct rigid_nearest at;
    double x[3];
    point_near(shape, depth, &state, x, &at);
    check_tensor(&at, 1 / fmax(fabs(at.distance), 1e-3 * depth));
    check_foot(shape, x, &at, depth);
    left_out += !check_differences(shape, x, &at, step, tolerance / depth);
  }
  ck_assert_msg(left_out <= count / 20, "%d of %d points at a jump", left_out, count);
}

void probe_turned(const struct rigid_shape *shape, double depth, int count) {
  const double place[3] = {0.3, -0.2, 0.7}, axis[3] = {1, -2, 0.5};
  struct rigid_pose pose = rigid_pose_turned(place, axis, 1.2);
  unsigned state = 3;
  for (int n = 0; n < count; n++) {
    struct rigid_nearest at, there;
    double x[3], y[3], normal[3], along[3], expected[3];
    point_near(shape, depth, &state, x, &at);
    rigid_pose_outward(&pose, x, y);
    ck_assert(rigid_shape_nearest_posed(shape, &pose, y, INFINITY, &there));
    ck_assert_double_eq_tol(there.distance, at.distance, 1e-12);
    rigid_pose_turn_inward(&pose, there.normal, normal);
    /* The curvature along a direction, which turns with the object. */
    const double direction[3] = {0.3, 0.5, -0.8};
    double outward[3];
    rigid_pose_turn_outward(&pose, direction, outward);
    apply(&there, outward, along);
    rigid_pose_turn_inward(&pose, along, along);
    apply(&at, direction, expected);
    double scale = 1 / fmax(fabs(at.distance), 1e-3 * depth);
    for (int i = 0; i < 3; i++) {
      ck_assert_double_eq_tol(normal[i], at.normal[i], 1e-10 * depth * scale);
      ck_assert_double_eq_tol(along[i], expected[i], 1e-7 * depth * scale * scale);
    }
  }
}
