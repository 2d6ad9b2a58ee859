#include "server/plot/legend.h"

#include <math.h>
#include <stdio.h>

/* Design units: line sample, its distance from the words, border, height of a line. */
enum { SAMPLE = 28, GAP = 8, PAD = 7, LINE = 19 };

struct point frame_pixel(const struct frame *frame, struct point p) {
  double fx = (p.x - frame->x_min) / (frame->x_max - frame->x_min);
  double fy = (p.y - frame->y_min) / (frame->y_max - frame->y_min);
  return (struct point){frame->area.x + fx * frame->area.width,
                        frame->area.y + (1.0 - fy) * frame->area.height};
}

static void set_dash(struct canvas *canvas, enum chart_dash dash) {
  static const double patterns[DASH_COUNT][4] = {{0}, {8, 4, 8, 4}, {4, 3, 4, 3}, {8, 3, 1.5, 3}};
  double scaled[4];
  for (int i = 0; i < 4; i++) {
    scaled[i] = patterns[dash][i] * canvas->unit;
  }
  cairo_set_dash(canvas->cr, scaled, dash == DASH_SOLID ? 0 : 4, 0);
}

static void draw_polygon(cairo_t *cr, struct point at, const double (*corners)[2], int count,
                         double r) {
  for (int i = 0; i < count; i++) {
    cairo_line_to(cr, at.x + corners[i][0] * r, at.y + corners[i][1] * r);
  }
  cairo_close_path(cr);
}

static void draw_marker(struct canvas *canvas, enum chart_marker marker, struct point at,
                        struct colour colour) {
  static const double square[4][2] = {{-0.9, -0.9}, {0.9, -0.9}, {0.9, 0.9}, {-0.9, 0.9}};
  static const double triangle[3][2] = {{0, -1.25}, {1.1, 0.8}, {-1.1, 0.8}};
  static const double diamond[4][2] = {{0, -1.3}, {1.3, 0}, {0, 1.3}, {-1.3, 0}};
  cairo_t *cr = canvas->cr;
  double r = 3.6 * canvas->unit;
  cairo_new_path(cr);
  switch (marker) {
  case MARKER_CIRCLE:
    cairo_arc(cr, at.x, at.y, r, 0, 2 * G_PI);
    break;
  case MARKER_SQUARE:
    draw_polygon(cr, at, square, 4, r);
    break;
  case MARKER_TRIANGLE:
    draw_polygon(cr, at, triangle, 3, r);
    break;
  case MARKER_DIAMOND:
    draw_polygon(cr, at, diamond, 4, r);
    break;
  case MARKER_CROSS:
  case MARKER_PLUS: {
    double d = marker == MARKER_CROSS ? r * 0.9 : 0.0, e = marker == MARKER_CROSS ? d : r * 1.2;
    cairo_move_to(cr, at.x - e, at.y - d);
    cairo_line_to(cr, at.x + e, at.y + d);
    cairo_move_to(cr, at.x - d, at.y + e);
    cairo_line_to(cr, at.x + d, at.y - e);
    canvas_set_colour(canvas, colour);
    cairo_set_line_width(cr, 2.0 * canvas->unit);
    cairo_stroke(cr);
    return;
  }
  default:
    return;
  }
  /* a white rim keeps neighbouring markers and crossing lines apart */
  canvas_set_colour(canvas, colour_paper);
  cairo_set_line_width(cr, 1.6 * canvas->unit);
  cairo_stroke_preserve(cr);
  canvas_set_colour(canvas, colour);
  cairo_fill(cr);
}

void legend_draw_series(struct canvas *canvas, const struct frame *frame,
                        const struct chart_series *series) {
  cairo_t *cr = canvas->cr;
  if (series->width > 0 && series->count > 1) {
    for (size_t i = 0; i < series->count; i++) {
      struct point p = frame_pixel(frame, series->points[i]);
      cairo_line_to(cr, p.x, p.y);
    }
    canvas_set_colour(canvas, series->colour);
    cairo_set_line_width(cr, series->width * canvas->unit);
    cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
    set_dash(canvas, series->dash);
    cairo_stroke(cr);
    set_dash(canvas, DASH_SOLID);
  }
  /* many points would merge into a thick worm: draw about forty of them */
  size_t stride = series->count / 40 + 1;
  for (size_t i = 0; i < series->count; i += stride) {
    draw_marker(canvas, series->marker, frame_pixel(frame, series->points[i]), series->colour);
  }
}

static size_t named_count(const struct chart *chart) {
  size_t count = 0;
  for (size_t i = 0; i < chart->series_count; i++) {
    count += chart->series[i].name != NULL && chart->series[i].count > 0;
  }
  return count;
}

static double text_width(struct canvas *canvas, const char *text) {
  double width = 0, height;
  if (text) {
    struct text_style style = chart_style_tick();
    canvas_measure(canvas, text, &style, &width, &height);
  }
  return width;
}

struct legend legend_measure(struct canvas *canvas, const struct chart *chart, size_t columns,
                             double max_width, double max_height) {
  size_t count = named_count(chart);
  struct legend legend = {.columns = columns};
  if (count == 0) {
    return legend;
  }
  double u = canvas->unit, widest = 0;
  for (size_t i = 0; i < chart->series_count; i++) {
    const struct chart_series *series = &chart->series[i];
    if (series->name && series->count > 0) {
      double detail = series->detail ? text_width(canvas, series->detail) + 2 * GAP * u : 0;
      widest = fmax(widest, ceil(text_width(canvas, series->name)) + 1 + detail);
    }
  }
  double most_rows = fmax(floor((max_height / u - 2 * PAD) / LINE), 1);
  legend.rows = (count + columns - 1) / columns;
  legend.rows = (double)legend.rows > most_rows ? (size_t)most_rows : legend.rows;
  legend.shown = count <= legend.rows * columns ? count : legend.rows * columns - 1;
  double full = (double)columns * ((SAMPLE + GAP) * u + widest) +
                (double)(columns - 1) * 3 * GAP * u + 2 * PAD * u;
  legend.box.width = fmin(full, max_width);
  legend.box.height = (2 * PAD + LINE * (double)legend.rows) * u;
  return legend;
}

/* One line of the legend; (x, y) is the middle of its left edge. */
static void draw_row(struct canvas *canvas, const struct chart_series *series, double x, double y,
                     double width) {
  double u = canvas->unit;
  struct text_style style = chart_style_tick();
  style.colour = colour_ink;
  struct point ends[2] = {{0, 0}, {1, 0}}, middle = {x + SAMPLE * u / 2, y};
  struct frame frame = {{x, y, SAMPLE * u, 0}, 0, 1, 0, 1};
  struct chart_series line = *series;
  line.points = ends;
  line.count = 2;
  line.marker = MARKER_NONE;
  legend_draw_series(canvas, &frame, &line);
  draw_marker(canvas, series->marker, middle, series->colour);
  double text_x = x + (SAMPLE + GAP) * u, room = width - (SAMPLE + GAP) * u;
  double detail = series->detail ? text_width(canvas, series->detail) : 0;
  style.max_width = fmax(room - (detail > 0 ? detail + GAP * u : 0), 24 * u);
  canvas_text(canvas, text_x, y, 0, 0.5, series->name, &style);
  if (detail > 0) {
    style.max_width = 0;
    style.colour = colour_muted;
    canvas_text(canvas, x + width - detail, y, 0, 0.5, series->detail, &style);
  }
}

void legend_draw(struct canvas *canvas, const struct chart *chart, const struct legend *legend) {
  double u = canvas->unit, between = 3 * GAP * u;
  const struct box *box = &legend->box;
  double columns = (double)legend->columns;
  double width = (box->width - 2 * PAD * u - (columns - 1) * between) / columns;
  cairo_rectangle(canvas->cr, box->x, box->y, box->width, box->height);
  canvas_set_colour(canvas, colour_paper);
  cairo_fill(canvas->cr);
  size_t place = 0, count = named_count(chart);
  for (size_t i = 0; i < chart->series_count && place <= legend->shown; i++) {
    const struct chart_series *series = &chart->series[i];
    if (!series->name || series->count == 0) {
      continue;
    }
    double x = box->x + PAD * u + (double)(place / legend->rows) * (width + between);
    double y = box->y + (PAD + LINE * ((double)(place % legend->rows) + 0.5)) * u;
    if (place < legend->shown) {
      draw_row(canvas, series, x, y, width);
    } else {
      char more[64];
      snprintf(more, sizeof more, "and %zu more", count - legend->shown);
      struct text_style style = chart_style_tick();
      canvas_text(canvas, x + (SAMPLE + GAP) * u, y, 0, 0.5, more, &style);
    }
    place++;
  }
}
