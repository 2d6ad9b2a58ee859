/* Thousands of dots or lines, through which the density shows. What lies on top of each other is
 * averaged, whatever the order: where n things of opacity a meet, their mean colour covers the
 * sheet with opacity 1 - (1 - a)^n. Cairo takes 10 us a dot, this 0.1 us. */
#ifndef PNEULAB_PLOT_CLOUD_H
#define PNEULAB_PLOT_CLOUD_H

#include <stdbool.h>
#include "server/plot/canvas.h"
#include "server/plot/place.h"

struct cloud;

/* An empty cloud over the whole pixels of `area`, cut to the canvas; coarse: of 2 x 2 pixels, a
 * quarter of the work. NULL when memory ran out. */
struct cloud *cloud_create(const struct canvas *canvas, struct box area, bool coarse);
void cloud_destroy(struct cloud *cloud);

/* Adds a disc of `radius` pixels (0.5 to 40) at a place on the sheet. */
void cloud_dot(struct cloud *cloud, double x, double y, double radius, struct rgb colour);

/* One of many lines between two upright axes. */
struct cloud_line {
  float from, to; /* y in pixels at the two axes */
  float r, g, b;
  float weight; /* counts as so many lines, whole; 1 usually; together under 8 million */
};

/* Adds lines from x0 to x1, about `width` pixels wide; x1 > x0. */
void cloud_lines(struct cloud *cloud, double x0, double x1, const struct cloud_line *lines,
                 size_t count, double width);

/* Puts the cloud on the sheet; opacity: of one dot or line, 0 to 1. */
void cloud_paint(const struct cloud *cloud, struct canvas *canvas, double opacity);

/* An opacity that shows single things and the density of `count` of them alike. */
double cloud_opacity(size_t count);

#endif
