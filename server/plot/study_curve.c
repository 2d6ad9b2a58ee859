#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/series.h"
#include "server/plot/study_dots.h"
#include "server/plot/study_draw.h"

/* Most lines: more could not be told apart. */
enum { FAMILIES = 8 };

/* Members that differ in x alone, as a line each. */
struct families {
  size_t count;
  size_t row[FAMILIES]; /* one of their members */
  struct point *points; /* [FAMILIES * members] */
  size_t length[FAMILIES];
  char name[FAMILIES][STUDY_LABEL];
};

static bool same_family(const struct study_table *table, size_t x, size_t a, size_t b) {
  for (size_t k = 0; k < table->parameters; k++) {
    double va = table->value[a * table->parameters + k],
           vb = table->value[b * table->parameters + k];
    if (k != x && va != vb && !(isnan(va) && isnan(vb))) {
      return false;
    }
  }
  return true;
}

static int compare_points(const void *a, const void *b) {
  const struct point *p = a, *q = b;
  return (p->x > q->x) - (p->x < q->x);
}

/* Names a family by the parameters in which it differs from the others. */
static void name_family(const struct study_table *table, size_t x, const struct families *families,
                        size_t family, char name[STUDY_LABEL]) {
  size_t used = 0;
  name[0] = '\0';
  for (size_t k = 0; k < table->parameters; k++) {
    bool differs = false;
    struct study_axis axis = study_axis_parameter(table, k);
    for (size_t f = 0; f < families->count; f++) {
      double first = study_axis_at(&axis, families->row[0]);
      differs = differs || study_axis_at(&axis, families->row[f]) != first;
    }
    if (k != x && differs && used < STUDY_LABEL - 1) {
      char value[STUDY_LABEL];
      study_axis_text(&axis, study_axis_at(&axis, families->row[family]), true, value);
      int more = snprintf(name + used, STUDY_LABEL - used, "%s%.60s %.60s", used ? ", " : "",
                          axis.column->categorical ? "" : axis.column->title, value);
      used += more > 0 ? (size_t)more : 0;
    }
  }
}

/* Divides the members; false when there are too many families, or hardly two members in each. */
static bool divide(const struct study_axis *x, const struct study_axis *y,
                   struct families *families) {
  const struct study_table *table = x->table;
  size_t counted = 0;
  for (size_t row = 0; row < table->members; row++) {
    struct point p = {study_axis_at(x, row), study_axis_at(y, row)};
    size_t f = 0;
    if (isnan(p.x) || isnan(p.y)) {
      continue;
    }
    while (f < families->count && !same_family(table, x->index, families->row[f], row)) {
      f++;
    }
    if (f == FAMILIES) {
      return false;
    }
    if (f == families->count) {
      families->row[families->count++] = row;
    }
    families->points[f * table->members + families->length[f]++] = p;
    counted++;
  }
  for (size_t f = 0; f < families->count; f++) {
    qsort(families->points + f * table->members, families->length[f], sizeof *families->points,
          compare_points);
    name_family(table, x->index, families, f, families->name[f]);
  }
  return families->count > 0 && 2 * families->count <= counted + 1;
}

static void set_axes(struct study_panel *panel, const struct study_axis *x,
                     const struct study_axis *y, char labels[2][STUDY_LABEL]) {
  study_axis_label(x, labels[0]);
  study_axis_label(y, labels[1]);
  double spare = 0.03 * (x->high - x->low);
  panel->axes = (struct axes){
      .x_label = labels[0], .y_label = labels[1], .log_x = x->logarithmic, .log_y = y->logarithmic};
  if (x->column->categorical) {
    panel->axes.x_names = (const char *const *)x->column->words;
    panel->axes.x_name_count = x->column->word_count;
  }
  panel->frame = (struct frame){
      .x_min = x->low - spare, .x_max = x->high + spare, .y_min = y->low, .y_max = y->high};
}

static void draw_families(struct study_panel *panel, struct canvas *canvas,
                          const struct families *families, const struct study_axis *x) {
  struct chart_series series[FAMILIES + 1];
  size_t members = x->table->members;
  for (size_t f = 0; f < families->count; f++) {
    bool words = x->column->categorical;
    series[f] = (struct chart_series){.points = families->points + f * members,
                                      .count = families->length[f],
                                      .colour = colour_series(f),
                                      .width = words ? 0 : 2,
                                      .dash = (enum chart_dash)(f % DASH_COUNT),
                                      .marker = MARKER_CIRCLE + (enum chart_marker)(f % 4),
                                      .name = families->count > 1 ? families->name[f] : NULL};
  }
  series[families->count] = study_panel_failed_key(x->table);
  panel->key = series;
  panel->key_count = families->count + 1;
  study_panel_begin(panel, canvas);
  for (size_t f = 0; f < families->count; f++) {
    series_draw(canvas, &panel->frame, &series[f]);
  }
  study_panel_failed(panel, canvas, x);
}

static enum status draw_dots(struct study_panel *panel, struct canvas *canvas,
                             const struct study_axis *x, const struct study_axis *y,
                             const struct study_axis *colour, struct error *error) {
  struct study_dots dots;
  study_dots_make(x->table, colour, true, &dots);
  panel->bar = dots.bar;
  panel->key = dots.key;
  panel->key_count = dots.key_count;
  study_panel_begin(panel, canvas);
  enum status status = study_dots_draw(&dots, canvas, &panel->frame, x, y, error);
  study_panel_failed(panel, canvas, x);
  return status;
}

enum status study_draw_curve(struct canvas *canvas, const struct study_plot_input *input,
                             const struct study_plot_options *options, struct error *error) {
  const struct study_table *table = input->table;
  struct study_axis x, y, colour = {0};
  struct study_panel panel = {.title = "A metric over a parameter"};
  struct families families = {0};
  char labels[2][STUDY_LABEL];
  study_panel_words(&panel, table);
  enum status status = study_axis_choose_metric(table, options->metric, &y, error);
  if (status == STATUS_OK) {
    status = study_axis_choose_parameter(table, options->x, NULL, false, &x, error);
  }
  if (status == STATUS_OK && options->colour) {
    status = study_axis_find(table, options->colour, &colour, error);
  } else if (status == STATUS_OK) {
    status = study_axis_choose_parameter(table, NULL, &x, false, &colour, error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  if (!x.table || !y.table || !(y.low <= y.high)) {
    study_panel_empty(&panel, canvas,
                      x.table || !y.table || table->members == 0
                          ? "No member has been solved yet"
                          : "No parameter of this study varies");
    return STATUS_OK;
  }
  snprintf(panel.title, sizeof panel.title, "%.150s over %.150s", y.column->title, x.column->title);
  set_axes(&panel, &x, &y, labels);
  families.points = malloc((FAMILIES * table->members + 1) * sizeof *families.points);
  if (!families.points) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  if (!options->colour && divide(&x, &y, &families)) {
    draw_families(&panel, canvas, &families, &x);
  } else {
    status = draw_dots(&panel, canvas, &x, &y, &colour, error);
  }
  free(families.points);
  return status;
}
