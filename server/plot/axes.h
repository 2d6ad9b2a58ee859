/* The lines, numbers and words around the inside of a chart. */
#ifndef PNEULAB_PLOT_AXES_H
#define PNEULAB_PLOT_AXES_H

#include "server/plot/chart.h"

/* What the axes of a frame count and say. */
struct axes {
  const char *x_label, *y_label; /* NULL: none */
  bool log_x, log_y;
  bool whole_x;               /* only whole numbers on the x axis */
  const char *const *x_names; /* words under x = 0, 1, ...; NULL: numbers */
  size_t x_name_count;
  const char *const *y_names; /* words beside y = 0, 1, ...; NULL: numbers */
  size_t y_name_count;
  bool no_x_text; /* the chart below says it */
  bool no_y_text; /* the chart on the left says it */
};

/* Number of ticks that suits a length in pixels, when they are `spacing` design units apart. */
int axes_tick_target(const struct canvas *canvas, double length, double spacing);

/* Widest text of the ticks, in pixels. */
double axes_widest_tick(struct canvas *canvas, const struct ticks *ticks);

/* Room in pixels left of a frame of these y values and height, for numbers and label. */
double axes_left_room(struct canvas *canvas, const struct axes *axes, const struct frame *frame);

/* Room in pixels below a frame of this width. Words that do not fit side by side stand on a slant.
 */
double axes_bottom_room(struct canvas *canvas, const struct axes *axes, double width);

/* Widens the ranges of a frame with an area to round numbers. */
void axes_widen(const struct canvas *canvas, const struct axes *axes, struct frame *frame);

/* Draws grid, axes, numbers and labels. empty: no numbers, they would claim a range that nothing
 * was measured in. */
void axes_draw(struct canvas *canvas, const struct axes *axes, const struct frame *frame,
               bool empty);

/* Draws what belongs to the x axis alone: grid, numbers and label. */
void axes_draw_x(struct canvas *canvas, const struct axes *axes, const struct frame *frame);

#endif
