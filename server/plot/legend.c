#include "server/plot/legend.h"

#include <math.h>
#include <stdio.h>

#include "server/plot/series.h"

/* Design units: line sample, its distance from the words, border, height of a line. */
enum { SAMPLE = 28, GAP = 8, PAD = 7, LINE = 19 };

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
  struct legend legend = {.columns = columns, .complete = true};
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
  legend.complete = count == legend.shown && full <= max_width;
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
  series_draw_sample(canvas, series, x, y, SAMPLE * u);
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
