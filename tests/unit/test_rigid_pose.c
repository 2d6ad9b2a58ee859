/* Poses of rigid objects: there and back, turns about axes, many small moves. */
#include <math.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/rigid/pose.h"
#include "tests/unit/suite.h"

static void check_vector(const double a[3], double x, double y, double z, double tolerance) {
  ck_assert_double_eq_tol(a[0], x, tolerance);
  ck_assert_double_eq_tol(a[1], y, tolerance);
  ck_assert_double_eq_tol(a[2], z, tolerance);
}

START_TEST(a_quarter_turn_about_z_takes_x_to_y) {
  struct rigid_pose pose =
      rigid_pose_turned((double[3]){1, 2, 3}, (double[3]){0, 0, 5}, 0.5 * acos(-1));
  double x[3] = {1, 0, 0}, out[3];
  rigid_pose_outward(&pose, x, out);
  check_vector(out, 1, 3, 3, 1e-15);
  rigid_pose_inward(&pose, out, out);
  check_vector(out, 1, 0, 0, 1e-15);
  rigid_pose_turn_outward(&pose, x, x);
  check_vector(x, 0, 1, 0, 1e-15);
  rigid_pose_turn_inward(&pose, x, x);
  check_vector(x, 1, 0, 0, 1e-15);
}
END_TEST

START_TEST(the_axis_of_an_upright_object_is_the_given_one) {
  static const double axes[][3] = {{0, 0, 2},       {0, 0, -1},       {1, 0, 0},
                                   {0, -3, 0},      {1, 2, -2},       {1e-9, 0, 1},
                                   {1e-200, 0, -1}, {1e-9, 1e-9, -1}, {-0.5, 0.1, 0.2}};
  for (size_t i = 0; i < sizeof axes / sizeof *axes; i++) {
    struct rigid_pose pose = rigid_pose_upright((double[3]){0, 0, 0}, axes[i]);
    double out[3], length = vec3_norm(axes[i]);
    rigid_pose_turn_outward(&pose, (double[3]){0, 0, 1}, out);
    check_vector(out, axes[i][0] / length, axes[i][1] / length, axes[i][2] / length, 1e-14);
  }
}
END_TEST

START_TEST(composed_poses_act_one_after_the_other) {
  struct rigid_pose outer = rigid_pose_turned((double[3]){1, -2, 0.5}, (double[3]){1, 1, 0}, 0.7);
  struct rigid_pose inner = rigid_pose_turned((double[3]){0, 0.3, -1}, (double[3]){0, 2, 1}, -1.9);
  struct rigid_pose both = rigid_pose_compose(&outer, &inner);
  double x[3] = {0.2, -0.4, 0.9}, once[3], twice[3];
  rigid_pose_outward(&both, x, once);
  rigid_pose_outward(&inner, x, twice);
  rigid_pose_outward(&outer, twice, twice);
  check_vector(once, twice[0], twice[1], twice[2], 1e-15);
}
END_TEST

START_TEST(a_million_moves_leave_the_rotation_orthonormal) {
  struct rigid_pose pose = rigid_pose_identity();
  const double turn[3] = {1e-3, -2e-3, 5e-4}, shift[3] = {1e-6, 0, -1e-6};
  for (int i = 0; i < 1000000; i++) {
    rigid_pose_move(&pose, shift, turn);
  }
  for (int i = 0; i < 9; i++) {
    double product = vec3_dot(pose.rotation + 3 * (i / 3), pose.rotation + 3 * (i % 3));
    ck_assert_double_eq_tol(product, i % 4 == 0, 1e-14);
  }
  check_vector(pose.place, 1, 0, -1, 1e-9);
  /* All turns have one axis: together they are one turn. */
  struct rigid_pose once =
      rigid_pose_turned(pose.place, turn, fmod(1e6 * vec3_norm(turn), 2 * acos(-1)));
  for (int i = 0; i < 9; i++) {
    ck_assert_double_eq_tol(pose.rotation[i], once.rotation[i], 1e-9);
  }
}
END_TEST

START_TEST(tensors_turn_with_the_object) {
  struct rigid_pose pose = rigid_pose_turned((double[3]){0, 0, 0}, (double[3]){1, 0, 0}, acos(0));
  double tensor[3][3] = {{1, 0, 0}, {0, 2, 0}, {0, 0, 3}}, wanted[3] = {1, 3, 2};
  rigid_pose_tensor_outward(&pose, tensor);
  for (int i = 0; i < 9; i++) {
    ck_assert_double_eq_tol(tensor[i / 3][i % 3], i % 4 == 0 ? wanted[i / 3] : 0, 1e-15);
  }
  /* A tensor that is not symmetric, against the meaning: R t x = (R t R^T) R x. */
  pose = rigid_pose_turned((double[3]){0, 0, 0}, (double[3]){1, 2, -1}, 0.8);
  double skew[3][3] = {{1, 2, 3}, {-4, 5, 6}, {7, -8, 9}}, x[3] = {0.3, -0.7, 0.2}, y[3], image[3];
  for (int i = 0; i < 3; i++) {
    image[i] = vec3_dot(skew[i], x);
  }
  rigid_pose_turn_outward(&pose, image, image);
  rigid_pose_turn_outward(&pose, x, y);
  rigid_pose_tensor_outward(&pose, skew);
  check_vector(image, vec3_dot(skew[0], y), vec3_dot(skew[1], y), vec3_dot(skew[2], y), 1e-14);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("rigid: poses");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, a_quarter_turn_about_z_takes_x_to_y);
  tcase_add_test(tcase, the_axis_of_an_upright_object_is_the_given_one);
  tcase_add_test(tcase, composed_poses_act_one_after_the_other);
  tcase_add_test(tcase, a_million_moves_leave_the_rotation_orthonormal);
  tcase_add_test(tcase, tensors_turn_with_the_object);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
