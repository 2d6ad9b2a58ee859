/* Cook's membrane: 48 x 44 x 16 mm, thickness 1 mm, clamped at the left, a dead shear traction of
 * 1 N in all on the right edge. */
#include <check.h>
#include <stdio.h>
#include "tests/physics/body.h"
#include "tests/physics/newton.h"
#include "tests/physics/plane_strain.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

static void cook_map(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  x[0] = 48e-3 * s[0];
  x[1] = 44e-3 * s[0] + s[1] * (44e-3 + (16e-3 - 44e-3) * s[0]);
  x[2] = 1e-3 * s[2];
}

/* Vertical displacement of the upper right corner, mm, with n elements an edge. */
static double cook_tip(int n, double bulk_ratio, bool plane_strain) {
  struct material_spec material = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {0.4225e6}, .bulk_ratio = bulk_ratio};
  struct body body = {.blocks = 1, .cells = {n, n, 1}, .map = cook_map};
  struct mesh mesh;
  struct fe_state state;
  body_build(&body, &mesh);
  body_hold(&mesh, 0, 0, HOLD_ALL);
  if (plane_strain) {
    body_hold(&mesh, -1, 0, HOLD_Z);
  }
  struct fe_model *model = body_model(&mesh, &material);
  body_add_traction(model, 0, 48e-3, (double[3]){0, 1 / 16e-6, 0});
  ck_assert_int_eq(state_create(model, &state), STATUS_OK);
  for (int k = 1; k <= 4; k++) {
    struct fe_load load = {0, 0, k / 4.0};
    ck_assert_int_eq(newton_solve(model, &load, &state, 1e-11, NULL), STATUS_OK);
  }
  double tip = 1e3 * state.u[3 * body_node(&mesh, 48e-3, 60e-3, 0) + 1];
  state_release(&state);
  model_destroy(model);
  mesh_release(&mesh);
  return tip;
}

static const double mu = 0.4225;                              /* MPa */
static const double ratio_03 = 2 * 1.3 / (3 * (1 - 2 * 0.3)); /* kappa/mu at nu = 0.3 */

/* The published series (Q2, 1 to 64 elements an edge: 12.19, 13.83, 14.22, 14.30, 14.32, 14.33,
 * 14.33) is said to be plane strain. Its program looks for the faces z = +-0.5 by their x
 * coordinate, finds none, and so leaves the sheet free across its thickness; that is what the
 * values belong to, and what is solved here. Plane strain gives 13.76 (below).
 * The published law is kappa/4 (J^2 - 1 - 2 ln J), ours kappa/2 (J - 1)^2. */
START_TEST(free_sheet_meets_the_published_value) {
  const int meshes[] = {2, 4, 8, 16};
  double tip = 0;
  for (int k = 0; k < 4; k++) {
    char mesh[20];
    tip = cook_tip(meshes[k], ratio_03, false);
    snprintf(mesh, sizeof mesh, "%d x %d x 1", meshes[k], meshes[k]);
    report_value("Cook, nu = 0.3, free faces, tip, mm", mesh, 14.33, tip);
  }
  ck_assert_double_eq_tol(tip, 14.33, 5e-3 * 14.33);
}
END_TEST

/* Plane strain at the same load against an independent program, which also tells how much the
 * volumetric law matters. */
START_TEST(plane_strain_meets_an_independent_program) {
  double square = plane_strain_cook(12, mu, ratio_03 * mu, LAW_SQUARE);
  double logarithm = plane_strain_cook(12, mu, ratio_03 * mu, LAW_LOGARITHM);
  double tip = cook_tip(12, ratio_03, true);
  report_check("Cook, nu = 0.3, plane strain, independent program, mm", "12 x 12", square, tip,
               1e-3);
  report_check("Cook, nu = 0.3, effect of the volumetric law, mm", "12 x 12", square, logarithm,
               1e-3);
}
END_TEST

/* A locking element would be far too stiff on the coarse mesh. */
START_TEST(nearly_incompressible) {
  double coarse = cook_tip(4, 1000, true), fine = cook_tip(16, 1000, true);
  report_check("Cook, bulk/shear 1000, 4 x 4 against 16 x 16, mm", "4 x 4", fine, coarse, 0.02);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("Cook's membrane");
  TCase *cook = tcase_create("Cook");
  tcase_set_timeout(cook, 200);
  tcase_add_test(cook, free_sheet_meets_the_published_value);
  tcase_add_test(cook, plane_strain_meets_an_independent_program);
  tcase_add_test(cook, nearly_incompressible);
  suite_add_tcase(suite, cook);
  return suite_run(suite);
}
