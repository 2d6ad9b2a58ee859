/* Curves of a chart and the box that names them. */
#ifndef PNEULAB_PLOT_LEGEND_H
#define PNEULAB_PLOT_LEGEND_H

#include "server/plot/chart.h"

/* Where a point of the chart is on the sheet. */
struct point frame_pixel(const struct frame *frame, struct point p);

/* Draws one curve, clipped to nothing: its points are inside the frame by construction. */
void legend_draw_series(struct canvas *canvas, const struct frame *frame,
                        const struct chart_series *series);

/* Size of the legend in pixels; 0 by 0 without named series. max_width, max_height limit it: names
 * are shortened, and curves that do not fit are counted in a last line. */
void legend_measure(struct canvas *canvas, const struct chart *chart, double max_width,
                    double max_height, double *width, double *height);

/* Draws the legend with its top left corner at (box.x, box.y); box has the measured size. */
void legend_draw(struct canvas *canvas, const struct chart *chart, struct box box);

#endif
