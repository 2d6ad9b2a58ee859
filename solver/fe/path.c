#include "solver/fe/path_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "solver/fe/obstacle.h"

/* Step control. */
static const double cut_factor = 0.4;
static const double grow_factor = 2;
/* Foreseen at the first step: movement in longest steps, overlap in widths of the gap. */
static const double foreseen = 0.8, closing = 0.3;
/* Overlap foreseen at later steps, likewise. */
static const double passing = 1;
enum {
  HALVINGS = 6,
  SHORTENINGS = 2,
  ROUGH_STEPS = 3,
  LONG_STEP = 4, /* in smallest ones */
  EASY_ITERATIONS = 6,
  SMALLEST_PART = 60 /* of the load: below that, arc length */
};

struct fe_load walk_load(const struct walk *w, const struct stage *stage, double value) {
  bool dead = w->options->dead_load;
  return stage->dead ? (struct fe_load){0, 0, value} : (struct fe_load){value, value, dead ? 1 : 0};
}

enum status walk_visit(struct walk *w, const struct stage *stage, bool recorded,
                       const struct fe_state *state, double value) {
  struct fe_load load = walk_load(w, stage, value);
  struct path_point point = {load.pressure, load.dead,         w->iterations,
                             recorded,      state != w->state, state};
  if (recorded) {
    w->iterations = 0;
  }
  return w->options->visit ? w->options->visit(w->options->context, &point) : STATUS_OK;
}

enum status walk_advance(struct walk *w, const struct stage *stage, double target,
                         int *iterations) {
  struct fe_model *m = w->solver->model;
  struct fe_load load = walk_load(w, stage, target);
  double previous = stage->dead ? 0 : w->value;
  state_copy(m, &w->trial, w->state);
  enum status status = equilibrium_solve(w->solver, &load, previous, &w->trial, iterations);
  w->iterations += *iterations;
  if (status == STATUS_OK) {
    model_commit_obstacles(m, &w->trial);
    state_copy(m, w->state, &w->trial);
    w->value = target;
  }
  if (w->solver->verbose) {
    fprintf(stderr, "  load %.6g: %s after %d factorisations\n", target, status_word(status),
            *iterations);
  }
  return status;
}

/* Next load to try on the way to `goal`: a step that would leave a sliver before it ends on it. */
static double next_target(const struct walk *w, double goal) {
  double target = w->value + w->step;
  return target > goal - 0.05 * w->step ? goal : target;
}

/* Whether a step of the load along `direction` closes gaps by more than `share` of their width. */
static bool step_closes(struct walk *w, double step, const double *direction, double share,
                        double *most) {
  struct fe_model *m = w->solver->model;
  *most = 0;
  state_copy(m, &w->trial, w->state);
  for (int d = 0; d < 3 * m->mesh->node_count; d++) {
    double move = m->equation[d] >= 0 ? step * direction[m->equation[d]] : 0;
    w->trial.u[d] += move;
    *most = fmax(*most, fabs(move));
  }
  model_update_gaps(m, &w->trial);
  return m->use_contact && contact_summarise(&m->contact).min_gap < -share * m->mesh->gap_width;
}

/* Shortens a step to `goal` by which, as the factor of the last equilibrium foresees, the body
 * would pass far into itself: Newton's method would not find out of that. */
static enum status shorten(struct walk *w, const struct stage *stage, double *target) {
  struct equilibrium *solver = w->solver;
  struct fe_model *m = solver->model;
  if (!solver->options.hasty || stage->dead || !solver->factor_fits || !m->use_contact ||
      m->mesh->facing_count == 0) {
    return STATUS_OK;
  }
  double *direction = calloc((size_t)m->dof_count + 1, sizeof *direction), most;
  if (!direction) {
    return STATUS_NO_MEMORY;
  }
  equilibrium_direction(solver, w->state, direction);
  double step = *target - w->value;
  for (int k = 0; k < SHORTENINGS && step_closes(w, step, direction, passing, &most); k++) {
    step *= 0.5;
    *target = w->value + step;
    w->step = step;
  }
  model_update_gaps(m, w->state);
  free(direction);
  return STATUS_OK;
}

/* In haste a long step that does not go well is given up early, and no contact settles on the way.
 */
static void be_hasty(struct walk *w, const struct stage *stage, double target, double goal) {
  struct equilibrium_options *o = &w->solver->options;
  bool is_long = target - w->value > LONG_STEP * stage->end / SMALLEST_PART;
  o->rough_steps = o->hasty && is_long ? ROUGH_STEPS : 0;
  o->passing = o->hasty && target < goal;
}

/* Reaches `goal`, by load steps or, where they get too short, by arc length. */
static enum status reach(struct walk *w, const struct stage *stage, double goal) {
  while (w->value < goal) {
    double target = next_target(w, goal);
    if (shorten(w, stage, &target) != STATUS_OK) {
      return STATUS_NO_MEMORY;
    }
    int iterations;
    be_hasty(w, stage, target, goal);
    enum status status = walk_advance(w, stage, target, &iterations);
    w->solver->options.passing = false;
    if (status_is_final(status)) {
      return status;
    }
    if (status != STATUS_OK) {
      w->failure = status;
      w->step = cut_factor * (target - w->value);
      if (w->step >= stage->end / SMALLEST_PART) {
        continue;
      }
      status = walk_arc(w, stage, goal);
      if (status != STATUS_OK) {
        return status;
      }
    } else if (iterations <= EASY_ITERATIONS) {
      w->step = fmin(grow_factor * w->step, stage->full);
    }
    if (w->value < goal) {
      status = walk_visit(w, stage, false, w->state, w->value);
    }
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

/* Whether in the last converged state the body presses on itself beyond neighbouring chambers. */
static bool folded(struct walk *w) {
  model_use_multipliers(w->solver->model, w->state);
  return w->solver->model->use_contact && contact_folded(&w->solver->model->contact);
}

/* Largest first step that the tangent at the start foresees as harmless: the body moves by a small
 * part of its length and its gaps do not close by far. The factor serves the step itself too. */
static enum status foresee(struct walk *w, const struct stage *stage) {
  struct equilibrium *solver = w->solver;
  const struct fe_model *m = solver->model;
  struct fe_load load = walk_load(w, stage, 0);
  double *direction = calloc((size_t)m->dof_count + 1, sizeof *direction);
  enum status status = direction
                           ? equilibrium_tangent(solver, &load, stage->dead, w->state, direction)
                           : STATUS_NO_MEMORY;
  for (int k = 0; status == STATUS_OK && k < HALVINGS; k++) {
    double most;
    bool closes = step_closes(w, w->step, direction, closing, &most);
    if (most < foreseen * solver->options.longest_step && !closes) {
      break;
    }
    w->step *= 0.5;
  }
  solver->factor_fits = status == STATUS_OK;
  free(direction);
  return status_is_final(status) ? status : STATUS_OK;
}

static enum status walk_stage(struct walk *w, const struct stage *stage) {
  w->value = 0;
  w->step = stage->full;
  enum status status = foresee(w, stage);
  if (status != STATUS_OK) {
    return status;
  }
  for (int record = 1; record <= stage->records; record++) {
    status = reach(w, stage, stage->end * record / stage->records);
    if (status == STATUS_DIVERGED) {
      return folded(w) ? STATUS_CONTACT : STATUS_STEP_MINIMUM;
    }
    if (status == STATUS_OK) {
      status = walk_visit(w, stage, !stage->dead, w->state, w->value);
    }
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

/* Says how far the walk came and why it ended there. */
static void explain(const struct walk *w, const struct stage *stage, enum status status,
                    struct error *error) {
  const char *what = stage->dead ? "of the weight" : "kPa";
  double unit = stage->dead ? 1 : 1e-3;
  if (status == STATUS_LIMIT_POINT) {
    error_set(error, status, "/load",
              "the load cannot be raised beyond %.5g %s: a limit point, after which the path was "
              "followed down to %.5g %s",
              unit * w->limit, what, unit * w->beyond, what);
  } else {
    error_set(error, status, "/load", "stopped at %.5g %s: %s (last attempt: %s)", unit * w->value,
              what, status_sentence(status), status_sentence(w->failure));
  }
}

enum status path_follow(struct equilibrium *solver, const struct path_options *options,
                        struct fe_state *state, struct error *error) {
  struct walk w = {.solver = solver, .options = options, .state = state};
  struct stage dead = {true, 1, 1, 0.5};
  struct stage pressure = {false, options->pressure_to, options->steps,
                           options->pressure_to / options->steps};
  const struct stage *stage = &dead;
  enum status status = state_create(solver->model, &w.trial);
  if (status == STATUS_OK && options->dead_load) {
    status = walk_stage(&w, &dead);
  }
  if (status == STATUS_OK) {
    stage = &pressure;
    w.value = 0;
    status = walk_visit(&w, &pressure, true, state, 0);
  }
  if (status == STATUS_OK) {
    status = walk_stage(&w, &pressure);
  }
  if (status != STATUS_OK) {
    explain(&w, stage, status, error);
  }
  state_release(&w.trial);
  return status;
}
