#include "server/plot/chart.h"

#include <math.h>
#include <string.h>

#include "server/plot/axes.h"
#include "server/plot/legend.h"
#include "server/plot/series.h"

enum { MARGIN = 16 }; /* design units: edge of the sheet */

struct text_style chart_style_label(void) {
  return (struct text_style){.size = 14, .colour = colour_ink};
}

struct text_style chart_style_tick(void) {
  return (struct text_style){.size = 12, .colour = colour_muted};
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

enum { BAR_GAP = 18, BAR_WIDTH = 16, BAR_TEXT = 7, BAR_LABEL = 24 };

static struct ticks bar_ticks(const struct canvas *canvas, const struct colour_bar *bar,
                              double height) {
  return (bar->logarithmic ? ticks_make_log : ticks_make)(bar->min, bar->max,
                                                          axes_tick_target(canvas, height, 56));
}

double chart_bar_room(struct canvas *canvas, const struct colour_bar *bar) {
  if (!bar->label) {
    return 0;
  }
  struct ticks ticks = bar_ticks(canvas, bar, canvas->height * 0.7);
  return axes_widest_tick(canvas, &ticks) +
         (BAR_GAP + BAR_WIDTH + BAR_TEXT + BAR_LABEL) * canvas->unit;
}

struct colour chart_bar_colour(const struct colour_bar *bar, double value) {
  double t = (value - bar->min) / (bar->max - bar->min);
  if (bar->bands > 0) {
    double last = bar->bands - 1;
    t = isnan(t) ? t : fmin(fmax(floor(t * bar->bands), 0), last) / fmax(last, 1);
  }
  return bar->map(t);
}

void chart_bar(struct canvas *canvas, const struct colour_bar *bar, struct box area) {
  double u = canvas->unit;
  double x = area.x + area.width - chart_bar_room(canvas, bar) + BAR_GAP * u;
  int height = (int)round(area.height);
  for (int i = 0; i < height; i++) {
    double value = bar->min + (1.0 - (i + 0.5) / height) * (bar->max - bar->min);
    canvas_set_colour(canvas, chart_bar_colour(bar, value));
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
  label.max_width = area.height;
  canvas_text_upwards(canvas, area.x + area.width - 8 * u, area.y + area.height / 2, bar->label,
                      &label);
}

/* Widens a range by one series, error bars and bands included. */
static void add_range(const struct chart_series *series, struct frame *frame) {
  double half = series->style == STYLE_COLUMNS ? series->width / 2 : 0;
  for (size_t i = 0; i < series->count; i++) {
    struct point p = series->points[i];
    double reach = series->errors && series->errors[i] > 0 ? series->errors[i] : 0;
    reach = series->band ? fmax(reach, series->band[i]) : reach;
    frame->x_min = fmin(frame->x_min, p.x - half);
    frame->x_max = fmax(frame->x_max, p.x + half);
    frame->y_min = fmin(frame->y_min, p.y - reach);
    frame->y_max = fmax(frame->y_max, p.y + reach);
    if (series->style == STYLE_COLUMNS || series->style == STYLE_STEMS) {
      frame->y_min = fmin(frame->y_min, 0.0);
      frame->y_max = fmax(frame->y_max, 0.0);
    }
  }
}

/* Range of all points; returns their number. */
static size_t data_range(const struct chart *chart, struct frame *frame) {
  size_t count = 0;
  frame->x_min = frame->y_min = chart->from_zero ? 0.0 : INFINITY;
  frame->x_max = frame->y_max = chart->from_zero ? 0.0 : -INFINITY;
  for (size_t s = 0; s < chart->series_count; s++) {
    if (!chart->series[s].guide) {
      add_range(&chart->series[s], frame);
      count += chart->series[s].count;
    }
  }
  if (chart->mark && count > 0) {
    frame->x_min = fmin(frame->x_min, chart->mark->x);
    frame->x_max = fmax(frame->x_max, chart->mark->x);
  }
  if (chart->loose_x) {
    double spare = 0.04 * (frame->x_max - frame->x_min);
    frame->x_min -= spare;
    frame->x_max += spare;
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

/* A chart on its way to the sheet. */
struct panel {
  const struct chart *chart;
  struct axes axes;
  struct box sheet;  /* all that the chart may use */
  double left;       /* pixels: least room left of the axis */
  double beside;     /* pixels that a legend above the chart may use on its right */
  struct frame data; /* range of the points */
  size_t points;
  struct frame frame;
};

static struct panel panel_make(const struct chart *chart) {
  struct panel panel = {.chart = chart,
                        .axes = {.x_label = chart->x_label,
                                 .y_label = chart->y_label,
                                 .log_x = chart->log_x,
                                 .log_y = chart->log_y,
                                 .whole_x = chart->whole_x,
                                 .x_names = chart->x_names,
                                 .x_name_count = chart->x_name_count}};
  panel.points = data_range(chart, &panel.data);
  return panel;
}

/* Finds the inside of the axes from `top` downwards, and with it the final ranges. */
static void lay_out(struct panel *panel, struct canvas *canvas, double top) {
  double u = canvas->unit;
  const struct chart *chart = panel->chart;
  struct frame *frame = &panel->frame;
  double right = panel->sheet.x + panel->sheet.width;
  right -= chart->bar.label ? 8 * u + chart_bar_room(canvas, &chart->bar) : 26 * u;
  struct box area = {panel->sheet.x + 74 * u, top, 0, 0};
  /* the width of the tick texts depends on the ranges, which depend on the width: twice is enough
   */
  for (int pass = 0; pass < 2; pass++) {
    area.width = right - area.x;
    double bottom = panel->sheet.y + panel->sheet.height;
    area.height = fmax(bottom - axes_bottom_room(canvas, &panel->axes, area.width) - top, 20 * u);
    *frame = panel->data;
    frame->area = area;
    if (chart->equal) {
      equalise(frame);
    } else {
      axes_widen(canvas, &panel->axes, frame);
    }
    double left = fmax(axes_left_room(canvas, &panel->axes, frame), panel->left);
    area.x = round(panel->sheet.x + left);
  }
  frame->area.x = area.x;
  frame->area.width = right - area.x;
}

/* Notes every curve and marker as an obstacle. */
static void add_obstacles(const struct panel *panel, const struct canvas *canvas,
                          struct place *place) {
  const struct chart *chart = panel->chart;
  const struct frame *frame = &panel->frame;
  place->bounds = frame->area;
  for (size_t s = 0; s < chart->series_count; s++) {
    series_add_obstacles(canvas, frame, &chart->series[s], place);
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

static void draw_curves(const struct panel *panel, struct canvas *canvas, bool guides) {
  const struct box *area = &panel->frame.area;
  cairo_save(canvas->cr);
  if (guides) {
    cairo_rectangle(canvas->cr, area->x, area->y, area->width, area->height);
    cairo_clip(canvas->cr);
  }
  for (size_t i = 0; i < panel->chart->series_count; i++) {
    const struct chart_series *series = &panel->chart->series[i];
    if (series->guide == guides && series->style != STYLE_SPAN) {
      series_draw(canvas, &panel->frame, series);
    }
  }
  cairo_restore(canvas->cr);
}

/* Fills the spans, which lie below the grid. */
static void draw_spans(const struct panel *panel, struct canvas *canvas) {
  const struct box *area = &panel->frame.area;
  cairo_save(canvas->cr);
  cairo_rectangle(canvas->cr, area->x, area->y, area->width, area->height);
  cairo_clip(canvas->cr);
  for (size_t i = 0; i < panel->chart->series_count; i++) {
    if (panel->chart->series[i].style == STYLE_SPAN) {
      series_draw(canvas, &panel->frame, &panel->chart->series[i]);
    }
  }
  cairo_restore(canvas->cr);
}

/* The legend in a band above the chart, all of it if it can be: in as few columns as make it two
 * lines high, or as many as there is room for. */
static struct legend measure_band(const struct panel *panel, struct canvas *canvas) {
  enum { COLUMNS_MOST = 8, ROWS_GOOD = 2 };
  const struct chart *chart = panel->chart;
  const struct box *area = &panel->frame.area;
  double width = area->width + panel->beside, height = 0.45 * area->height;
  size_t usual = chart->series_count > 4 ? 2 : 1;
  struct legend best = legend_measure(canvas, chart, usual, width, height);
  for (size_t columns = usual + 1;
       columns <= COLUMNS_MOST && (best.rows > ROWS_GOOD || !best.complete); columns++) {
    struct legend legend = legend_measure(canvas, chart, columns, width, height);
    best = legend.complete ? legend : best;
  }
  return best;
}

/* Lays out the chart so that the legend is inside where nothing is, or else in a band above. */
static struct legend lay_out_with_legend(struct panel *panel, struct canvas *canvas) {
  const struct chart *chart = panel->chart;
  struct place place = {0};
  double top = panel->sheet.y, margin = 6 * canvas->unit;
  const struct box *area = &panel->frame.area;
  lay_out(panel, canvas, top);
  struct legend legend = legend_measure(canvas, chart, 1, 0.62 * area->width, 0.6 * area->height);
  add_obstacles(panel, canvas, &place);
  bool complete = legend.shown == legend.rows;
  bool inside =
      legend.rows == 0 ||
      (complete && place_find(&place, legend.box.width, legend.box.height, margin, &legend.box));
  place_release(&place);
  if (!inside) {
    legend = measure_band(panel, canvas);
    lay_out(panel, canvas, top + legend.box.height);
    legend.box.x = area->x;
    legend.box.y = top - 4 * canvas->unit;
  }
  return legend;
}

static void draw_panel(struct panel *panel, struct canvas *canvas) {
  const struct chart *chart = panel->chart;
  const struct frame *frame = &panel->frame;
  struct place place = {0};
  struct legend legend = lay_out_with_legend(panel, canvas);
  draw_spans(panel, canvas);
  axes_draw(canvas, &panel->axes, frame, panel->points == 0);
  if (panel->points == 0) {
    draw_empty(chart, canvas, &frame->area);
  }
  add_obstacles(panel, canvas, &place);
  if (legend.rows > 0) {
    legend_draw(canvas, chart, &legend);
    place_add_box(&place, legend.box);
  }
  if (chart->mark && panel->points > 0) {
    draw_mark(chart, canvas, frame, &place);
  }
  draw_curves(panel, canvas, true);
  draw_curves(panel, canvas, false);
  draw_labels(chart, canvas, frame, &place);
  if (chart->bar.label) {
    double right = frame->area.x + frame->area.width + chart_bar_room(canvas, &chart->bar);
    chart_bar(
        canvas, &chart->bar,
        (struct box){frame->area.x, frame->area.y, right - frame->area.x, frame->area.height});
  }
  place_release(&place);
}

void chart_draw(const struct chart *chart, struct canvas *canvas) {
  struct panel panel = panel_make(chart);
  double top = chart_heading_height(canvas, chart->subtitle, chart->notice);
  panel.sheet = (struct box){0, top, canvas->width, canvas->height - top};
  draw_panel(&panel, canvas);
  chart_heading(canvas, panel.frame.area.x, chart->title, chart->subtitle, chart->notice);
}

static bool has_legend(const struct chart *chart) {
  bool named = false;
  for (size_t i = 0; i < chart->series_count; i++) {
    named = named || (chart->series[i].name && chart->series[i].count > 0);
  }
  return named;
}

/* Moves the tops of charts beside one whose legend stands above it, so that all begin alike. When
 * that is the first and only one of a row, it may be as long as the row. */
static void align_row(struct panel *panels, size_t count, struct canvas *canvas) {
  double lowest = 0;
  bool alone = true;
  for (size_t i = 1; i < count; i++) {
    alone = alone && !has_legend(panels[i].chart);
  }
  panels[0].beside = alone ? (double)(count - 1) * panels[0].sheet.width : 0;
  for (size_t i = 0; i < count; i++) {
    lay_out_with_legend(&panels[i], canvas);
    lowest = fmax(lowest, panels[i].frame.area.y);
  }
  for (size_t i = 0; i < count; i++) {
    double shift = lowest - panels[i].frame.area.y;
    panels[i].sheet.y += shift;
    panels[i].sheet.height -= shift;
  }
}

void chart_draw_grid(const struct chart *charts, const double *shares, size_t rows, size_t columns,
                     struct canvas *canvas) {
  struct panel panels[CHART_TABLE];
  double top = chart_heading_height(canvas, charts->subtitle, charts->notice);
  double y = top, from = INFINITY, to = -INFINITY, left[CHART_TABLE] = {0};
  double across = (double)canvas->width / (double)columns;
  /* the last row has the numbers and the label besides */
  double extra = 46 * canvas->unit, height = canvas->height - top - extra;
  for (size_t i = 0; i < rows * columns; i++) {
    size_t row = i / columns, column = i % columns;
    double own = shares[row] * height + (row + 1 < rows ? 0 : extra);
    panels[i] = panel_make(&charts[i]);
    panels[i].axes.no_x_text = row + 1 < rows;
    panels[i].sheet = (struct box){(double)column * across, y, across, own};
    y += column + 1 < columns ? 0 : own;
    from = panels[i].points > 0 ? fmin(from, panels[i].data.x_min) : from;
    to = panels[i].points > 0 ? fmax(to, panels[i].data.x_max) : to;
  }
  for (size_t i = 0; i < rows * columns; i++) {
    panels[i].data.x_min = from <= to ? from : 0;
    panels[i].data.x_max = from <= to ? to : 1;
  }
  /* twice: legends and numbers need room, which changes the numbers */
  for (size_t pass = 0; pass < 2; pass++) {
    for (size_t row = 0; row < rows; row++) {
      align_row(panels + row * columns, columns, canvas);
    }
    for (size_t i = 0; i < rows * columns; i++) {
      left[i % columns] = fmax(left[i % columns], panels[i].frame.area.x - panels[i].sheet.x);
    }
    for (size_t i = 0; i < rows * columns; i++) {
      panels[i].left = left[i % columns];
    }
  }
  for (size_t i = 0; i < rows * columns; i++) {
    draw_panel(&panels[i], canvas);
  }
  chart_heading(canvas, left[0], charts->title, charts->subtitle, charts->notice);
}

void chart_draw_stack(const struct chart *charts, const double *shares, size_t count,
                      struct canvas *canvas) {
  chart_draw_grid(charts, shares, count, 1, canvas);
}
