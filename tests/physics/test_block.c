/* A nearly incompressible block (nu = 0.4999) under a pressure on the middle of its top, after
 * Reese and others (2000): a quarter of it, 1 x 1 x 1 mm, mu = 80.194 MPa. The top moves only
 * vertically, the pressure p/p0, p0 = 4 MPa, keeps its direction and its reference area. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "tests/physics/body.h"
#include "tests/physics/newton.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

static void cube_map(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  memcpy(x, s, 3 * sizeof *x);
}

/* Volume of the deformed body over that of the undeformed one. */
static double volume_ratio(const struct fe_model *m, const struct fe_state *state) {
  double volume = 0;
  for (int e = 0; e < m->mesh->element_count; e++) {
    double u[3][HEX27_STRIDE];
    model_gather(m, state->u, e, u);
    for (int q = 0; q < HEX27_POINTS; q++) {
      struct kinematics k;
      element_gradient(&m->geometry[e], q, u, k.f);
      volume += m->geometry[e].weight[q] * kinematics_complete(&k);
    }
  }
  return volume / m->reference_volume;
}

/* Presses to p/p0 = 80; returns the shortening at the middle and the change of volume. */
static double press(int n, double *change) {
  const double nu = 0.4999, shear = 80.194, pressure = 320; /* MPa; lengths in mm */
  struct material_spec material = {.model = MATERIAL_NEO_HOOKE,
                                   .terms = 1,
                                   .c = {shear},
                                   .bulk_ratio = 2 * (1 + nu) / (3 * (1 - 2 * nu))};
  struct body body = {.blocks = 1, .cells = {n, n, n}, .map = cube_map};
  struct mesh mesh;
  struct fe_state state;
  body_build(&body, &mesh);
  body_hold(&mesh, 0, 0, HOLD_X);
  body_hold(&mesh, 1, 0, HOLD_Y);
  body_hold(&mesh, 2, 0, HOLD_Z);
  body_hold(&mesh, 2, 1, HOLD_X | HOLD_Y);
  struct fe_model *m = body_model(&mesh, &material);
  body_add_traction_within(m, 2, 1, 0.5, (double[3]){0, 0, -pressure});
  ck_assert_int_eq(state_create(m, &state), STATUS_OK);
  for (int k = 1; k <= 20; k++) {
    struct fe_load load = {0, 0, k / 20.0};
    enum status status = newton_solve(m, &load, &state, 1e-9, NULL);
    ck_assert_msg(status == STATUS_OK, "step %d: %s", k, status_word(status));
  }
  double shortening = -state.u[3 * body_node(&mesh, 0, 0, 1) + 2];
  *change = volume_ratio(m, &state) - 1;
  state_release(&state);
  model_destroy(m);
  mesh_release(&mesh);
  return shortening;
}

START_TEST(volume_is_kept) {
  const int meshes[] = {2, 4};
  double shortening[2], change = 0;
  for (int k = 0; k < 2; k++) {
    char mesh[40];
    shortening[k] = press(meshes[k], &change);
    snprintf(mesh, sizeof mesh, "%d x %d x %d", meshes[k], meshes[k], meshes[k]);
    report_value("pressed block, p/p0 = 80, change of volume", mesh, 0, change);
    printf("shortening %.4f of 1\n", shortening[k]);
  }
  ck_assert_double_lt(fabs(change), 1e-4);
  ck_assert_double_eq_tol(shortening[0], shortening[1], 0.05 * shortening[1]);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("block");
  TCase *block = tcase_create("block");
  tcase_set_timeout(block, 200);
  tcase_add_test(block, volume_is_kept);
  suite_add_tcase(suite, block);
  return suite_run(suite);
}
