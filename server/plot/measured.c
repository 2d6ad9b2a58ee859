#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "server/plot/quantity.h"

/* Curves that were measured, and what differs from them. */
struct comparison {
  struct point *simulated; /* of the samples */
  size_t simulated_count;
  struct point *measured, *differences;
  double *errors; /* of the measured points, NaN for none */
  size_t measured_count, difference_count;
  double largest, mean_square;
};

static void comparison_release(struct comparison *c) {
  free(c->simulated);
  free(c->measured);
  free(c->differences);
  free(c->errors);
}

/* The angle that was measured. */
static const char *metric_of(const json_t *result) {
  const char *metric = json_string_value(json_object_get(result, "measured_metric"));
  return metric ? metric : "bending_angle_deg";
}

static enum status comparison_read(const json_t *result, struct comparison *c,
                                   struct error *error) {
  const json_t *list = json_object_get(result, "measured");
  size_t listed = json_array_size(list);
  enum status status = data_samples(result, "pressure_kPa", metric_of(result), &c->simulated,
                                    &c->simulated_count, error);
  c->measured = calloc(listed + 1, sizeof *c->measured);
  c->differences = calloc(listed + 1, sizeof *c->differences);
  c->errors = calloc(listed + 1, sizeof *c->errors);
  if (status == STATUS_OK && (!c->measured || !c->differences || !c->errors)) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu points", listed);
  }
  for (size_t i = 0; status == STATUS_OK && i < listed; i++) {
    const json_t *entry = json_array_get(list, i);
    double pressure = data_number(entry, "pressure_kPa");
    struct point measured = {pressure, data_number(entry, "measured")};
    struct point difference = {pressure, data_number(entry, "error")};
    if (!isfinite(difference.y)) {
      difference.y = data_number(entry, "simulated") - measured.y;
    }
    if (isfinite(pressure) && isfinite(measured.y)) {
      c->errors[c->measured_count] = data_number(entry, "uncertainty");
      c->measured[c->measured_count++] = measured;
    }
    if (isfinite(pressure) && isfinite(difference.y)) {
      c->differences[c->difference_count++] = difference;
      c->largest = fmax(c->largest, fabs(difference.y));
      c->mean_square += difference.y * difference.y;
    }
  }
  c->mean_square /= fmax((double)c->difference_count, 1);
  return status;
}

enum status draw_measured(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                          struct error *error) {
  static const double shares[2] = {0.66, 0.34};
  (void)count;
  struct comparison c = {.simulated = NULL};
  char y_label[160], subtitle[DATA_HEADING], notice[DATA_HEADING], name[140], worst[TICKS_TEXT],
      mean[TICKS_TEXT];
  enum status status = comparison_read(inputs[0].result, &c, error);
  if (status != STATUS_OK) {
    goto done;
  }
  quantity_label(metric_of(inputs[0].result), y_label, sizeof y_label);
  data_subtitle(&inputs[0], subtitle);
  data_notice(inputs[0].result, notice);
  ticks_number(c.largest, 2, worst);
  ticks_number(sqrt(c.mean_square), 2, mean);
  snprintf(name, sizeof name, "largest %s°, root mean square %s°", worst, mean);
  const struct chart_series curves[] = {{.points = c.simulated,
                                         .count = c.simulated_count,
                                         .colour = colour_series(0),
                                         .width = 2.2,
                                         .name = "simulation"},
                                        {.points = c.measured,
                                         .count = c.measured_count,
                                         .colour = colour_series(1),
                                         .marker = MARKER_CIRCLE,
                                         .hollow = true,
                                         .errors = c.errors,
                                         .name = "measured"}};
  const struct chart_series bars[] = {{.points = c.differences,
                                       .count = c.difference_count,
                                       .style = STYLE_STEMS,
                                       .colour = colour_series(1),
                                       .width = 2.0,
                                       .marker = MARKER_CIRCLE,
                                       .name = name}};
  const struct chart charts[2] = {{.title = "Simulation against measurement",
                                   .subtitle = subtitle,
                                   .notice = notice,
                                   .x_label = "Pressure (kPa)",
                                   .y_label = y_label,
                                   .from_zero = true,
                                   .series = curves,
                                   .series_count = 2,
                                   .empty = "Neither samples nor measured points"},
                                  {.x_label = "Pressure (kPa)",
                                   .y_label = "Difference (°)",
                                   .from_zero = true,
                                   .series = bars,
                                   .series_count = 1,
                                   .empty = "No differences"}};
  chart_draw_stack(charts, shares, 2, canvas);
done:
  comparison_release(&c);
  return status;
}
