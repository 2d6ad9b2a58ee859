#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "server/plot/extension.h"
#include "server/plot/grasp.h"
#include "server/plot/profile.h"

struct texts {
  char name[DATA_HEADING];
  char detail[80];
};

/* "1.27 °/kPa" with a star when the curve ends early; without the number when it is not known. */
static void describe(const json_t *result, char *text, size_t size) {
  char notice[DATA_HEADING], number[TICKS_TEXT];
  double slope = data_number(json_object_get(result, "metrics"), "sensitivity_deg_per_kPa");
  if (!isfinite(slope)) {
    slope = data_number(json_object_get(result, "fit"), "slope_deg_per_kPa");
  }
  data_notice(result, notice);
  ticks_number(slope, 3, number);
  if (isfinite(slope)) {
    snprintf(text, size, "%s °/kPa%s", number, *notice ? " *" : "");
  } else {
    snprintf(text, size, "%s", *notice ? "*" : "");
  }
}

/* Whether all of them are of one sort: bistable actuators, or grasps. */
static bool are_all(bool (*is_of)(const json_t *), const struct plot_input *inputs, size_t count) {
  bool all = true;
  for (size_t i = 0; i < count; i++) {
    all = all && is_of(inputs[i].result);
  }
  return all;
}

static enum status draw_bistable(struct canvas *canvas, const struct plot_input *inputs,
                                 size_t count, struct texts *texts, const char *subtitle,
                                 struct error *error) {
  struct extension_source sources[DRAW_OVERLAY_LIMIT];
  for (size_t i = 0; i < count; i++) {
    data_name(&inputs[i], texts[i].name);
    sources[i] = (struct extension_source){inputs[i].result, texts[i].name};
  }
  return extension_draw(canvas, sources, count,
                        &(struct extension_heading){.subtitle = subtitle, .notice = ""}, error);
}

static enum status draw_grasps(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                               struct texts *texts, const char *subtitle, struct error *error) {
  struct profile_source sources[DRAW_OVERLAY_LIMIT];
  for (size_t i = 0; i < count; i++) {
    data_name(&inputs[i], texts[i].name);
    sources[i] = (struct profile_source){inputs[i].result, texts[i].name};
  }
  return profile_draw(canvas, sources, count,
                      &(struct profile_heading){.subtitle = subtitle, .notice = ""}, error);
}

enum status draw_overlay(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error) {
  enum status status = STATUS_OK;
  struct chart_series series[DRAW_OVERLAY_LIMIT];
  struct point *points[DRAW_OVERLAY_LIMIT] = {NULL};
  struct texts *texts = calloc(count, sizeof *texts);
  if (!texts) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu curves", count);
  }
  bool stopped = false;
  char subtitle[64];
  snprintf(subtitle, sizeof subtitle, "%zu job%s", count, count == 1 ? "" : "s");
  if (are_all(extension_is_of, inputs, count)) {
    status = draw_bistable(canvas, inputs, count, texts, subtitle, error);
    goto done;
  }
  if (are_all(grasp_is_of, inputs, count)) {
    status = draw_grasps(canvas, inputs, count, texts, subtitle, error);
    goto done;
  }
  for (size_t i = 0; i < count; i++) {
    size_t point_count;
    status = data_samples(inputs[i].result, "pressure_kPa", "bending_angle_deg", &points[i],
                          &point_count, error);
    if (status != STATUS_OK) {
      goto done;
    }
    data_name(&inputs[i], texts[i].name);
    describe(inputs[i].result, texts[i].detail, sizeof texts[i].detail);
    stopped = stopped || strchr(texts[i].detail, '*');
    series[i] =
        (struct chart_series){.points = points[i],
                              .count = point_count,
                              .colour = colour_series(i),
                              .width = 2.0,
                              .marker = (enum chart_marker)(MARKER_CIRCLE + i % (MARKER_COUNT - 1)),
                              .dash = (enum chart_dash)(i % DASH_COUNT),
                              .name = texts[i].name,
                              .detail = texts[i].detail};
  }
  size_t used = strlen(subtitle);
  snprintf(subtitle + used, sizeof subtitle - used, "%s", stopped ? " · * stopped early" : "");
  struct chart chart = {.title = "Bending angle against pressure",
                        .subtitle = subtitle,
                        .x_label = "Pressure (kPa)",
                        .y_label = "Bending angle (°)",
                        .from_zero = true,
                        .series = series,
                        .series_count = count,
                        .empty = "None of the jobs has samples"};
  chart_draw(&chart, canvas);
done:
  for (size_t i = 0; i < count; i++) {
    free(points[i]);
  }
  free(texts);
  return status;
}
