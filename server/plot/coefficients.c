#include <math.h>
#include <stdlib.h>
#include <stdio.h>
#include <string.h>

#include "server/plot/bundle.h"
#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "solver/base/numbers.h"

enum { COEFFICIENTS = 4, MODES_MOST = 8, POINTS_MOST = 200 };

/* One coefficient over the set-points, of all modes: itself, or over the mass when that is not
 * known. */
struct sheet {
  const char *key, *label;
  const char *other_key, *other_label;
  struct bundle bundle;
};

/* A value with its interval at a set-point. */
struct interval {
  struct point at;
  double half;
};

/* An interval so many times as wide as the middle one is cut at the axes. */
static const double WIDE = 10;

static bool read_interval(const json_t *entry, const json_t *set_point_of,
                          struct interval *interval) {
  double low = data_number(entry, "low"), high = data_number(entry, "high");
  interval->at =
      (struct point){data_number(set_point_of, "set_point_kPa"), data_number(entry, "value")};
  interval->half = (high - low) / 2;
  return isfinite(interval->at.x) && isfinite(interval->at.y);
}

/* The widest half of an interval of a coefficient that its chart shows whole. */
static double widest_shown(const json_t *modes, const char *key) {
  double halves[POINTS_MOST];
  size_t count = 0, m, i;
  const json_t *mode, *entry;
  json_array_foreach(modes, m, mode) {
    json_array_foreach(json_object_get(mode, "points"), i, entry) {
      struct interval interval;
      if (count < POINTS_MOST && read_interval(json_object_get(entry, key), entry, &interval) &&
          isfinite(interval.half)) {
        halves[count++] = interval.half;
      }
    }
  }
  qsort(halves, count, sizeof *halves, numbers_compare);
  return count ? WIDE * halves[count / 2] : INFINITY;
}

/* Adds the identified values of a mode, `aside` of their set-points so that those of modes that
 * agree do not hide each other. Intervals wider than `widest` would squeeze all others: they are
 * cut at the axes. */
static enum status add_points(const json_t *mode, const struct sheet *sheet, double aside,
                              double widest, struct chart_series like, struct bundle *bundle,
                              struct error *error) {
  struct point points[2][POINTS_MOST];
  double errors[2][POINTS_MOST];
  size_t counts[2] = {0, 0}, index;
  const json_t *entry;
  enum status status = STATUS_OK;
  json_array_foreach(json_object_get(mode, "points"), index, entry) {
    struct interval interval;
    if (!read_interval(json_object_get(entry, sheet->key), entry, &interval)) {
      continue;
    }
    size_t wide = interval.half > widest;
    if (counts[wide] < POINTS_MOST) {
      errors[wide][counts[wide]] = interval.half;
      points[wide][counts[wide]++] = (struct point){interval.at.x + aside, interval.at.y};
    }
  }
  for (size_t wide = 0; wide < 2 && status == STATUS_OK; wide++) {
    like.errors = errors[wide];
    like.guide = like.hollow = wide == 1;
    like.name = wide ? NULL : like.name;
    status = bundle_add(bundle, like, points[wide], counts[wide], error);
  }
  return status;
}

/* Adds the polynomial of a mode with its band. */
static enum status add_polynomial(const json_t *mode, const char *key, struct chart_series like,
                                  struct bundle *bundle, struct error *error) {
  const json_t *polynomial = json_object_get(json_object_get(mode, "polynomials"), key);
  struct point points[POINTS_MOST];
  double band[POINTS_MOST];
  size_t count = 0, index;
  const json_t *entry;
  json_array_foreach(json_object_get(polynomial, "band"), index, entry) {
    struct interval interval;
    if (count < POINTS_MOST && read_interval(entry, entry, &interval)) {
      band[count] = isfinite(interval.half) ? interval.half : 0;
      points[count++] = interval.at;
    }
  }
  like.band = band;
  return bundle_add(bundle, like, points, count, error);
}

/* The largest set-point. */
static double reach_of(const json_t *modes) {
  double reach = 0;
  size_t m, i;
  const json_t *mode, *entry;
  json_array_foreach(modes, m, mode) {
    json_array_foreach(json_object_get(mode, "points"), i, entry) {
      reach = fmax(reach, fabs(data_number(entry, "set_point_kPa")));
    }
  }
  return reach;
}

/* Reads one coefficient: the polynomials below the values. Only the first chart names the modes. */
static enum status read_sheet(const json_t *result, bool named, struct sheet *sheet,
                              struct error *error) {
  const json_t *modes = json_object_get(result, "modes");
  size_t count = json_array_size(modes);
  double step = 0.012 * reach_of(modes), widest = widest_shown(modes, sheet->key);
  enum status status = STATUS_OK;
  count = count < MODES_MOST ? count : MODES_MOST;
  for (size_t m = 0; m < count && status == STATUS_OK; m++) {
    struct chart_series like = {.colour = colour_series(m), .width = 1.8};
    status = add_polynomial(json_array_get(modes, m), sheet->key, like, &sheet->bundle, error);
  }
  for (size_t m = 0; m < count && status == STATUS_OK; m++) {
    const json_t *mode = json_array_get(modes, m);
    const char *name = json_string_value(json_object_get(mode, "name"));
    struct chart_series like = {.colour = colour_series(m),
                                .marker = m % 2 ? MARKER_SQUARE : MARKER_CIRCLE,
                                .name = named ? name : NULL};
    double aside = ((double)m - (double)(count - 1) / 2) * step;
    status = add_points(mode, sheet, aside, widest, like, &sheet->bundle, error);
  }
  return status;
}

/* Takes the other key when that is what the modes have. */
static void choose_key(const json_t *result, struct sheet *sheet) {
  size_t index;
  const json_t *mode;
  json_array_foreach(json_object_get(result, "modes"), index, mode) {
    const json_t *point = json_array_get(json_object_get(mode, "points"), 0);
    if (sheet->other_key && json_object_get(point, sheet->other_key)) {
      sheet->key = sheet->other_key;
      sheet->label = sheet->other_label;
    }
  }
}

enum status draw_coefficients(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                              struct error *error) {
  struct sheet sheets[COEFFICIENTS] = {
      {"stiffness_N_m", "Stiffness k (N/m)", "stiffness_per_mass_1_s2", "k/m (1/s²)", {0}},
      {"damping_N_s_m", "Damping b (N s/m)", "damping_per_mass_1_s", "b/m (1/s)", {0}},
      {"alpha_1_s", "α (1/s)", NULL, NULL, {0}},
      {"beta_1_s", "β (1/s)", NULL, NULL, {0}}};
  static const double shares[2] = {0.5, 0.5};
  struct chart charts[COEFFICIENTS];
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  enum status status = STATUS_OK;
  (void)count;
  data_subtitle(&inputs[0], subtitle);
  data_notice(inputs[0].result, notice);
  for (size_t i = 0; i < COEFFICIENTS && status == STATUS_OK; i++) {
    choose_key(inputs[0].result, &sheets[i]);
    status = read_sheet(inputs[0].result, i == 0, &sheets[i], error);
    charts[i] = (struct chart){.title = "Identified coefficients with 95 % intervals, and their "
                                        "polynomials",
                               .subtitle = subtitle,
                               .notice = notice,
                               .x_label = "Set-point (kPa)",
                               .y_label = sheets[i].label,
                               .loose_x = true,
                               .series = sheets[i].bundle.series,
                               .series_count = sheets[i].bundle.count,
                               .empty = "Nothing was identified"};
  }
  if (status == STATUS_OK) {
    chart_draw_grid(charts, shares, 2, 2, canvas);
  }
  for (size_t i = 0; i < COEFFICIENTS; i++) {
    bundle_release(&sheets[i].bundle);
  }
  return status;
}
