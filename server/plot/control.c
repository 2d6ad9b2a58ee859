#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "server/plot/hybrid.h"

enum { PANELS = 2 };

/* Adds the elongation that is asked for. */
static enum status add_reference(const json_t *result, struct bundle *bundle, struct error *error) {
  struct chart_series like = {
      .colour = colour_series(1), .width = 1.8, .dash = DASH_LONG, .name = "reference"};
  struct point *points = NULL;
  size_t count = 0;
  enum status status = data_samples(result, "time_s", "reference_mm", &points, &count, error);
  if (status == STATUS_OK && count > 0) {
    count = data_thin(points, count, (points[count - 1].x - points[0].x) / 1500, 0);
    status = bundle_add(bundle, like, points, count, error);
  }
  free(points);
  return status;
}

/* Adds what was aimed at in place of a reference that is out of reach. */
static enum status add_targets(const json_t *result, struct bundle *bundle, struct error *error) {
  struct chart_series like = {
      .colour = colour_series(3), .width = 2.6, .name = "nearest within reach"};
  enum status status = STATUS_OK;
  size_t index;
  const json_t *step;
  json_array_foreach(json_object_get(result, "steps"), index, step) {
    double target = data_number(step, "target_mm");
    const struct point line[2] = {{data_number(step, "start_s"), target},
                                  {data_number(step, "end_s"), target}};
    if (json_is_false(json_object_get(step, "in_reach")) && status == STATUS_OK &&
        isfinite(line[0].x + line[1].x + target)) {
      status = bundle_add(bundle, like, line, 2, error);
      like.name = NULL;
    }
  }
  return status;
}

/* Adds the guards that are elongations, as level lines as long as `reach`. */
static enum status add_guards(const json_t *result, double reach, struct bundle *bundle,
                              struct error *error) {
  struct chart_series like = {
      .guide = true, .colour = colour_notice, .width = 1.2, .dash = DASH_DOT, .name = "guard"};
  enum status status = STATUS_OK;
  size_t index;
  const json_t *transition;
  json_array_foreach(json_object_get(json_object_get(result, "model"), "transitions"), index,
                     transition) {
    double level = 1e3 * data_number(json_object_get(transition, "when"), "h_m");
    const struct point line[2] = {{-reach, level}, {reach, level}};
    if (isfinite(level) && status == STATUS_OK) {
      status = bundle_add(bundle, like, line, 2, error);
      like.name = NULL;
    }
  }
  return status;
}

static enum status read_elongation(const struct hybrid *hybrid, const json_t *result,
                                   struct bundle *bundle, struct error *error) {
  struct chart_series like = {.colour = colour_ink, .width = 1.9, .name = "h"};
  double reach = hybrid_reach(hybrid, HYBRID_H);
  enum status status = hybrid_add_bands(hybrid, true, bundle, error);
  if (status == STATUS_OK) {
    status = hybrid_add_switches(result, reach, "switch", bundle, error);
  }
  if (status == STATUS_OK) {
    status = add_guards(result, hybrid_reach(hybrid, HYBRID_TIME), bundle, error);
  }
  if (status == STATUS_OK) {
    status = add_reference(result, bundle, error);
  }
  if (status == STATUS_OK) {
    status = add_targets(result, bundle, error);
  }
  return status == STATUS_OK ? hybrid_add_curve(hybrid, HYBRID_H, like, bundle, error) : status;
}

static enum status read_pressure(const struct hybrid *hybrid, const json_t *result,
                                 struct bundle *bundle, struct error *error) {
  struct chart_series asked = {.colour = colour_series(1), .width = 1.2, .name = "set-point"};
  struct chart_series got = {.colour = colour_ink, .width = 1.9, .name = "in the chamber"};
  double reach =
      fmax(hybrid_reach(hybrid, HYBRID_PRESSURE), hybrid_reach(hybrid, HYBRID_SET_POINT));
  enum status status = hybrid_add_bands(hybrid, false, bundle, error);
  if (status == STATUS_OK) {
    status = hybrid_add_switches(result, reach, NULL, bundle, error);
  }
  if (status == STATUS_OK) {
    status = hybrid_add_curve(hybrid, HYBRID_SET_POINT, asked, bundle, error);
  }
  return status == STATUS_OK ? hybrid_add_curve(hybrid, HYBRID_PRESSURE, got, bundle, error)
                             : status;
}

/* Adds "tracking RMS 2.61 mm, 2 switches". */
static void add_quality(const json_t *result, char subtitle[DATA_HEADING]) {
  const json_t *metrics = json_object_get(result, "metrics");
  double rms = data_number(metrics, "tracking_rms_mm");
  double switches = data_number(metrics, "switch_count");
  char number[TICKS_TEXT];
  size_t used = strlen(subtitle);
  if (isfinite(rms) && isfinite(switches)) {
    ticks_number(rms, 3, number);
    snprintf(subtitle + used, DATA_HEADING - used, "%stracking RMS %s mm, %.0f switch%s",
             used ? " · " : "", number, switches, switches == 1 ? "" : "es");
  }
}

enum status draw_control(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error) {
  static const double shares[PANELS] = {0.6, 0.4};
  const json_t *result = inputs[0].result;
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  struct bundle bundles[PANELS] = {{.series = NULL}};
  struct chart charts[PANELS];
  struct hybrid hybrid;
  enum status status = hybrid_read(result, &hybrid, error);
  (void)count;
  data_subtitle(&inputs[0], subtitle);
  add_quality(result, subtitle);
  data_notice(result, notice);
  for (size_t i = 0; i < PANELS && status == STATUS_OK; i++) {
    status = (i ? read_pressure : read_elongation)(&hybrid, result, &bundles[i], error);
    charts[i] = (struct chart){.title = "Elongation under position control",
                               .subtitle = subtitle,
                               .notice = notice,
                               .x_label = "Time (s)",
                               .y_label = i ? "Pressure (kPa)" : "h (mm)",
                               .series = bundles[i].series,
                               .series_count = bundles[i].count,
                               .empty = "No samples were recorded"};
  }
  if (status == STATUS_OK) {
    chart_draw_stack(charts, shares, PANELS, canvas);
  }
  for (size_t i = 0; i < PANELS; i++) {
    bundle_release(&bundles[i]);
  }
  hybrid_release(&hybrid);
  return status;
}
