#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/cloud.h"
#include "server/plot/study_columns.h"
#include "server/plot/study_dots.h"
#include "server/plot/study_draw.h"

enum { SIDE_MOST = 7, BINS = 16 };

/* A square of charts: dots below the diagonal, histograms on it, correlations above. */
struct matrix {
  struct study_axis axis[SIDE_MOST];
  double low[SIDE_MOST], high[SIDE_MOST]; /* of the charts, a little more than the data */
  size_t count;
  double left, top, width, height, gap; /* of the whole and of one chart, pixels */
  struct study_dots dots;
};

static struct frame frame_of(const struct matrix *m, size_t column, size_t row) {
  return (struct frame){.area = {round(m->left + (double)column * (m->width + m->gap)),
                                 round(m->top + (double)row * (m->height + m->gap)),
                                 round(m->width), round(m->height)},
                        .x_min = m->low[column],
                        .x_max = m->high[column],
                        .y_min = m->low[row],
                        .y_max = m->high[row]};
}

static void outline(struct canvas *canvas, const struct box *a) {
  canvas_set_colour(canvas, colour_edge);
  canvas_line(canvas, a->x, a->y + a->height, a->x + a->width, a->y + a->height, 1);
  canvas_line(canvas, a->x, a->y, a->x, a->y + a->height, 1);
}

/* How many of the numbers (rows that count) are in each part of the range. */
static void draw_histogram(struct canvas *canvas, const struct matrix *m, size_t k) {
  struct frame frame = frame_of(m, k, k);
  const struct study_axis *axis = &m->axis[k];
  size_t bins[BINS] = {0}, most = 1;
  size_t words = axis->column->categorical ? axis->column->word_count : 0;
  size_t count = words > 0 && words < BINS ? words : BINS;
  for (size_t row = 0; row < axis->table->members; row++) {
    double at = study_row_counts(axis->table, row) ? study_axis_at(axis, row) : NAN;
    double part = study_axis_part(axis, at);
    if (!isnan(part)) {
      size_t bin = (size_t)fmin(part * (double)count, (double)count - 1);
      most = ++bins[bin] > most ? bins[bin] : most;
    }
  }
  double room = frame.area.height - 20 * canvas->unit;
  double from = frame_pixel(&frame, (struct point){axis->low, 0}).x;
  double step = (frame_pixel(&frame, (struct point){axis->high, 0}).x - from) / (double)count;
  canvas_set_colour(canvas, colour_column);
  for (size_t i = 0; i < count && axis->varies; i++) {
    double height = fmax(room, 4) * (double)bins[i] / (double)most;
    double x = round(from + (double)i * step), end = round(from + (double)(i + 1) * step);
    cairo_rectangle(canvas->cr, x, frame.area.y + frame.area.height - height, fmax(end - x - 1, 1),
                    height);
  }
  cairo_fill(canvas->cr);
  outline(canvas, &frame.area);
}

/* The name of a column above its histogram. */
static void draw_name(struct canvas *canvas, const struct matrix *m, size_t k) {
  struct frame frame = frame_of(m, k, k);
  char label[STUDY_LABEL];
  struct text_style style = {.size = 11, .bold = 1, .colour = colour_ink};
  study_axis_label(&m->axis[k], label);
  /* the last one has no room on its right, the others that above the correlations */
  double more = k + 1 < m->count ? 0.4 * frame.area.width : 0;
  style.max_width = frame.area.width + more - 4 * canvas->unit;
  canvas_text(canvas, frame.area.x + 3 * canvas->unit, frame.area.y - 2, 0, 0, label, &style);
}

/* Pearson's correlation of the positions of the rows that have both; NaN for fewer than three. */
static double correlation(const struct study_axis *a, const struct study_axis *b) {
  double sum[5] = {0}, count = 0;
  for (size_t row = 0; row < a->table->members; row++) {
    double x = study_axis_part(a, study_axis_at(a, row)) - 0.5;
    double y = study_axis_part(b, study_axis_at(b, row)) - 0.5;
    if (isnan(x) || isnan(y) || !study_row_counts(a->table, row)) {
      continue;
    }
    const double term[5] = {x, y, x * x, y * y, x * y};
    for (int k = 0; k < 5; k++) {
      sum[k] += term[k];
    }
    count++;
  }
  double xx = sum[2] - sum[0] * sum[0] / count, yy = sum[3] - sum[1] * sum[1] / count;
  double xy = sum[4] - sum[0] * sum[1] / count;
  return count < 3 ? NAN : xx > 1e-12 && yy > 1e-12 ? xy / sqrt(xx * yy) : NAN;
}

/* A disc whose area is the size of the correlation, and its number. */
static void draw_correlation(struct canvas *canvas, const struct matrix *m, size_t column,
                             size_t row) {
  struct frame frame = frame_of(m, column, row);
  const struct study_axis *a = &m->axis[column], *b = &m->axis[row];
  struct text_style style = {.size = 12, .colour = colour_ink};
  struct point middle = {frame.area.x + frame.area.width / 2, frame.area.y + frame.area.height / 2};
  char text[TICKS_TEXT + 8] = "n/a";
  /* of words an order means nothing, but for two of them */
  bool ordered = (!a->column->categorical || a->column->word_count == 2) &&
                 (!b->column->categorical || b->column->word_count == 2);
  double r = ordered ? correlation(a, b) : NAN;
  if (!isnan(r)) {
    double most = 0.46 * fmin(frame.area.width, frame.area.height);
    cairo_arc(canvas->cr, middle.x, middle.y, most * sqrt(fabs(r)), 0, 2 * G_PI);
    canvas_set_colour(canvas, colour_fade(colour_series(r < 0), 0.62));
    cairo_fill(canvas->cr);
    ticks_number(round(r * 100) / 100 + 0.0, fabs(r) >= 0.995 ? 3 : 2, text);
    snprintf(text, sizeof text, "%s%.2f", r < -0.005 ? "\u2212" : "", fabs(r));
  } else {
    style.colour = colour_muted;
  }
  canvas_text(canvas, middle.x, middle.y, 0.5, 0.5, text, &style);
}

static struct ticks few_ticks(const struct canvas *canvas, const struct matrix *m, size_t k,
                              double length) {
  int target = length < 90 * canvas->unit ? 2 : 3;
  double low = m->axis[k].low, high = m->axis[k].high;
  high = high > low ? high : low + 1;
  return (m->axis[k].logarithmic ? ticks_make_log : ticks_make)(low, high, target);
}

/* Numbers below the last row and left of the first column. */
static void draw_scales(struct canvas *canvas, const struct matrix *m, size_t k) {
  double u = canvas->unit;
  struct frame below = frame_of(m, k, m->count - 1), beside = frame_of(m, 0, k);
  struct text_style style = {.size = 10, .colour = colour_muted};
  struct ticks ticks = few_ticks(canvas, m, k, m->width);
  const struct study_column *column = m->axis[k].column;
  int count = column->categorical ? (int)column->word_count : ticks.count;
  double reached = -INFINITY; /* right end of the last number below */
  for (int i = 0; i < count; i++) {
    char number[TICKS_TEXT];
    const char *text = number;
    double at = column->categorical ? i : ticks_value(&ticks, i);
    if (column->categorical) {
      text = column->words[i];
    } else {
      ticks_label(&ticks, i, number);
    }
    double x = frame_pixel(&below, (struct point){at, 0}).x;
    double y = frame_pixel(&beside, (struct point){0, at}).y;
    double bottom = below.area.y + below.area.height;
    double place = column->categorical ? m->width / fmax(count, 1) : m->width / 1.6;
    style.max_width = place - 2 * u;
    canvas_set_colour(canvas, colour_muted);
    canvas_line(canvas, x, bottom, x, bottom + 3 * u, 1);
    double width, height;
    canvas_measure(canvas, text, &style, &width, &height);
    if (place > 16 * u && x - width / 2 > reached) {
      reached = x + width / 2 + 5 * u;
      canvas_text(canvas, x, bottom + 4 * u, 0.5, 0, text, &style);
    }
    if (k > 0) {
      canvas_line(canvas, beside.area.x - 3 * u, y, beside.area.x, y, 1);
      style.max_width = m->left - 8 * u;
      canvas_text(canvas, beside.area.x - 5 * u, y, 1, 0.5, text, &style);
    }
  }
}

/* All dots of the matrix in one cloud; crosses would drown, failed members lie on the lower edge.
 */
static enum status draw_dots(struct canvas *canvas, const struct matrix *m, struct error *error) {
  size_t members = m->axis[0].table->members;
  struct box area = {m->left, m->top, canvas->width - m->left, canvas->height - m->top};
  struct cloud *cloud = cloud_create(canvas, area, false);
  double *at = malloc((m->count + 1) * sizeof *at);
  if (!cloud || !at) {
    cloud_destroy(cloud);
    free(at);
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  double radius = (members > 2000 ? 1.0 : members > 300 ? 1.5 : 2.1) * canvas->unit;
  for (size_t row = 0; row < members; row++) {
    bool failed = study_row_failed(m->axis[0].table, row);
    struct rgb c =
        colour_rgb(failed ? colour_notice : study_dots_colour(&m->dots, row), canvas->theme);
    if (!failed && !study_row_counts(m->axis[0].table, row)) {
      continue;
    }
    for (size_t k = 0; k < m->count; k++) {
      at[k] = study_axis_at(&m->axis[k], row);
      at[k] = isnan(at[k]) && failed ? m->low[k] : at[k];
    }
    for (size_t j = 1; j < m->count; j++) {
      for (size_t i = 0; i < j; i++) {
        struct frame frame = frame_of(m, i, j);
        struct point p = frame_pixel(&frame, (struct point){at[i], at[j]});
        cloud_dot(cloud, p.x, p.y, radius, c);
      }
    }
  }
  cloud_paint(cloud, canvas, fmax(cloud_opacity(members), 0.35));
  cloud_destroy(cloud);
  free(at);
  return STATUS_OK;
}

static void lay_out(struct matrix *m, const struct study_panel *panel, struct canvas *canvas) {
  double u = canvas->unit;
  m->left = 56 * u;
  m->top = chart_heading_height(canvas, panel->subtitle, panel->notice) + 2 * u;
  m->gap = 8 * u;
  double right = panel->bar.label ? chart_bar_room(canvas, &panel->bar) + 4 * u : 16 * u;
  double n = (double)m->count;
  m->width = (canvas->width - right - m->left - (n - 1) * m->gap) / n;
  m->height = (canvas->height - 26 * u - m->top - (n - 1) * m->gap) / n;
  for (size_t k = 0; k < m->count; k++) {
    double range = m->axis[k].high - m->axis[k].low;
    double spare = range > 0 ? 0.07 * range : 0.5;
    spare = m->axis[k].column->categorical ? 0.5 : spare;
    m->low[k] = m->axis[k].low - spare;
    m->high[k] = m->axis[k].high + spare;
  }
}

static enum status draw_matrix(struct canvas *canvas, struct matrix *m, struct study_panel *panel,
                               struct error *error) {
  lay_out(m, panel, canvas);
  for (size_t row = 0; row < m->count; row++) {
    for (size_t column = 0; column < m->count; column++) {
      if (column < row) {
        struct frame frame = frame_of(m, column, row);
        outline(canvas, &frame.area);
      } else if (column > row) {
        draw_correlation(canvas, m, column, row);
      }
    }
    draw_histogram(canvas, m, row);
    draw_scales(canvas, m, row);
  }
  enum status status = draw_dots(canvas, m, error);
  for (size_t k = 0; k < m->count; k++) {
    draw_name(canvas, m, k);
  }
  if (panel->bar.label) {
    chart_bar(canvas, &panel->bar,
              (struct box){m->left, m->top, canvas->width - 8 * canvas->unit - m->left,
                           canvas->height - 26 * canvas->unit - m->top});
  }
  chart_heading(canvas, 16 * canvas->unit, panel->title, panel->subtitle, panel->notice);
  return status;
}

enum status study_draw_scatter(struct canvas *canvas, const struct study_plot_input *input,
                               const struct study_plot_options *options, struct error *error) {
  const struct study_table *table = input->table;
  struct study_panel panel = {.title = "Each column over each other"};
  struct study_axis colour;
  study_panel_words(&panel, table);
  struct matrix *m = calloc(1, sizeof *m);
  enum status status = m ? study_axis_choose_metric(table, options->metric, &colour, error)
                         : error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out");
  if (status == STATUS_OK && options->colour) {
    status = study_axis_find(table, options->colour, &colour, error);
  }
  if (status == STATUS_OK) {
    status = study_columns(table, options->columns, &colour, SIDE_MOST, m->axis, &m->count, error);
  }
  bool solved = false;
  for (size_t k = 0; m && k < m->count && status == STATUS_OK; k++) {
    solved = solved || (m->axis[k].metric && m->axis[k].low <= m->axis[k].high);
  }
  if (status == STATUS_OK && (m->count < 2 || !solved)) {
    study_panel_empty(&panel, canvas,
                      !solved ? "No member has been solved yet" : "Fewer than two columns vary");
  } else if (status == STATUS_OK) {
    study_dots_make(table, &colour, false, &m->dots);
    panel.bar = m->dots.bar;
    snprintf(panel.title, sizeof panel.title, "Pairs of columns, distributions, correlations");
    status = draw_matrix(canvas, m, &panel, error);
  }
  free(m);
  return status;
}
