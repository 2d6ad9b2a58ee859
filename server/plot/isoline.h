/* Lines of equal value over a grid. */
#ifndef PNEULAB_PLOT_ISOLINE_H
#define PNEULAB_PLOT_ISOLINE_H

#include "server/plot/chart.h"

/* A line of equal value, in units of the grid: (column, row) from 0 to (columns - 1, rows - 1). */
struct isoline {
  struct point *points;
  size_t count;
  bool closed;
};

struct isolines {
  struct isoline *line;
  size_t count;
};

/* Finds the lines on which value[rows * columns] is `level`, by marching squares (Lorensen and
 * Cline 1987, in the plane) with straight pieces; none passes where a corner is NaN. The caller
 * calls isolines_release in either case. STATUS_NO_MEMORY. */
enum status isolines_find(const double *value, size_t columns, size_t rows, double level,
                          struct isolines *lines, struct error *error);
void isolines_release(struct isolines *lines);

#endif
