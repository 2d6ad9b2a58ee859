/* Cook's membrane: 48 x 44 x 16 mm, thickness 1 mm, clamped at the left, a dead shear traction of
 * 1 N in all on the right edge; vertical displacement of the upper right corner. */
#include <math.h>
#include "solver/verify/cases.h"
#include "solver/verify/plane_strain.h"

static const double shear_MPa = 0.4225;
static const double ratio_03 = 2 * 1.3 / (3 * (1 - 2 * 0.3)); /* kappa/mu at nu = 0.3 */

static void cook_map(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  x[0] = 48e-3 * s[0];
  x[1] = 44e-3 * s[0] + s[1] * (44e-3 + (16e-3 - 44e-3) * s[0]);
  x[2] = 1e-3 * s[2];
}

struct membrane {
  double bulk_ratio;
  bool plane_strain;
  int coarsest; /* elements an edge */
};

static enum status solve_membrane(struct verify_run *run, struct verify_body *b,
                                  struct error *error) {
  run->control.tolerance = 1e-11;
  body_add_traction(b->model, 0, 48e-3, (double[3]){0, 1 / 16e-6, 0});
  for (int k = 1; k <= 4; k++) {
    struct fe_load load = {0, 0, k / 4.0};
    enum status status = newton_solve(b->model, &load, &b->state, &run->control);
    if (status != STATUS_OK) {
      return verify_failed(status, "the load step", error);
    }
  }
  return STATUS_OK;
}

/* reference in mm */
static enum status membrane_case(struct verify_run *run, const struct membrane *c, double reference,
                                 struct error *error) {
  struct material_spec material = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1e6 * shear_MPa}, .bulk_ratio = c->bulk_ratio};
  for (int level = 0; level < run->refinement; level++) {
    int n = c->coarsest << level;
    struct body body = {.blocks = 1, .cells = {n, n, 1}, .map = cook_map};
    struct verify_body b = {.model = NULL};
    enum status status = body_build(&body, &b.mesh);
    if (status == STATUS_OK) {
      body_hold(&b.mesh, 0, 0, HOLD_ALL);
      body_hold(&b.mesh, c->plane_strain ? -1 : 0, 0, HOLD_Z);
      status = verify_body_open(&b, &material, false, error);
    }
    if (status == STATUS_OK) {
      status = solve_membrane(run, &b, error);
    }
    if (status == STATUS_OK) {
      double tip = 1e3 * b.state.u[3 * body_node(&b.mesh, 48e-3, 60e-3, 0) + 1];
      verify_result(run, tip, reference, 0);
      verify_row(run, 1.0 / n, tip, run->report.error, b.model, "%d x %d x 1", n, n);
    }
    verify_body_close(run, &b);
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

/* The published series (Q2, 1 to 64 elements an edge: 12.19, 13.83, 14.22, 14.30, 14.32, 14.33,
 * 14.33) is said to be plane strain. Its program looks for the faces z = +-0.5 by their x
 * coordinate, finds none, and so leaves the sheet free across its thickness; that is what the
 * values belong to, and what is solved here.
 * The published law is kappa/4 (J^2 - 1 - 2 ln J), ours kappa/2 (J - 1)^2. */
enum status case_cook_sheet(struct verify_run *run, struct error *error) {
  return membrane_case(run, &(struct membrane){ratio_03, false, 2}, 14.33, error);
}

/* Value of the second program for ever finer meshes, in mm: 3, 6 and 12 elements an edge,
 * extrapolated by Aitken's rule. What the extrapolation adds is reported. */
static enum status second_program(struct verify_run *run, double kappa, double *limit,
                                  struct error *error) {
  double tip[3];
  for (int k = 0; k < 3; k++) {
    tip[k] = plane_strain_cook(3 << k, shear_MPa, kappa, LAW_SQUARE);
  }
  double first = tip[1] - tip[0], second = tip[2] - tip[1];
  *limit = tip[2] + second * second / (first - second);
  verify_metric(run, "reference_extrapolated_percent", 100 * fabs(*limit / tip[2] - 1));
  return isfinite(*limit) ? STATUS_OK : verify_failed(STATUS_DIVERGED, "the second program", error);
}

/* The second program also tells how much the volumetric law matters. */
enum status case_cook_plane_strain(struct verify_run *run, struct error *error) {
  double mu = shear_MPa, kappa = ratio_03 * mu, reference = 0;
  double ratio =
      plane_strain_cook(6, mu, kappa, LAW_LOGARITHM) / plane_strain_cook(6, mu, kappa, LAW_SQUARE);
  verify_metric(run, "effect_of_volumetric_law_percent", 100 * fabs(ratio - 1));
  enum status status = second_program(run, kappa, &reference, error);
  return status == STATUS_OK
             ? membrane_case(run, &(struct membrane){ratio_03, true, 2}, reference, error)
             : status;
}

enum status case_cook_incompressible(struct verify_run *run, struct error *error) {
  double reference = 0;
  enum status status = second_program(run, 1000 * shear_MPa, &reference, error);
  return status == STATUS_OK
             ? membrane_case(run, &(struct membrane){1000, true, 2}, reference, error)
             : status;
}
