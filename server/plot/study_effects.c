#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/plot/series.h"
#include "server/plot/study_draw.h"
#include "server/plot/study_panel.h"

enum { CHARTS_MOST = 12 };

/* One of the small charts. */
struct small {
  struct study_axis x;
  char label[STUDY_LABEL];
  struct axes axes;
  struct frame frame;
};

struct board {
  struct study_axis metric;
  size_t count, columns, rows;
  struct small small[CHARTS_MOST];
  double low, high; /* of all charts */
};

static void set_range(struct board *board, const struct study_effects *effects) {
  board->low = INFINITY;
  board->high = -INFINITY;
  for (size_t e = 0; e < board->count; e++) {
    const struct study_effect *effect = &effects->effect[e];
    for (size_t i = 0; i < effect->count; i++) {
      board->low = fmin(fmin(board->low, effect->mean[i]), effect->low ? effect->low[i] : NAN);
      board->high = fmax(fmax(board->high, effect->mean[i]), effect->high ? effect->high[i] : NAN);
    }
  }
}

static void set_axes(struct board *board, size_t k, const char *y_label) {
  struct small *small = &board->small[k];
  const struct study_column *column = small->x.column;
  bool inner = k % board->columns > 0;
  study_axis_label(&small->x, small->label);
  small->axes = (struct axes){.x_label = small->label,
                              .y_label = inner ? NULL : y_label,
                              .log_x = small->x.logarithmic,
                              .no_y_text = inner};
  small->frame = (struct frame){
      .x_min = small->x.low, .x_max = small->x.high, .y_min = board->low, .y_max = board->high};
  if (column->categorical) {
    small->axes.x_names = (const char *const *)column->words;
    small->axes.x_name_count = column->word_count;
  }
}

/* All charts of a row are as high as the one whose words need most room, and all show the same
 * range of the metric. */
static void lay_out(struct board *board, struct canvas *canvas, double top) {
  double u = canvas->unit, left = 74 * u, gap = 18 * u, right = 22 * u;
  struct frame *first = &board->small[0].frame;
  for (int pass = 0; pass < 2; pass++) {
    double across = (canvas->width - left - right) / (double)board->columns;
    double down = (canvas->height - top - 4 * u) / (double)board->rows, bottom[CHARTS_MOST] = {0};
    for (size_t k = 0; k < board->count; k++) {
      double room = axes_bottom_room(canvas, &board->small[k].axes, across - gap);
      bottom[k / board->columns] = fmax(bottom[k / board->columns], room);
    }
    for (size_t k = 0; k < board->count; k++) {
      struct small *small = &board->small[k];
      small->frame = (struct frame){
          .x_min = small->x.low, .x_max = small->x.high, .y_min = board->low, .y_max = board->high};
      small->frame.area =
          (struct box){round(left + (double)(k % board->columns) * across),
                       round(top + (double)(k / board->columns) * down), round(across - gap),
                       round(fmax(down - bottom[k / board->columns], 24 * u))};
      axes_widen(canvas, &small->axes, &small->frame);
      small->frame.y_min = first->y_min;
      small->frame.y_max = first->y_max;
      if (!small->axes.x_names && small->x.high > small->x.low) {
        double spare = 0.02 * (small->x.high - small->x.low);
        small->frame.x_min = small->x.low - spare;
        small->frame.x_max = small->x.high + spare;
      }
    }
    left = axes_left_room(canvas, &board->small[0].axes, first);
  }
}

/* The band between low and high. */
static void draw_band(struct canvas *canvas, const struct small *small,
                      const struct study_effect *effect) {
  for (size_t k = 0; k < 2 * effect->count; k++) {
    size_t i = k < effect->count ? k : 2 * effect->count - 1 - k;
    double y = k < effect->count ? effect->low[i] : effect->high[i];
    double x = small->x.logarithmic ? log10(effect->x[i]) : effect->x[i];
    if (isfinite(x) && isfinite(y)) {
      struct point p = frame_pixel(&small->frame, (struct point){x, y});
      cairo_line_to(canvas->cr, p.x, p.y);
    }
  }
  cairo_close_path(canvas->cr);
  canvas_set_glaze(canvas, colour_series(0), 0.2);
  cairo_fill(canvas->cr);
}

/* An upright bar for each word. */
static void draw_bars(struct canvas *canvas, const struct small *small,
                      const struct study_effect *effect) {
  double cap = 4 * canvas->unit;
  canvas_set_colour(canvas, colour_series(0));
  for (size_t i = 0; i < effect->count; i++) {
    struct point low = frame_pixel(&small->frame, (struct point){effect->x[i], effect->low[i]});
    struct point high = frame_pixel(&small->frame, (struct point){effect->x[i], effect->high[i]});
    if (isfinite(low.x) && isfinite(low.y) && isfinite(high.y)) {
      canvas_line(canvas, low.x, low.y, high.x, high.y, 1.4);
      canvas_line(canvas, low.x - cap, low.y, low.x + cap, low.y, 1.4);
      canvas_line(canvas, high.x - cap, high.y, high.x + cap, high.y, 1.4);
    }
  }
}

static enum status draw_effect(struct canvas *canvas, const struct small *small,
                               const struct study_effect *effect, struct error *error) {
  struct point *points = malloc((effect->count + 1) * sizeof *points);
  bool words = small->x.column->categorical;
  size_t count = 0;
  if (!points) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  for (size_t i = 0; i < effect->count; i++) {
    double x = small->x.logarithmic ? log10(effect->x[i]) : effect->x[i];
    if (isfinite(x) && isfinite(effect->mean[i])) {
      points[count++] = (struct point){x, effect->mean[i]};
    }
  }
  struct chart_series series = {.points = points,
                                .count = count,
                                .colour = colour_series(0),
                                .width = words ? 0 : 2,
                                .marker = words ? MARKER_CIRCLE : MARKER_NONE};
  if (effect->low && effect->high) {
    (words ? draw_bars : draw_band)(canvas, small, effect);
  }
  series_draw(canvas, &small->frame, &series);
  free(points);
  return STATUS_OK;
}

/* As many columns as make charts a little wider than high. */
static void set_columns(struct board *board, const struct canvas *canvas) {
  double ratio = canvas->width / (double)canvas->height;
  double columns = ceil(sqrt((double)board->count * ratio) - 0.35);
  board->columns = (size_t)fmin(fmax(columns, 1), (double)board->count);
  board->rows = (board->count + board->columns - 1) / board->columns;
}

static enum status draw_board(struct canvas *canvas, struct study_panel *panel, struct board *board,
                              const struct study_effects *effects, struct error *error) {
  enum status status = STATUS_OK;
  char label[STUDY_LABEL];
  study_axis_label(&board->metric, label);
  set_columns(board, canvas);
  set_range(board, effects);
  for (size_t k = 0; k < board->count; k++) {
    board->small[k].x = study_axis_parameter(board->metric.table, effects->effect[k].parameter);
    set_axes(board, k, label);
  }
  lay_out(board, canvas, chart_heading_height(canvas, panel->subtitle, panel->notice) + 4);
  for (size_t k = 0; k < board->count && status == STATUS_OK; k++) {
    axes_draw(canvas, &board->small[k].axes, &board->small[k].frame, false);
    status = draw_effect(canvas, &board->small[k], &effects->effect[k], error);
  }
  chart_heading(canvas, 16 * canvas->unit, panel->title, panel->subtitle, panel->notice);
  return status;
}

enum status study_draw_effects(struct canvas *canvas, const struct study_plot_input *input,
                               const struct study_plot_options *options, struct error *error) {
  const struct study_effects *effects = input->effects;
  struct study_panel panel = {0};
  struct board *board = calloc(1, sizeof *board);
  (void)options;
  if (!board) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  enum status status = STATUS_OK;
  study_panel_words(&panel, input->table);
  board->metric = study_axis_metric(input->table, effects->metric);
  board->count = effects->count < CHARTS_MOST ? effects->count : CHARTS_MOST;
  snprintf(panel.title, sizeof panel.title, "%.150s: mean over each parameter",
           board->metric.column->title);
  if (effects->method && *effects->method) {
    study_panel_add(&panel, "%.120s", effects->method);
  }
  if (effects->band && *effects->band) {
    study_panel_add(&panel, "band: %.120s", effects->band);
  }
  if (effects->count > CHARTS_MOST) {
    study_panel_add(&panel, "the first %d of %zu", CHARTS_MOST, effects->count);
  }
  if (board->count == 0) {
    study_panel_empty(&panel, canvas, "The study has no parameters");
  } else {
    status = draw_board(canvas, &panel, board, effects, error);
  }
  free(board);
  return status;
}
