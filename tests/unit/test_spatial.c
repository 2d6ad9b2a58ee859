/* Bending, twist and reach of a body laid along curves that have closed forms. */
#include <math.h>
#include <stdlib.h>

#include "solver/base/vec3.h"
#include "solver/mesh/pneunet.h"
#include "solver/post/spatial.h"
#include "tests/physics/pneunet_case.h"
#include "tests/unit/suite.h"

static const double degree = M_PI / 180;

static void mesh_of(bool half, struct mesh *mesh) {
  struct job_spec spec;
  case_prototype(&spec, 8);
  case_refine(&spec, 1);
  spec.half_model = half;
  ck_assert_int_eq(pneunet_mesh(&spec, mesh, NULL), STATUS_OK);
}

/* Displacements that lay the body along the rod of constant curvature vector `w` (over the whole
 * length): frames exp(s w / L), centreline their integral, sections rigid. */
static double *lay(const struct mesh *mesh, const double w[3]) {
  int tip = mesh->centreline[mesh->section_count - 1];
  double length = mesh->x[3 * tip];
  double *u = calloc(3 * (size_t)mesh->node_count, sizeof *u);
  ck_assert_ptr_nonnull(u);
  for (int n = 0; n < mesh->node_count; n++) {
    const double *x = mesh->x + 3 * (size_t)n;
    double turn[3], frame[9], arm[3] = {0, x[1], x[2]}, offset[3], line[3] = {0};
    /* integral of exp(s w/L) e_x by Gauss points of 64 intervals, far below the tolerances */
    for (int k = 0; k < 128; k++) {
      double place = (k / 2 + 0.5 + (k % 2 ? 1 : -1) / sqrt(12)) / 64, e[3] = {1, 0, 0}, moved[3];
      for (int i = 0; i < 3; i++) {
        turn[i] = w[i] * place * x[0] / length;
      }
      rotation_matrix(turn, frame);
      mat3_apply(frame, e, moved);
      for (int i = 0; i < 3; i++) {
        line[i] += moved[i] * x[0] / 128;
      }
    }
    for (int i = 0; i < 3; i++) {
      turn[i] = w[i] * x[0] / length;
    }
    rotation_matrix(turn, frame);
    mat3_apply(frame, arm, offset);
    for (int i = 0; i < 3; i++) {
      u[3 * n + i] = line[i] + offset[i] - x[i];
    }
  }
  return u;
}

/* Chord of the helix with curvature vector w over a unit length: of the axis, the part along w is
 * kept, the rest turns (2 sin(|w|/2) / |w|). */
static double chord(const double w[3]) {
  double size = vec3_norm(w);
  if (size < 1e-12) {
    return 1;
  }
  double along = w[0] / size, across2 = 1 - along * along, part = 2 * sin(0.5 * size) / size;
  return sqrt(along * along + across2 * part * part);
}

static const double curves[][3] = {
    {0, 0, 0},    {0, 60, 0},  {0, 200, 0}, {0, 400, 0},  {0, -75, 0},    {50, 0, 0},
    {-300, 0, 0}, {0, 0, 100}, {40, 90, 0}, {120, 45, 0}, {-120, 176, 0}, {30, 200, -25},
};

START_TEST(rods_of_constant_curvature) {
  struct mesh mesh;
  struct spatial s;
  double w[3];
  mesh_of(false, &mesh);
  for (int i = 0; i < 3; i++) {
    w[i] = curves[_i][i] * degree;
  }
  double *u = lay(&mesh, w);
  ck_assert_int_eq(spatial_measure(&mesh, u, &s), STATUS_OK);
  ck_assert_double_eq_tol(s.twist, w[0], 1e-6);
  ck_assert_double_eq_tol(s.bending, w[1], 1e-6);
  ck_assert_double_eq_tol(s.side_bending, w[2], 1e-6);
  ck_assert_double_eq_tol(s.turn, hypot(w[1], w[2]), 1e-6);
  /* The quaternion of the end section is (cos |w|/2, sin |w|/2 w/|w|). */
  double size = vec3_norm(w), half = 0.5 * size;
  double twist = size > 0 ? 2 * atan2(sin(half) * w[0] / size, cos(half)) : 0;
  ck_assert_double_eq_tol(remainder(s.end_twist - twist, 2 * M_PI), 0, 1e-6);
  ck_assert_double_lt(fabs(s.end_twist - s.twist), M_PI + 1e-6);
  double swing =
      size > 0 ? (w[0] * w[0] + (w[1] * w[1] + w[2] * w[2]) * cos(size)) / (size * size) : 1;
  ck_assert_double_eq_tol(cos(s.end_bending), swing, 1e-6);
  ck_assert_double_eq_tol(s.contraction, 1 - chord(w), 1e-6);
  free(u);
  mesh_release(&mesh);
}
END_TEST

/* The half model of a plane bend says the same, and no twist at all. */
START_TEST(half_model_has_no_twist) {
  struct mesh mesh;
  struct spatial s;
  mesh_of(true, &mesh);
  double w[3] = {0, 250 * degree, 0};
  double *u = lay(&mesh, w);
  ck_assert_int_eq(spatial_measure(&mesh, u, &s), STATUS_OK);
  ck_assert_double_eq_tol(s.bending, w[1], 1e-6);
  ck_assert_double_eq_tol(s.contraction, 1 - chord(w), 1e-6);
  ck_assert(s.twist == 0 && s.side_bending == 0 && s.end_twist == 0);
  free(u);
  mesh_release(&mesh);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("spatial");
  TCase *test = tcase_create("rods");
  tcase_add_loop_test(test, rods_of_constant_curvature, 0, sizeof curves / sizeof *curves);
  tcase_add_test(test, half_model_has_no_twist);
  suite_add_tcase(suite, test);
  return suite_run(suite);
}
