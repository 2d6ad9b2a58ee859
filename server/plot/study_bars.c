#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/plot/legend.h"
#include "server/plot/study_bars.h"
#include "server/plot/study_draw.h"

/* Design units: most height of a row, room of the number right of a bar. */
enum { ROW = 88, NUMBER = 58 };

/* Room for the names: that of the longest, at most two fifths of the sheet. */
static double name_room(struct canvas *canvas, const struct study_bars *bars) {
  struct text_style style = chart_style_tick();
  double widest = 0, width, height;
  for (size_t i = 0; i < bars->count; i++) {
    canvas_measure(canvas, bars->name[i], &style, &width, &height);
    widest = fmax(widest, width);
  }
  return fmin(widest + 30 * canvas->unit, 0.4 * canvas->width);
}

static void lay_out(struct study_bars *bars, struct study_panel *panel, struct canvas *canvas,
                    double top) {
  double u = canvas->unit;
  struct box *area = &panel->frame.area;
  area->x = round(name_room(canvas, bars));
  area->y = top;
  area->width = canvas->width - area->x - NUMBER * u;
  double room = canvas->height - top - axes_bottom_room(canvas, &panel->axes, area->width);
  area->height = round(fmin(room, (double)bars->count * ROW * u));
  panel->frame.y_min = (double)bars->count - 0.5;
  panel->frame.y_max = -0.5;
  ticks_widen(&panel->frame.x_min, &panel->frame.x_max, axes_tick_target(canvas, area->width, 90));
}

void study_bars_begin(struct study_bars *bars, struct study_panel *panel, struct canvas *canvas) {
  double u = canvas->unit;
  const struct chart key = {.series = panel->key, .series_count = panel->key_count};
  double top = chart_heading_height(canvas, panel->subtitle, panel->notice);
  size_t columns = panel->key_count > 0 ? panel->key_count : 1;
  struct legend legend;
  do {
    legend = legend_measure(canvas, &key, columns, canvas->width - 24 * u, 0.3 * canvas->height);
  } while (!legend.complete && --columns > 0);
  lay_out(bars, panel, canvas, top + (legend.rows > 0 ? legend.box.height : 0));
  const struct box *area = &panel->frame.area;
  legend.box.x = fmin(area->x - 7 * u, canvas->width - 8 * u - legend.box.width);
  legend.box.y = top - 5 * u;
  axes_draw_x(canvas, &panel->axes, &panel->frame);
  if (legend.rows > 0) {
    legend_draw(canvas, &key, &legend);
  }
  struct text_style style = chart_style_tick();
  style.colour = colour_ink;
  style.max_width = area->x - 20 * u;
  for (size_t i = 0; i < bars->count; i++) {
    double y = frame_pixel(&panel->frame, (struct point){0, (double)i}).y;
    canvas_text(canvas, area->x - 9 * u, y, 1, 0.5, bars->name[i], &style);
  }
  chart_heading(canvas, 16 * u, panel->title, panel->subtitle, panel->notice);
}

void study_bars_fill(struct canvas *canvas, const struct frame *frame, double row, double thick,
                     double from, double to, struct colour colour) {
  struct point a = frame_pixel(frame, (struct point){fmin(from, to), row - thick / 2});
  struct point b = frame_pixel(frame, (struct point){fmax(from, to), row + thick / 2});
  canvas_set_colour(canvas, colour);
  cairo_rectangle(canvas->cr, a.x, round(a.y), b.x - a.x, fmax(round(b.y) - round(a.y), 1));
  cairo_fill(canvas->cr);
}

/* A level interval with its caps. */
static void draw_interval(struct canvas *canvas, const struct frame *frame, double row, double low,
                          double high) {
  struct point a = frame_pixel(frame, (struct point){fmax(low, frame->x_min), row});
  struct point b = frame_pixel(frame, (struct point){fmin(high, frame->x_max), row});
  double cap = 3.5 * canvas->unit;
  canvas_set_colour(canvas, colour_ink);
  canvas_line(canvas, a.x, a.y, b.x, b.y, 1.2);
  canvas_line(canvas, a.x, a.y - cap, a.x, a.y + cap, 1.2);
  canvas_line(canvas, b.x, b.y - cap, b.x, b.y + cap, 1.2);
}

void study_bars_zero(const struct study_panel *panel, struct canvas *canvas) {
  const struct box *a = &panel->frame.area;
  double zero = frame_pixel(&panel->frame, (struct point){0, 0}).x;
  canvas_set_colour(canvas, colour_muted);
  canvas_line(canvas, zero, a->y, zero, a->y + a->height, 1);
}

static void draw_share(struct canvas *canvas, const struct frame *frame, double row, double thick,
                       const struct share *share, struct colour colour) {
  struct text_style style = chart_style_tick();
  char text[TICKS_TEXT + 4];
  style.size = 11;
  study_bars_fill(canvas, frame, row, thick, 0, share->value, colour);
  draw_interval(canvas, frame, row, share->low, share->high);
  double end = fmax(fmax(share->value, share->high), 0);
  struct point p = frame_pixel(frame, (struct point){fmin(end, frame->x_max), row});
  snprintf(text, sizeof text, "%s%.2f", share->value < -0.005 ? "\u2212" : "", fabs(share->value));
  canvas_text(canvas, p.x + 6 * canvas->unit, p.y, 0, 0.5, text, &style);
}

/* The parameters with the largest total share first. */
static size_t order(const struct study_importance *importance, size_t parameters, size_t *sorted) {
  size_t count = 0;
  for (size_t k = 0; k < parameters; k++) {
    size_t at = count < STUDY_BARS ? count++ : STUDY_BARS - 1;
    if (at == STUDY_BARS - 1 && k >= STUDY_BARS &&
        importance->share[sorted[at]].total.value >= importance->share[k].total.value) {
      continue;
    }
    while (at > 0 &&
           importance->share[sorted[at - 1]].total.value < importance->share[k].total.value) {
      sorted[at] = sorted[at - 1];
      at--;
    }
    sorted[at] = k;
  }
  return count;
}

enum status study_draw_importance(struct canvas *canvas, const struct study_plot_input *input,
                                  const struct study_plot_options *options, struct error *error) {
  const struct study_importance *importance = input->importance;
  const struct study_table *table = input->table;
  const struct point dummy = {0, 0};
  const struct chart_series key[2] = {{.points = &dummy,
                                       .count = 1,
                                       .style = STYLE_COLUMNS,
                                       .colour = colour_series(0),
                                       .name = "of the parameter alone"},
                                      {.points = &dummy,
                                       .count = 1,
                                       .style = STYLE_COLUMNS,
                                       .colour = {.role = COLOUR_COLUMN_UP},
                                       .name = "with all its interactions"}};
  struct study_panel panel = {.axes = {.x_label = "Share of the variance (Sobol indices)"},
                              .frame = {.x_max = 1},
                              .key = key,
                              .key_count = 2};
  size_t sorted[STUDY_BARS];
  struct study_bars bars = {.count = order(importance, table->parameters, sorted)};
  (void)options;
  (void)error;
  study_panel_words(&panel, table);
  snprintf(panel.title, sizeof panel.title, "What %.200s depends on",
           table->metric[importance->metric].title);
  if (importance->method && *importance->method) {
    study_panel_add(&panel, "%.150s", importance->method);
  }
  study_panel_add(&panel, "95 %% intervals");
  if (bars.count == 0) {
    study_panel_empty(&panel, canvas, "The study has no parameters");
    return STATUS_OK;
  }
  for (size_t i = 0; i < bars.count; i++) {
    const struct importance *share = &importance->share[sorted[i]];
    bars.name[i] = table->parameter[sorted[i]].title;
    panel.frame.x_min = fmin(panel.frame.x_min, fmin(share->first.value, share->total.value));
    panel.frame.x_max = fmax(panel.frame.x_max, fmin(share->total.high, 1.5));
  }
  study_bars_begin(&bars, &panel, canvas);
  for (size_t i = 0; i < bars.count; i++) {
    const struct importance *share = &importance->share[sorted[i]];
    draw_share(canvas, &panel.frame, (double)i - 0.19, 0.34, &share->first, key[0].colour);
    draw_share(canvas, &panel.frame, (double)i + 0.19, 0.34, &share->total, key[1].colour);
  }
  study_bars_zero(&panel, canvas);
  return STATUS_OK;
}
