#include "solver/fe/warm.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/section_form.h"

/* In haste, a walk that does not go well is given up at once: another one begins at rest. */
enum { ROUGH_STEPS = 1 };

/* A mesh with the undeformed places of the record's body. */
static struct mesh record_mesh(const struct path_record *r, const struct mesh *mesh) {
  struct mesh before = *mesh;
  before.x = r->x;
  return before;
}

enum status path_record_carry(const struct path_record *r, int index, const struct fe_model *m,
                              struct fe_state *state) {
  const struct fe_state *old = &r->state[index];
  struct section_form form = {0};
  enum status status = STATUS_OK;
  memcpy(state->p, old->p, sizeof *old->p * ELEMENT_PRESSURES * (size_t)r->element_count);
  memcpy(state->lambda, old->lambda, sizeof *old->lambda * (size_t)r->point_count);
  if (m->mesh->section_count == 0) {
    memcpy(state->u, old->u, sizeof *old->u * 3 * (size_t)r->node_count);
    return STATUS_OK;
  }
  struct mesh before = record_mesh(r, m->mesh);
  status = section_form_create(m->mesh, &form);
  if (status == STATUS_OK) {
    status = section_form_take(&before, old->u, &form);
  }
  if (status == STATUS_OK) {
    status = section_form_give(m->mesh, &form, state->u);
  }
  section_form_release(&form);
  return status;
}

/* One walk down. */
struct descent {
  struct equilibrium *solver;
  const struct path_options *options;
  const struct path_record *record;
  struct fe_state *state;
  struct path_record *found;                   /* highest load first */
  int *iterations;                             /* of each of them */
  struct section_form old, last_old, last_new; /* at this load and at the one before */
};

/* The record's state whose load is nearest. */
static int nearest(const struct path_record *r, double pressure) {
  int best = 0;
  for (int k = 1; k < r->count; k++) {
    if (fabs(r->pressure[k] - pressure) < fabs(r->pressure[best] - pressure)) {
      best = k;
    }
  }
  return best;
}

/* values <- old + share (last_new - last_old) */
static void extrapolate(double *values, const double *old, double share, const double *last_old,
                        const double *last_new, int count) {
  for (int i = 0; i < count; i++) {
    values[i] = old[i] + share * (last_new[i] - last_old[i]);
  }
}

/* First guess at load `pressure`: the record's state there, moved on by a share of what the new
 * body differed by at the load before. Contact that has not been there is not made up. */
static enum status guess(struct descent *d, double pressure, double previous) {
  const struct path_record *r = d->record;
  const struct mesh *mesh = d->solver->model->mesh;
  const struct fe_state *old = &r->state[nearest(r, pressure)];
  const struct fe_state *last_old = &r->state[nearest(r, previous)];
  const struct fe_state *last_new = &d->found->state[d->found->count - 1];
  struct mesh before = record_mesh(r, mesh);
  double share = pressure / previous;
  extrapolate(d->state->p, old->p, share, last_old->p, last_new->p,
              ELEMENT_PRESSURES * r->element_count);
  extrapolate(d->state->lambda, old->lambda, share, last_old->lambda, last_new->lambda,
              r->point_count);
  for (int i = 0; i < r->point_count; i++) {
    d->state->lambda[i] = old->lambda[i] > 0 ? fmax(0, d->state->lambda[i]) : 0;
  }
  if (mesh->section_count == 0) {
    extrapolate(d->state->u, old->u, share, last_old->u, last_new->u, 3 * r->node_count);
    return STATUS_OK;
  }
  enum status status = section_form_take(&before, old->u, &d->old);
  if (status == STATUS_OK) {
    status = section_form_take(&before, last_old->u, &d->last_old);
  }
  if (status == STATUS_OK) {
    status = section_form_take(mesh, last_new->u, &d->last_new);
  }
  if (status == STATUS_OK) {
    section_form_extrapolate(mesh, &d->old, share, &d->last_old, &d->last_new);
    status = section_form_give(mesh, &d->old, d->state->u);
  }
  return status;
}

/* Whether the record has states at both loads. */
static bool recorded(const struct path_record *r, double pressure, double previous) {
  double near = fabs(r->pressure[nearest(r, pressure)] - pressure);
  double near_previous = fabs(r->pressure[nearest(r, previous)] - previous);
  return fmax(near, near_previous) < 1e-6 * previous;
}

/* Equilibrium at load `pressure` below `previous` from a guess. By what a design differs from one
 * other at a load, it differs at the next, too; but what was expected from several is off in any
 * direction, so that it is tried as it is. */
static enum status solve_guess(struct descent *d, const struct fe_load *load, double previous,
                               bool corrected, int *iterations) {
  const struct path_record *r = d->record;
  int spent = *iterations;
  enum status status =
      corrected ? guess(d, load->pressure, previous)
                : path_record_carry(r, nearest(r, load->pressure), d->solver->model, d->state);
  d->solver->factor_fits = false;
  model_renew_pairs(d->solver->model);
  if (status == STATUS_OK) {
    status = equilibrium_solve(d->solver, load, load->pressure, d->state, iterations);
    *iterations += spent;
  }
  return status;
}

/* Equilibrium at a load below `previous`. */
static enum status step_down(struct descent *d, double pressure, double previous, int *iterations) {
  struct fe_load load = {pressure, pressure, d->options->dead_load ? 1 : 0};
  bool mixed = d->record->mixed;
  if (!recorded(d->record, pressure, previous)) {
    return equilibrium_solve(d->solver, &load, previous, d->state, iterations);
  }
  enum status status = solve_guess(d, &load, previous, !mixed, iterations);
  if (mixed && status != STATUS_OK && !status_is_final(status)) {
    status = solve_guess(d, &load, previous, true, iterations);
  }
  return status;
}

static enum status descend(struct descent *d) {
  const struct path_options *o = d->options;
  const struct fe_model *m = d->solver->model;
  double previous = o->pressure_to;
  enum status status = path_record_carry(d->record, nearest(d->record, previous), m, d->state);
  d->solver->options.rough_steps = d->solver->options.hasty ? ROUGH_STEPS : 0;
  for (int k = o->steps; k >= 0 && status == STATUS_OK; k--) {
    double pressure = o->pressure_to * k / o->steps;
    struct fe_load load = {pressure, pressure, o->dead_load ? 1 : 0};
    if (k == 0 && !o->dead_load) {
      state_clear(m, d->state);
    } else if (k == o->steps) {
      status = equilibrium_solve(d->solver, &load, previous, d->state, &d->iterations[k]);
    } else {
      status = step_down(d, pressure, previous, &d->iterations[k]);
    }
    /* A stable path from the undeformed state has none. */
    if (status == STATUS_OK && d->solver->negative_pivots > 0) {
      status = STATUS_DIVERGED;
    }
    if (status == STATUS_OK) {
      status = path_record_add(d->found, pressure, d->state);
    }
    previous = pressure;
  }
  d->solver->options.rough_steps = 0;
  return status;
}

/* Hands the states that were found to the visitor, lowest load first. */
static enum status report(const struct descent *d) {
  const struct path_options *o = d->options;
  enum status status = STATUS_OK;
  for (int k = 0; k <= o->steps && status == STATUS_OK; k++) {
    const struct fe_state *state = &d->found->state[o->steps - k];
    struct path_point point = {.pressure = o->pressure_to * k / o->steps,
                               .dead = o->dead_load ? 1 : 0,
                               .iterations = d->iterations[k],
                               .recorded = true,
                               .state = state};
    state_copy(d->solver->model, d->state, state);
    model_use_multipliers(d->solver->model, state);
    status = model_search_contact(d->solver->model, state);
    if (status == STATUS_OK && o->visit) {
      status = o->visit(o->context, &point);
    }
  }
  return status;
}

enum status path_follow_warm(struct equilibrium *solver, const struct path_options *options,
                             const struct path_record *record, struct fe_state *state, bool *warm,
                             struct error *error) {
  const struct fe_model *m = solver->model;
  struct descent d = {.solver = solver, .options = options, .record = record, .state = state};
  enum status status = STATUS_DIVERGED;
  *warm = false;
  if (path_record_fits(record, m)) {
    d.iterations = calloc((size_t)options->steps + 1, sizeof *d.iterations);
    bool room = d.iterations && path_record_create(m, &d.found) == STATUS_OK &&
                section_form_create(m->mesh, &d.old) == STATUS_OK &&
                section_form_create(m->mesh, &d.last_old) == STATUS_OK &&
                section_form_create(m->mesh, &d.last_new) == STATUS_OK &&
                model_foresee_pattern(solver->model, record->facing) == STATUS_OK;
    status = room ? descend(&d) : STATUS_NO_MEMORY;
  }
  *warm = status == STATUS_OK;
  if (*warm) {
    status = report(&d);
  } else if (status != STATUS_TIMEOUT && status != STATUS_CANCELLED) {
    solver->factor_fits = false;
    state_clear(m, state);
    status = path_follow(solver, options, state, error);
  } else {
    error_set(error, status, "/load", "%s", status_sentence(status));
  }
  path_record_destroy(d.found);
  section_form_release(&d.old);
  section_form_release(&d.last_old);
  section_form_release(&d.last_new);
  free(d.iterations);
  return status;
}
