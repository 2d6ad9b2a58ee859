/* Straight-line fit. */
#ifndef PNEULAB_POST_FIT_H
#define PNEULAB_POST_FIT_H

#include <stdbool.h>
#include <stddef.h>

struct line_fit {
  double slope, intercept;
  double r_squared; /* coefficient of determination */
};

/* Least-squares line y = slope x + intercept through the points with from <= x <= to (a
 * relative margin of 1e-9 included). False with fewer than two distinct x there. With all y
 * equal R2 is 1. */
bool line_fit(const double *x, const double *y, size_t count, double from, double to,
              struct line_fit *fit);

#endif
