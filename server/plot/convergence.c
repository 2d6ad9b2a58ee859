#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"

/* Errors below this are round-off, and zero has no logarithm. */
static const double least_percent = 1e-15;

/* The logarithms of the meshes' sizes and of their errors at `key`. */
static struct point *read_errors(const json_t *result, const char *key, size_t *count) {
  const json_t *meshes = json_object_get(result, "meshes");
  struct point *points = calloc(json_array_size(meshes) + 1, sizeof *points);
  *count = 0;
  for (size_t i = 0; points && i < json_array_size(meshes); i++) {
    const json_t *mesh = json_array_get(meshes, i);
    double size = data_number(mesh, "size"), error = data_number(mesh, key);
    if (size > 0 && error >= 0) {
      points[(*count)++] = (struct point){log10(size), log10(fmax(error, least_percent))};
    }
  }
  return points;
}

struct slope {
  struct point ends[2];
  char name[60];
};

/* The line of the slope that theory gives, through the error in the middle of those before the
 * errors stop falling: neither the coarsest mesh nor round-off says much about the slope. */
static bool slope_line(double order, const struct point *points, size_t count,
                       struct slope *slope) {
  if (!(order > 0) || count < 2) {
    return false;
  }
  size_t through = 0;
  double low = points[0].x, high = points[0].x;
  for (size_t i = 0; i < count; i++) {
    low = fmin(low, points[i].x);
    high = fmax(high, points[i].x);
  }
  while (through + 1 < count && points[through + 1].y < points[through].y) {
    through++;
  }
  struct point p = points[(through + 1) / 2];
  slope->ends[0] = (struct point){low, p.y + order * (low - p.x)};
  slope->ends[1] = (struct point){high, p.y + order * (high - p.x)};
  snprintf(slope->name, sizeof slope->name, "slope %g", order);
  return true;
}

static const char *string_at(const json_t *object, const char *key, const char *otherwise) {
  const char *text = json_string_value(json_object_get(object, key));
  return text ? text : otherwise;
}

enum status draw_convergence(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                             struct error *error) {
  (void)count;
  const json_t *result = inputs[0].result, *known = json_object_get(result, "case");
  struct point *points[2];
  size_t point_count[2];
  points[0] = read_errors(result, "error_percent", &point_count[0]);
  points[1] = read_errors(result, "other_error_percent", &point_count[1]);
  if (!points[0] || !points[1]) {
    free(points[0]);
    free(points[1]);
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out while reading errors");
  }
  char subtitle[DATA_HEADING], notice[DATA_HEADING], x_label[120];
  data_subtitle(&inputs[0], subtitle);
  data_notice(result, notice);
  snprintf(x_label, sizeof x_label, "%.100s", string_at(known, "size", "element size"));
  x_label[0] = x_label[0] >= 'a' && x_label[0] <= 'z' ? (char)(x_label[0] - 'a' + 'A') : x_label[0];
  struct slope slope[2] = {{.name = ""}, {.name = ""}};
  struct chart_series series[4] = {{.points = NULL}};
  for (int k = 0; k < 2; k++) {
    bool has_slope = slope_line(data_number(known, k ? "other_order" : "order"), points[k],
                                point_count[k], &slope[k]);
    series[k] = (struct chart_series){.points = points[k],
                                      .count = point_count[k],
                                      .colour = colour_series((size_t)k),
                                      .width = 2.2,
                                      .marker = k ? MARKER_SQUARE : MARKER_CIRCLE,
                                      .name = string_at(known, k ? "other_norm" : "norm", "error")};
    series[2 + k] = (struct chart_series){.points = slope[k].ends,
                                          .count = has_slope ? 2 : 0,
                                          .colour = colour_muted,
                                          .width = 1.4,
                                          .dash = k ? DASH_SHORT : DASH_LONG,
                                          .guide = true,
                                          .name = slope[k].name};
  }
  struct chart chart = {.title = "Error",
                        .subtitle = subtitle,
                        .notice = notice,
                        .x_label = x_label,
                        .y_label = "Error (%)",
                        .log_x = true,
                        .log_y = true,
                        .series = series,
                        .series_count = sizeof series / sizeof *series,
                        .empty = "No mesh was solved"};
  chart_draw(&chart, canvas);
  free(points[0]);
  free(points[1]);
  return STATUS_OK;
}
