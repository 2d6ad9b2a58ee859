#include "solver/estimate.h"

#include "solver/fe/transfer.h"
#include "solver/mesh/actuator.h"

/* The difference of two meshes is wanted to a few per cent of itself only. */
static const double loose_steps = 20;
static const double loose_traction = 10;

static enum status solve_finer(const struct job_spec *spec, const struct solve *coarse,
                               double pressure, struct solve *fine, struct error *error) {
  enum status status =
      transfer_state(coarse->model, &coarse->state, fine->model, &fine->state, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct equilibrium_options *o = &fine->solver->options;
  const struct equilibrium_options *given = &coarse->solver->options;
  o->step_tolerance *= loose_steps;
  o->traction_tolerance *= loose_traction;
  o->deadline_s = given->deadline_s;
  o->cancelled = given->cancelled;
  o->cancel_context = given->cancel_context;
  fine->solver->verbose = coarse->solver->verbose;
  struct fe_load load = {pressure, pressure, solve_has_gravity(spec) ? 1 : 0};
  int iterations;
  status = equilibrium_solve(fine->solver, &load, pressure, &fine->state, &iterations);
  return status == STATUS_OK
             ? status
             : error_set(error, status, NULL, "on the finer mesh, %s", status_sentence(status));
}

enum status estimate_finer(const struct job_spec *spec, const struct solve *coarse, double pressure,
                           struct sample *finer, struct error *error) {
  struct solve fine = {0};
  enum status status = actuator_mesh_finer(spec, &fine.mesh, error);
  if (status == STATUS_OK) {
    status = solve_prepare(spec, &fine, error);
  }
  if (status == STATUS_OK) {
    status = solve_finer(spec, coarse, pressure, &fine, error);
  }
  if (status == STATUS_OK) {
    *finer = (struct sample){.pressure = pressure};
    status = sample_measure(fine.model, &fine.state, finer);
  }
  solve_release(&fine);
  return status;
}
