#include "solver/rigid/pose.h"

#include <math.h>
#include <string.h>

#include "solver/base/vec3.h"

struct rigid_pose rigid_pose_identity(void) {
  return (struct rigid_pose){.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
}

struct rigid_pose rigid_pose_turned(const double place[3], const double axis[3], double angle) {
  struct rigid_pose pose = {.place = {place[0], place[1], place[2]}};
  double factor = angle / vec3_norm(axis);
  rotation_matrix((double[3]){factor * axis[0], factor * axis[1], factor * axis[2]}, pose.rotation);
  return pose;
}

struct rigid_pose rigid_pose_upright(const double place[3], const double axis[3]) {
  double across = hypot(axis[0], axis[1]);
  if (across == 0) {
    return rigid_pose_turned(place, (double[3]){1, 0, 0}, axis[2] < 0 ? acos(-1) : 0);
  }
  return rigid_pose_turned(place, (double[3]){-axis[1] / across, axis[0] / across, 0},
                           atan2(across, axis[2]));
}

static void multiply(const double a[9], const double b[9], double out[9]) {
  for (int i = 0; i < 9; i++) {
    out[i] = 0;
    for (int k = 0; k < 3; k++) {
      out[i] += a[3 * (i / 3) + k] * b[3 * k + i % 3];
    }
  }
}

struct rigid_pose rigid_pose_compose(const struct rigid_pose *outer,
                                     const struct rigid_pose *inner) {
  struct rigid_pose pose;
  rigid_pose_outward(outer, inner->place, pose.place);
  multiply(outer->rotation, inner->rotation, pose.rotation);
  return pose;
}

/* One step of Newton's iteration for the nearest rotation, R (3 - R^T R) / 2: quadratic, and the
 * matrix is orthonormal but for round-off already. */
static void straighten(double r[9]) {
  double square[9], correction[9];
  for (int i = 0; i < 9; i++) {
    square[i] = 0;
    for (int k = 0; k < 3; k++) {
      square[i] += r[3 * k + i / 3] * r[3 * k + i % 3];
    }
    square[i] = 0.5 * ((i % 4 == 0 ? 3 : 0) - square[i]);
  }
  multiply(r, square, correction);
  memcpy(r, correction, sizeof correction);
}

void rigid_pose_move(struct rigid_pose *pose, const double shift[3], const double turn[3]) {
  double step[9], turned[9];
  rotation_matrix(turn, step);
  multiply(step, pose->rotation, turned);
  straighten(turned);
  memcpy(pose->rotation, turned, sizeof turned);
  for (int i = 0; i < 3; i++) {
    pose->place[i] += shift[i];
  }
}

void rigid_pose_turn_outward(const struct rigid_pose *pose, const double in[3], double out[3]) {
  mat3_apply(pose->rotation, in, out);
}

void rigid_pose_turn_inward(const struct rigid_pose *pose, const double in[3], double out[3]) {
  const double *r = pose->rotation, x[3] = {in[0], in[1], in[2]};
  for (int i = 0; i < 3; i++) {
    out[i] = r[i] * x[0] + r[3 + i] * x[1] + r[6 + i] * x[2];
  }
}

void rigid_pose_outward(const struct rigid_pose *pose, const double in[3], double out[3]) {
  mat3_apply(pose->rotation, in, out);
  for (int i = 0; i < 3; i++) {
    out[i] += pose->place[i];
  }
}

void rigid_pose_inward(const struct rigid_pose *pose, const double in[3], double out[3]) {
  double from[3];
  for (int i = 0; i < 3; i++) {
    from[i] = in[i] - pose->place[i];
  }
  rigid_pose_turn_inward(pose, from, out);
}

void rigid_pose_tensor_outward(const struct rigid_pose *pose, double tensor[3][3]) {
  double half[3][3];
  for (int i = 0; i < 3; i++) {
    mat3_apply(pose->rotation, tensor[i], half[i]); /* t R^T, by rows */
  }
  for (int j = 0; j < 3; j++) {
    double column[3] = {half[0][j], half[1][j], half[2][j]};
    mat3_apply(pose->rotation, column, column);
    for (int i = 0; i < 3; i++) {
      tensor[i][j] = column[i];
    }
  }
}
