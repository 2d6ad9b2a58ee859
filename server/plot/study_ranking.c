#include <math.h>
#include <stdio.h>

#include "server/plot/study_bars.h"
#include "server/plot/study_draw.h"

enum { PARTS_MOST = 8 };

/* Colours of parts that touch alternate in lightness, so that they differ without colour, too. */
static struct colour part_colour(size_t part) {
  return part % 2 ? colour_fade(colour_series(part / 2), 0.55) : colour_series(part / 2);
}

static void draw_row(struct canvas *canvas, const struct frame *frame,
                     const struct study_ranking *ranking, size_t row, double score) {
  double above = 0, below = 0;
  struct text_style style = chart_style_tick();
  char text[TICKS_TEXT];
  for (size_t k = 0; k < ranking->parts; k++) {
    double part = ranking->part[row * ranking->parts + k];
    double *end = part < 0 ? &below : &above;
    if (isfinite(part)) {
      study_bars_fill(canvas, frame, (double)row, 0.66, *end, *end + part, part_colour(k));
      *end += part;
    }
  }
  ticks_number(score, 3, text);
  struct point p = frame_pixel(frame, (struct point){above, (double)row});
  canvas_text(canvas, p.x + 6 * canvas->unit, p.y, 0, 0.5, text, &style);
}

enum status study_draw_ranking(struct canvas *canvas, const struct study_plot_input *input,
                               const struct study_plot_options *options, struct error *error) {
  const struct study_ranking *ranking = input->ranking;
  const struct point dummy = {0, 0};
  struct chart_series key[PARTS_MOST] = {{0}};
  char names[STUDY_BARS][STUDY_LABEL];
  struct study_bars bars = {.count = ranking->count < STUDY_BARS ? ranking->count : STUDY_BARS};
  struct study_panel panel = {
      .axes = {.x_label = ranking->score && *ranking->score ? ranking->score : "Score"},
      .key = key};
  double score[STUDY_BARS];
  (void)options;
  (void)error;
  study_panel_words(&panel, input->table);
  snprintf(panel.title, sizeof panel.title,
           ranking->ranked > bars.count ? "The best %zu designs" : "Ranking of the designs",
           bars.count);
  if (bars.count == 0) {
    study_panel_empty(&panel, canvas, "No design has a score");
    return STATUS_OK;
  }
  for (size_t k = 0; k < ranking->parts && k < PARTS_MOST; k++) {
    key[panel.key_count++] = (struct chart_series){.points = &dummy,
                                                   .count = 1,
                                                   .style = STYLE_COLUMNS,
                                                   .colour = part_colour(k),
                                                   .name = ranking->part_name[k]};
  }
  for (size_t i = 0; i < bars.count; i++) {
    double above = 0, below = 0;
    for (size_t k = 0; k < ranking->parts; k++) {
      double part = ranking->part[i * ranking->parts + k];
      above += isfinite(part) ? fmax(part, 0) : 0;
      below += isfinite(part) ? fmin(part, 0) : 0;
    }
    score[i] = above + below;
    panel.frame.x_max = fmax(panel.frame.x_max, above);
    panel.frame.x_min = fmin(panel.frame.x_min, below);
    snprintf(names[i], sizeof names[i], "%zu. %.170s", i + 1, ranking->name[i]);
    bars.name[i] = names[i];
  }
  study_bars_begin(&bars, &panel, canvas);
  for (size_t i = 0; i < bars.count; i++) {
    draw_row(canvas, &panel.frame, ranking, i, score[i]);
  }
  study_bars_zero(&panel, canvas);
  return STATUS_OK;
}
