#include "server/plot/series.h"

#include <math.h>

enum { MARKERS_MOST = 40 }; /* on one curve: more would merge into a thick worm */

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

/* Adds the outline of a closed marker to the path; false for the open ones. */
static bool marker_path(cairo_t *cr, enum chart_marker marker, struct point at, double r) {
  static const double square[4][2] = {{-0.9, -0.9}, {0.9, -0.9}, {0.9, 0.9}, {-0.9, 0.9}};
  static const double triangle[3][2] = {{0, -1.25}, {1.1, 0.8}, {-1.1, 0.8}};
  static const double diamond[4][2] = {{0, -1.3}, {1.3, 0}, {0, 1.3}, {-1.3, 0}};
  cairo_new_path(cr);
  switch (marker) {
  case MARKER_CIRCLE:
    cairo_arc(cr, at.x, at.y, r, 0, 2 * G_PI);
    return true;
  case MARKER_SQUARE:
    draw_polygon(cr, at, square, 4, r);
    return true;
  case MARKER_TRIANGLE:
    draw_polygon(cr, at, triangle, 3, r);
    return true;
  case MARKER_DIAMOND:
    draw_polygon(cr, at, diamond, 4, r);
    return true;
  default:
    return false;
  }
}

static void draw_strokes(struct canvas *canvas, enum chart_marker marker, struct point at,
                         struct colour colour, double r) {
  cairo_t *cr = canvas->cr;
  double d = marker == MARKER_CROSS ? r * 0.9 : 0.0, e = marker == MARKER_CROSS ? d : r * 1.2;
  cairo_move_to(cr, at.x - e, at.y - d);
  cairo_line_to(cr, at.x + e, at.y + d);
  cairo_move_to(cr, at.x - d, at.y + e);
  cairo_line_to(cr, at.x + d, at.y - e);
  canvas_set_colour(canvas, colour);
  cairo_set_line_width(cr, 2.0 * canvas->unit);
  cairo_stroke(cr);
}

static void draw_marker(struct canvas *canvas, const struct chart_series *series, struct point at) {
  cairo_t *cr = canvas->cr;
  double r = (series->hollow ? 4.2 : series->small ? 1.8 : 3.6) * canvas->unit;
  if (series->marker == MARKER_NONE) {
    return;
  }
  if (!marker_path(cr, series->marker, at, r)) {
    draw_strokes(canvas, series->marker, at, series->colour, r);
    return;
  }
  /* a rim of paper keeps neighbouring markers and crossing lines apart */
  canvas_set_colour(canvas, colour_paper);
  cairo_set_line_width(cr, (series->hollow ? 3.6 : series->small ? 0.4 : 1.6) * canvas->unit);
  cairo_stroke_preserve(cr);
  if (series->hollow) {
    cairo_fill_preserve(cr);
    canvas_set_colour(canvas, series->colour);
    cairo_set_line_width(cr, 1.7 * canvas->unit);
    cairo_stroke(cr);
  } else {
    canvas_set_colour(canvas, series->colour);
    cairo_fill(cr);
  }
}

static void draw_band(struct canvas *canvas, const struct frame *frame,
                      const struct chart_series *series) {
  for (size_t k = 0; k < 2 * series->count; k++) {
    size_t i = k < series->count ? k : 2 * series->count - 1 - k;
    struct point p = series->points[i];
    p.y += k < series->count ? series->band[i] : -series->band[i];
    p = frame_pixel(frame, p);
    cairo_line_to(canvas->cr, p.x, p.y);
  }
  cairo_close_path(canvas->cr);
  /* bands that overlap stay visible */
  canvas_set_glaze(canvas, series->colour, 0.2);
  cairo_fill(canvas->cr);
}

static void draw_errors(struct canvas *canvas, const struct frame *frame,
                        const struct chart_series *series) {
  double cap = 4 * canvas->unit;
  if (series->style == STYLE_COLUMNS) {
    double slot = frame->area.width / (frame->x_max - frame->x_min);
    cap = fmin(cap, 0.4 * series->width * slot);
  }
  /* on a column of its own colour a bar could not be seen */
  canvas_set_colour(canvas, series->style == STYLE_COLUMNS ? colour_ink : series->colour);
  for (size_t i = 0; i < series->count; i++) {
    double error = series->errors[i];
    if (!isfinite(error) || error <= 0) {
      continue;
    }
    struct point p = series->points[i];
    struct point low = frame_pixel(frame, (struct point){p.x, p.y - error});
    struct point high = frame_pixel(frame, (struct point){p.x, p.y + error});
    canvas_line(canvas, low.x, low.y, high.x, high.y, 1.4);
    canvas_line(canvas, low.x - cap, low.y, low.x + cap, low.y, 1.4);
    canvas_line(canvas, high.x - cap, high.y, high.x + cap, high.y, 1.4);
  }
}

static struct box column_box(const struct frame *frame, const struct chart_series *series,
                             struct point p) {
  struct point a = frame_pixel(frame, (struct point){p.x - series->width / 2, fmax(p.y, 0)});
  struct point b = frame_pixel(frame, (struct point){p.x + series->width / 2, fmin(p.y, 0)});
  return (struct box){round(a.x), a.y, fmax(round(b.x) - round(a.x), 1), b.y - a.y};
}

static void draw_stems(struct canvas *canvas, const struct frame *frame,
                       const struct chart_series *series) {
  canvas_set_colour(canvas, series->colour);
  for (size_t i = 0; i < series->count; i++) {
    struct point p = frame_pixel(frame, series->points[i]);
    struct point zero = frame_pixel(frame, (struct point){series->points[i].x, 0});
    canvas_line(canvas, p.x, p.y, p.x, zero.y, series->width);
  }
}

static void fill_box(struct canvas *canvas, struct box box, struct colour colour) {
  canvas_set_colour(canvas, colour);
  cairo_rectangle(canvas->cr, box.x, box.y, box.width, box.height);
  cairo_fill(canvas->cr);
}

static struct box span_box(const struct frame *frame, const struct chart_series *series) {
  double from = frame_pixel(frame, series->points[0]).x;
  double to = frame_pixel(frame, series->points[1]).x;
  return (struct box){fmin(from, to), frame->area.y, fabs(to - from), frame->area.height};
}

static void draw_line(struct canvas *canvas, const struct frame *frame,
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
}

void series_draw(struct canvas *canvas, const struct frame *frame,
                 const struct chart_series *series) {
  if (series->style == STYLE_SPAN) {
    if (series->count >= 2) {
      fill_box(canvas, span_box(frame, series), series->colour);
    }
    return;
  }
  if (series->style == STYLE_COLUMNS) {
    for (size_t i = 0; i < series->count; i++) {
      fill_box(canvas, column_box(frame, series, series->points[i]), series->colour);
    }
  } else if (series->style == STYLE_STEMS) {
    draw_stems(canvas, frame, series);
  } else {
    if (series->band && series->count > 1) {
      draw_band(canvas, frame, series);
    }
    draw_line(canvas, frame, series);
  }
  if (series->errors) {
    draw_errors(canvas, frame, series);
  }
  /* single points are data and all shown; on a line some are enough */
  size_t stride = series->width > 0 ? series->count / MARKERS_MOST + 1 : 1;
  for (size_t i = 0; i < series->count; i += stride) {
    draw_marker(canvas, series, frame_pixel(frame, series->points[i]));
  }
}

void series_draw_sample(struct canvas *canvas, const struct chart_series *series, double x,
                        double y, double width) {
  struct point ends[2] = {{0, 0}, {1, 0}}, middle = {x + width / 2, y};
  struct frame frame = {{x, y, width, 0}, 0, 1, 0, 1};
  double half = 5 * canvas->unit;
  if (series->style == STYLE_STEMS) {
    draw_marker(canvas, series, middle);
    return;
  }
  if (series->style != STYLE_LINE) {
    fill_box(canvas, (struct box){x + width / 4, y - half, width / 2, 2 * half}, series->colour);
    return;
  }
  if (series->band) {
    fill_box(canvas, (struct box){x, y - half, width, 2 * half}, colour_fade(series->colour, 0.8));
  }
  struct chart_series line = *series;
  line.points = ends;
  line.count = 2;
  draw_line(canvas, &frame, &line);
  draw_marker(canvas, series, middle);
}

void series_add_obstacles(const struct canvas *canvas, const struct frame *frame,
                          const struct chart_series *series, struct place *place) {
  double r = 5 * canvas->unit;
  struct point before[3] = {{0, 0}};
  if (series->style == STYLE_SPAN) {
    return;
  }
  for (size_t i = 0; i < series->count; i++) {
    struct point at = series->points[i], p = frame_pixel(frame, at);
    double reach = series->band ? series->band[i] : 0;
    struct point edges[3] = {p, frame_pixel(frame, (struct point){at.x, at.y + reach}),
                             frame_pixel(frame, (struct point){at.x, at.y - reach})};
    if (series->style == STYLE_COLUMNS) {
      place_add_box(place, column_box(frame, series, at));
    }
    if (series->style == STYLE_STEMS) {
      struct point zero = frame_pixel(frame, (struct point){at.x, 0});
      place_add_segment(place, (struct place_segment){p.x, p.y, p.x, zero.y});
    }
    if (series->marker != MARKER_NONE) {
      place_add_box(place, (struct box){p.x - r, p.y - r, 2 * r, 2 * r});
    }
    for (int k = 0; series->style == STYLE_LINE && i > 0 && k < (series->band ? 3 : 1); k++) {
      if (series->width > 0 || k > 0) {
        place_add_segment(place,
                          (struct place_segment){before[k].x, before[k].y, edges[k].x, edges[k].y});
      }
    }
    for (int k = 0; k < 3; k++) {
      before[k] = edges[k];
    }
    if (series->errors && isfinite(series->errors[i])) {
      struct point low = frame_pixel(frame, (struct point){at.x, at.y - series->errors[i]});
      struct point high = frame_pixel(frame, (struct point){at.x, at.y + series->errors[i]});
      place_add_box(place, (struct box){p.x - r, high.y, 2 * r, fmax(low.y - high.y, 0)});
    }
  }
}
