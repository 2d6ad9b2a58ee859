#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"

enum {
  COEFFICIENTS_MOST = 12,
  POINTS_FEW = 60 /* more than these are small dots, or they would hide the curve */
};

/* A tensile test with the curve through it. */
struct tensile {
  struct point *measured, *fitted;
  double *band; /* of the fitted curve; NULL when no point has one */
  size_t measured_count, fitted_count;
  struct point range[2]; /* x: strains of the fit */
  bool has_range;
  char fit_name[120];
  char lines[COEFFICIENTS_MOST][120]; /* coefficients in words */
  size_t line_count;
};

static void tensile_release(struct tensile *t) {
  free(t->measured);
  free(t->fitted);
  free(t->band);
}

static enum status read_samples(const json_t *result, struct tensile *t, struct error *error) {
  const json_t *samples = json_object_get(result, "samples");
  size_t count = json_array_size(samples), banded = 0;
  t->measured = calloc(count + 1, sizeof *t->measured);
  t->fitted = calloc(count + 1, sizeof *t->fitted);
  t->band = calloc(count + 1, sizeof *t->band);
  if (!t->measured || !t->fitted || !t->band) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu points", count);
  }
  for (size_t i = 0; i < count; i++) {
    const json_t *sample = json_array_get(samples, i);
    double strain = data_number(sample, "strain"), band = data_number(sample, "band_MPa");
    struct point measured = {strain, data_number(sample, "measured_stress_MPa")};
    struct point fitted = {strain, data_number(sample, "fitted_stress_MPa")};
    if (isfinite(strain) && isfinite(measured.y)) {
      t->measured[t->measured_count++] = measured;
    }
    if (isfinite(strain) && isfinite(fitted.y)) {
      banded += band >= 0;
      t->band[t->fitted_count] = band >= 0 ? band : 0;
      t->fitted[t->fitted_count++] = fitted;
    }
  }
  if (banded == 0) {
    free(t->band);
    t->band = NULL;
  }
  return STATUS_OK;
}

/* Writes a name with its Greek letter: "μ1" for "mu1". */
static void greek(const char *name, char text[32]) {
  bool mu = strncmp(name, "mu", strlen("mu")) == 0;
  bool alpha = strncmp(name, "alpha", strlen("alpha")) == 0;
  snprintf(text, 32, "%s%.20s",
           mu      ? "μ"
           : alpha ? "α"
                   : "",
           name + (mu      ? strlen("mu")
                   : alpha ? strlen("alpha")
                           : 0));
}

/* The name of a law as people write it. */
static const char *law_name(const char *model) {
  static const char *const names[][2] = {{"yeoh", "Yeoh"},
                                         {"ogden", "Ogden"},
                                         {"neo-hooke", "neo-Hooke"},
                                         {"mooney-rivlin", "Mooney-Rivlin"}};
  for (size_t i = 0; model && i < sizeof names / sizeof *names; i++) {
    if (strcmp(model, names[i][0]) == 0) {
      return names[i][1];
    }
  }
  return "fitted";
}

/* "C1 = 0.1124 ± 0.0031 MPa" for every coefficient with its interval. */
static void read_coefficients(const json_t *result, struct tensile *t) {
  const json_t *list = json_object_get(result, "coefficients");
  for (size_t i = 0; i < json_array_size(list) && t->line_count < COEFFICIENTS_MOST; i++) {
    const json_t *entry = json_array_get(list, i);
    const char *name = json_string_value(json_object_get(entry, "name"));
    const char *unit = json_string_value(json_object_get(entry, "unit"));
    double value = data_number(entry, "value"), half = data_number(entry, "half_width");
    char number[TICKS_TEXT], interval[TICKS_TEXT], extent[TICKS_TEXT + 8] = "", symbol[32];
    if (!name || !isfinite(value)) {
      continue;
    }
    ticks_number(value, 4, number);
    if (isfinite(half)) {
      ticks_number(half, 2, interval);
      snprintf(extent, sizeof extent, " ± %s", interval);
    }
    greek(name, symbol);
    bool pure = !unit || strcmp(unit, "1") == 0;
    snprintf(t->lines[t->line_count++], sizeof *t->lines, "%s = %s%s%s%.12s", symbol, number,
             extent, pure ? "" : " ", pure ? "" : unit);
  }
}

/* Name of the fitted curve and the strains that it comes from. */
static void read_fit(const json_t *result, struct tensile *t) {
  const json_t *metrics = json_object_get(result, "metrics");
  const json_t *material = json_object_get(result, "material");
  const char *model = json_string_value(json_object_get(material, "model"));
  double r_squared = data_number(metrics, "r_squared");
  char number[TICKS_TEXT];
  ticks_number(r_squared, r_squared > 0.9999 ? 6 : 4, number);
  snprintf(t->fit_name, sizeof t->fit_name, "%s%s%s%s", law_name(model),
           t->band ? ", 95 % band" : "", isfinite(r_squared) ? ", R² = " : "",
           isfinite(r_squared) ? number : "");
  t->range[0].x = data_number(metrics, "strain_from");
  t->range[1].x = data_number(metrics, "strain_to");
  t->has_range = t->range[1].x > t->range[0].x;
}

static void draw_tensile(struct canvas *canvas, const struct plot_input *input,
                         const struct tensile *t) {
  struct chart_series series[3 + COEFFICIENTS_MOST] = {{.points = t->fitted,
                                                        .count = t->fitted_count,
                                                        .colour = colour_series(0),
                                                        .width = 2.2,
                                                        .band = t->band,
                                                        .name = t->fit_name}};
  size_t count = 1;
  /* coefficients are words in the legend without anything in the chart */
  for (size_t i = 0; i < t->line_count && t->fitted_count > 0; i++) {
    series[count++] = (struct chart_series){
        .points = t->fitted, .count = 1, .colour = colour_series(0), .name = t->lines[i]};
  }
  series[count++] = (struct chart_series){.points = t->measured,
                                          .count = t->measured_count,
                                          .colour = colour_series(1),
                                          .marker = MARKER_CIRCLE,
                                          .hollow = t->measured_count <= POINTS_FEW,
                                          .small = t->measured_count > POINTS_FEW,
                                          .name = "measured"};
  series[count++] = (struct chart_series){.points = t->range,
                                          .count = t->has_range ? 2 : 0,
                                          .style = STYLE_SPAN,
                                          .guide = true,
                                          .colour = colour_shade,
                                          .name = "range of the fit"};
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  data_subtitle(input, subtitle);
  data_notice(input->result, notice);
  struct chart chart = {.title = "Stress against strain",
                        .subtitle = subtitle,
                        .notice = notice,
                        .x_label = "Engineering strain",
                        .y_label = "Engineering stress (MPa)",
                        .from_zero = true,
                        .series = series,
                        .series_count = count,
                        .empty = "No points were fitted"};
  chart_draw(&chart, canvas);
}

enum status draw_fit(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                     struct error *error) {
  (void)count;
  struct tensile tensile = {.measured = NULL};
  enum status status = read_samples(inputs[0].result, &tensile, error);
  if (status == STATUS_OK) {
    read_coefficients(inputs[0].result, &tensile);
    read_fit(inputs[0].result, &tensile);
    draw_tensile(canvas, &inputs[0], &tensile);
  }
  tensile_release(&tensile);
  return status;
}
