/* The speed of Newton's method: a thick sphere under a follower pressure, in one step from rest.
 * The material is compressible: else the pressures carry most of the error, and the displacements
 * alone do not show the order. */
#include <math.h>
#include "solver/verify/cases.h"
#include "solver/verify/inflation.h"

/* Order of convergence: slope of correction over correction before, both in logarithms, from the
 * second iteration to the last one above round-off. */
static double observed_order(struct verify_run *run, const struct newton_log *log, int unknowns) {
  int last = 0;
  for (int k = 0; k + 1 < log->count; k++) {
    double e = log->correction[k + 1];
    verify_row(run, log->correction[k], e, e, NULL, "iteration %d", k + 2);
    run->report.row[run->report.row_count - 1].unknowns = unknowns;
    last = e > 1e-13 ? k + 1 : last;
  }
  return verify_order(run, 1, last);
}

enum status case_newton(struct verify_run *run, struct error *error) {
  struct material_spec material = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 1};
  struct newton_log log;
  struct inflation c;
  int n = 1 + run->refinement;
  enum status status = inflation_open(&c, &inflation_sphere, &material, n, n, error);
  if (status == STATUS_OK) {
    struct fe_load load = {0.5, 0.5, 0};
    run->control.tolerance = 1e-14;
    run->control.log = &log;
    status = newton_solve(c.body.model, &load, &c.body.state, &run->control);
    run->control.log = NULL;
    if (status == STATUS_OK) {
      verify_result(run, observed_order(run, &log, c.body.model->dof_count), 2, 0);
      verify_metric(run, "iterations", log.count);
    } else {
      verify_failed(status, "Newton's method", error);
    }
  }
  verify_body_close(run, &c.body);
  return status;
}
