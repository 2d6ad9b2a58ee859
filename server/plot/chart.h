/* A chart in Cartesian axes: described by plain data, drawn in one call. */
#ifndef PNEULAB_PLOT_CHART_H
#define PNEULAB_PLOT_CHART_H

#include <stdbool.h>
#include "server/plot/canvas.h"
#include "server/plot/place.h"
#include "server/plot/ticks.h"

struct point {
  double x, y;
};

enum chart_marker {
  MARKER_NONE,
  MARKER_CIRCLE,
  MARKER_SQUARE,
  MARKER_TRIANGLE,
  MARKER_DIAMOND,
  MARKER_CROSS,
  MARKER_PLUS,
  MARKER_COUNT
};

enum chart_dash { DASH_SOLID, DASH_LONG, DASH_SHORT, DASH_DOT, DASH_COUNT };

/* One curve. Every point is finite. A series with a name has a line in the legend. */
struct chart_series {
  const struct point *points; /* borrowed */
  size_t count;
  struct colour colour;
  double width; /* of the line, design units */
  enum chart_marker marker;
  enum chart_dash dash;
  bool guide;         /* an aid drawn below the curves: cut at the axes, whose range ignores it */
  const char *name;   /* borrowed, may be shortened; NULL: not in the legend */
  const char *detail; /* borrowed, follows the name and is never shortened; may be NULL */
};

/* Words beside a point, left out when there is no room. */
struct chart_label {
  struct point at;
  char text[TICKS_TEXT + 16];
};

/* Colours for a third quantity, shown as a bar on the right. */
struct colour_bar {
  const char *label; /* NULL: no bar */
  struct colour (*map)(double t);
  double min, max; /* map(0) and map(1), max > min */
};

struct chart {
  const char *title;
  const char *subtitle;
  const char *notice; /* a warning under the subtitle; "" for none */
  const char *x_label, *y_label;
  bool equal;     /* one unit is as long in x as in y */
  bool from_zero; /* both axes show zero */
  bool log_axes;  /* x and y of all points are decimal logarithms of what the axes count */
  const struct chart_series *series;
  size_t series_count;
  const struct chart_label *labels;
  size_t label_count;
  const struct point *mark; /* x of an upright dashed line; NULL: none */
  const char *mark_text;
  struct colour_bar bar;
  const char *empty; /* said in the middle when no series has a point */
};

/* Where the inside of a chart lies on the sheet and what it shows. */
struct frame {
  struct box area; /* pixels */
  double x_min, x_max, y_min, y_max;
};

/* Draws the chart over the whole canvas. */
void chart_draw(const struct chart *chart, struct canvas *canvas);

/* Draws title, subtitle and notice with their left edge at `left`, in pixels. */
void chart_heading(struct canvas *canvas, double left, const char *title, const char *subtitle,
                   const char *notice);
/* Height in pixels from the top of the sheet to where the picture below a heading may start. */
double chart_heading_height(const struct canvas *canvas, const char *subtitle, const char *notice);

/* Draws a colour bar along the right end of `area`, whose right part of chart_bar_room() pixels
 * it takes. */
void chart_bar(struct canvas *canvas, const struct colour_bar *bar, struct box area);
double chart_bar_room(struct canvas *canvas, const struct colour_bar *bar);

/* Text styles shared by all plots. */
struct text_style chart_style_label(void);
struct text_style chart_style_tick(void);

#endif
