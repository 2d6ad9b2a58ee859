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

enum chart_style {
  STYLE_LINE,
  STYLE_COLUMNS, /* upright bars from zero, `width` wide in units of x */
  STYLE_STEMS,   /* a line from zero to every point */
  STYLE_SPAN     /* the stretch between points[0].x and points[1].x, filled over the full height */
};

/* One curve. Every point is finite. A series with a name has a line in the legend. */
struct chart_series {
  const struct point *points; /* borrowed */
  size_t count;
  enum chart_style style;
  struct colour colour;
  double width; /* of the line, design units; 0: no line */
  enum chart_marker marker;
  enum chart_dash dash;
  bool hollow;          /* markers are rings */
  bool small;           /* markers are half as large, for crowds of points */
  const double *errors; /* borrowed: half the height of an error bar at each point, NaN for none;
                         * NULL: no bars */
  const double *band;   /* borrowed: half the height of a light band about the line at each point,
                         * finite; NULL: no band */
  bool guide;           /* an aid drawn below the curves: cut at the axes, whose range ignores it */
  const char *name;     /* borrowed, may be shortened; NULL: not in the legend */
  const char *detail;   /* borrowed, follows the name and is never shortened; may be NULL */
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
  double min, max;  /* map(0) and map(1), max > min */
  bool logarithmic; /* min and max are decimal logarithms */
  int bands;        /* so many steps of even colour; 0: it changes all along */
};

struct chart {
  const char *title;
  const char *subtitle;
  const char *notice; /* a warning under the subtitle; "" for none */
  const char *x_label, *y_label;
  bool equal;     /* one unit is as long in x as in y */
  bool from_zero; /* both axes show zero */
  bool loose_x;   /* points keep a distance from the ends of the x axis */
  bool whole_x;   /* x counts things: only whole numbers on its axis */
  bool log_x,
      log_y; /* that coordinate of all points is the decimal logarithm of what its axis counts
              */
  const char *const *x_names; /* words under x = 0, 1, ... instead of numbers; NULL: numbers */
  size_t x_name_count;
  const struct chart_series *series;
  size_t series_count;
  const struct chart_label *labels;
  size_t label_count;
  const struct point *mark; /* x of an upright dashed line; NULL: none */
  const char *mark_text;
  struct colour_bar bar;
  const char *empty; /* said in the middle when no series has a point */
};

/* Where the inside of a chart lies on the sheet and what it shows. An axis may run backwards: then
 * its minimum is above its maximum. */
struct frame {
  struct box area; /* pixels */
  double x_min, x_max, y_min, y_max;
};

/* Where a point of the chart is on the sheet. */
struct point frame_pixel(const struct frame *frame, struct point p);

/* Draws the chart over the whole canvas. */
void chart_draw(const struct chart *chart, struct canvas *canvas);

/* Most charts in one stack or grid. */
enum { CHART_TABLE = 8 };

/* Draws up to CHART_TABLE charts below each other over the whole canvas, with the heading of the
 * first. They share the x axis, whose numbers and label are those of the last. shares: parts of the
 * height, sum 1. Bars of colour are left out. */
void chart_draw_stack(const struct chart *charts, const double *shares, size_t count,
                      struct canvas *canvas);

/* The same for rows x columns charts, given row by row, at most CHART_TABLE; shares are those of
 * the rows. The numbers and the label of x are below the last row. */
void chart_draw_grid(const struct chart *charts, const double *shares, size_t rows, size_t columns,
                     struct canvas *canvas);

/* Draws title, subtitle and notice with their left edge at `left`, in pixels. */
void chart_heading(struct canvas *canvas, double left, const char *title, const char *subtitle,
                   const char *notice);
/* Height in pixels from the top of the sheet to where the picture below a heading may start. */
double chart_heading_height(const struct canvas *canvas, const char *subtitle, const char *notice);

/* Colour of a value; grey for NaN.
 * chart_bar draws a colour bar along the right end of `area`, whose right part of chart_bar_room()
 * pixels it takes. */
struct colour chart_bar_colour(const struct colour_bar *bar, double value);
void chart_bar(struct canvas *canvas, const struct colour_bar *bar, struct box area);
double chart_bar_room(struct canvas *canvas, const struct colour_bar *bar);

/* Text styles shared by all plots. */
struct text_style chart_style_label(void);
struct text_style chart_style_tick(void);

#endif
