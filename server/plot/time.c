#include <math.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "server/plot/hybrid.h"

enum { PANELS = 3, PRESSURE = 2 };

/* Adds background and curves of one panel: h, v, or the pressure with its set-point. */
static enum status read_panel(const struct hybrid *hybrid, const json_t *result, size_t panel,
                              struct bundle *bundle, struct error *error) {
  static const enum hybrid_quantity quantities[PANELS] = {HYBRID_H, HYBRID_VELOCITY,
                                                          HYBRID_PRESSURE};
  double reach = hybrid_reach(hybrid, quantities[panel]);
  if (panel == PRESSURE) {
    reach = fmax(reach, hybrid_reach(hybrid, HYBRID_SET_POINT));
  }
  enum status status = hybrid_add_bands(hybrid, panel == 0, bundle, error);
  if (status == STATUS_OK) {
    status = hybrid_add_switches(result, reach, panel == 0 ? "switch" : NULL, bundle, error);
  }
  if (status == STATUS_OK && panel == PRESSURE) {
    struct chart_series like = {
        .colour = colour_series(1), .width = 1.6, .dash = DASH_LONG, .name = "set-point"};
    status = hybrid_add_curve(hybrid, HYBRID_SET_POINT, like, bundle, error);
  }
  struct chart_series like = {
      .colour = colour_ink, .width = 1.8, .name = panel == PRESSURE ? "in the chamber" : NULL};
  return status == STATUS_OK ? hybrid_add_curve(hybrid, quantities[panel], like, bundle, error)
                             : status;
}

enum status draw_time(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                      struct error *error) {
  static const double shares[PANELS] = {0.37, 0.26, 0.37};
  static const char *const labels[PANELS] = {"h (mm)", "h' (m/s)", "Pressure (kPa)"};
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  struct bundle bundles[PANELS] = {{.series = NULL}};
  struct chart charts[PANELS];
  struct hybrid hybrid;
  enum status status = hybrid_read(inputs[0].result, &hybrid, error);
  (void)count;
  data_subtitle(&inputs[0], subtitle);
  data_notice(inputs[0].result, notice);
  for (size_t i = 0; i < PANELS && status == STATUS_OK; i++) {
    status = read_panel(&hybrid, inputs[0].result, i, &bundles[i], error);
    charts[i] = (struct chart){.title = "Elongation, speed and pressure over time",
                               .subtitle = subtitle,
                               .notice = notice,
                               .x_label = "Time (s)",
                               .y_label = labels[i],
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
