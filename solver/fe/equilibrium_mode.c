#include <math.h>
#include "solver/fe/equilibrium.h"

static double largest(const double *v, int count) {
  double most = 0;
  for (int i = 0; i < count; i++) {
    most = fmax(most, fabs(v[i]));
  }
  return most;
}

void equilibrium_softest_mode(struct equilibrium *s, double *mode) {
  enum { ITERATIONS = 8 };
  int count = s->model->dof_count;
  unsigned seed = 1;
  for (int i = 0; i < count; i++) {
    seed = 1664525u * seed + 1013904223u;
    mode[i] = (double)(seed >> 8) / (1 << 23) - 1;
  }
  for (int k = 0; k < ITERATIONS; k++) {
    model_solve(s->model, mode, mode);
    double size = largest(mode, count);
    for (int i = 0; i < count && size > 0; i++) {
      mode[i] /= size;
    }
  }
}
