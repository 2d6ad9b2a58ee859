#include "solver/solve.h"

/* Tolerances of a draft relative to those of others: what they leave open, 1e-4 of the angle, is
 * far less than what the mesh does. */
static const double draft_step = 10, draft_traction = 3;

bool solve_has_gravity(const struct job_spec *spec) {
  const double *g = spec->load.gravity;
  return g[0] != 0 || g[1] != 0 || g[2] != 0;
}

enum status solve_prepare(const struct job_spec *spec, struct solve *solve, struct error *error) {
  return solve_prepare_with(spec, NULL, solve, error);
}

enum status solve_prepare_model(const struct job_spec *spec, struct fe_analyses *spare,
                                struct solve *solve, struct error *error) {
  enum status status =
      model_create_with(&solve->mesh, &spec->material, spec->contact, spare, &solve->model, error);
  if (status != STATUS_OK) {
    return status;
  }
  for (int c = 0; c < MESH_CAVITIES; c++) {
    solve->model->cavity_share[c] = spec->load.cavity_share[c];
  }
  if (solve_has_gravity(spec)) {
    model_add_gravity(solve->model, spec->load.gravity);
  }
  for (int k = 0; k < spec->plane_count; k++) {
    struct error behind = {0};
    status = model_add_plane(solve->model, spec->plane[k].point, spec->plane[k].normal, &behind);
    if (status != STATUS_OK) {
      return error_set(error, status, "/planes", "plane %d: %s", k, behind.message);
    }
  }
  return STATUS_OK;
}

enum status solve_prepare_solver(const struct job_spec *spec, struct solve *solve,
                                 struct error *error) {
  enum status status = equilibrium_create(solve->model, &solve->solver, error);
  if (status != STATUS_OK) {
    return status;
  }
  /* 1 % of the pressure between chambers leaves a penetration far below the wall thickness. */
  solve->solver->options.traction_tolerance = 0.01 * spec->load.pressure_to;
  if (spec->accuracy == ACCURACY_DRAFT) {
    solve->solver->options.traction_tolerance *= draft_traction;
    solve->solver->options.step_tolerance *= draft_step;
    solve->solver->options.hasty = true;
  }
  if (state_create(solve->model, &solve->state) != STATUS_OK) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the state");
  }
  return STATUS_OK;
}

enum status solve_prepare_with(const struct job_spec *spec, struct fe_analyses *spare,
                               struct solve *solve, struct error *error) {
  enum status status = solve_prepare_model(spec, spare, solve, error);
  return status == STATUS_OK ? solve_prepare_solver(spec, solve, error) : status;
}

void solve_release(struct solve *solve) {
  state_release(&solve->state);
  equilibrium_destroy(solve->solver);
  model_destroy(solve->model);
  mesh_release(&solve->mesh);
  *solve = (struct solve){0};
}
