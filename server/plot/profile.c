#include "server/plot/profile.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/plot/grasp.h"

enum { DETAIL = 100 };

/* "peak 12.1 N, mean 8.03 N", with a star when the curve ends early. */
static void describe(const json_t *result, const struct grasp_curve *curve, char text[DETAIL]) {
  const json_t *metrics = json_object_get(result, "metrics");
  char notice[DATA_HEADING], number[TICKS_TEXT], second[TICKS_TEXT];
  double peak = data_number(metrics, "grasp_force_peak_N");
  double mean = data_number(metrics, "grasp_force_mean_N");
  text[0] = '\0';
  if (!isfinite(peak) && curve->count > 0) {
    peak = curve->points[grasp_curve_peak(curve)].y;
  }
  data_notice(result, notice);
  ticks_number(peak, 3, number);
  ticks_number(mean, 3, second);
  if (isfinite(peak)) {
    snprintf(text, DETAIL, "peak %s N%s%s%s%s", number, isfinite(mean) ? ", mean " : "",
             isfinite(mean) ? second : "", isfinite(mean) ? " N" : "", *notice ? " *" : "");
  }
}

static bool any_pulls(const struct profile_source *sources, size_t count) {
  bool any = false;
  for (size_t i = 0; i < count; i++) {
    any = any || grasp_has_stage(sources[i].result, "pull");
  }
  return any;
}

static enum status add_source(struct bundle *bundle, const struct profile_source *source,
                              size_t place, bool pulls, char detail[DETAIL], struct error *error) {
  struct grasp_curve curve;
  enum status status =
      grasp_curve_read(source->result, pulls ? "pull" : NULL,
                       pulls ? "displacement_mm" : "pressure_kPa", "grasp_force_N", &curve, error);
  if (status == STATUS_OK && curve.count > 0) {
    describe(source->result, &curve, detail);
    struct chart_series like = {.colour = colour_series(place),
                                .width = 2.0,
                                .dash = (enum chart_dash)(place / COLOUR_SERIES_COUNT % DASH_COUNT),
                                .name = source->name,
                                .detail = detail};
    status = bundle_add(bundle, like, curve.points, curve.count, error);
  }
  if (status == STATUS_OK && curve.count > 0) { /* the peak tells curves apart without colour */
    struct chart_series peak = {
        .colour = colour_series(place),
        .marker = (enum chart_marker)(MARKER_CIRCLE + place % (MARKER_COUNT - 1))};
    status = bundle_add(bundle, peak, &curve.points[grasp_curve_peak(&curve)], 1, error);
  }
  grasp_curve_release(&curve);
  return status;
}

enum status profile_draw(struct canvas *canvas, const struct profile_source *sources, size_t count,
                         const struct profile_heading *heading, struct error *error) {
  struct bundle bundle = {.series = NULL};
  bool pulls = any_pulls(sources, count);
  char(*details)[DETAIL] = calloc(count + 1, sizeof *details);
  enum status status =
      details ? STATUS_OK
              : error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu curves", count);
  for (size_t i = 0; i < count && status == STATUS_OK; i++) {
    status = add_source(&bundle, &sources[i], i, pulls, details[i], error);
  }
  if (status == STATUS_OK) {
    struct chart chart = {.title = pulls ? "Grasp force against displacement"
                                         : "Force on the object against pressure",
                          .subtitle = heading->subtitle,
                          .notice = heading->notice,
                          .x_label = pulls ? "Displacement of the object (mm)" : "Pressure (kPa)",
                          .y_label = "Grasp force (N)",
                          .from_zero = true,
                          .series = bundle.series,
                          .series_count = bundle.count,
                          .empty = "No forces were recorded"};
    chart_draw(&chart, canvas);
  }
  bundle_release(&bundle);
  free(details);
  return status;
}
