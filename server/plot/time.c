#include <math.h>
#include <stdlib.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "server/plot/hybrid.h"

enum { PANELS = 3, CURVES = 2, EVENTS_MOST = 60 };

/* The upright lines of the switches, as high as `reach` on both sides of zero. */
static size_t read_events(const json_t *result, double reach, struct point lines[EVENTS_MOST][2]) {
  const json_t *events = json_object_get(result, "events");
  size_t count = 0;
  for (size_t i = 0; i < json_array_size(events) && count < EVENTS_MOST; i++) {
    double time = data_number(json_array_get(events, i), "time_s");
    if (time >= 0) {
      lines[count][0] = (struct point){time, -reach};
      lines[count++][1] = (struct point){time, reach};
    }
  }
  return count;
}

/* What lies behind the curves of every panel: a band for each stay in a mode, a line for each
 * switch. Many stays make no picture: then there are none. */
static size_t add_background(const struct hybrid *hybrid, struct point lines[EVENTS_MOST][2],
                             size_t events, bool named, struct chart_series *series) {
  size_t count = 0;
  for (size_t i = 0; i < hybrid->span_count && hybrid->span_count <= HYBRID_SPANS; i++) {
    const struct hybrid_span *span = &hybrid->span[i];
    series[count++] =
        (struct chart_series){.points = span->ends,
                              .count = 2,
                              .style = STYLE_SPAN,
                              .guide = true,
                              .colour = hybrid_band(span->mode),
                              .name = named && span->named ? hybrid->mode[span->mode] : NULL};
  }
  for (size_t i = 0; i < events && hybrid->span_count <= HYBRID_SPANS; i++) {
    series[count++] = (struct chart_series){.points = lines[i],
                                            .count = 2,
                                            .guide = true,
                                            .colour = colour_muted,
                                            .width = 1.2,
                                            .dash = DASH_SHORT,
                                            .name = named && i == 0 ? "switch" : NULL};
  }
  return count;
}

/* Reads the curves of the panels: h, v, p and beside it the set-point. */
static enum status read_curves(const struct hybrid *hybrid, struct point *points[PANELS + 1],
                               size_t counts[PANELS + 1], struct error *error) {
  static const enum hybrid_quantity quantities[PANELS + 1] = {HYBRID_H, HYBRID_VELOCITY,
                                                              HYBRID_PRESSURE, HYBRID_SET_POINT};
  enum status status = STATUS_OK;
  for (size_t i = 0; i <= PANELS && status == STATUS_OK; i++) {
    status = hybrid_curve(hybrid, HYBRID_TIME, quantities[i], 0, hybrid->count, &points[i],
                          &counts[i], error);
  }
  return status;
}

enum status draw_time(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                      struct error *error) {
  static const double shares[PANELS] = {0.37, 0.26, 0.37};
  static const char *const labels[PANELS] = {"h (mm)", "h' (m/s)", "Pressure (kPa)"};
  (void)count;
  struct chart_series series[PANELS][HYBRID_SPANS + EVENTS_MOST + CURVES];
  struct point lines[PANELS][EVENTS_MOST][2], *points[PANELS + 1] = {NULL};
  size_t counts[PANELS + 1] = {0};
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  struct hybrid hybrid;
  struct chart charts[PANELS];
  enum status status = hybrid_read(inputs[0].result, &hybrid, error);
  if (status == STATUS_OK) {
    status = read_curves(&hybrid, points, counts, error);
  }
  if (status != STATUS_OK) {
    goto done;
  }
  data_subtitle(&inputs[0], subtitle);
  data_notice(inputs[0].result, notice);
  const double reaches[PANELS] = {
      hybrid_reach(&hybrid, HYBRID_H), hybrid_reach(&hybrid, HYBRID_VELOCITY),
      fmax(hybrid_reach(&hybrid, HYBRID_PRESSURE), hybrid_reach(&hybrid, HYBRID_SET_POINT))};
  for (size_t i = 0; i < PANELS; i++) {
    size_t events = read_events(inputs[0].result, reaches[i], lines[i]);
    size_t used = add_background(&hybrid, lines[i], events, i == 0, series[i]);
    bool pressure = i + 1 == PANELS;
    if (pressure) {
      series[i][used++] = (struct chart_series){.points = points[PANELS],
                                                .count = counts[PANELS],
                                                .colour = colour_series(1),
                                                .width = 1.6,
                                                .dash = DASH_LONG,
                                                .name = "set-point"};
    }
    series[i][used++] = (struct chart_series){.points = points[i],
                                              .count = counts[i],
                                              .colour = colour_ink,
                                              .width = 1.8,
                                              .name = pressure ? "in the chamber" : NULL};
    charts[i] = (struct chart){.title = "Elongation, speed and pressure over time",
                               .subtitle = subtitle,
                               .notice = notice,
                               .x_label = "Time (s)",
                               .y_label = labels[i],
                               .series = series[i],
                               .series_count = used,
                               .empty = "No samples were recorded"};
  }
  chart_draw_stack(charts, shares, PANELS, canvas);
done:
  for (size_t i = 0; i <= PANELS; i++) {
    free(points[i]);
  }
  hybrid_release(&hybrid);
  return status;
}
