#include <math.h>

#include "server/plot/draw.h"
#include "server/plot/grasp.h"

/* The force on the object while the pressure rises: that of a tip against a plate, or what a body
 * does to an object before it is pulled. */
enum status draw_press(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error) {
  const json_t *result = inputs[0].result, *metrics = json_object_get(result, "metrics");
  bool blocked = isfinite(data_number(metrics, "blocked_force_N"));
  struct bundle bundle = {.series = NULL};
  struct grasp_curve curve;
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  (void)count;
  data_subtitle(&inputs[0], subtitle);
  data_notice(result, notice);
  enum status status =
      grasp_curve_read(result, "inflation", "pressure_kPa", "grasp_force_N", &curve, error);
  if (status == STATUS_OK && curve.count > 0) {
    struct chart_series like = {.colour = colour_series(0), .width = 2.2, .marker = MARKER_CIRCLE};
    status = grasp_curve_add(&bundle, &curve, like, error);
  }
  if (status == STATUS_OK) {
    struct chart chart = {.title = blocked ? "Blocked force against pressure"
                                           : "Force on the object against pressure",
                          .subtitle = subtitle,
                          .notice = notice,
                          .x_label = "Pressure (kPa)",
                          .y_label = blocked ? "Blocked force (N)" : "Force (N)",
                          .from_zero = true,
                          .series = bundle.series,
                          .series_count = bundle.count,
                          .empty = "The body did not press on the object"};
    chart_draw(&chart, canvas);
  }
  grasp_curve_release(&curve);
  bundle_release(&bundle);
  return status;
}
