/* A body that leaves its plane: its centreline and the way of its tip in three views. */
#include <math.h>
#include <stdlib.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "server/plot/views.h"

struct lines {
  struct views_point *points;
  struct views_path *paths;
  double *pressures; /* kPa, of each path */
  size_t count;
  double low, high; /* kPa */
};

static size_t count_points(const json_t *list) {
  size_t total = 0;
  for (size_t i = 0; i < json_array_size(list); i++) {
    total += json_array_size(json_object_get(json_array_get(list, i), "points_mm"));
  }
  return total;
}

static bool read_point(const json_t *array, struct views_point *p) {
  for (size_t k = 0; k < 3; k++) {
    p->at[k] = data_element(array, k);
  }
  return isfinite(p->at[0]) && isfinite(p->at[1]) && isfinite(p->at[2]);
}

static void lines_release(struct lines *lines) {
  free(lines->points);
  free(lines->paths);
  free(lines->pressures);
}

/* Reads the centrelines that have a pressure and two points at least. */
static enum status lines_read(const json_t *result, struct lines *lines, struct error *error) {
  const json_t *list = json_object_get(result, "midlines");
  size_t listed = json_array_size(list), used = 0;
  *lines = (struct lines){calloc(count_points(list) + 1, sizeof *lines->points),
                          calloc(listed + 1, sizeof *lines->paths),
                          calloc(listed + 1, sizeof *lines->pressures),
                          0,
                          INFINITY,
                          -INFINITY};
  if (!lines->points || !lines->paths || !lines->pressures) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu centrelines", listed);
  }
  for (size_t i = 0; i < listed; i++) {
    const json_t *line = json_array_get(list, i), *points = json_object_get(line, "points_mm");
    double pressure = data_number(line, "pressure_kPa");
    struct views_point *start = lines->points + used;
    size_t length = 0;
    for (size_t k = 0; k < json_array_size(points); k++) {
      length += read_point(json_array_get(points, k), &start[length]);
    }
    if (length >= 2 && isfinite(pressure)) {
      lines->pressures[lines->count] = pressure;
      lines->paths[lines->count++] =
          (struct views_path){.points = start, .count = length, .width = 2.0};
      lines->low = fmin(lines->low, pressure);
      lines->high = fmax(lines->high, pressure);
      used += length;
    }
  }
  return STATUS_OK;
}

/* Colours every centreline by its pressure. */
static void colour_lines(struct lines *lines) {
  struct views_point *p = lines->points;
  for (size_t i = 0; i < lines->count; i++) {
    double t = (lines->pressures[i] - lines->low) / (lines->high - lines->low);
    for (size_t k = 0; k < lines->paths[i].count; k++) {
      (p++)->colour = lines->high > lines->low ? colour_map_line(t) : colour_series(0);
    }
  }
}

enum status draw_midline3d(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                           struct error *error) {
  (void)count;
  struct lines lines;
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  enum status status = lines_read(inputs[0].result, &lines, error);
  if (status == STATUS_OK) {
    colour_lines(&lines);
    data_subtitle(&inputs[0], subtitle);
    data_notice(inputs[0].result, notice);
    struct views views = {.title = "Centreline at the recorded pressures",
                          .subtitle = subtitle,
                          .notice = notice,
                          .paths = lines.paths,
                          .path_count = lines.count,
                          .empty = "No centrelines were recorded"};
    if (lines.high > lines.low) {
      views.bar = (struct colour_bar){
          .label = "Pressure (kPa)", .map = colour_map_line, .min = lines.low, .max = lines.high};
    }
    views_draw(&views, canvas);
  }
  lines_release(&lines);
  return status;
}

enum status draw_tip3d(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error) {
  (void)count;
  const json_t *samples = json_object_get(inputs[0].result, "samples");
  size_t recorded = json_array_size(samples), used = 0;
  struct views_point *points = calloc(recorded + 1, sizeof *points);
  double *pressures = calloc(recorded + 1, sizeof *pressures), low = INFINITY, high = -INFINITY;
  if (!points || !pressures) {
    free(points);
    free(pressures);
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu samples", recorded);
  }
  for (size_t i = 0; i < recorded; i++) {
    const json_t *sample = json_array_get(samples, i);
    struct views_point p = {{data_number(sample, "tip_x_mm"), data_number(sample, "tip_y_mm"),
                             data_number(sample, "tip_z_mm")},
                            colour_series(0)};
    double pressure = data_number(sample, "pressure_kPa");
    if (isfinite(p.at[0] + p.at[1] + p.at[2] + pressure)) {
      pressures[used] = pressure;
      points[used++] = p;
      low = fmin(low, pressure);
      high = fmax(high, pressure);
    }
  }
  for (size_t i = 0; i < used && high > low; i++) {
    points[i].colour = colour_map_line((pressures[i] - low) / (high - low));
  }
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  const struct views_path path = {.points = points, .count = used, .width = 1.6, .dots = true};
  data_subtitle(&inputs[0], subtitle);
  data_notice(inputs[0].result, notice);
  struct views views = {.title = "Path of the tip",
                        .subtitle = subtitle,
                        .notice = notice,
                        .paths = &path,
                        .path_count = 1,
                        .empty = "No positions of the tip were recorded"};
  if (high > low) {
    views.bar = (struct colour_bar){
        .label = "Pressure (kPa)", .map = colour_map_line, .min = low, .max = high};
  }
  views_draw(&views, canvas);
  free(points);
  free(pressures);
  return STATUS_OK;
}
