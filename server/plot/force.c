#include <math.h>
#include <stdio.h>

#include "server/plot/draw.h"
#include "server/plot/grasp.h"

enum { WORDS = TICKS_TEXT + 16 };

/* What stands beside the curve. */
struct remarks {
  char mean[WORDS], peak[WORDS], slip[WORDS], end[WORDS];
  struct point slips;
  struct chart_label labels[2];
  size_t label_count;
};

static void say(char text[WORDS], const char *before, double value, const char *unit) {
  char number[TICKS_TEXT];
  ticks_plain(value, 3, number);
  snprintf(text, WORDS, "%s%s%s", before, number, unit);
}

static void add_label(struct remarks *remarks, struct point at, const char *text) {
  struct chart_label *label = &remarks->labels[remarks->label_count++];
  label->at = at;
  snprintf(label->text, sizeof label->text, "%s", text);
}

/* The mean as a level line over the stretch it was taken of, as far as that can be seen. */
static enum status add_mean(struct bundle *bundle, const struct grasp_curve *curve, double mean,
                            double released, struct remarks *remarks, struct error *error) {
  if (!isfinite(mean) || curve->count < 2) {
    return STATUS_OK;
  }
  double end = curve->points[curve->count - 1].x;
  struct point line[2] = {{curve->points[0].x, mean}, {isfinite(released) ? released : end, mean}};
  say(remarks->mean, "mean ", mean, " N");
  struct chart_series series = {.colour = colour_series(2),
                                .width = 1.6,
                                .dash = DASH_LONG,
                                .name = "mean in contact",
                                .detail = remarks->mean + 5};
  return bundle_add(bundle, series, line, 2, error);
}

static enum status add_marks(struct bundle *bundle, const struct grasp_curve *curve,
                             const json_t *metrics, struct remarks *remarks, struct error *error) {
  double peak = data_number(metrics, "grasp_force_peak_N");
  double released = data_number(metrics, "released_at_mm");
  struct point top = curve->points[grasp_curve_peak(curve)];
  struct chart_series marker = {.colour = colour_ink, .marker = MARKER_DIAMOND, .hollow = true};
  say(remarks->peak, "peak ", isfinite(peak) ? peak : top.y, " N");
  add_label(remarks, top, remarks->peak);
  enum status status =
      add_mean(bundle, curve, data_number(metrics, "grasp_force_mean_N"), released, remarks, error);
  if (status == STATUS_OK) {
    status = bundle_add(bundle, marker, &top, 1, error);
  }
  if (status == STATUS_OK && isfinite(released)) {
    struct point end = {released, 0};
    marker.marker = MARKER_CROSS;
    marker.hollow = false;
    say(remarks->end, "lets go at ", released, " mm");
    add_label(remarks, end, remarks->end);
    status = bundle_add(bundle, marker, &end, 1, error);
  }
  remarks->slips.x = data_number(metrics, "slip_onset_mm");
  say(remarks->slip, "slips from ", remarks->slips.x, " mm");
  return status;
}

static void draw_chart(struct canvas *canvas, const struct plot_input *input,
                       const struct bundle *bundle, const struct remarks *remarks) {
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  data_subtitle(input, subtitle);
  data_notice(input->result, notice);
  struct chart chart = {.title = "Grasp force against displacement",
                        .subtitle = subtitle,
                        .notice = notice,
                        .x_label = "Displacement of the object (mm)",
                        .y_label = "Grasp force (N)",
                        .from_zero = true,
                        .series = bundle->series,
                        .series_count = bundle->count,
                        .labels = remarks->labels,
                        .label_count = remarks->label_count,
                        .mark = remarks->slips.x > 0 ? &remarks->slips : NULL,
                        .mark_text = remarks->slip,
                        .empty = "The object was not pulled"};
  chart_draw(&chart, canvas);
}

enum status draw_force(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error) {
  const json_t *result = inputs[0].result;
  struct bundle bundle = {.series = NULL};
  struct remarks remarks = {.slips = {NAN, 0}};
  struct grasp_curve curve;
  (void)count;
  enum status status =
      grasp_curve_read(result, "pull", "displacement_mm", "grasp_force_N", &curve, error);
  if (status == STATUS_OK && curve.count > 0) {
    struct chart_series like = {.colour = colour_series(0), .width = 2.2, .name = "quasi-static"};
    status = grasp_curve_add(&bundle, &curve, like, error);
  }
  if (status == STATUS_OK && curve.count > 0) {
    status = add_marks(&bundle, &curve, json_object_get(result, "metrics"), &remarks, error);
  }
  if (status == STATUS_OK) {
    draw_chart(canvas, &inputs[0], &bundle, &remarks);
  }
  grasp_curve_release(&curve);
  bundle_release(&bundle);
  return status;
}
