/* The colours of the pressure between a body and what it holds. */
#ifndef PNEULAB_PLOT_CONTACT_H
#define PNEULAB_PLOT_CONTACT_H

#include "server/plot/chart.h"
#include "server/plot/frames.h"

struct contact_scale {
  double top;                       /* kPa */
  struct rgb shades[RASTER_SHADES]; /* the first is that of a body where nothing touches it */
  struct colour_bar bar;
};

/* Finds the scale for all shots; at edges pressures are singular: it ends where 2 % of the points
 * in contact are above, and its bar says so. STATUS_NO_MEMORY. */
enum status contact_scale_make(const struct frames *frames, enum colour_theme theme,
                               struct contact_scale *scale, struct error *error);

/* Shade of a pressure, 0 to 1. */
double contact_scale_at(const struct contact_scale *scale, double pressure);

/* Draws a swatch with what it means, its left edge at x and its middle at y. Returns the right end.
 */
double contact_key(struct canvas *canvas, double x, double y, struct colour colour,
                   const char *words);

/* Draws a bar of round length, at most `room` pixels long, that says how many mm it is. Returns the
 * right end of its words. */
double contact_ruler(struct canvas *canvas, double x, double y, double pixels_per_mm, double room);

#endif
