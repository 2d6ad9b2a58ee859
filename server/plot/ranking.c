#include "server/plot/ranking.h"

#include <math.h>
#include <stdio.h>

#include "server/plot/axes.h"
#include "server/plot/draw.h"
#include "server/plot/legend.h"
#include "server/plot/members.h"
#include "server/plot/series.h"

enum { BEST = 15, SLOT = 48 }; /* bars; most height of one, design units */

/* One bar: the part of the mean weighted score and that of the evenness, and their sum. */
struct bar {
  const char *name;
  double rank; /* shared by designs that agree */
  double mean, evenness, final;
};

const json_t *ranking_list(const json_t *result) {
  const json_t *list = json_object_get(json_object_get(result, "ranking"), "designs");
  return json_array_size(list) > 0 ? list : NULL;
}

/* Reads the best designs that have a score. The score is mean_weight times the mean weighted score
 * and the rest times one less the variance; a list with other scores shows them as they are. */
static size_t read_bars(const json_t *result, struct bar bars[BEST], double *weight,
                        bool *divided) {
  const json_t *list = ranking_list(result), *ranking = json_object_get(result, "ranking");
  size_t count = 0;
  double given = data_number(ranking, "mean_weight");
  *weight = given >= 0 && given <= 1 ? given : 0.5;
  *divided = true;
  for (size_t i = 0; i < json_array_size(list) && count < BEST; i++) {
    const json_t *entry = json_array_get(list, i);
    const char *name = json_string_value(json_object_get(entry, "name"));
    double final = data_number(entry, "final");
    double rank = data_number(entry, "rank");
    struct bar bar = {name ? name : "unnamed", rank >= 0 ? rank : (double)i + 1,
                      *weight * data_number(entry, "mean_weighted"),
                      (1 - *weight) * (1 - data_number(entry, "normalised_variance")), final};
    if (!(fabs(final) <= 1e6)) {
      continue;
    }
    *divided = *divided && bar.mean >= 0 && bar.evenness >= 0 &&
               fabs(bar.mean + bar.evenness - final) < 1e-3;
    bars[count++] = bar;
  }
  return count;
}

static void fill(struct canvas *canvas, const struct frame *frame, double from, double to,
                 double middle, double height, struct colour colour) {
  double x = frame_pixel(frame, (struct point){from, 0}).x;
  double end = frame_pixel(frame, (struct point){to, 0}).x;
  canvas_set_colour(canvas, colour);
  cairo_rectangle(canvas->cr, fmin(x, end), round(middle - height / 2), fabs(end - x),
                  round(height));
  cairo_fill(canvas->cr);
}

static const struct colour mean_colour = {.role = COLOUR_SERIES};
static const struct colour evenness_colour = {.role = COLOUR_COLUMN_UP};

static void draw_bars(struct canvas *canvas, const struct frame *frame, const struct bar *bars,
                      size_t count, bool divided) {
  double u = canvas->unit, slot = frame->area.height / (double)count;
  double thick = fmin(0.66 * slot, 26 * u);
  struct text_style name = chart_style_tick(), value = chart_style_tick();
  name.colour = colour_ink;
  for (size_t i = 0; i < count; i++) {
    double y = frame->area.y + ((double)i + 0.5) * slot;
    const struct bar *bar = &bars[i];
    char words[240], number[TICKS_TEXT];
    snprintf(words, sizeof words, "%.0f. %.200s", bar->rank, bar->name);
    name.max_width = frame->area.x - 26 * u;
    canvas_text(canvas, frame->area.x - 9 * u, y, 1, 0.5, words, &name);
    if (divided) {
      fill(canvas, frame, 0, bar->mean, y, thick, mean_colour);
      fill(canvas, frame, bar->mean, bar->final, y, thick, evenness_colour);
    } else {
      fill(canvas, frame, 0, bar->final, y, thick, mean_colour);
    }
    ticks_number(bar->final, 3, number);
    double end = frame_pixel(frame, (struct point){fmax(bar->final, 0), 0}).x;
    canvas_text(canvas, end + 6 * u, y, 0, 0.5, number, &value);
  }
}

/* Room for the names: that of the longest, at most two fifths of the sheet. */
static double name_room(struct canvas *canvas, const struct bar *bars, size_t count) {
  struct text_style style = chart_style_tick();
  double widest = 0, width, height;
  for (size_t i = 0; i < count; i++) {
    char words[240];
    snprintf(words, sizeof words, "%.0f. %.200s", bars[i].rank, bars[i].name);
    canvas_measure(canvas, words, &style, &width, &height);
    widest = fmax(widest, width);
  }
  return fmin(widest + 30 * canvas->unit, 0.4 * canvas->width);
}

static void draw_all(struct canvas *canvas, const struct bar *bars, size_t count, bool divided,
                     double weight, double top) {
  double u = canvas->unit;
  struct frame frame = {.x_max = 0, .y_max = 1};
  struct axes axes = {.x_label = "Final score"};
  char parts[2][120], first[TICKS_TEXT], second[TICKS_TEXT];
  ticks_plain(weight, 3, first);
  ticks_plain(1 - weight, 3, second);
  snprintf(parts[0], sizeof parts[0], "%s × mean weighted score", first);
  snprintf(parts[1], sizeof parts[1], "%s × (1 − normalised variance of the slope)", second);
  struct point dummy = {0, 0};
  const struct chart_series series[2] = {{.points = &dummy,
                                          .count = 1,
                                          .style = STYLE_COLUMNS,
                                          .colour = mean_colour,
                                          .name = parts[0]},
                                         {.points = &dummy,
                                          .count = 1,
                                          .style = STYLE_COLUMNS,
                                          .colour = evenness_colour,
                                          .name = parts[1]}};
  struct chart key = {.series = series, .series_count = divided ? 2 : 0};
  struct legend legend = legend_measure(canvas, &key, 2, canvas->width - 32 * u, 60 * u);
  frame.area.x = round(name_room(canvas, bars, count));
  legend.box.x = fmin(frame.area.x, canvas->width - 16 * u - legend.box.width);
  legend.box.y = top - 6 * u;
  top += legend.rows > 0 ? legend.box.height : 0;
  frame.area.width = canvas->width - frame.area.x - 64 * u;
  frame.area.y = top;
  double room = canvas->height - top - axes_bottom_room(canvas, &axes, frame.area.width);
  frame.area.height = fmin(room, (double)count * SLOT * u);
  for (size_t i = 0; i < count; i++) {
    frame.x_min = fmin(frame.x_min, bars[i].final);
    frame.x_max = fmax(frame.x_max, bars[i].final);
  }
  ticks_widen(&frame.x_min, &frame.x_max, axes_tick_target(canvas, frame.area.width, 90));
  axes_draw_x(canvas, &axes, &frame);
  draw_bars(canvas, &frame, bars, count, divided);
  canvas_set_colour(canvas, colour_muted);
  double zero = frame_pixel(&frame, (struct point){0, 0}).x;
  canvas_line(canvas, zero, frame.area.y, zero, frame.area.y + frame.area.height, 1);
  if (legend.rows > 0) {
    legend_draw(canvas, &key, &legend);
  }
}

enum status draw_ranking(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error) {
  (void)count;
  (void)error;
  const json_t *result = inputs[0].result;
  struct bar bars[BEST];
  double weight;
  bool divided;
  char subtitle[DATA_HEADING];
  size_t shown = read_bars(result, bars, &weight, &divided);
  size_t ranked = json_array_size(ranking_list(result));
  members_subtitle(&inputs[0], json_array_size(json_object_get(result, "members")), subtitle);
  double top = chart_heading_height(canvas, subtitle, NULL);
  char title[80];
  snprintf(title, sizeof title, ranked > shown ? "The best %zu designs" : "Ranking of the designs",
           shown);
  chart_heading(canvas, 16 * canvas->unit, title, subtitle, NULL);
  if (shown > 0) {
    draw_all(canvas, bars, shown, divided, weight, top);
  } else {
    struct text_style style = chart_style_label();
    style.colour = colour_muted;
    canvas_text(canvas, canvas->width / 2.0, canvas->height / 2.0, 0.5, 0.5,
                "No design has a score", &style);
  }
  return STATUS_OK;
}
