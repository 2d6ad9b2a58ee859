#include "solver/verify/newton.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/clock.h"

/* state <- state + du, pressures recovered. Returns the largest entry of du. */
static double add_step(struct fe_model *m, struct fe_state *state, const double *du) {
  double most = 0;
  model_recover(m, state, du, 1);
  for (int d = 0; d < 3 * m->mesh->node_count; d++) {
    if (m->equation[d] >= 0) {
      state->u[d] += du[m->equation[d]];
      most = fmax(most, fabs(du[m->equation[d]]));
    }
  }
  return most;
}

enum status newton_check_limits(const struct newton_control *control) {
  if (control->cancelled && control->cancelled(control->cancel_context)) {
    return STATUS_CANCELLED;
  }
  bool late = control->deadline_s > 0 && clock_wall_s() > control->deadline_s;
  return late ? STATUS_TIMEOUT : STATUS_OK;
}

/* Evaluates and factorises at the state, unless it is time to stop. */
static enum status linearise(struct fe_model *m, const struct fe_load *load,
                             const struct fe_state *state, const struct newton_control *control) {
  enum status status = newton_check_limits(control);
  if (status == STATUS_OK) {
    status = model_evaluate(m, state, load, true);
  }
  if (status == STATUS_OK) {
    model_factor(m);
    m->statistics.newton_iterations++;
  }
  return status;
}

enum status newton_solve(struct fe_model *m, const struct fe_load *load, struct fe_state *state,
                         const struct newton_control *control) {
  double *du = malloc(sizeof *du * ((size_t)m->dof_count + 1));
  enum status status = du ? STATUS_OK : STATUS_NO_MEMORY;
  bool converged = false;
  for (int it = 0; status == STATUS_OK && !converged && it < NEWTON_ITERATIONS; it++) {
    status = linearise(m, load, state, control);
    if (status != STATUS_OK) {
      break;
    }
    model_solve(m, m->residual, du);
    for (int i = 0; i < m->dof_count; i++) {
      du[i] = -du[i];
    }
    double most = add_step(m, state, du);
    if (control->log) {
      control->log->correction[it] = most;
      control->log->count = it + 1;
    }
    converged = most < control->tolerance;
  }
  free(du);
  return status == STATUS_OK && !converged ? STATUS_DIVERGED : status;
}

static double dot(int n, const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < n; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

/* The bordered system: one load parameter more, one condition more. */
struct border {
  enum { BORDER_VOLUME, BORDER_DISPLACEMENT } kind;
  double target, scale; /* scale * model_volume() is to be `target` */
  int equation;         /* whose displacement is to be `target` */
};

/* What the condition lacks, its gradient, and the derivative -dr/d(parameter). */
static double border_fill(const struct border *b, const struct fe_model *m,
                          const struct fe_state *state, double *gradient, double *rate) {
  if (b->kind == BORDER_VOLUME) {
    double missing = b->target - b->scale * model_volume(m, state, gradient);
    memcpy(rate, gradient, sizeof *rate * (size_t)m->dof_count);
    return missing;
  }
  double missing = 0;
  memset(gradient, 0, sizeof *gradient * (size_t)m->dof_count);
  gradient[b->equation] = 1;
  for (int d = 0; d < 3 * m->mesh->node_count; d++) {
    if (m->equation[d] >= 0) {
      rate[m->equation[d]] = m->dead_load[d];
    }
    if (m->equation[d] == b->equation) {
      missing = b->target - state->u[d];
    }
  }
  return missing;
}

static enum status solve_bordered(struct fe_model *m, const struct border *border,
                                  struct fe_state *state, double *parameter,
                                  const struct newton_control *control) {
  size_t n = (size_t)m->dof_count + 1;
  double *gradient = malloc(sizeof *gradient * 4 * n);
  double *rate = gradient + n, *by_residual = rate + n, *by_parameter = by_residual + n;
  enum status status = gradient ? STATUS_OK : STATUS_NO_MEMORY;
  bool converged = false;
  for (int it = 0; status == STATUS_OK && !converged && it < NEWTON_ITERATIONS; it++) {
    bool pressure = border->kind == BORDER_VOLUME;
    struct fe_load load = {pressure ? *parameter : 0, pressure ? *parameter : 0,
                           pressure ? 0 : *parameter};
    status = linearise(m, &load, state, control);
    if (status != STATUS_OK) {
      break;
    }
    double missing = border_fill(border, m, state, gradient, rate);
    model_solve(m, m->residual, by_residual);
    model_solve(m, rate, by_parameter);
    double step = (missing + dot(m->dof_count, gradient, by_residual)) /
                  dot(m->dof_count, gradient, by_parameter);
    for (int i = 0; i < m->dof_count; i++) {
      by_residual[i] = step * by_parameter[i] - by_residual[i];
    }
    *parameter += step;
    converged = add_step(m, state, by_residual) < control->tolerance;
  }
  free(gradient);
  return status == STATUS_OK && !converged ? STATUS_DIVERGED : status;
}

enum status newton_inflate(struct fe_model *m, double volume, double scale, struct fe_state *state,
                           double *pressure, const struct newton_control *control) {
  struct border border = {.kind = BORDER_VOLUME, .target = volume, .scale = scale};
  return solve_bordered(m, &border, state, pressure, control);
}

enum status newton_reach(struct fe_model *m, int equation, double target, struct fe_state *state,
                         double *dead, const struct newton_control *control) {
  struct border border = {.kind = BORDER_DISPLACEMENT, .target = target, .equation = equation};
  return solve_bordered(m, &border, state, dead, control);
}
