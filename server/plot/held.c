#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"

static const char slope_key[] = "force_per_pressure_N_per_kPa";

/* The published slope that the document carries, or NaN. */
static double published_slope(const json_t *result) {
  size_t index;
  const json_t *entry;
  json_array_foreach(json_object_get(result, "published"), index, entry) {
    const char *metric = json_string_value(json_object_get(entry, "metric"));
    if (metric && strcmp(metric, slope_key) == 0) {
      return data_number(entry, "value");
    }
  }
  return NAN;
}

static void name_slope(char *text, size_t size, const char *what, double slope) {
  char number[TICKS_TEXT];
  ticks_number(slope, 3, number);
  snprintf(text, size, isfinite(slope) ? "%s, %s N/kPa" : "%s", what, number);
}

/* Reads the forces that hold the length; *last becomes the largest pressure. */
static struct point *read_held(const json_t *result, size_t *count, double *last) {
  const json_t *held = json_object_get(result, "held");
  struct point *points = malloc((json_array_size(held) + 1) * sizeof *points);
  *count = 0;
  *last = 0;
  for (size_t i = 0; points && i < json_array_size(held); i++) {
    const json_t *entry = json_array_get(held, i);
    struct point p = {data_number(entry, "pressure_kPa"), data_number(entry, "force_N")};
    if (isfinite(p.x) && isfinite(p.y)) {
      *last = fmax(*last, p.x);
      points[(*count)++] = p;
    }
  }
  return points;
}

enum status draw_held(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                      struct error *error) {
  const json_t *result = inputs[0].result;
  char subtitle[DATA_HEADING], notice[DATA_HEADING], names[2][80];
  size_t held = 0;
  double last = 0, published = published_slope(result);
  struct point *points = read_held(result, &held, &last);
  (void)count;
  if (!points) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for the held forces");
  }
  const struct point line[2] = {{0, 0}, {last, published * last}};
  data_subtitle(&inputs[0], subtitle);
  data_notice(result, notice);
  name_slope(names[0], sizeof names[0], "computed",
             data_number(json_object_get(result, "metrics"), slope_key));
  name_slope(names[1], sizeof names[1], "published", published);
  const struct chart_series series[2] = {{.points = line,
                                          .count = isfinite(published) && held ? 2 : 0,
                                          .colour = colour_series(1),
                                          .width = 2.0,
                                          .dash = DASH_LONG,
                                          .name = names[1]},
                                         {.points = points,
                                          .count = held,
                                          .colour = colour_series(0),
                                          .width = 2.2,
                                          .marker = MARKER_CIRCLE,
                                          .name = names[0]}};
  const struct chart chart = {.title = "Force of the actuator held at its natural length",
                              .subtitle = subtitle,
                              .notice = notice,
                              .x_label = "Pressure (kPa)",
                              .y_label = "Force (N)",
                              .from_zero = true,
                              .series = series,
                              .series_count = 2,
                              .empty = "No held forces were computed"};
  chart_draw(&chart, canvas);
  free(points);
  return STATUS_OK;
}
