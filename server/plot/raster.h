/* Triangles and lines with hidden parts removed by a depth buffer. */
#ifndef PNEULAB_PLOT_RASTER_H
#define PNEULAB_PLOT_RASTER_H

#include <cairo.h>
#include <stdint.h>
#include "server/plot/colour.h"

/* A grid of samples, `factor` by `factor` for each pixel of the finished picture. */
struct raster {
  int width, height; /* samples */
  int factor;
  uint32_t *samples; /* 0xAARRGGBB, transparent where nothing was drawn */
  float *depth;      /* of the nearest thing drawn, infinite where nothing was */
  int lowest;        /* what has a lower shade hides what is behind it, but stays transparent */
};

struct raster_vertex {
  double x, y;  /* samples, y downwards */
  double depth; /* larger is further away */
  double value; /* 0 to 1, looked up in the shades */
};

enum { RASTER_SHADES = 256 };

/* Creates an empty raster for width x height pixels; takes as many samples a pixel (1, 4, 9), at
 * most finest x finest of them, as stay below 8 million. Returns NULL when memory ran out. */
struct raster *raster_create(int width, int height, int finest);
void raster_destroy(struct raster *raster);

/* Forgets the depths, so that what follows covers everything drawn before. */
void raster_bring_forward(struct raster *raster);

/* Fills a triangle with shades[value], times `light` (0 to 1). */
void raster_triangle(struct raster *raster, const struct raster_vertex corners[3],
                     const struct rgb shades[RASTER_SHADES], double light);

/* Draws a line `width` samples wide where it is at most `bias` behind what is drawn already. */
void raster_line(struct raster *raster, const struct raster_vertex ends[2], struct rgb colour,
                 double width, double bias);

/* Paints the averaged samples with their top left corner at (x, y), a part `alpha` (0 to 1) of
 * them. Error: false when memory ran out. */
int raster_paint(const struct raster *raster, cairo_t *cr, double x, double y, double alpha);

#endif
