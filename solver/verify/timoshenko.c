#include "solver/verify/timoshenko.h"

#include <math.h>

/* Moment and shear force at the end of a cantilever that vibrates with angular frequency w, for a
 * unit moment (k = 0) or shear force (k = 1) at its clamp, by Runge-Kutta's method. */
static void end_forces(const struct timoshenko *b, double w, int k, double end[2]) {
  double area = b->edge * b->edge, second = area * area / 12, density = b->density;
  double shear = 10 * (1 + b->poisson) / (12 + 11 * b->poisson) * b->shear * area;
  double y[4] = {0, 0, k == 0, k == 1}; /* way, turn, moment, shear force */
  const int steps = 400;
  const double h = 1.0 / steps, part[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
  for (int n = 0; n < steps; n++) {
    double slope[4] = {0}, sum[4] = {0};
    for (int stage = 0; stage < 4; stage++) {
      double z[4];
      for (int i = 0; i < 4; i++) {
        z[i] = y[i] + part[stage] * h * slope[i];
      }
      slope[0] = z[1] + z[3] / shear;
      slope[1] = z[2] / (b->young * second);
      slope[2] = -z[3] - density * second * w * w * z[1];
      slope[3] = -density * area * w * w * z[0];
      for (int i = 0; i < 4; i++) {
        sum[i] += weight[stage] * slope[i];
      }
    }
    for (int i = 0; i < 4; i++) {
      y[i] += h / 6 * sum[i];
    }
  }
  end[0] = y[2];
  end[1] = y[3];
}

double timoshenko_slender(const struct timoshenko *b) {
  return 3.51601527 * sqrt(b->young / b->density * b->edge * b->edge / 12);
}

double timoshenko_frequency(const struct timoshenko *b) {
  double slender = timoshenko_slender(b);
  double low = 0.8 * slender, high = 1.1 * slender, sign = 0;
  for (int i = 0; i < 50; i++) {
    double w = i == 0 ? low : 0.5 * (low + high), a[2], c[2];
    end_forces(b, w, 0, a);
    end_forces(b, w, 1, c);
    double determinant = a[0] * c[1] - a[1] * c[0];
    if (i == 0) {
      sign = determinant;
    } else if (determinant * sign > 0) {
      low = w;
    } else {
      high = w;
    }
  }
  return low;
}
