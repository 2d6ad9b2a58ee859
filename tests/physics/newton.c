#include "tests/physics/newton.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

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

enum status newton_solve(struct fe_model *m, const struct fe_load *load, struct fe_state *state,
                         double tolerance, struct newton_log *log) {
  double *du = malloc(sizeof *du * (size_t)m->dof_count);
  ck_assert_ptr_nonnull(du);
  enum status status = STATUS_DIVERGED;
  for (int it = 0; it < NEWTON_ITERATIONS; it++) {
    enum status evaluated = model_evaluate(m, state, load, true);
    if (evaluated != STATUS_OK) {
      status = evaluated;
      break;
    }
    model_factor(m);
    model_solve(m, m->residual, du);
    for (int i = 0; i < m->dof_count; i++) {
      du[i] = -du[i];
    }
    double most = add_step(m, state, du);
    if (log) {
      log->correction[it] = most;
      log->count = it + 1;
    }
    if (most < tolerance) {
      status = STATUS_OK;
      break;
    }
  }
  free(du);
  return status;
}

static double dot(int n, const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < n; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

enum status newton_inflate(struct fe_model *m, double volume, double scale, struct fe_state *state,
                           double *pressure, double tolerance) {
  int n = m->dof_count;
  double *gradient = malloc(sizeof *gradient * 3 * (size_t)n);
  ck_assert_ptr_nonnull(gradient);
  double *by_residual = gradient + n, *by_pressure = by_residual + n;
  enum status status = STATUS_DIVERGED;
  for (int it = 0; it < NEWTON_ITERATIONS; it++) {
    struct fe_load load = {*pressure, *pressure, 0};
    enum status evaluated = model_evaluate(m, state, &load, true);
    if (evaluated != STATUS_OK) {
      status = evaluated;
      break;
    }
    model_factor(m);
    double missing = volume - scale * model_volume(m, state, gradient);
    model_solve(m, m->residual, by_residual);
    model_solve(m, gradient, by_pressure);
    double dp = (missing + dot(n, gradient, by_residual)) / dot(n, gradient, by_pressure);
    for (int i = 0; i < n; i++) {
      by_residual[i] = dp * by_pressure[i] - by_residual[i];
    }
    *pressure += dp;
    if (add_step(m, state, by_residual) < tolerance) {
      status = STATUS_OK;
      break;
    }
  }
  free(gradient);
  return status;
}
