#include "solver/post/fit.h"

#include <math.h>

bool line_fit(const double *x, const double *y, size_t count, double from, double to,
              struct line_fit *fit) {
  double margin = 1e-9 * fmax(fabs(from), fabs(to)), mean_x = 0, mean_y = 0;
  size_t used = 0;
  for (size_t i = 0; i < count; i++) {
    if (x[i] >= from - margin && x[i] <= to + margin) {
      mean_x += x[i];
      mean_y += y[i];
      used++;
    }
  }
  if (used < 2) {
    return false;
  }
  mean_x /= (double)used;
  mean_y /= (double)used;
  double xx = 0, xy = 0, yy = 0;
  for (size_t i = 0; i < count; i++) {
    if (x[i] >= from - margin && x[i] <= to + margin) {
      double dx = x[i] - mean_x, dy = y[i] - mean_y;
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  }
  if (!(xx > 0)) {
    return false;
  }
  fit->slope = xy / xx;
  fit->intercept = mean_y - fit->slope * mean_x;
  fit->r_squared = yy > 0 ? xy * xy / (xx * yy) : 1;
  return true;
}
