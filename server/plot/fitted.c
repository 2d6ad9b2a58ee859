#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/bundle.h"
#include "server/plot/data.h"
#include "server/plot/draw.h"

/* Trials in one picture, and measured points shown of each: more could not be told apart. */
enum {
  TRIALS_MOST = 6,
  DOTS_MOST = 80,
  RINGS_MOST = 26,
  NAME = 120,
  QUANTITIES = 2,
  PANELS = 2 * QUANTITIES
};

/* A measured quantity and what the model makes of it. */
struct quantity {
  const char *measured, *simulated, *label, *difference_label;
};

static const struct quantity quantities[QUANTITIES] = {
    {"h_mm", "simulated_h_mm", "h (mm)", "Δh (mm)"},
    {"pressure_kPa", "simulated_pressure_kPa", "p (kPa)", "Δp (kPa)"}};

static bool is_held_out(const json_t *trial) {
  return json_is_true(json_object_get(trial, "held_out"));
}

/* Chooses trials evenly spread over the list; when none of these was held out, the first one that
 * was takes the place of the last. */
static size_t choose_trials(const json_t *trials, const json_t *chosen[TRIALS_MOST]) {
  size_t listed = json_array_size(trials);
  size_t count = listed < TRIALS_MOST ? listed : TRIALS_MOST;
  bool held_out = false;
  for (size_t i = 0; i < count; i++) {
    chosen[i] = json_array_get(trials, count > 1 ? i * (listed - 1) / (count - 1) : 0);
    held_out = held_out || is_held_out(chosen[i]);
  }
  for (size_t i = 0; i < listed && !held_out; i++) {
    if (is_held_out(json_array_get(trials, i))) {
      chosen[count - 1] = json_array_get(trials, i);
      held_out = true;
    }
  }
  return count;
}

/* The samples of a trial that are shown: those after one change of its set-point. */
struct stretch {
  const json_t *trial;
  size_t first, end;
};

static double number_at(const json_t *trial, size_t index, const char *key) {
  return data_number(json_array_get(json_object_get(trial, "samples"), index), key);
}

/* How much a quantity moves over a stretch. */
static double range_of(const struct stretch *stretch, const char *key) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = stretch->first; i < stretch->end; i++) {
    double value = number_at(stretch->trial, i, key);
    low = fmin(low, value);
    high = fmax(high, value);
  }
  return high > low ? high - low : 0;
}

/* The first stretch between changes of the set-point in which the pressure moves about as much as
 * in any. */
static struct stretch choose_stretch(const json_t *trial) {
  size_t count = json_array_size(json_object_get(trial, "samples"));
  struct stretch best = {trial, 0, count}, stretch = {trial, 0, 0};
  double most = -1;
  for (size_t i = 1; i <= count; i++) {
    double before = number_at(trial, i - 1, "set_point_kPa");
    double after = i < count ? number_at(trial, i, "set_point_kPa") : NAN;
    if (i == count || fabs(after - before) > 1e-6) {
      stretch.end = i;
      double range = range_of(&stretch, "pressure_kPa");
      if (range > 1.2 * most) {
        most = range;
        best = stretch;
      }
      stretch.first = i;
    }
  }
  return best;
}

/* Time from the start of the stretch until what is simulated stays near its end. */
static double settling_s(const struct stretch *stretch) {
  double start = number_at(stretch->trial, stretch->first, "time_s"), settled = 0;
  for (size_t q = 0; q < QUANTITIES; q++) {
    const char *key = quantities[q].simulated;
    double near = 0.02 * range_of(stretch, key);
    double last = NAN;
    for (size_t i = stretch->end; i > stretch->first; i--) {
      double value = number_at(stretch->trial, i - 1, key);
      last = isnan(last) ? value : last;
      if (fabs(value - last) > near) {
        settled = fmax(settled, number_at(stretch->trial, i - 1, "time_s") - start);
        break;
      }
    }
  }
  return settled;
}

/* Points (time, value) of a stretch: measured, simulated, or the first less the second. */
struct curves {
  struct point *measured, *simulated, *difference;
  size_t measured_count, simulated_count, difference_count;
};

static void curves_release(struct curves *curves) {
  free(curves->measured);
  free(curves->simulated);
  free(curves->difference);
}

/* Reads the first `span` seconds of a stretch; of the measured points at most `marks`. */
static enum status read_curves(const struct stretch *stretch, const struct quantity *quantity,
                               double span, size_t marks, struct curves *curves,
                               struct error *error) {
  double start = number_at(stretch->trial, stretch->first, "time_s");
  size_t end = stretch->first;
  while (end < stretch->end && !(number_at(stretch->trial, end, "time_s") > start + span)) {
    end++;
  }
  size_t most = end - stretch->first + 1, stride = most / marks + 1;
  *curves = (struct curves){.measured = malloc(most * sizeof *curves->measured),
                            .simulated = malloc(most * sizeof *curves->simulated),
                            .difference = malloc(most * sizeof *curves->difference)};
  if (!curves->measured || !curves->simulated || !curves->difference) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a trial");
  }
  for (size_t i = stretch->first; i < end; i++) {
    double time = number_at(stretch->trial, i, "time_s") - start;
    double measured = number_at(stretch->trial, i, quantity->measured);
    double simulated = number_at(stretch->trial, i, quantity->simulated);
    if (isfinite(time + measured) && (i - stretch->first) % stride == 0) {
      curves->measured[curves->measured_count++] = (struct point){time, measured};
    }
    if (isfinite(time + simulated)) {
      curves->simulated[curves->simulated_count++] = (struct point){time, simulated};
    }
    if (isfinite(time + measured - simulated)) {
      curves->difference[curves->difference_count++] = (struct point){time, measured - simulated};
    }
  }
  return STATUS_OK;
}

/* "trial 8, 20.7 kPa, held out" */
static void name_trial(const struct stretch *stretch, char name[NAME]) {
  const char *its = json_string_value(json_object_get(stretch->trial, "name"));
  bool number = its && *its >= '0' && *its <= '9';
  double set_point = number_at(stretch->trial, stretch->first, "set_point_kPa");
  char pressure[TICKS_TEXT + 8] = "", text[TICKS_TEXT];
  if (isfinite(set_point)) {
    ticks_number(set_point, 3, text);
    snprintf(pressure, sizeof pressure, ", %s kPa", text);
  }
  snprintf(name, NAME, "%s%.40s%s%s", number || !its ? "trial " : "", its ? its : "", pressure,
           is_held_out(stretch->trial) ? ", held out" : "");
}

/* Adds how well the trials that were held out are told. */
static void add_quality(const json_t *result, char subtitle[DATA_HEADING]) {
  const json_t *metrics = json_object_get(result, "metrics");
  char numbers[2][TICKS_TEXT];
  double h = data_number(metrics, "held_out_r_squared_h");
  double pressure = data_number(metrics, "held_out_r_squared_pressure");
  size_t used = strlen(subtitle);
  if (isfinite(h) && isfinite(pressure)) {
    ticks_number(h, 4, numbers[0]);
    ticks_number(pressure, 4, numbers[1]);
    snprintf(subtitle + used, DATA_HEADING - used, "%sR² held out: h %s, p %s", used ? " · " : "",
             numbers[0], numbers[1]);
  }
}

/* Adds one trial to the chart of a quantity and to that of its differences. */
static enum status add_trial(const struct stretch *stretch, double span, size_t place,
                             const struct quantity *quantity, const char *name,
                             struct bundle *values, struct bundle *differences,
                             struct error *error) {
  struct curves curves;
  bool held_out = is_held_out(stretch->trial);
  struct chart_series like = {.colour = colour_series(place), .name = name};
  enum status status =
      read_curves(stretch, quantity, span, held_out ? RINGS_MOST : DOTS_MOST, &curves, error);
  if (status == STATUS_OK) {
    like.marker = place % 2 ? MARKER_SQUARE : MARKER_CIRCLE;
    like.small = !held_out;
    like.hollow = held_out;
    status = bundle_add(values, like, curves.measured, curves.measured_count, error);
  }
  like = (struct chart_series){.colour = colour_series(place), .width = 1.6};
  if (status == STATUS_OK) {
    status = bundle_add(values, like, curves.simulated, curves.simulated_count, error);
  }
  like.width = 1.2;
  like.dash = held_out ? DASH_SHORT : DASH_SOLID;
  if (status == STATUS_OK) {
    status = bundle_add(differences, like, curves.difference, curves.difference_count, error);
  }
  curves_release(&curves);
  return status;
}

/* Adds the chosen trials to the charts: of h and pressure, and of their differences. */
static enum status read_trials(const json_t *result, char names[TRIALS_MOST][NAME],
                               struct bundle bundles[PANELS], struct error *error) {
  const json_t *chosen[TRIALS_MOST];
  struct stretch stretches[TRIALS_MOST];
  size_t trials = choose_trials(json_object_get(result, "trials"), chosen);
  enum status status = STATUS_OK;
  double span = 0;
  for (size_t i = 0; i < trials; i++) {
    stretches[i] = choose_stretch(chosen[i]);
    span = fmax(span, 1.6 * settling_s(&stretches[i]));
  }
  for (size_t i = 0; i < trials; i++) {
    name_trial(&stretches[i], names[i]);
    for (size_t q = 0; q < QUANTITIES && status == STATUS_OK; q++) {
      status = add_trial(&stretches[i], span > 0 ? span : INFINITY, i, &quantities[q],
                         q == 0 ? names[i] : NULL, &bundles[q], &bundles[QUANTITIES + q], error);
    }
  }
  return status;
}

enum status draw_fitted(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error) {
  static const double shares[2] = {0.64, 0.36};
  struct bundle bundles[PANELS] = {{.series = NULL}};
  struct chart charts[PANELS];
  char names[TRIALS_MOST][NAME], subtitle[DATA_HEADING], notice[DATA_HEADING];
  enum status status = read_trials(inputs[0].result, names, bundles, error);
  (void)count;
  data_subtitle(&inputs[0], subtitle);
  add_quality(inputs[0].result, subtitle);
  data_notice(inputs[0].result, notice);
  for (size_t i = 0; i < PANELS; i++) {
    const struct quantity *quantity = &quantities[i % QUANTITIES];
    bool difference = i >= QUANTITIES;
    if (status == STATUS_OK && difference) {
      status = bundle_add_zero(&bundles[i], error);
    }
    charts[i] = (struct chart){.title = "Trials: measured (marks) and simulated (lines)",
                               .subtitle = subtitle,
                               .notice = notice,
                               .x_label = "Time from the step (s)",
                               .y_label = difference ? quantity->difference_label : quantity->label,
                               .series = bundles[i].series,
                               .series_count = bundles[i].count,
                               .empty = "No samples of trials were kept"};
  }
  if (status == STATUS_OK) {
    chart_draw_grid(charts, shares, 2, QUANTITIES, canvas);
  }
  for (size_t i = 0; i < PANELS; i++) {
    bundle_release(&bundles[i]);
  }
  return status;
}
