#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/plot/study_draw.h"
#include "server/plot/study_panel.h"

/* The positions that the cells stand for. */
struct centres {
  double x[STUDY_CELLS], y[STUDY_CELLS];
};

static size_t set_centres(const struct study_axis *axis, double centre[STUDY_CELLS]) {
  enum { FREE = 5 };
  double values[STUDY_VALUES];
  size_t count = study_axis_values(axis, values);
  if (count > 0 && count <= STUDY_CELLS) {
    for (size_t i = 0; i < count; i++) {
      centre[i] = values[i];
    }
    return count;
  }
  for (size_t i = 0; i < FREE; i++) {
    centre[i] = axis->low + (axis->high - axis->low) * ((double)i + 0.5) / FREE;
  }
  return FREE;
}

/* The member nearest to each cell, in parts of the cells; none that is in another one. */
static void choose_rows(const struct study_axis *x, const struct study_axis *y,
                        const struct centres *centres, struct study_cells *cells) {
  double best[STUDY_CELLS * STUDY_CELLS];
  for (size_t k = 0; k < cells->columns * cells->rows; k++) {
    best[k] = INFINITY;
    cells->row[k] = SIZE_MAX;
  }
  double wide = cells->columns > 1 ? (x->high - x->low) / (double)cells->columns : 1;
  double high = cells->rows > 1 ? (y->high - y->low) / (double)cells->rows : 1;
  for (size_t row = 0; row < x->table->members; row++) {
    double ax = study_axis_at(x, row), ay = study_axis_at(y, row);
    size_t i = 0, j = 0;
    if (isnan(ax) || isnan(ay)) {
      continue;
    }
    for (size_t k = 1; k < cells->columns; k++) {
      i = fabs(centres->x[k] - ax) < fabs(centres->x[i] - ax) ? k : i;
    }
    for (size_t k = 1; k < cells->rows; k++) {
      j = fabs(centres->y[k] - ay) < fabs(centres->y[j] - ay) ? k : j;
    }
    double far = hypot((ax - centres->x[i]) / wide, (ay - centres->y[j]) / high);
    /* any that is solved before one that failed */
    far += study_row_counts(x->table, row) ? 0 : 10;
    if (far < best[j * cells->columns + i]) {
      best[j * cells->columns + i] = far;
      cells->row[j * cells->columns + i] = row;
    }
  }
}

/* The axes and the positions of their cells; x.table or y.table NULL: there are no two. */
static enum status find_axes(const struct study_table *table,
                             const struct study_plot_options *options, struct study_axis *x,
                             struct study_axis *y, struct error *error) {
  enum status status = study_axis_choose_parameter(table, options->x, NULL, false, x, error);
  return status == STATUS_OK ? study_axis_choose_parameter(table, options->y, x, false, y, error)
                             : status;
}

static void find_cells(const struct study_axis *x, const struct study_axis *y,
                       struct centres *centres, struct study_cells *cells) {
  *cells = (struct study_cells){.x = x->index,
                                .y = y->index,
                                .columns = set_centres(x, centres->x),
                                .rows = set_centres(y, centres->y)};
  choose_rows(x, y, centres, cells);
}

enum status study_plot_cells(const struct study_table *table,
                             const struct study_plot_options *options, struct study_cells *cells,
                             struct error *error) {
  struct study_axis x, y;
  struct centres centres;
  enum status status = find_axes(table, options, &x, &y, error);
  if (status == STATUS_OK && (!x.table || !y.table)) {
    status =
        error_set(error, STATUS_NOT_FOUND, NULL, "fewer than two parameters of this study vary");
  }
  if (status == STATUS_OK) {
    find_cells(&x, &y, &centres, cells);
  }
  return status;
}

/* What fits all bodies into one cell at the same scale. */
struct fit {
  double left, right, bottom, top; /* mm */
  double scale;                    /* pixels a mm */
};

static const struct study_shape *shape_of(const struct study_plot_input *input, size_t row) {
  for (size_t i = 0; i < input->shape_count; i++) {
    if (input->shapes[i].row == row && input->shapes[i].count > 1) {
      return &input->shapes[i];
    }
  }
  return NULL;
}

static void widen(struct fit *fit, const struct study_shape *shape) {
  for (size_t i = 0; i < shape->count; i++) {
    double x = shape->line[2 * i], z = shape->line[2 * i + 1];
    if (isfinite(x) && isfinite(z)) {
      fit->left = fmin(fit->left, x);
      fit->right = fmax(fit->right, x);
      fit->bottom = fmin(fit->bottom, z);
      fit->top = fmax(fit->top, z);
    }
  }
}

static struct fit find_fit(const struct study_plot_input *input, double width, double height) {
  struct fit fit = {.left = 0, .right = 1e-6, .bottom = 0, .top = 1e-6};
  for (size_t i = 0; i < input->shape_count; i++) {
    widen(&fit, &input->shapes[i]);
  }
  fit.scale = fmin(width / (fit.right - fit.left), height / (fit.top - fit.bottom));
  return fit;
}

static void draw_body(struct canvas *canvas, const struct fit *fit, struct box box,
                      const struct study_shape *shape, struct colour colour) {
  double x0 =
      box.x + (box.width - fit->scale * (fit->right - fit->left)) / 2 - fit->scale * fit->left;
  double y0 =
      box.y + (box.height - fit->scale * (fit->top - fit->bottom)) / 2 + fit->scale * fit->top;
  double thick =
      fmin(fmax(0.045 * fmin(box.width, box.height), 1.5 * canvas->unit), 6 * canvas->unit);
  for (size_t i = 0; i < shape->count; i++) {
    double x = shape->line[2 * i], z = shape->line[2 * i + 1];
    if (isfinite(x) && isfinite(z)) {
      cairo_line_to(canvas->cr, x0 + fit->scale * x, y0 - fit->scale * z);
    }
  }
  canvas_set_colour(canvas, colour);
  cairo_set_line_width(canvas->cr, thick);
  cairo_set_line_join(canvas->cr, CAIRO_LINE_JOIN_ROUND);
  cairo_stroke(canvas->cr);
  /* the wall that holds the base */
  double wall = fmin(5 * canvas->unit, 0.2 * box.height);
  canvas_set_colour(canvas, colour_muted);
  canvas_line(canvas, x0, y0 - wall, x0, y0 + wall, 2);
}

/* A cell: the body and the metric, or why there is none. */
static void draw_cell(struct canvas *canvas, const struct study_plot_input *input,
                      const struct study_panel *panel, const struct study_axis *metric,
                      const struct fit *fit, struct box box, size_t row) {
  double u = canvas->unit;
  struct text_style style = {.size = 11, .colour = colour_muted, .max_width = box.width - 6 * u};
  const struct study_shape *shape = row == SIZE_MAX ? NULL : shape_of(input, row);
  double value = metric->table && row != SIZE_MAX ? study_axis_at(metric, row) : NAN;
  char text[STUDY_LABEL] = "";
  cairo_rectangle(canvas->cr, box.x, box.y, box.width, box.height);
  canvas_set_colour(canvas, colour_fade(colour_shade, 0.35));
  cairo_fill(canvas->cr);
  if (row == SIZE_MAX) {
    return;
  }
  bool failed = study_row_failed(input->table, row);
  if (!isnan(value)) {
    double size = pow(10, floor(log10(fmax(fabs(value), 1e-9))) - 2);
    study_axis_text(metric, round(value / size) * size, true, text);
  } else {
    snprintf(text, sizeof text, "%s", failed ? "failed" : "not solved yet");
  }
  style.colour = failed ? colour_notice : colour_ink;
  canvas_text(canvas, box.x + box.width - 3 * u, box.y + box.height - 1 * u, 1, 1, text, &style);
  if (shape) {
    double words = 14 * u;
    box.height -= words;
    draw_body(canvas, fit, box, shape,
              panel->bar.label ? chart_bar_colour(&panel->bar, value) : colour_series(0));
  }
}

/* Words for the cells along one axis. */
static void name_cells(const struct study_axis *axis, const double *centre, size_t count,
                       char text[STUDY_CELLS][STUDY_LABEL], const char *name[STUDY_CELLS]) {
  for (size_t i = 0; i < count; i++) {
    double rounded = centre[i];
    if (!axis->column->categorical && !axis->logarithmic) {
      double digit = pow(10, floor(log10(fmax(axis->high - axis->low, 1e-9))) - 2);
      rounded = round(rounded / digit) * digit;
    }
    study_axis_text(axis, rounded, false, text[i]);
    name[i] = text[i];
  }
}

/* The bar that says how long things are, right below the bar of colours. */
static void draw_scale(struct canvas *canvas, const struct box *area, const struct fit *fit) {
  double u = canvas->unit, left = area->x + area->width + 18 * u;
  double room = canvas->width - 12 * u - left, y = area->y + area->height + 24 * u;
  if (room < 30 * u || !(fit->scale > 0) || !isfinite(fit->scale)) {
    return;
  }
  struct ticks ticks = ticks_make(0, room / fit->scale, 2);
  double length = ticks.step * fit->scale;
  char number[TICKS_TEXT], text[TICKS_TEXT + 8];
  struct text_style style = chart_style_tick();
  if (length > room) {
    return;
  }
  ticks_plain(ticks.step, 3, number);
  snprintf(text, sizeof text, "%s mm", number);
  canvas_set_colour(canvas, colour_ink);
  canvas_line(canvas, left, y, left + length, y, 2);
  canvas_line(canvas, left, y - 4 * u, left, y + 4 * u, 1.4);
  canvas_line(canvas, left + length, y - 4 * u, left + length, y + 4 * u, 1.4);
  canvas_text(canvas, left, y + 5 * u, 0, 0, text, &style);
}

static void draw_cells(struct canvas *canvas, const struct study_plot_input *input,
                       struct study_panel *panel, const struct study_axis axes[3],
                       const struct study_cells *cells, const struct centres *centres) {
  char texts[2][STUDY_CELLS][STUDY_LABEL], labels[3][STUDY_LABEL];
  const char *names[2][STUDY_CELLS];
  name_cells(&axes[0], centres->x, cells->columns, texts[0], names[0]);
  name_cells(&axes[1], centres->y, cells->rows, texts[1], names[1]);
  study_axis_label(&axes[0], labels[0]);
  study_axis_label(&axes[1], labels[1]);
  panel->bar = study_panel_bar(&axes[2], colour_map_line, labels[2]);
  panel->tight = true;
  panel->axes = (struct axes){.x_label = labels[0],
                              .y_label = labels[1],
                              .x_names = names[0],
                              .x_name_count = cells->columns,
                              .y_names = names[1],
                              .y_name_count = cells->rows};
  panel->frame = (struct frame){.x_min = -0.5,
                                .x_max = (double)cells->columns - 0.5,
                                .y_min = -0.5,
                                .y_max = (double)cells->rows - 0.5};
  study_panel_begin(panel, canvas);
  const struct box *area = &panel->frame.area;
  double gap = 3 * canvas->unit, width = area->width / (double)cells->columns;
  double height = area->height / (double)cells->rows;
  struct fit fit =
      find_fit(input, width - gap - 14 * canvas->unit, height - gap - 26 * canvas->unit);
  for (size_t k = 0; k < cells->columns * cells->rows; k++) {
    size_t i = k % cells->columns, j = k / cells->columns;
    struct box box = {area->x + (double)i * width + gap / 2,
                      area->y + (double)(cells->rows - 1 - j) * height + gap / 2, width - gap,
                      height - gap};
    draw_cell(canvas, input, panel, &axes[2], &fit, box, cells->row[k]);
  }
  study_panel_rim(panel, canvas);
  if (input->shape_count > 0) {
    draw_scale(canvas, area, &fit);
  }
}

enum status study_draw_shapes(struct canvas *canvas, const struct study_plot_input *input,
                              const struct study_plot_options *options, struct error *error) {
  const struct study_table *table = input->table;
  struct study_panel panel = {.title = "Bent bodies over two parameters"};
  struct study_axis axes[3] = {{0}};
  struct study_cells cells;
  struct centres centres;
  study_panel_words(&panel, table);
  enum status status = study_axis_choose_metric(table, options->metric, &axes[2], error);
  if (status == STATUS_OK) {
    status = find_axes(table, options, &axes[0], &axes[1], error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  if (!axes[0].table || !axes[1].table) {
    study_panel_empty(&panel, canvas,
                      table->members == 0 ? "No member has been solved yet"
                                          : "Fewer than two parameters of this study vary");
    return STATUS_OK;
  }
  find_cells(&axes[0], &axes[1], &centres, &cells);
  snprintf(panel.title, sizeof panel.title, "Bodies over %.100s and %.100s", axes[0].column->title,
           axes[1].column->title);
  if (cells.columns * cells.rows < table->members) {
    study_panel_add(&panel, "a member a cell, the nearest to its middle");
  }
  draw_cells(canvas, input, &panel, axes, &cells, &centres);
  return STATUS_OK;
}
