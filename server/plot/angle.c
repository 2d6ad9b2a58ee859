#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"

struct fit {
  struct point ends[2];
  char name[120];
};

/* Reads the straight-line fit; false when there is none. Without a recorded range it is drawn over
 * that of the samples. */
static bool read_fit(const json_t *result, const struct point *points, size_t count,
                     struct fit *fit) {
  const json_t *object = json_object_get(result, "fit");
  double slope = data_number(object, "slope_deg_per_kPa");
  double intercept = data_number(object, "intercept_deg");
  double from = data_number(object, "from_kPa"), to = data_number(object, "to_kPa");
  double r_squared = data_number(object, "r_squared");
  if (!isfinite(slope) || !isfinite(intercept) || count < 2) {
    return false;
  }
  from = isfinite(from) ? from : points[0].x;
  to = isfinite(to) ? to : points[count - 1].x;
  fit->ends[0] = (struct point){from, intercept + slope * from};
  fit->ends[1] = (struct point){to, intercept + slope * to};
  char slope_text[TICKS_TEXT], r_text[TICKS_TEXT];
  ticks_number(slope, 3, slope_text);
  ticks_number(r_squared, r_squared > 0.99 ? 4 : 3, r_text);
  snprintf(fit->name, sizeof fit->name, "linear fit: %s °/kPa, R² = %s", slope_text, r_text);
  return isfinite(fit->ends[0].y) && isfinite(fit->ends[1].y);
}

/* Error bars of a curve: the estimated error belongs to the last point of one that was finished.
 * NULL when memory ran out. */
static double *read_errors(const json_t *result, size_t count) {
  double *errors = malloc((count + 1) * sizeof *errors);
  for (size_t i = 0; errors && i < count; i++) {
    bool last = i + 1 == count;
    errors[i] =
        last ? data_number(json_object_get(result, "metrics"), "bending_angle_deg_error") : NAN;
  }
  return errors;
}

enum status draw_angle(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error) {
  (void)count;
  const json_t *result = inputs[0].result;
  struct point *points = NULL;
  size_t point_count = 0;
  enum status status =
      data_samples(result, "pressure_kPa", "bending_angle_deg", &points, &point_count, error);
  if (status != STATUS_OK) {
    return status;
  }
  double *errors = read_errors(result, point_count);
  if (!errors) {
    free(points);
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu points", point_count);
  }
  char subtitle[DATA_HEADING], notice[DATA_HEADING], number[TICKS_TEXT], mark_text[80];
  data_subtitle(&inputs[0], subtitle);
  data_notice(result, notice);
  struct fit fit = {0};
  bool has_fit = read_fit(result, points, point_count, &fit);
  const struct chart_series series[] = {{.points = points,
                                         .count = point_count,
                                         .colour = colour_series(0),
                                         .width = 2.2,
                                         .marker = MARKER_CIRCLE,
                                         .errors = errors,
                                         .name = "simulation"},
                                        {.points = fit.ends,
                                         .count = has_fit ? 2 : 0,
                                         .colour = colour_series(1),
                                         .width = 1.8,
                                         .dash = DASH_LONG,
                                         .guide = true,
                                         .name = fit.name}};
  struct point onset = {data_number(json_object_get(result, "metrics"), "contact_onset_kPa"), 0};
  ticks_plain(onset.x, 3, number);
  snprintf(mark_text, sizeof mark_text, "contact from %s kPa", number);
  struct chart chart = {.title = "Bending angle against pressure",
                        .subtitle = subtitle,
                        .notice = notice,
                        .x_label = "Pressure (kPa)",
                        .y_label = "Bending angle (°)",
                        .from_zero = true,
                        .series = series,
                        .series_count = sizeof series / sizeof *series,
                        .mark = isfinite(onset.x) ? &onset : NULL,
                        .mark_text = mark_text,
                        .empty = "No samples were recorded"};
  chart_draw(&chart, canvas);
  free(errors);
  free(points);
  return STATUS_OK;
}
