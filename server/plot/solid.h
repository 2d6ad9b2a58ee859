/* Bodies of quadrilaterals drawn in parallel projection, with light and with their edges. */
#ifndef PNEULAB_PLOT_SOLID_H
#define PNEULAB_PLOT_SOLID_H

#include <stdbool.h>
#include "server/plot/raster.h"
#include "server/plot/skin.h"

/* Corners and faces; everything is borrowed. A triangle is a quadrilateral whose last two corners
 * are one. */
struct solid {
  const struct skin_point *points; /* mm */
  size_t point_count;
  const size_t (*quads)[4];
  size_t quad_count;
  bool closed; /* all faces look outwards: those that look away from the viewer are hidden */
};

/* A projection: a point p lies at left + scale (across p) and bottom - scale (up p), and (away p)
 * is how far away it is. */
struct solid_view {
  struct skin_point across, up, away;
  struct skin_point light; /* towards the lamp, unit */
  double scale;            /* samples per mm */
  double left, bottom;     /* samples */
};

/* Looks from the front (-y), right and above, such that lengths and angles in the plane y = 0 stay
 * true; scale and place are left to solid_view_fit. */
struct solid_view solid_view_oblique(void);
/* Looks at right angles from a direction, which is not upright and need not be a unit vector; what
 * faces the viewer is lit. */
struct solid_view solid_view_from(struct skin_point viewer);

/* A rectangle in mm of the projection. */
struct solid_box {
  double left, right, bottom, top;
};
struct solid_box solid_box_empty(void);
/* Grows the box until it has all points of the solid. */
void solid_box_widen(struct solid_box *box, const struct solid_view *view,
                     const struct solid *solid);
/* Samples per mm at which the box takes 0.96 of the raster. */
double solid_box_scale(const struct solid_box *box, const struct raster *raster);
/* Puts the middle of the box into the middle of the raster at a scale. */
void solid_view_centre(struct solid_view *view, const struct solid_box *box, double scale,
                       const struct raster *raster);

/* Fills the faces with shades[value], in light from `ambient` (0 to 1) to 1; values: 0 to 1 at each
 * point, NULL: all 0. */
void solid_fill(const struct solid *solid, const double *values,
                const struct rgb shades[RASTER_SHADES], double ambient,
                const struct solid_view *view, struct raster *raster);

/* The sum of the values over the area of the faces that look at the viewer, as it is seen from
 * there, in mm2; what hides it is not asked. values: at each point. */
double solid_seen(const struct solid *solid, const double *values, const struct solid_view *view);

/* An edge of a quadrilateral. */
struct solid_edge {
  size_t low, high; /* its points, low < high */
  size_t quad;
  int forward; /* the quad runs from low to high */
};

/* The edges of all quadrilaterals, 4 a quadrilateral, those of one place next to each other. The
 * caller frees the array; NULL when memory ran out. */
struct solid_edge *solid_edges(const struct solid *solid);

/* Draws the creases and the outline; edges: of solid_edges. */
void solid_outline(const struct solid *solid, const struct solid_edge *edges, struct rgb colour,
                   double width, const struct solid_view *view, struct raster *raster);

#endif
