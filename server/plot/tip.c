#include <math.h>
#include <stdlib.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"

enum { LABELS = 7 };

/* Labels the pressure at about LABELS samples spread evenly along the way, first and last among
 * them; several samples may lie close together when the body stops moving. */
static size_t label_pressures(const json_t *result, struct chart_label labels[LABELS]) {
  const json_t *samples = json_object_get(result, "samples");
  size_t recorded = json_array_size(samples), count = 0, last = recorded;
  size_t wanted = recorded < LABELS ? recorded : LABELS;
  for (size_t k = 0; k < wanted; k++) {
    size_t i = wanted > 1 ? k * (recorded - 1) / (wanted - 1) : 0;
    const json_t *sample = json_array_get(samples, i);
    struct point at = {data_number(sample, "tip_x_mm"), data_number(sample, "tip_z_mm")};
    double pressure = data_number(sample, "pressure_kPa");
    if (i == last || !isfinite(at.x) || !isfinite(at.y) || !isfinite(pressure)) {
      continue;
    }
    char number[TICKS_TEXT];
    ticks_plain(pressure, 3, number);
    labels[count].at = at;
    snprintf(labels[count].text, sizeof labels[count].text, "%s kPa", number);
    count++;
    last = i;
  }
  return count;
}

enum status draw_tip(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                     struct error *error) {
  (void)count;
  struct point *points = NULL;
  size_t point_count = 0;
  enum status status =
      data_samples(inputs[0].result, "tip_x_mm", "tip_z_mm", &points, &point_count, error);
  if (status != STATUS_OK) {
    return status;
  }
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  data_subtitle(&inputs[0], subtitle);
  data_notice(inputs[0].result, notice);
  struct chart_label labels[LABELS];
  struct chart_series series = {.points = points,
                                .count = point_count,
                                .colour = colour_series(0),
                                .width = 2.2,
                                .marker = MARKER_CIRCLE};
  struct chart chart = {.title = "Path of the tip",
                        .subtitle = subtitle,
                        .notice = notice,
                        .x_label = "x along the body (mm)",
                        .y_label = "z (mm)",
                        .equal = true,
                        .series = &series,
                        .series_count = 1,
                        .labels = labels,
                        .label_count = label_pressures(inputs[0].result, labels),
                        .empty = "No positions of the tip were recorded"};
  chart_draw(&chart, canvas);
  free(points);
  return STATUS_OK;
}
