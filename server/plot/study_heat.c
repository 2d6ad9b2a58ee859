#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/plot/study_draw.h"
#include "server/plot/study_panel.h"

/* Cells that are worth a number each; values that are worth a word on the axis each. */
enum { NUMBERS_MOST = 150, NAMES_MOST = 24 };

/* The values of one axis and their cells: cell i lies between edge[i] and edge[i + 1]. */
struct side {
  struct study_axis axis;
  double value[STUDY_VALUES];
  size_t count;
  double edge[STUDY_VALUES + 1];
  char text[STUDY_VALUES][40];
  const char *name[STUDY_VALUES];
  bool named; /* cells of equal size with words, else numbers on the axis */
};

/* What is in a cell: the mean over members that agree in both parameters. */
struct cell {
  double sum;
  size_t count, failed;
};

/* Divides the range of many values into equal cells, so many that most have some members. */
static void make_bins(struct side *side) {
  enum { BINS_LEAST = 4, BINS_MOST = 32, MEMBERS_A_CELL = 4 };
  double members = (double)side->axis.table->members;
  side->count = (size_t)fmin(fmax(sqrt(members / MEMBERS_A_CELL), BINS_LEAST), BINS_MOST);
  for (size_t i = 0; i <= side->count; i++) {
    double part = (double)i / (double)side->count;
    side->edge[i] = side->axis.low + (side->axis.high - side->axis.low) * part;
  }
}

static void make_side(struct side *side) {
  side->count = study_axis_values(&side->axis, side->value);
  if ((double)side->count > fmax(12, 2 * sqrt((double)side->axis.table->members))) {
    side->count = 0; /* values that hardly two members share are no grid */
  }
  side->named = side->count > 0 && side->count <= NAMES_MOST;
  if (side->count == 0) {
    make_bins(side);
    return;
  }
  for (size_t i = 0; i < side->count; i++) {
    char text[STUDY_LABEL];
    study_axis_text(&side->axis, side->value[i], false, text);
    snprintf(side->text[i], sizeof side->text[i], "%.39s", text);
    side->name[i] = side->text[i];
  }
  for (size_t i = 0; i <= side->count; i++) {
    if (side->named) {
      side->edge[i] = (double)i - 0.5;
    } else if (i > 0 && i < side->count) {
      side->edge[i] = (side->value[i - 1] + side->value[i]) / 2;
    }
  }
  if (!side->named) {
    side->edge[0] = 2 * side->value[0] - side->edge[1];
    side->edge[side->count] = 2 * side->value[side->count - 1] - side->edge[side->count - 1];
  }
}

/* The cell of a row; count when it has none. */
static size_t place(const struct side *side, size_t row) {
  double at = study_axis_at(&side->axis, row);
  if (isnan(at) || side->named) {
    return isnan(at) ? side->count : study_axis_place(side->value, side->count, at);
  }
  size_t i = 0;
  while (i + 1 < side->count && at >= side->edge[i + 1]) {
    i++;
  }
  return i;
}

static void fill_cells(const struct side *x, const struct side *y, const struct study_axis *metric,
                       struct cell *cells, double *low, double *high) {
  for (size_t row = 0; row < metric->table->members; row++) {
    size_t i = place(x, row), j = place(y, row);
    double value = study_axis_at(metric, row);
    if (i == x->count || j == y->count) {
      continue;
    }
    struct cell *cell = &cells[j * x->count + i];
    cell->failed += study_row_failed(metric->table, row);
    if (!isnan(value)) {
      cell->sum += value;
      cell->count++;
    }
  }
  *low = INFINITY;
  *high = -INFINITY;
  for (size_t k = 0; k < x->count * y->count; k++) {
    double mean = cells[k].sum / (double)cells[k].count;
    *low = fmin(*low, mean);
    *high = fmax(*high, mean);
  }
}

static struct box cell_box(const struct frame *frame, const struct side *x, const struct side *y,
                           size_t i, size_t j) {
  struct point a = frame_pixel(frame, (struct point){x->edge[i], y->edge[j + 1]});
  struct point b = frame_pixel(frame, (struct point){x->edge[i + 1], y->edge[j]});
  return (struct box){round(a.x), round(a.y), round(b.x) - round(a.x), round(b.y) - round(a.y)};
}

/* The number in a cell, dark on light and light on dark. */
static void draw_number(struct canvas *canvas, struct box box, double value, struct colour fill) {
  struct rgb rgb = colour_rgb(fill, canvas->theme);
  bool bright = 0.3 * rgb.r + 0.59 * rgb.g + 0.11 * rgb.b > 0.5;
  char text[TICKS_TEXT];
  double width, height, u = canvas->unit;
  struct text_style style = {.size = 12};
  ticks_plain(value, 3, text);
  canvas_measure(canvas, text, &style, &width, &height);
  if (width + 4 * u < box.width && height < box.height) {
    bool ink = bright == (canvas->theme == THEME_LIGHT);
    style.colour = ink ? colour_ink : (struct colour){.role = COLOUR_PAPER};
    canvas_text(canvas, box.x + box.width / 2, box.y + box.height / 2, 0.5, 0.5, text, &style);
  }
}

/* A member failed: a cross over the cell. */
static void draw_cross(struct canvas *canvas, struct box box) {
  double r = fmin(fmin(box.width, box.height) * 0.3, 6 * canvas->unit);
  double x = box.x + box.width / 2, y = box.y + box.height / 2;
  canvas_set_colour(canvas, colour_notice);
  cairo_set_line_width(canvas->cr, fmin(1.8 * canvas->unit, 0.6 * r + 0.5));
  cairo_move_to(canvas->cr, x - r, y - r);
  cairo_line_to(canvas->cr, x + r, y + r);
  cairo_move_to(canvas->cr, x - r, y + r);
  cairo_line_to(canvas->cr, x + r, y - r);
  cairo_stroke(canvas->cr);
}

static void draw_cells(struct study_panel *panel, struct canvas *canvas, const struct side *x,
                       const struct side *y, const struct cell *cells) {
  bool numbers = x->count * y->count <= NUMBERS_MOST;
  double gap = x->count * y->count <= 600 ? 1 : 0;
  for (size_t k = 0; k < x->count * y->count; k++) {
    struct box box = cell_box(&panel->frame, x, y, k % x->count, k / x->count);
    const struct cell *cell = &cells[k];
    double value = cell->sum / (double)cell->count;
    struct colour colour = chart_bar_colour(&panel->bar, value);
    if (cell->count == 0 && cell->failed == 0) {
      continue;
    }
    canvas_set_colour(canvas, cell->count > 0 ? colour : colour_shade);
    cairo_rectangle(canvas->cr, box.x, box.y, fmax(box.width - gap, 1), fmax(box.height - gap, 1));
    cairo_fill(canvas->cr);
    if (cell->count == 0) {
      draw_cross(canvas, box);
    } else if (numbers) {
      draw_number(canvas, box, panel->bar.logarithmic ? pow(10, value) : value, colour);
    }
  }
}

/* Says what cells are that stand for several members. */
static void add_words(struct study_panel *panel, const struct side *x, const struct side *y,
                      const struct cell *cells) {
  size_t most = 0, empty = 0;
  for (size_t k = 0; k < x->count * y->count; k++) {
    most = cells[k].count > most ? cells[k].count : most;
    empty += cells[k].count == 0 && cells[k].failed > 0;
  }
  if (most > 1) {
    study_panel_add(panel, "means of up to %zu members a cell", most);
  }
  if (empty > 0) {
    study_panel_add(panel, "×: all failed");
  }
}

static enum status draw_sides(struct canvas *canvas, struct study_panel *panel, struct side *x,
                              struct side *y, const struct study_axis *metric,
                              struct error *error) {
  char labels[3][STUDY_LABEL];
  double low, high;
  make_side(x);
  make_side(y);
  struct cell *cells = calloc(x->count * y->count, sizeof *cells);
  if (!cells) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  fill_cells(x, y, metric, cells, &low, &high);
  add_words(panel, x, y, cells);
  struct study_axis shown = *metric;
  shown.low = low;
  shown.high = high;
  panel->bar = study_panel_bar(&shown, colour_map_area, labels[2]);
  study_axis_label(&x->axis, labels[0]);
  study_axis_label(&y->axis, labels[1]);
  panel->axes.x_label = labels[0];
  panel->axes.y_label = labels[1];
  panel->axes.log_x = !x->named && x->axis.logarithmic;
  panel->axes.log_y = !y->named && y->axis.logarithmic;
  panel->axes.x_names = x->named ? x->name : NULL;
  panel->axes.x_name_count = x->count;
  panel->axes.y_names = y->named ? y->name : NULL;
  panel->axes.y_name_count = y->count;
  panel->frame = (struct frame){.x_min = x->edge[0],
                                .x_max = x->edge[x->count],
                                .y_min = y->edge[0],
                                .y_max = y->edge[y->count]};
  panel->tight = true;
  study_panel_begin(panel, canvas);
  draw_cells(panel, canvas, x, y, cells);
  study_panel_rim(panel, canvas);
  free(cells);
  return STATUS_OK;
}

enum status study_draw_heat_map(struct canvas *canvas, const struct study_plot_input *input,
                                const struct study_plot_options *options, struct error *error) {
  const struct study_table *table = input->table;
  struct study_panel panel = {.title = "A metric over two parameters"};
  struct study_axis metric;
  study_panel_words(&panel, table);
  struct side *sides = calloc(2, sizeof *sides);
  enum status status = sides ? study_axis_choose_metric(table, options->metric, &metric, error)
                             : error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out");
  if (status == STATUS_OK) {
    struct study_axis *x = &sides[0].axis, *y = &sides[1].axis;
    status = study_axis_choose_parameter(table, options->x, NULL, false, x, error);
    if (status == STATUS_OK) {
      status = study_axis_choose_parameter(table, options->y, x, false, y, error);
    }
  }
  if (status != STATUS_OK) {
    free(sides);
    return status;
  }
  if (!metric.table || !(metric.low <= metric.high)) {
    study_panel_empty(&panel, canvas, "No member has been solved yet");
  } else if (!sides[0].axis.table || !sides[1].axis.table) {
    study_panel_empty(&panel, canvas, "Fewer than two parameters of this study vary");
  } else {
    snprintf(panel.title, sizeof panel.title, "%.120s over %.100s and %.100s", metric.column->title,
             sides[0].axis.column->title, sides[1].axis.column->title);
    status = draw_sides(canvas, &panel, &sides[0], &sides[1], &metric, error);
  }
  free(sides);
  return status;
}
