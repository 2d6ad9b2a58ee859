/* One thing in space from three sides, in one scale. */
#ifndef PNEULAB_PLOT_VIEWS_H
#define PNEULAB_PLOT_VIEWS_H

#include "server/plot/chart.h"

/* A point in space, in mm: x along the body, y across it, z up. */
struct views_point {
  double at[3];
  struct colour colour; /* of its dot, and of the line to it */
};

/* Points joined by a line. */
struct views_path {
  const struct views_point *points; /* borrowed */
  size_t count;
  double width; /* of the line, design units */
  bool light;   /* the line is grey and below all dots, instead of coloured */
  bool dots;
};

struct views {
  const char *title, *subtitle, *notice;
  const struct views_path *paths;
  size_t path_count;
  struct colour_bar bar;
  /* draws into the free quarter of the sheet; NULL: nothing */
  void (*key)(struct canvas *canvas, struct box area, const void *context);
  const void *key_context;
  const char *empty; /* said when there is no point */
};

/* Draws a third-angle projection over the whole canvas: the side (x, z), right of it the front as
 * seen from the tip (y, z), and under the side the body from below (x, y). */
void views_draw(const struct views *views, struct canvas *canvas);

#endif
