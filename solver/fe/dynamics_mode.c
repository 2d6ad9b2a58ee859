#include <math.h>
#include <stdlib.h>
#include "solver/fe/dynamics.h"

enum { MOST_ITERATIONS = 200 };

/* mode <- K^-1 M mode, of largest entry 1; returns Rayleigh's quotient of the new one. */
static double iterate(struct dynamics *d, double *mode, double *momentum) {
  struct fe_model *m = d->model;
  int count = 3 * m->mesh->node_count;
  double *x = m->residual, up = 0, most = 0;
  inertia_multiply(d->inertia, mode, momentum);
  for (int i = 0; i < count; i++) {
    if (m->equation[i] >= 0) {
      x[m->equation[i]] = momentum[i];
    }
  }
  model_solve(m, x, x);
  for (int i = 0; i < count; i++) {
    mode[i] = m->equation[i] >= 0 ? x[m->equation[i]] : 0;
    up += mode[i] * momentum[i];
    most = fmax(most, fabs(mode[i]));
  }
  double square = up / (2 * inertia_kinetic(d->inertia, mode));
  for (int i = 0; i < count; i++) {
    mode[i] /= most;
  }
  return square;
}

enum status dynamics_frequency(struct dynamics *d, const struct fe_load *load,
                               const struct fe_state *state, double *mode, double *frequency) {
  struct fe_model *m = d->model;
  int count = 3 * m->mesh->node_count;
  struct fe_load now = {load->pressure, load->pressure, load->dead};
  double *momentum = malloc((size_t)count * sizeof *momentum), square = 0;
  unsigned seed = 1;
  if (!momentum) {
    return STATUS_NO_MEMORY;
  }
  for (int i = 0; i < count; i++) {
    seed = 1664525u * seed + 1013904223u;
    mode[i] = 1 + 0.1 * ((double)(seed >> 8) / (1 << 23) - 1);
  }
  model_use_multipliers(m, state);
  d->solver->factor_fits = false;
  enum status status = model_evaluate(m, state, &now, true);
  if (status == STATUS_OK && model_factor(m) > 0) {
    status = STATUS_UNSTABLE_PATH;
  }
  bool settled = false;
  for (int k = 0; status == STATUS_OK && !settled && k < MOST_ITERATIONS; k++) {
    double last = square;
    square = iterate(d, mode, momentum);
    settled = fabs(square - last) < 1e-12 * square;
  }
  free(momentum);
  *frequency = sqrt(square);
  return status == STATUS_OK && !settled ? STATUS_DIVERGED : status;
}
