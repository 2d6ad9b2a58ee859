/* Contact between faces of the body: tangent against differences, and the patch test: a uniform
 * pressure arrives unchanged. */
#include <math.h>
#include <stdlib.h>
#include "solver/fe/equilibrium.h"
#include "solver/verify/cases.h"
#include "solver/verify/contact_pair.h"

/* ---- tangent ---- */

/* Penetrating; in the range of the smoothing; a multiplier across an open gap, for which the
 * curvature of the master face counts most. */
static const struct regime {
  double gap, lambda, crooked;
} regimes[] = {{-0.12, 0, 0.05}, {0.01, 0, 0.05}, {0.08, 3, 0.05}};
enum { REGIMES = sizeof regimes / sizeof *regimes };

static double worst_error(void *context, double h) {
  struct contact_pair_case *c = context;
  double worst = 0;
  for (int k = 0; k < REGIMES; k++) {
    worst = fmax(worst, contact_pair_error(&c[k], h));
  }
  return worst;
}

enum status case_tangent_contact(struct verify_run *run, struct error *error) {
  struct contact_pair_case *c = calloc(REGIMES, sizeof *c);
  enum status status = c ? STATUS_OK : STATUS_NO_MEMORY;
  for (int k = 0; status == STATUS_OK && k < REGIMES; k++) {
    status = contact_pair_open(&c[k], regimes[k].gap, regimes[k].crooked, regimes[k].lambda);
    if (status == STATUS_OK) {
      status = contact_pair_tangent(&c[k]);
    }
  }
  if (status == STATUS_OK) {
    verify_difference(run, worst_error, c, 2e-3);
  } else {
    verify_failed(status, "the pair of faces", error);
  }
  for (int k = 0; c && k < REGIMES; k++) {
    contact_pair_close(&c[k]);
  }
  free(c);
  return status;
}

/* ---- patch test ---- */

static const double traction = 0.3;
static const double patch_gap = 1e-6; /* nodes of touching blocks would be joined */

static enum status transmit(struct verify_run *run, struct verify_body *b, int cells,
                            struct error *error) {
  struct equilibrium *solver;
  struct fe_load load = {0, 0, 1};
  int iterations;
  enum status status = equilibrium_create(b->model, &solver, error);
  if (status != STATUS_OK) {
    return status;
  }
  body_add_traction(b->model, 0, 2 + patch_gap, (double[3]){-traction, 0, 0});
  solver->options.traction_tolerance = 1e-8;
  solver->options.step_tolerance = 1e-9;
  solver->options.deadline_s = run->control.deadline_s;
  solver->options.cancelled = run->control.cancelled;
  status = equilibrium_solve(solver, &load, 0, &b->state, &iterations);
  equilibrium_destroy(solver);
  if (status != STATUS_OK) {
    return verify_failed(status, "the contact", error);
  }
  /* The points of the faces in the middle: those of the slaves come first. */
  double worst = 0, found = traction;
  for (int i = 0; i < cells * cells * QUAD9_POINTS; i++) {
    double pressure = b->model->contact.point[i].lambda;
    if (fabs(pressure / traction - 1) >= worst) {
      worst = fabs(pressure / traction - 1);
      found = pressure;
    }
  }
  verify_result(run, found, traction, 0);
  verify_row(run, 1.0 / cells, found, worst, b->model, "2 x (1 x %d x %d)", cells, cells);
  return STATUS_OK;
}

/* The blocks slide on three planes of symmetry. */
enum status case_contact_patch(struct verify_run *run, struct error *error) {
  const struct material_spec rubber = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 50};
  enum status status = STATUS_OK;
  for (int cells = 2; status == STATUS_OK && cells <= 1 + run->refinement; cells++) {
    struct verify_body b = {.model = NULL};
    status = contact_blocks_build(cells, patch_gap, &b.mesh);
    if (status == STATUS_OK) {
      body_hold(&b.mesh, 0, 0, HOLD_X);
      body_hold(&b.mesh, 1, 0, HOLD_Y);
      body_hold(&b.mesh, 2, 0, HOLD_Z);
      status = verify_body_open(&b, &rubber, true, error);
    }
    if (status == STATUS_OK) {
      status = transmit(run, &b, cells, error);
    }
    verify_body_close(run, &b);
  }
  return status;
}
