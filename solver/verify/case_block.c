/* A nearly incompressible block (nu = 0.4999) under a pressure on the middle of its top, after
 * Reese and others (2000): a quarter of it, 1 x 1 x 1 mm, mu = 80.194 MPa. The top moves only
 * vertically, the pressure p/p0, p0 = 4 MPa, keeps its direction and its reference area. */
#include <string.h>
#include "solver/verify/cases.h"

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

/* Presses to p/p0 = 80 in 20 steps. */
static enum status press(struct verify_run *run, int n, double *shortening, struct error *error) {
  const double nu = 0.4999, shear = 80.194, pressure = 320; /* MPa; lengths in mm */
  struct material_spec material = {.model = MATERIAL_NEO_HOOKE,
                                   .terms = 1,
                                   .c = {shear},
                                   .bulk_ratio = 2 * (1 + nu) / (3 * (1 - 2 * nu))};
  struct body body = {.blocks = 1, .cells = {n, n, n}, .map = cube_map};
  struct verify_body b = {.model = NULL};
  enum status status = body_build(&body, &b.mesh);
  if (status == STATUS_OK) {
    body_hold(&b.mesh, 0, 0, HOLD_X);
    body_hold(&b.mesh, 1, 0, HOLD_Y);
    body_hold(&b.mesh, 2, 0, HOLD_Z);
    body_hold(&b.mesh, 2, 1, HOLD_X | HOLD_Y);
    status = verify_body_open(&b, &material, false, error);
  }
  if (status == STATUS_OK) {
    body_add_traction_within(b.model, 2, 1, 0.5, (double[3]){0, 0, -pressure});
  }
  for (int k = 1; status == STATUS_OK && k <= 20; k++) {
    struct fe_load load = {0, 0, k / 20.0};
    status = newton_solve(b.model, &load, &b.state, &run->control);
    if (status != STATUS_OK) {
      verify_failed(status, "the load step", error);
    }
  }
  if (status == STATUS_OK) {
    double ratio = volume_ratio(b.model, &b.state);
    *shortening = -b.state.u[3 * body_node(&b.mesh, 0, 0, 1) + 2];
    verify_result(run, ratio, 1, 0);
    verify_row(run, 1.0 / n, ratio, run->report.error, b.model, "%d x %d x %d", n, n, n);
  }
  verify_body_close(run, &b);
  return status;
}

enum status case_block(struct verify_run *run, struct error *error) {
  double shortening = 0;
  enum status status = STATUS_OK;
  run->control.tolerance = 1e-9;
  for (int level = 1; status == STATUS_OK && level <= run->refinement; level++) {
    status = press(run, 2 * level, &shortening, error);
  }
  if (status == STATUS_OK) {
    verify_metric(run, "shortening_percent", 100 * shortening);
  }
  return status;
}
