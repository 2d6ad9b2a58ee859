/* A body with everything that it takes to follow its load path. */
#ifndef PNEULAB_SOLVE_H
#define PNEULAB_SOLVE_H

#include "solver/fe/equilibrium.h"
#include "solver/job/spec.h"

struct solve {
  struct mesh mesh;
  struct fe_model *model;
  struct equilibrium *solver;
  struct fe_state state;
};

/* Fills model, solver and state (undeformed) for `solve->mesh`, which the caller has made, from
 * material, loads and contact of the job. solve_release is due in either case. STATUS_OK or the
 * failures of model_create and equilibrium_create. */
enum status solve_prepare(const struct job_spec *spec, struct solve *solve, struct error *error);

/* The same with analyses of other bodies, as in model_create_with. */
enum status solve_prepare_with(const struct job_spec *spec, struct fe_analyses *spare,
                               struct solve *solve, struct error *error);

/* The same in two parts, between which objects can be added: the model, then solver and state. */
enum status solve_prepare_model(const struct job_spec *spec, struct fe_analyses *spare,
                                struct solve *solve, struct error *error);
enum status solve_prepare_solver(const struct job_spec *spec, struct solve *solve,
                                 struct error *error);

/* Releases everything, the mesh too, and clears it. */
void solve_release(struct solve *solve);

/* Whether the body has weight. */
bool solve_has_gravity(const struct job_spec *spec);

#endif
