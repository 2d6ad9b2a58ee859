#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/cloud.h"
#include "server/plot/study_columns.h"
#include "server/plot/study_dots.h"
#include "server/plot/study_draw.h"

/* Of more lines than LINES_FINE, 2 x 2 pixels are one. */
enum { AXES_MOST = 12, LINES_FINE = 3000 };

/* One upright axis. */
struct rail {
  struct study_axis axis;
  double low, high; /* positions at its ends */
  double x;         /* pixels */
};

struct rails {
  struct rail rail[AXES_MOST];
  size_t count;
  double top, bottom;
};

static void set_range(struct rail *rail, const struct rails *rails, const struct canvas *canvas) {
  const struct study_column *column = rail->axis.column;
  rail->low = rail->axis.low;
  rail->high = rail->axis.high;
  if (column->categorical) {
    rail->low = -0.5;
    rail->high = (double)(column->word_count > 0 ? column->word_count : 1) - 0.5;
    return;
  }
  int target = axes_tick_target(canvas, rails->bottom - rails->top, 60);
  if (!(rail->low <= rail->high)) {
    rail->low = rail->high = 0;
  }
  (rail->axis.logarithmic ? ticks_widen_log : ticks_widen)(&rail->low, &rail->high, target);
}

static double rail_y(const struct rails *rails, const struct rail *rail, double position) {
  double part = (position - rail->low) / (rail->high - rail->low);
  return rails->bottom - part * (rails->bottom - rails->top);
}

/* Words at a tick, on a ground of paper so that lines do not run through them. */
static void draw_text(struct canvas *canvas, double x, double y, double room, const char *text) {
  struct text_style style = chart_style_tick();
  double width, height, u = canvas->unit;
  style.colour = colour_ink;
  style.size = 11;
  style.max_width = room;
  canvas_measure(canvas, text, &style, &width, &height);
  canvas_set_glaze(canvas, colour_paper, 0.78);
  cairo_rectangle(canvas->cr, x + 5 * u, y - height / 2, width + 4 * u, height);
  cairo_fill(canvas->cr);
  canvas_text(canvas, x + 7 * u, y, 0, 0.5, text, &style);
}

static void draw_scale(struct canvas *canvas, const struct rails *rails, const struct rail *rail,
                       double room) {
  double u = canvas->unit;
  const struct study_column *column = rail->axis.column;
  int target = axes_tick_target(canvas, rails->bottom - rails->top, 60);
  struct ticks ticks =
      (rail->axis.logarithmic ? ticks_make_log : ticks_make)(rail->low, rail->high, target);
  int count = column->categorical ? (int)column->word_count : ticks.count;
  int stride = column->categorical ? count / 24 + 1 : 1;
  canvas_set_colour(canvas, colour_ink);
  canvas_line(canvas, rail->x, rails->top, rail->x, rails->bottom, 1.4);
  for (int i = 0; i < count; i += stride) {
    char number[TICKS_TEXT];
    const char *text = number;
    double position = column->categorical ? i : ticks_value(&ticks, i);
    double y = rail_y(rails, rail, position);
    if (column->categorical) {
      text = column->words[i];
    } else {
      ticks_label(&ticks, i, number);
    }
    canvas_set_colour(canvas, colour_ink);
    canvas_line(canvas, rail->x, y, rail->x + 4 * u, y, 1.2);
    draw_text(canvas, rail->x, y, room, text);
  }
}

/* The name of an axis above it, on two lines with its unit, and if need be on a slant. */
static void draw_name(struct canvas *canvas, const struct rails *rails, const struct rail *rail,
                      double gap, bool slanted) {
  char label[STUDY_LABEL];
  double u = canvas->unit;
  struct text_style style = chart_style_tick();
  style.colour = colour_ink;
  style.bold = rail->axis.metric;
  study_axis_label(&rail->axis, label);
  if (slanted) {
    style.max_width = 78 * u / sin(0.5);
    style.max_width = fmin(style.max_width, (canvas->width - rail->x - 4 * u) / cos(0.5));
    canvas_text_turned(canvas, rail->x, rails->top - 8 * u, -0.5, 0, 1, label, &style);
  } else {
    style.max_width = gap - 8 * u;
    canvas_text(canvas, rail->x, rails->top - 8 * u, 0, 1, label, &style);
  }
}

/* Whether all names fit beside each other. */
static bool names_fit(struct canvas *canvas, const struct rails *rails, double gap) {
  bool fit = true;
  struct text_style style = chart_style_tick();
  for (size_t i = 0; i < rails->count; i++) {
    char label[STUDY_LABEL];
    double width, height;
    style.bold = rails->rail[i].axis.metric;
    study_axis_label(&rails->rail[i].axis, label);
    canvas_measure(canvas, label, &style, &width, &height);
    fit = fit && width < gap - 8 * canvas->unit;
  }
  return fit;
}

/* A place on a categorical axis is spread, so that lines to one word do not all meet in a point. */
static double spread(const struct rail *rail, size_t row) {
  return rail->axis.column->categorical
             ? 0.5 * ((double)((row * 2654435761u >> 8) % 1024) / 1023 - 0.5)
             : 0;
}

/* The lines of the members between two axes. One that failed outweighs those that it crosses. */
static size_t make_lines(const struct rails *rails, size_t left, const struct rgb *colours,
                         struct cloud_line *lines) {
  const struct rail *a = &rails->rail[left], *b = a + 1;
  const struct study_table *table = a->axis.table;
  float heavy = 4 + (float)(table->members / 400);
  size_t count = 0;
  for (size_t row = 0; row < table->members; row++) {
    double from = study_axis_at(&a->axis, row), to = study_axis_at(&b->axis, row);
    bool solved = study_row_counts(table, row);
    if (isnan(from) || isnan(to) || !(solved || study_row_failed(table, row))) {
      continue;
    }
    struct rgb c = colours[row];
    lines[count++] = (struct cloud_line){.from = (float)rail_y(rails, a, from + spread(a, row)),
                                         .to = (float)rail_y(rails, b, to + spread(b, row)),
                                         .r = (float)c.r,
                                         .g = (float)c.g,
                                         .b = (float)c.b,
                                         .weight = solved ? 1 : heavy};
  }
  return count;
}

/* Draws all members; those that failed end where an axis is a metric. */
static enum status draw_lines(struct canvas *canvas, const struct rails *rails,
                              const struct study_dots *dots, struct error *error) {
  const struct study_table *table = rails->rail[0].axis.table;
  size_t members = table->members, most = 0;
  struct box area = {rails->rail[0].x, rails->top - 2,
                     rails->rail[rails->count - 1].x - rails->rail[0].x,
                     rails->bottom - rails->top + 4};
  struct cloud *cloud = cloud_create(canvas, area, members > LINES_FINE);
  struct cloud_line *lines = malloc((members + 1) * sizeof *lines);
  struct rgb *colours = malloc((members + 1) * sizeof *colours);
  enum status status = STATUS_OK;
  if (!cloud || !lines || !colours) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
    goto done;
  }
  for (size_t row = 0; row < members; row++) {
    bool failed = study_row_failed(table, row);
    struct colour colour = failed ? colour_notice : study_dots_colour(dots, row);
    colours[row] = colour_rgb(colour, canvas->theme);
  }
  for (size_t i = 0; i + 1 < rails->count; i++) {
    size_t count = make_lines(rails, i, colours, lines);
    most = count > most ? count : most;
    cloud_lines(cloud, rails->rail[i].x, rails->rail[i + 1].x, lines, count, 1.3 * canvas->unit);
  }
  if (most > 0) {
    cloud_paint(cloud, canvas, cloud_opacity(most));
    canvas->busy = canvas->busy || most > LINES_FINE;
  }
done:
  cloud_destroy(cloud);
  free(lines);
  free(colours);
  return status;
}

static enum status draw_rails(struct study_panel *panel, struct canvas *canvas, struct rails *rails,
                              struct study_dots *dots, struct error *error) {
  double u = canvas->unit, left = 26 * u;
  double right =
      canvas->width - (panel->bar.label ? chart_bar_room(canvas, &panel->bar) + 72 * u : 96 * u);
  double gap = rails->count > 1 ? (right - left) / (double)(rails->count - 1) : right - left;
  bool slanted = !names_fit(canvas, rails, gap);
  rails->top =
      chart_heading_height(canvas, panel->subtitle, panel->notice) + (slanted ? 92 : 34) * u;
  rails->bottom = canvas->height - 24 * u;
  for (size_t i = 0; i < rails->count; i++) {
    rails->rail[i].x = round(left + (double)i * gap);
    set_range(&rails->rail[i], rails, canvas);
  }
  enum status status = draw_lines(canvas, rails, dots, error);
  for (size_t i = 0; i < rails->count; i++) {
    draw_scale(canvas, rails, &rails->rail[i], fmin(gap - 12 * u, 84 * u));
    draw_name(canvas, rails, &rails->rail[i], gap, slanted);
  }
  if (panel->bar.label) {
    struct box area = {left, rails->top, canvas->width - 8 * u - left, rails->bottom - rails->top};
    chart_bar(canvas, &panel->bar, area);
  }
  chart_heading(canvas, 16 * u, panel->title, panel->subtitle, panel->notice);
  return status;
}

enum status study_draw_parallel(struct canvas *canvas, const struct study_plot_input *input,
                                const struct study_plot_options *options, struct error *error) {
  const struct study_table *table = input->table;
  struct study_panel panel = {.title = "All members over all parameters"};
  struct study_axis axes[AXES_MOST], colour;
  struct study_dots dots;
  size_t count = 0;
  study_panel_words(&panel, table);
  enum status status = study_axis_choose_metric(table, options->metric, &colour, error);
  if (status == STATUS_OK && options->colour) {
    status = study_axis_find(table, options->colour, &colour, error);
  }
  if (status == STATUS_OK) {
    status = study_columns(table, options->columns, &colour, AXES_MOST, axes, &count, error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  if (table->members == 0 || count < 2) {
    study_panel_empty(&panel, canvas,
                      table->members == 0 ? "No member has been solved yet"
                                          : "Fewer than two columns vary");
    return STATUS_OK;
  }
  study_dots_make(table, &colour, false, &dots);
  panel.bar = dots.bar;
  struct rails *rails = calloc(1, sizeof *rails);
  if (!rails) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  rails->count = count;
  for (size_t i = 0; i < count; i++) {
    rails->rail[i].axis = axes[i];
  }
  if (*panel.notice) {
    size_t used = strlen(panel.notice);
    snprintf(panel.notice + used, sizeof panel.notice - used,
             "; their lines, of this colour, end before the metrics");
  }
  snprintf(panel.title, sizeof panel.title, "Members over %zu axes", count);
  if (colour.table) {
    snprintf(panel.title, sizeof panel.title, "Members over %zu axes, coloured by %.150s", count,
             colour.column->title);
  }
  status = draw_rails(&panel, canvas, rails, &dots, error);
  free(rails);
  return status;
}
