#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/plot/cloud.h"
#include "server/plot/series.h"
#include "server/plot/study_draw.h"
#include "server/plot/study_panel.h"

/* More evaluations are a cloud. */
enum { CLOUD = 400 };

/* The evaluations by what they are; each member takes one place. */
struct course {
  struct point *good, *broken, *best; /* best: two places a member, for its steps */
  size_t good_count, broken_count, best_count;
  double low, high;
};

static enum status make(const struct study_table *table, const struct study_history *history,
                        struct course *course, struct error *error) {
  size_t room = table->members + 1;
  double best = NAN;
  *course = (struct course){.good = malloc(room * sizeof *course->good),
                            .broken = malloc(room * sizeof *course->broken),
                            .best = malloc((2 * room + 1) * sizeof *course->best),
                            .low = INFINITY,
                            .high = -INFINITY};
  if (!course->good || !course->broken || !course->best) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  for (size_t row = 0; row < table->members; row++) {
    struct point p = {(double)table->member[row] + 1, history->value[row]};
    if (!isfinite(p.y)) {
      continue;
    }
    course->low = fmin(course->low, p.y);
    course->high = fmax(course->high, p.y);
    if (history->feasible && !history->feasible[row]) {
      course->broken[course->broken_count++] = p;
      continue;
    }
    course->good[course->good_count++] = p;
    double gain = !isnan(history->target)
                      ? fabs(best - history->target) - fabs(p.y - history->target)
                  : history->maximise ? p.y - best
                                      : best - p.y;
    if (isnan(best) || gain > 0) {
      if (!isnan(best)) {
        course->best[course->best_count++] = (struct point){p.x, best};
      }
      best = p.y;
      course->best[course->best_count++] = (struct point){p.x, best};
    }
  }
  if (course->best_count > 0) {
    course->best[course->best_count++] = (struct point){(double)table->members, best};
  }
  return STATUS_OK;
}

/* Of many evaluations, dots; without memory for them the line of the best is left. */
static void draw_cloud(struct canvas *canvas, const struct study_panel *panel,
                       const struct course *course) {
  struct cloud *cloud = cloud_create(canvas, panel->frame.area, false);
  struct rgb good = colour_rgb(colour_series(0), canvas->theme);
  struct rgb broken = colour_rgb(colour_series(5), canvas->theme);
  for (size_t i = 0; cloud && i < course->good_count; i++) {
    struct point p = frame_pixel(&panel->frame, course->good[i]);
    cloud_dot(cloud, p.x, p.y, 1.5 * canvas->unit, good);
  }
  for (size_t i = 0; cloud && i < course->broken_count; i++) {
    struct point p = frame_pixel(&panel->frame, course->broken[i]);
    cloud_dot(cloud, p.x, p.y, 1.5 * canvas->unit, broken);
  }
  if (cloud) {
    cloud_paint(cloud, canvas, fmax(cloud_opacity(course->good_count), 0.5));
  }
  cloud_destroy(cloud);
}

static void draw_course(struct canvas *canvas, struct study_panel *panel,
                        const struct study_table *table, const struct study_history *history,
                        const struct course *course) {
  size_t most = course->good_count + course->broken_count;
  struct point target[2] = {{0, history->target}, {(double)table->members + 1, history->target}};
  const struct chart_series series[5] = {{.points = target,
                                          .count = isnan(history->target) ? 0 : 2,
                                          .width = 1.4,
                                          .colour = colour_muted,
                                          .dash = DASH_SHORT,
                                          .name = "target"},
                                         {.points = course->good,
                                          .count = course->good_count,
                                          .colour = colour_series(0),
                                          .marker = MARKER_CIRCLE,
                                          .small = most > 120,
                                          .name = "evaluation"},
                                         {.points = course->broken,
                                          .count = course->broken_count,
                                          .colour = colour_series(5),
                                          .marker = MARKER_DIAMOND,
                                          .hollow = most <= 300,
                                          .small = most > 300,
                                          .name = "breaks a constraint"},
                                         {.points = course->best,
                                          .count = course->best_count,
                                          .colour = colour_series(1),
                                          .width = 2,
                                          .name = "best so far"},
                                         study_panel_failed_key(table)};
  panel->key = series;
  panel->key_count = 5;
  study_panel_begin(panel, canvas);
  bool cloudy = most > CLOUD;
  if (cloudy) {
    draw_cloud(canvas, panel, course);
  }
  for (size_t i = 0; i < 4; i++) {
    if (series[i].count > 0 && (series[i].width > 0 || !cloudy)) {
      series_draw(canvas, &panel->frame, &series[i]);
    }
  }
}

/* Failed evaluations have no value: crosses on the axis, at their number. */
static void draw_failed(struct canvas *canvas, const struct study_panel *panel,
                        const struct study_table *table) {
  double bottom = panel->frame.y_min;
  for (size_t row = 0; row < table->members; row++) {
    if (study_row_failed(table, row)) {
      struct point p = {(double)table->member[row] + 1, bottom};
      p.y += 7 * canvas->unit / panel->frame.area.height * (panel->frame.y_max - bottom);
      struct chart_series cross = study_panel_failed_key(table);
      cross.points = &p;
      series_draw(canvas, &panel->frame, &cross);
    }
  }
}

enum status study_draw_history(struct canvas *canvas, const struct study_plot_input *input,
                               const struct study_plot_options *options, struct error *error) {
  const struct study_table *table = input->table;
  struct study_history plain = {.target = NAN};
  const struct study_history *history = input->history ? input->history : &plain;
  struct study_panel panel = {.title = "Course of the evaluations"};
  struct study_axis metric;
  struct course course = {0};
  char label[STUDY_LABEL];
  double *values = NULL;
  study_panel_words(&panel, table);
  enum status status = study_axis_choose_metric(table, options->metric, &metric, error);
  if (status == STATUS_OK && !input->history && metric.table) {
    values = malloc((table->members + 1) * sizeof *values);
    study_axis_label(&metric, label);
    plain.value = values;
    plain.label = label;
    /* without an objective nothing is better: the largest so far is shown */
    plain.maximise = true;
    for (size_t row = 0; values && row < table->members; row++) {
      values[row] = study_axis_value(&metric, study_axis_at(&metric, row));
    }
  }
  if (status == STATUS_OK && history->value) {
    status = make(table, history, &course, error);
  }
  if (status == STATUS_OK && course.good_count + course.broken_count == 0) {
    study_panel_empty(&panel, canvas, "No member has been solved yet");
  } else if (status == STATUS_OK) {
    panel.axes = (struct axes){.x_label = "Evaluation", .y_label = history->label, .whole_x = true};
    panel.frame = (struct frame){.x_min = 1,
                                 .x_max = (double)table->member[table->members - 1] + 1,
                                 .y_min = course.low,
                                 .y_max = course.high};
    panel.frame.y_min = fmin(panel.frame.y_min, history->target);
    panel.frame.y_max = fmax(panel.frame.y_max, history->target);
    snprintf(panel.title, sizeof panel.title, "%.200s, evaluation by evaluation", history->label);
    draw_course(canvas, &panel, table, history, &course);
    draw_failed(canvas, &panel, table);
  }
  free(course.good);
  free(course.broken);
  free(course.best);
  free(values);
  return status;
}
