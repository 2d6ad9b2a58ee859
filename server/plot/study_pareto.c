#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/cloud.h"
#include "server/plot/series.h"
#include "server/plot/study_dots.h"
#include "server/plot/study_draw.h"

/* The designs of the front in the order of the first objective. */
struct edge {
  struct point *points;
  size_t *row;
  size_t count;
};

struct place_of {
  struct point p;
  size_t row;
};

static int compare_places(const void *a, const void *b) {
  const struct place_of *p = a, *q = b;
  return (p->p.x > q->p.x) - (p->p.x < q->p.x);
}

static enum status find_edge(const struct study_pareto *pareto, const struct study_axis *x,
                             const struct study_axis *y, struct edge *edge, struct error *error) {
  size_t members = x->table->members;
  struct place_of *places = malloc((members + 1) * sizeof *places);
  edge->points = malloc((2 * members + 1) * sizeof *edge->points);
  edge->row = malloc((members + 1) * sizeof *edge->row);
  if (!places || !edge->points || !edge->row) {
    free(places);
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  for (size_t row = 0; row < members; row++) {
    struct point p = {study_axis_at(x, row), study_axis_at(y, row)};
    if (pareto->front[row] == 1 && !isnan(p.x) && !isnan(p.y)) {
      places[edge->count++] = (struct place_of){p, row};
    }
  }
  qsort(places, edge->count, sizeof *places, compare_places);
  for (size_t i = 0; i < edge->count; i++) {
    edge->points[i] = places[i].p;
    edge->row[i] = places[i].row;
  }
  free(places);
  return STATUS_OK;
}

/* The border of what the front dominates: steps between neighbours, level or upright first by the
 * side on which the better values lie. */
static void draw_steps(struct canvas *canvas, const struct frame *frame, const struct edge *edge,
                       bool better_right) {
  cairo_t *cr = canvas->cr;
  for (size_t i = 0; i < edge->count; i++) {
    struct point p = frame_pixel(frame, edge->points[i]);
    if (i > 0) {
      struct point before = frame_pixel(frame, edge->points[i - 1]);
      struct point corner =
          better_right ? (struct point){before.x, p.y} : (struct point){p.x, before.y};
      cairo_line_to(cr, corner.x, corner.y);
    }
    cairo_line_to(cr, p.x, p.y);
  }
  canvas_set_colour(canvas, colour_series(1));
  cairo_set_line_width(cr, 1.6 * canvas->unit);
  cairo_stroke(cr);
}

/* All that is not on the front, grey. */
static enum status draw_rest(struct canvas *canvas, const struct frame *frame,
                             const struct study_pareto *pareto, const struct study_axis *x,
                             const struct study_axis *y, struct error *error) {
  double radius = (x->table->members > 3000 ? 1.4 : 2.4) * canvas->unit;
  struct cloud *cloud = cloud_create(canvas, frame->area, false);
  if (!cloud) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  struct rgb grey = colour_rgb(colour_muted, canvas->theme);
  for (size_t row = 0; row < x->table->members; row++) {
    if (pareto->front[row] != 1) {
      struct point p =
          frame_pixel(frame, (struct point){study_axis_at(x, row), study_axis_at(y, row)});
      cloud_dot(cloud, p.x, p.y, radius, grey);
    }
  }
  cloud_paint(cloud, canvas, fmax(0.75 * cloud_opacity(x->table->members), 0.4));
  cloud_destroy(cloud);
  return STATUS_OK;
}

/* Dots of the front, coloured and sized by a third objective. */
static void draw_front(struct canvas *canvas, const struct frame *frame, const struct edge *edge,
                       const struct colour_bar *bar, const struct study_axis *third) {
  double scale = edge->count > 300 ? 0.5 : 1;
  for (size_t i = 0; i < edge->count; i++) {
    struct point p = frame_pixel(frame, edge->points[i]);
    double value = third->table ? study_axis_at(third, edge->row[i]) : NAN;
    double r = isnan(value) ? 4 : 3 + 4 * study_axis_part(third, value);
    struct colour colour = bar->label ? chart_bar_colour(bar, value) : colour_series(1);
    cairo_arc(canvas->cr, p.x, p.y, scale * r * canvas->unit, 0, 2 * G_PI);
    canvas_set_colour(canvas, colour);
    cairo_fill_preserve(canvas->cr);
    canvas_set_colour(canvas, colour_paper);
    cairo_set_line_width(canvas->cr, canvas->unit);
    cairo_stroke(canvas->cr);
  }
}

static void goal_label(const struct study_axis *axis, bool maximise, char label[STUDY_LABEL + 16]) {
  char plain[STUDY_LABEL];
  study_axis_label(axis, plain);
  snprintf(label, STUDY_LABEL + 16, "%s, %s", plain,
           maximise ? "more is better" : "less is better");
}

static void add_words(struct study_panel *panel, const struct study_pareto *pareto,
                      const struct edge *edge) {
  char number[TICKS_TEXT];
  study_panel_add(panel, "%zu on the front", edge->count);
  if (!isnan(pareto->hypervolume)) {
    ticks_plain(pareto->hypervolume, 4, number);
    study_panel_add(panel, "hypervolume %s", number);
    if (pareto->reference && pareto->count == 2) {
      char first[TICKS_TEXT], second[TICKS_TEXT];
      size_t used = strlen(panel->subtitle);
      ticks_plain(pareto->reference[0], 3, first);
      ticks_plain(pareto->reference[1], 3, second);
      snprintf(panel->subtitle + used, sizeof panel->subtitle - used, " from (%s, %s)", first,
               second);
    }
  }
}

/* Draws with everything found. */
static enum status draw_all(struct canvas *canvas, struct study_panel *panel,
                            const struct study_pareto *pareto, const struct study_axis axes[3],
                            const struct edge *edge, struct error *error) {
  const struct study_axis *x = &axes[0], *y = &axes[1], *third = &axes[2];
  const struct point dummy = {0, 0};
  char labels[2][STUDY_LABEL + 16], bar_label[STUDY_LABEL], size[STUDY_LABEL + 60];
  goal_label(x, pareto->maximise[0], labels[0]);
  goal_label(y, pareto->maximise[1], labels[1]);
  if (third->table) {
    panel->bar = study_panel_bar(third, colour_map_line, bar_label);
    snprintf(size, sizeof size, "on the front; larger: more %.100s", third->column->title);
  }
  const struct chart_series key[2] = {{.points = &dummy,
                                       .count = 1,
                                       .colour = third->table ? colour_ink : colour_series(1),
                                       .marker = MARKER_CIRCLE,
                                       .width = third->table ? 0 : 1.6,
                                       .name = third->table ? size : "on the front"},
                                      {.points = &dummy,
                                       .count = 1,
                                       .colour = colour_fade(colour_muted, 0.35),
                                       .marker = MARKER_CIRCLE,
                                       .small = true,
                                       .name = "dominated"}};
  panel->axes = (struct axes){
      .x_label = labels[0], .y_label = labels[1], .log_x = x->logarithmic, .log_y = y->logarithmic};
  panel->frame =
      (struct frame){.x_min = x->low, .x_max = x->high, .y_min = y->low, .y_max = y->high};
  panel->key = key;
  panel->key_count = 2;
  study_panel_begin(panel, canvas);
  enum status status = draw_rest(canvas, &panel->frame, pareto, x, y, error);
  if (!third->table) {
    draw_steps(canvas, &panel->frame, edge, pareto->maximise[0]);
  }
  draw_front(canvas, &panel->frame, edge, &panel->bar, third);
  return status;
}

enum status study_draw_pareto(struct canvas *canvas, const struct study_plot_input *input,
                              const struct study_plot_options *options, struct error *error) {
  const struct study_pareto *pareto = input->pareto;
  const struct study_table *table = input->table;
  struct study_panel panel = {.title = "Designs that no other one beats"};
  struct study_axis axes[3] = {{0}};
  struct edge edge = {0};
  (void)options;
  study_panel_words(&panel, table);
  if (pareto->count < 2) {
    return error_set(error, STATUS_NOT_FOUND, NULL,
                     "a front needs two objectives, as in ?objectives=max:KEY,min:KEY");
  }
  for (size_t k = 0; k < 3 && k < pareto->count; k++) {
    axes[k] = study_axis_metric(table, pareto->metric[k]);
  }
  enum status status = find_edge(pareto, &axes[0], &axes[1], &edge, error);
  if (status == STATUS_OK && edge.count == 0) {
    study_panel_empty(&panel, canvas, "No member has been solved yet");
  } else if (status == STATUS_OK) {
    snprintf(panel.title, sizeof panel.title, "%.150s against %.150s", axes[1].column->title,
             axes[0].column->title);
    add_words(&panel, pareto, &edge);
    status = draw_all(canvas, &panel, pareto, axes, &edge, error);
  }
  free(edge.points);
  free(edge.row);
  return status;
}
