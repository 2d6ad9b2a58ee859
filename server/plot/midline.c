#include <math.h>
#include <stdlib.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"

/* All centrelines in one array of points: series i owns points from its start on. */
struct midlines {
  struct chart_series *series;
  double *pressures; /* kPa, one per series */
  size_t count;
  struct point *points;
};

static void midlines_release(struct midlines *lines) {
  free(lines->series);
  free(lines->pressures);
  free(lines->points);
}

static size_t count_points(const json_t *list) {
  size_t total = 0;
  for (size_t i = 0; i < json_array_size(list); i++) {
    total += json_array_size(json_object_get(json_array_get(list, i), "points_mm"));
  }
  return total;
}

/* Reads the x and z of each line that has a pressure and two points at least. */
static enum status midlines_read(const json_t *result, struct midlines *lines,
                                 struct error *error) {
  const json_t *list = json_object_get(result, "midlines");
  size_t listed = json_array_size(list), used = 0;
  lines->series = calloc(listed + 1, sizeof *lines->series);
  lines->pressures = calloc(listed + 1, sizeof *lines->pressures);
  lines->points = calloc(count_points(list) + 1, sizeof *lines->points);
  if (!lines->series || !lines->pressures || !lines->points) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu centrelines", listed);
  }
  for (size_t i = 0; i < listed; i++) {
    const json_t *line = json_array_get(list, i);
    const json_t *points = json_object_get(line, "points_mm");
    struct point *start = lines->points + used;
    size_t length = 0;
    for (size_t k = 0; k < json_array_size(points); k++) {
      const json_t *p = json_array_get(points, k);
      struct point at = {data_element(p, 0), data_element(p, 2)};
      if (isfinite(at.x) && isfinite(at.y)) {
        start[length++] = at;
      }
    }
    double pressure = data_number(line, "pressure_kPa");
    if (length >= 2 && isfinite(pressure)) {
      lines->pressures[lines->count] = pressure;
      lines->series[lines->count++] =
          (struct chart_series){.points = start, .count = length, .width = 2.2};
      used += length;
    }
  }
  return STATUS_OK;
}

enum status draw_midline(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error) {
  (void)count;
  struct midlines lines = {0};
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  enum status status = midlines_read(inputs[0].result, &lines, error);
  if (status != STATUS_OK) {
    goto done;
  }
  data_subtitle(&inputs[0], subtitle);
  data_notice(inputs[0].result, notice);
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < lines.count; i++) {
    low = fmin(low, lines.pressures[i]);
    high = fmax(high, lines.pressures[i]);
  }
  bool coloured = high > low;
  for (size_t i = 0; i < lines.count; i++) {
    lines.series[i].colour =
        coloured ? colour_map_line((lines.pressures[i] - low) / (high - low)) : colour_series(0);
  }
  struct chart chart = {.title = "Centreline at the recorded pressures",
                        .subtitle = subtitle,
                        .notice = notice,
                        .x_label = "x along the body (mm)",
                        .y_label = "z (mm)",
                        .equal = true,
                        .series = lines.series,
                        .series_count = lines.count,
                        .empty = "No centrelines were recorded"};
  if (coloured) {
    chart.bar = (struct colour_bar){
        .label = "Pressure (kPa)", .map = colour_map_line, .min = low, .max = high};
  }
  chart_draw(&chart, canvas);
done:
  midlines_release(&lines);
  return status;
}
