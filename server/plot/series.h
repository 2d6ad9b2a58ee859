/* Curves, bars and markers of a chart. */
#ifndef PNEULAB_PLOT_SERIES_H
#define PNEULAB_PLOT_SERIES_H

#include "server/plot/chart.h"

/* Draws one series, clipped to nothing. */
void series_draw(struct canvas *canvas, const struct frame *frame,
                 const struct chart_series *series);

/* Draws the sample of a series in a legend: `width` pixels from (x, y), the middle of its left
 * edge. */
void series_draw_sample(struct canvas *canvas, const struct chart_series *series, double x,
                        double y, double width);

/* Notes what series_draw draws as obstacles. */
void series_add_obstacles(const struct canvas *canvas, const struct frame *frame,
                          const struct chart_series *series, struct place *place);

#endif
