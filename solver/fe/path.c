#include "solver/fe/path.h"

#include <math.h>
#include <stdio.h>

/* Step control. */
static const double cut_factor = 0.4;
static const double grow_factor = 2;
enum { EASY_ITERATIONS = 6, SMALLEST_PART = 500 };

/* The load parameter runs over [0, 1] for the dead load and then over the pressure. */
struct stage {
  bool dead;   /* this stage ramps the dead load */
  double end;  /* final value of the parameter */
  int records; /* recorded at k/records end, k = 1 .. records */
  double full; /* largest step */
};

struct walk {
  struct equilibrium *solver;
  const struct path_options *options;
  struct fe_state *state; /* last converged */
  struct fe_state trial;
  double value; /* converged parameter of the stage */
  double step;
  int iterations;      /* since the last recorded state */
  enum status failure; /* of the last attempt */
};

static struct fe_load stage_load(const struct walk *w, const struct stage *stage, double value) {
  bool dead = w->options->dead_load;
  return stage->dead ? (struct fe_load){0, 0, value} : (struct fe_load){value, value, dead ? 1 : 0};
}

static enum status visit(struct walk *w, const struct stage *stage, bool recorded) {
  struct fe_load load = stage_load(w, stage, w->value);
  struct path_point point = {load.pressure, load.dead, w->iterations, recorded, w->state};
  if (recorded) {
    w->iterations = 0;
  }
  return w->options->visit ? w->options->visit(w->options->context, &point) : STATUS_OK;
}

/* Tries one step to `target`. On failure the state stays. */
static enum status advance(struct walk *w, const struct stage *stage, double target,
                           int *iterations) {
  struct fe_model *m = w->solver->model;
  struct fe_load load = stage_load(w, stage, target);
  double previous = stage->dead ? 0 : w->value;
  state_copy(m, &w->trial, w->state);
  enum status status = equilibrium_solve(w->solver, &load, previous, &w->trial, iterations);
  w->iterations += *iterations;
  if (status == STATUS_OK) {
    state_copy(m, w->state, &w->trial);
    w->value = target;
  }
  if (w->solver->verbose) {
    fprintf(stderr, "  load %.6g: %s after %d factorisations\n", target, status_word(status),
            *iterations);
  }
  return status;
}

static bool final_status(enum status status) {
  return status == STATUS_TIMEOUT || status == STATUS_CANCELLED || status == STATUS_NO_MEMORY;
}

static enum status walk_stage(struct walk *w, const struct stage *stage) {
  w->value = 0;
  w->step = stage->full;
  for (int record = 1; record <= stage->records;) {
    double goal = stage->end * record / stage->records;
    double target = w->value + w->step;
    /* A step that would leave a sliver before the goal ends on it. */
    if (target > goal - 0.05 * w->step) {
      target = goal;
    }
    int iterations;
    enum status status = advance(w, stage, target, &iterations);
    if (final_status(status)) {
      return status;
    }
    if (status != STATUS_OK) {
      w->failure = status;
      w->step = cut_factor * (target - w->value);
      if (w->step < stage->end / SMALLEST_PART) {
        return status == STATUS_INVERTED ? status : STATUS_STEP_MINIMUM;
      }
      continue;
    }
    if (iterations <= EASY_ITERATIONS) {
      w->step = fmin(grow_factor * w->step, stage->full);
    }
    bool recorded = target == goal;
    record += recorded;
    status = visit(w, stage, recorded && !stage->dead);
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
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
    status = visit(&w, &pressure, true);
  }
  if (status == STATUS_OK) {
    status = walk_stage(&w, &pressure);
  }
  if (status != STATUS_OK) {
    const char *what = stage->dead ? "of the weight" : "Pa of pressure";
    error_set(error, status, "/load", "stopped at %.6g %s: %s (last attempt: %s)", w.value, what,
              status_sentence(status), status_sentence(w.failure));
  }
  state_release(&w.trial);
  return status;
}
