#include <stdlib.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"

/* From so many points on, the reference is drawn as a curve; fewer than FEW points are not joined,
 * which would show kinks that are none. */
enum { DENSE = 40, FEW = 12 };

enum status draw_curve(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error) {
  (void)count;
  const json_t *result = inputs[0].result, *known = json_object_get(result, "case");
  const char *key = json_string_value(json_object_get(known, "point"));
  const char *x_label = json_string_value(json_object_get(known, "x_label"));
  const char *y_label = json_string_value(json_object_get(known, "y_label"));
  struct point *computed = NULL, *reference = NULL;
  size_t computed_count = 0, reference_count = 0;
  enum status status = STATUS_OK;
  if (key) {
    status = data_samples(result, key, "computed", &computed, &computed_count, error);
  }
  if (key && status == STATUS_OK) {
    status = data_samples(result, key, "reference", &reference, &reference_count, error);
  }
  if (status == STATUS_OK) {
    char subtitle[DATA_HEADING], notice[DATA_HEADING];
    data_subtitle(&inputs[0], subtitle);
    data_notice(result, notice);
    bool dense = reference_count >= DENSE;
    struct chart_series known_series = {.points = reference,
                                        .count = reference_count,
                                        .colour = colour_series(1),
                                        .width = dense ? 2.2 : 0,
                                        .marker = dense ? MARKER_NONE : MARKER_CROSS,
                                        .name = "reference"};
    struct chart_series computed_series = {.points = computed,
                                           .count = computed_count,
                                           .colour = colour_series(0),
                                           .width = dense || computed_count < FEW ? 0 : 1.8,
                                           .marker = MARKER_CIRCLE,
                                           .name = "computed"};
    /* Single values stay visible on top of the curve, a curve below the points. */
    const struct chart_series series[] = {dense ? known_series : computed_series,
                                          dense ? computed_series : known_series};
    struct chart chart = {.title = "Computed and reference",
                          .subtitle = subtitle,
                          .notice = notice,
                          .x_label = x_label ? x_label : "",
                          .y_label = y_label ? y_label : "",
                          .series = series,
                          .series_count = sizeof series / sizeof *series,
                          .empty = "This case has no curve"};
    chart_draw(&chart, canvas);
  }
  free(computed);
  free(reference);
  return status;
}
