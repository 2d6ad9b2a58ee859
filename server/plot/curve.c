#include <stdlib.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"

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
    const struct chart_series series[] = {{.points = reference,
                                           .count = reference_count,
                                           .colour = colour_series(1),
                                           .width = 2.2,
                                           .name = "reference"},
                                          {.points = computed,
                                           .count = computed_count,
                                           .colour = colour_series(0),
                                           .marker = MARKER_CIRCLE,
                                           .name = "computed"}};
    struct chart chart = {.title = "Computed and reference",
                          .subtitle = subtitle,
                          .notice = notice,
                          .x_label = x_label ? x_label : "",
                          .y_label = y_label ? y_label : "",
                          .from_zero = false,
                          .series = series,
                          .series_count = sizeof series / sizeof *series,
                          .empty = "This case has no curve"};
    chart_draw(&chart, canvas);
  }
  free(computed);
  free(reference);
  return status;
}
