/* Arc length: the path where a rising load finds no equilibrium. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/obstacle.h"
#include "solver/fe/path_internal.h"

enum {
  ARC_STEPS = 150,   /* of a whole walk */
  STEPS_BEYOND = 12, /* after a limit point */
  EASY_ITERATIONS = 4,
  HARD_ITERATIONS = 8,
  PUSHES = 3 /* changes of the branch in a whole walk */
};
static const double raise = 0.005; /* of the whole load, when the branch is left */
static const double cut_factor = 0.4, grow_factor = 1.6, slow_factor = 0.7;
static const double smallest_part = 5e-3; /* of the first step */
static const double deepest_fall = 0.7;   /* of the load at the limit point */
static const double landing_tolerance = 1e-3;

/* One walk along the arc. Lengths are root mean squares over the unknowns, m. */
struct arc {
  struct walk *walk;
  const struct stage *stage;
  struct fe_state state;  /* last converged on the arc */
  struct fe_state passed; /* one beyond the goal */
  double value;
  double *direction; /* d u / d load */
  double *last;      /* dof_count: the last step, empty before the first */
  bool started;
  double length, first_length;
  int beyond; /* steps since the limit point */
};

static double norm(const double *v, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++) {
    sum += v[i] * v[i];
  }
  return sqrt(3 * sum / count);
}

/* Change of the load for the next step: of the arc's length, in the sense of the last step. */
static double next_change(const struct arc *a) {
  int count = a->walk->solver->model->dof_count;
  double size = norm(a->direction, count), along = 0;
  for (int i = 0; a->started && i < count; i++) {
    along += a->direction[i] * a->last[i];
  }
  return (along < 0 ? -1 : 1) * a->length / size;
}

/* One step of the arc from its last state into walk->trial. */
static enum status try_step(struct arc *a, struct fe_load *load, int *iterations) {
  struct walk *w = a->walk;
  *load = walk_load(w, a->stage, a->value);
  enum status status =
      equilibrium_tangent(w->solver, load, a->stage->dead, &a->state, a->direction);
  *iterations = 0;
  if (status != STATUS_OK) {
    return status;
  }
  if (a->first_length == 0) {
    a->first_length = a->length = w->step * norm(a->direction, w->solver->model->dof_count);
  }
  state_copy(w->solver->model, &w->trial, &a->state);
  double change = next_change(a);
  status = equilibrium_follow(w->solver, load, a->stage->dead, a->direction, change, &w->trial,
                              iterations);
  w->iterations += *iterations + 1;
  if (w->solver->verbose) {
    fprintf(stderr, "  arc %.3e m, load %.6g: %s after %d factorisations\n", a->length,
            a->stage->dead ? load->dead : load->pressure, status_word(status), *iterations);
  }
  return status;
}

/* Takes over the trial state. */
static void accept(struct arc *a, double value, int iterations) {
  struct walk *w = a->walk;
  struct fe_model *m = w->solver->model;
  model_commit_obstacles(m, &w->trial);
  for (int d = 0; d < 3 * m->mesh->node_count; d++) {
    if (m->equation[d] >= 0) {
      a->last[m->equation[d]] = w->trial.u[d] - a->state.u[d];
    }
  }
  a->started = true;
  state_copy(m, &a->state, &w->trial);
  a->value = value;
  if (iterations <= EASY_ITERATIONS) {
    a->length *= grow_factor;
  } else if (iterations >= HARD_ITERATIONS) {
    a->length *= slow_factor;
  }
}

/* Takes the trial state, in equilibrium with `value`, as the state of the walk. */
static void arrive(struct walk *w, double value) {
  model_commit_obstacles(w->solver->model, &w->trial);
  state_copy(w->solver->model, w->state, &w->trial);
  w->value = value;
  w->limit = 0;
}

/* The trial, in equilibrium with `value`, has passed `goal`: brings it to exactly that load. Where
 * a held load does not converge, a trial close to the goal is taken as it is, and else the next
 * step of the arc is to end there. */
static enum status land(struct arc *a, double goal, double value, int *iterations) {
  struct walk *w = a->walk;
  struct fe_load load = walk_load(w, a->stage, goal);
  struct fe_state *passed = &a->passed;
  state_copy(w->solver->model, passed, &w->trial);
  w->solver->factor_fits = false;
  enum status status = equilibrium_solve(w->solver, &load, load.pressure, &w->trial, iterations);
  w->iterations += *iterations;
  if (status == STATUS_OK) {
    arrive(w, goal);
  } else if (!status_is_final(status) && value - goal < landing_tolerance * goal) {
    state_copy(w->solver->model, &w->trial, passed);
    arrive(w, value);
    status = STATUS_OK;
  } else {
    a->length *= fmin(0.9, 1.01 * (goal - a->value) / (value - a->value)) / cut_factor;
  }
  return status;
}

/* Whether the path beyond a limit point has been seen far enough. */
static bool fallen(struct arc *a) {
  struct walk *w = a->walk;
  if (a->value >= w->value && a->value > w->limit) {
    w->limit = 0;
    w->value = a->value; /* still on the way up: the state goes with it */
    state_copy(w->solver->model, w->state, &a->state);
    a->beyond = 0;
    return false;
  }
  w->limit = w->value;
  w->beyond = a->beyond == 0 ? a->value : fmin(w->beyond, a->value);
  a->beyond++;
  return a->beyond >= STEPS_BEYOND || a->value < deepest_fall * w->limit;
}

static enum status follow(struct arc *a, double goal) {
  struct walk *w = a->walk;
  while (w->arc_steps < ARC_STEPS) {
    struct fe_load load;
    int iterations;
    enum status status = try_step(a, &load, &iterations);
    double value = a->stage->dead ? load.dead : load.pressure;
    w->arc_steps++;
    if (status_is_final(status)) {
      return status;
    }
    if (status == STATUS_OK && value >= goal) {
      status = land(a, goal, value, &iterations);
      if (status == STATUS_OK || status_is_final(status)) {
        return status;
      }
    }
    if (status != STATUS_OK) {
      w->failure = status;
      a->length *= cut_factor;
      if (a->length < smallest_part * a->first_length) {
        break;
      }
      continue;
    }
    accept(a, value, iterations);
    status = walk_visit(w, a->stage, false, &a->state, a->value);
    if (status != STATUS_OK) {
      return status;
    }
    if (fallen(a)) {
      break;
    }
  }
  return a->beyond > 0 ? STATUS_LIMIT_POINT : w->failure;
}

/* Tries to go on where the arc has got stuck at a singular tangent: from the last state, pushed
 * along the softest mode, either way, to a stable equilibrium at a slightly higher load. */
static enum status leave_branch(struct arc *a, double goal) {
  static const double pushes[] = {0.05, -0.05, 0.2, -0.2, 0.5, -0.5}; /* in walls */
  struct walk *w = a->walk;
  struct equilibrium *solver = w->solver;
  const struct fe_model *m = solver->model;
  struct fe_load load = walk_load(w, a->stage, w->value);
  enum status status = equilibrium_tangent(solver, &load, a->stage->dead, w->state, a->direction);
  if (status != STATUS_OK) {
    return status;
  }
  equilibrium_softest_mode(solver, a->last);
  load = walk_load(w, a->stage, fmin(goal, w->value + raise * a->stage->end));
  for (size_t k = 0; k < sizeof pushes / sizeof *pushes; k++) {
    int iterations;
    state_copy(m, &w->trial, w->state);
    for (int d = 0; d < 3 * m->mesh->node_count; d++) {
      if (m->equation[d] >= 0) {
        w->trial.u[d] += pushes[k] * m->mesh->wall_thickness * a->last[m->equation[d]];
      }
    }
    solver->factor_fits = false;
    status = equilibrium_solve(solver, &load, load.pressure, &w->trial, &iterations);
    w->iterations += iterations;
    if (solver->verbose) {
      fprintf(stderr, "  pushed %.2f walls: %s after %d factorisations, %d negative\n", pushes[k],
              status_word(status), iterations, solver->negative_pivots);
    }
    if (status_is_final(status)) {
      return status;
    }
    if (status == STATUS_OK && solver->negative_pivots == 0) {
      arrive(w, a->stage->dead ? load.dead : load.pressure);
      return STATUS_OK;
    }
  }
  return STATUS_UNSTABLE_PATH;
}

/* Whether the tangent is singular next to the last state: the last attempt, a tiny one, met it with
 * and without negative pivots. */
static bool at_singular_tangent(const struct arc *a) {
  const struct equilibrium *s = a->walk->solver;
  return a->walk->failure != STATUS_OK && s->most_negative > s->fewest_negative;
}

enum status walk_arc(struct walk *w, const struct stage *stage, double goal) {
  const struct fe_model *m = w->solver->model;
  struct arc a = {.walk = w, .stage = stage, .value = w->value};
  a.direction = calloc((size_t)m->dof_count + 1, sizeof *a.direction);
  a.last = calloc((size_t)m->dof_count + 1, sizeof *a.last);
  enum status status = STATUS_NO_MEMORY;
  if (a.direction && a.last && state_create(m, &a.state) == STATUS_OK &&
      state_create(m, &a.passed) == STATUS_OK) {
    state_copy(m, &a.state, w->state);
    status = follow(&a, goal);
    if (!status_is_final(status) && status != STATUS_OK && status != STATUS_LIMIT_POINT &&
        at_singular_tangent(&a)) {
      status = w->pushed < PUSHES ? leave_branch(&a, goal) : STATUS_UNSTABLE_PATH;
      w->pushed++;
    }
  }
  state_release(&a.state);
  state_release(&a.passed);
  free(a.direction);
  free(a.last);
  return status;
}
