#include "server/plot/chart.h"

#include <math.h>
#include <string.h>

#include "server/plot/legend.h"

enum { MARGIN = 16, TICK = 4 }; /* design units: edge of the sheet, tick mark */

struct text_style chart_style_label(void) {
  return (struct text_style){.size = 14, .colour = colour_ink};
}

struct text_style chart_style_tick(void) {
  return (struct text_style){.size = 12, .colour = colour_muted};
}

/* Number of ticks that suits a length in pixels. */
static int tick_target(const struct canvas *canvas, double length, double spacing) {
  int target = (int)(length / (spacing * canvas->unit));
  return target < 2 ? 2 : target > 12 ? 12 : target;
}

enum { TITLE_HEIGHT = 24, SUBTITLE_HEIGHT = 17 };

void chart_heading(struct canvas *canvas, double left, const char *title, const char *subtitle,
                   const char *notice) {
  double u = canvas->unit, y = MARGIN * u;
  double room = canvas->width - left - MARGIN * u;
  struct text_style big = {.size = 17, .bold = 1, .colour = colour_ink, .max_width = room};
  struct text_style small = {.size = 12, .colour = colour_muted, .max_width = room};
  canvas_text(canvas, left, y, 0, 0, title, &big);
  y += TITLE_HEIGHT * u;
  if (subtitle && *subtitle) {
    canvas_text(canvas, left, y, 0, 0, subtitle, &small);
    y += SUBTITLE_HEIGHT * u;
  }
  if (notice && *notice) {
    small.colour = colour_notice;
    canvas_text(canvas, left, y, 0, 0, notice, &small);
  }
}

double chart_heading_height(const struct canvas *canvas, const char *subtitle, const char *notice) {
  double lines = (subtitle && *subtitle ? 1 : 0) + (notice && *notice ? 1 : 0);
  return (MARGIN + TITLE_HEIGHT + SUBTITLE_HEIGHT * lines + 8) * canvas->unit;
}

/* Widest tick text of an axis. */
static double widest_tick(struct canvas *canvas, const struct ticks *ticks) {
  double widest = 0;
  struct text_style style = chart_style_tick();
  for (int i = 0; i < ticks->count; i++) {
    char text[TICKS_TEXT];
    double width, height;
    ticks_label(ticks, i, text);
    canvas_measure(canvas, text, &style, &width, &height);
    widest = fmax(widest, width);
  }
  return widest;
}

enum { BAR_GAP = 18, BAR_WIDTH = 16, BAR_TEXT = 7, BAR_LABEL = 24 };

static struct ticks bar_ticks(const struct canvas *canvas, const struct colour_bar *bar,
                              double height) {
  return ticks_make(bar->min, bar->max, tick_target(canvas, height, 56));
}

double chart_bar_room(struct canvas *canvas, const struct colour_bar *bar) {
  if (!bar->label) {
    return 0;
  }
  struct ticks ticks = bar_ticks(canvas, bar, canvas->height * 0.7);
  return widest_tick(canvas, &ticks) + (BAR_GAP + BAR_WIDTH + BAR_TEXT + BAR_LABEL) * canvas->unit;
}

void chart_bar(struct canvas *canvas, const struct colour_bar *bar, struct box area) {
  double u = canvas->unit;
  double x = area.x + area.width - chart_bar_room(canvas, bar) + BAR_GAP * u;
  int height = (int)round(area.height);
  for (int i = 0; i < height; i++) {
    canvas_set_colour(canvas, bar->map(1.0 - (i + 0.5) / height));
    cairo_rectangle(canvas->cr, round(x), round(area.y) + i, round(BAR_WIDTH * u), 1);
    cairo_fill(canvas->cr);
  }
  struct ticks ticks = bar_ticks(canvas, bar, area.height);
  struct text_style style = chart_style_tick();
  double right = round(x) + round(BAR_WIDTH * u);
  for (int i = 0; i < ticks.count; i++) {
    double share = (ticks_value(&ticks, i) - bar->min) / (bar->max - bar->min);
    double y = round(area.y) + (1.0 - share) * height;
    char text[TICKS_TEXT];
    ticks_label(&ticks, i, text);
    canvas_set_colour(canvas, colour_muted);
    canvas_line(canvas, right, y, right + 3 * u, y, 1);
    canvas_text(canvas, right + BAR_TEXT * u, y, 0, 0.5, text, &style);
  }
  struct text_style label = chart_style_label();
  canvas_text_upwards(canvas, area.x + area.width - 8 * u, area.y + area.height / 2, bar->label,
                      &label);
}

static size_t data_range(const struct chart *chart, struct frame *frame) {
  size_t count = 0;
  frame->x_min = frame->y_min = chart->from_zero ? 0.0 : INFINITY;
  frame->x_max = frame->y_max = chart->from_zero ? 0.0 : -INFINITY;
  for (size_t s = 0; s < chart->series_count; s++) {
    if (chart->series[s].guide) {
      continue;
    }
    for (size_t i = 0; i < chart->series[s].count; i++) {
      struct point p = chart->series[s].points[i];
      frame->x_min = fmin(frame->x_min, p.x);
      frame->x_max = fmax(frame->x_max, p.x);
      frame->y_min = fmin(frame->y_min, p.y);
      frame->y_max = fmax(frame->y_max, p.y);
    }
    count += chart->series[s].count;
  }
  if (chart->mark && count > 0) {
    frame->x_min = fmin(frame->x_min, chart->mark->x);
    frame->x_max = fmax(frame->x_max, chart->mark->x);
  }
  if (count == 0) {
    frame->x_min = frame->y_min = 0.0;
    frame->x_max = frame->y_max = 1.0;
  }
  return count;
}

/* Widens the shorter direction until both have the same scale. */
static void equalise(struct frame *frame) {
  double pad = 0.06;
  double dx = frame->x_max - frame->x_min, dy = frame->y_max - frame->y_min;
  double scale = fmax(dx / frame->area.width, dy / frame->area.height) * (1 + 2 * pad);
  /* a single point gets one unit around it */
  scale = fmax(scale, 1.0 / frame->area.width);
  double spare_x = (scale * frame->area.width - dx) / 2;
  double spare_y = (scale * frame->area.height - dy) / 2;
  frame->x_min -= spare_x;
  frame->x_max += spare_x;
  frame->y_min -= spare_y;
  frame->y_max += spare_y;
}

static struct ticks axis_ticks(const struct chart *chart, double min, double max, int target) {
  return chart->log_axes ? ticks_make_log(min, max, target) : ticks_make(min, max, target);
}

/* Finds the inside of the axes below `top`, and with it the final ranges. */
static void lay_out(const struct chart *chart, struct canvas *canvas, double top,
                    const struct frame *data, struct frame *frame) {
  double u = canvas->unit;
  *frame = *data;
  double bottom = canvas->height - 60 * u;
  frame->area = (struct box){74 * u, top, 0, bottom - top};
  double right = canvas->width - 26 * u;
  if (chart->bar.label) {
    right = canvas->width - 8 * u - chart_bar_room(canvas, &chart->bar);
  }
  /* the width of the tick texts depends on the ranges, which depend on the width: twice is enough
   */
  for (int pass = 0; pass < 2; pass++) {
    frame->area.width = right - frame->area.x;
    struct box area = frame->area;
    *frame = *data;
    frame->area = area;
    if (chart->equal) {
      equalise(frame);
    } else {
      void (*widen)(double *, double *, int) = chart->log_axes ? ticks_widen_log : ticks_widen;
      widen(&frame->x_min, &frame->x_max, tick_target(canvas, area.width, 90));
      widen(&frame->y_min, &frame->y_max, tick_target(canvas, area.height, 60));
    }
    struct ticks ticks =
        axis_ticks(chart, frame->y_min, frame->y_max, tick_target(canvas, area.height, 60));
    frame->area.x = round((MARGIN + 32) * u + widest_tick(canvas, &ticks));
    frame->area.width = right - frame->area.x;
  }
}

static void draw_axes(const struct chart *chart, struct canvas *canvas, const struct frame *frame,
                      bool empty) {
  double u = canvas->unit;
  const struct box *a = &frame->area;
  double bottom = a->y + a->height, right = a->x + a->width;
  int x_target = tick_target(canvas, a->width, 90), y_target = tick_target(canvas, a->height, 60);
  struct ticks xs = axis_ticks(chart, frame->x_min, frame->x_max, x_target);
  struct ticks ys = axis_ticks(chart, frame->y_min, frame->y_max, y_target);
  struct text_style tick = chart_style_tick(), label = chart_style_label();
  if (empty) {
    xs.count = ys.count = 0; /* numbers would claim a range that nothing was measured in */
  }
  char text[TICKS_TEXT];
  for (int i = 0; i < xs.count; i++) {
    double x = frame_pixel(frame, (struct point){ticks_value(&xs, i), frame->y_min}).x;
    canvas_set_colour(canvas, colour_grid);
    canvas_line(canvas, x, a->y, x, bottom, 1);
    canvas_set_colour(canvas, colour_muted);
    canvas_line(canvas, x, bottom, x, bottom + TICK * u, 1);
    ticks_label(&xs, i, text);
    canvas_text(canvas, x, bottom + (TICK + 4) * u, 0.5, 0, text, &tick);
  }
  for (int i = 0; i < ys.count; i++) {
    double y = frame_pixel(frame, (struct point){frame->x_min, ticks_value(&ys, i)}).y;
    canvas_set_colour(canvas, colour_grid);
    canvas_line(canvas, a->x, y, right, y, 1);
    canvas_set_colour(canvas, colour_muted);
    canvas_line(canvas, a->x - TICK * u, y, a->x, y, 1);
    ticks_label(&ys, i, text);
    canvas_text(canvas, a->x - (TICK + 5) * u, y, 1, 0.5, text, &tick);
  }
  canvas_set_colour(canvas, colour_muted);
  canvas_line(canvas, a->x, a->y, a->x, bottom, 1);
  canvas_line(canvas, a->x, bottom, right, bottom, 1);
  label.max_width = a->width;
  canvas_text(canvas, a->x + a->width / 2, canvas->height - MARGIN * u, 0.5, 1, chart->x_label,
              &label);
  label.max_width = a->height;
  canvas_text_upwards(canvas, MARGIN * u + 6 * u, a->y + a->height / 2, chart->y_label, &label);
}

/* Notes every curve and marker as an obstacle. */
static void add_obstacles(const struct chart *chart, const struct canvas *canvas,
                          const struct frame *frame, struct place *place) {
  double r = 5 * canvas->unit;
  place->bounds = frame->area;
  for (size_t s = 0; s < chart->series_count; s++) {
    const struct chart_series *series = &chart->series[s];
    struct point before = {0};
    for (size_t i = 0; i < series->count; i++) {
      struct point p = frame_pixel(frame, series->points[i]);
      if (series->marker != MARKER_NONE) {
        place_add_box(place, (struct box){p.x - r, p.y - r, 2 * r, 2 * r});
      }
      if (i > 0 && series->width > 0) {
        place_add_segment(place, (struct place_segment){before.x, before.y, p.x, p.y});
      }
      before = p;
    }
  }
  if (chart->mark) {
    double x = frame_pixel(frame, *chart->mark).x;
    double bottom = frame->area.y + frame->area.height;
    place_add_segment(place, (struct place_segment){x, frame->area.y, x, bottom});
  }
}

/* The upright line with its words at the first free height, on whichever side has room. */
static void draw_mark(const struct chart *chart, struct canvas *canvas, const struct frame *frame,
                      struct place *place) {
  double u = canvas->unit;
  double x = frame_pixel(frame, *chart->mark).x;
  double top = frame->area.y, bottom = top + frame->area.height;
  const double dashes[2] = {2 * u, 3 * u};
  cairo_set_dash(canvas->cr, dashes, 2, 0);
  canvas_set_colour(canvas, colour_muted);
  canvas_line(canvas, x, top, x, bottom, 1.4);
  cairo_set_dash(canvas->cr, NULL, 0, 0);
  struct text_style style = chart_style_tick();
  double width, height;
  canvas_measure(canvas, chart->mark_text, &style, &width, &height);
  for (int i = 0; i < 40; i++) {
    double left = i % 2 ? x - 6 * u - width : x + 6 * u;
    struct box box = {left, top + 4 * u + (i / 2) * 0.05 * (bottom - top - height), width, height};
    if (place_is_free(place, box, 2 * u)) {
      canvas_set_colour(canvas, colour_paper);
      cairo_rectangle(canvas->cr, box.x - u, box.y, box.width + 2 * u, box.height);
      cairo_fill(canvas->cr);
      canvas_text(canvas, box.x, box.y, 0, 0, chart->mark_text, &style);
      place_add_box(place, box);
      return;
    }
  }
}

static void draw_labels(const struct chart *chart, struct canvas *canvas, const struct frame *frame,
                        struct place *place) {
  struct text_style style = chart_style_tick();
  style.colour = colour_ink;
  for (size_t i = 0; i < chart->label_count; i++) {
    struct point p = frame_pixel(frame, chart->labels[i].at);
    struct box box = {0};
    canvas_measure(canvas, chart->labels[i].text, &style, &box.width, &box.height);
    for (double distance = 9; distance < 40; distance += 6) {
      if (place_find_beside(place, p.x, p.y, box.width, box.height, distance * canvas->unit,
                            &box)) {
        canvas_text(canvas, box.x, box.y, 0, 0, chart->labels[i].text, &style);
        place_add_box(place, box);
        break;
      }
    }
  }
}

static void draw_empty(const struct chart *chart, struct canvas *canvas, const struct box *area) {
  struct text_style style = chart_style_label();
  style.colour = colour_muted;
  style.max_width = area->width * 0.9;
  double width, height;
  canvas_measure(canvas, chart->empty, &style, &width, &height);
  double x = area->x + area->width / 2, y = area->y + area->height / 2;
  canvas_set_colour(canvas, colour_paper);
  cairo_rectangle(canvas->cr, x - width / 2 - 8, y - height, width + 16, 2 * height);
  cairo_fill(canvas->cr);
  canvas_text(canvas, x, y, 0.5, 0.5, chart->empty, &style);
}

static void draw_curves(const struct chart *chart, struct canvas *canvas, const struct frame *frame,
                        bool guides) {
  cairo_save(canvas->cr);
  if (guides) {
    cairo_rectangle(canvas->cr, frame->area.x, frame->area.y, frame->area.width,
                    frame->area.height);
    cairo_clip(canvas->cr);
  }
  for (size_t i = 0; i < chart->series_count; i++) {
    if (chart->series[i].guide == guides) {
      legend_draw_series(canvas, frame, &chart->series[i]);
    }
  }
  cairo_restore(canvas->cr);
}

/* Lays out the chart so that the legend is inside where nothing is, or else in a band above. */
static struct legend lay_out_with_legend(const struct chart *chart, struct canvas *canvas,
                                         double top, struct frame *frame) {
  struct frame data = *frame;
  struct place place = {0};
  double margin = 6 * canvas->unit;
  lay_out(chart, canvas, top, &data, frame);
  struct legend legend =
      legend_measure(canvas, chart, 1, 0.62 * frame->area.width, 0.6 * frame->area.height);
  add_obstacles(chart, canvas, frame, &place);
  bool complete = legend.shown == legend.rows;
  bool inside =
      legend.rows == 0 ||
      (complete && place_find(&place, legend.box.width, legend.box.height, margin, &legend.box));
  place_release(&place);
  if (!inside) {
    size_t columns = chart->series_count > 4 ? 2 : 1;
    legend = legend_measure(canvas, chart, columns, frame->area.width, 0.45 * frame->area.height);
    lay_out(chart, canvas, top + legend.box.height, &data, frame);
    legend.box.x = frame->area.x;
    legend.box.y = top - 4 * canvas->unit;
  }
  return legend;
}

void chart_draw(const struct chart *chart, struct canvas *canvas) {
  struct place place = {0};
  struct frame frame = {0};
  double top = chart_heading_height(canvas, chart->subtitle, chart->notice);
  size_t points = data_range(chart, &frame);
  struct legend legend = lay_out_with_legend(chart, canvas, top, &frame);
  chart_heading(canvas, frame.area.x, chart->title, chart->subtitle, chart->notice);
  draw_axes(chart, canvas, &frame, points == 0);
  if (points == 0) {
    draw_empty(chart, canvas, &frame.area);
  }
  add_obstacles(chart, canvas, &frame, &place);
  if (legend.rows > 0) {
    legend_draw(canvas, chart, &legend);
    place_add_box(&place, legend.box);
  }
  if (chart->mark && points > 0) {
    draw_mark(chart, canvas, &frame, &place);
  }
  draw_curves(chart, canvas, &frame, true);
  draw_curves(chart, canvas, &frame, false);
  draw_labels(chart, canvas, &frame, &place);
  if (chart->bar.label) {
    double right = frame.area.x + frame.area.width + chart_bar_room(canvas, &chart->bar);
    chart_bar(canvas, &chart->bar,
              (struct box){frame.area.x, frame.area.y, right - frame.area.x, frame.area.height});
  }
  place_release(&place);
}
