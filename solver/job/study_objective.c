#include "solver/job/study_objective.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- reading ------------------------------------------------------------------------------ */

static enum status read_pressure(const struct reader *reader, const json_t *object,
                                 double pressure_to, const char *place, double *pressure) {
  const json_t *given = json_object_get(object, "at_pressure");
  char pointer[120];
  *pressure = given ? 1e-3 * reader_quantity(reader, given, "kPa") : NAN;
  snprintf(pointer, sizeof pointer, "%s/at_pressure", place);
  if (given && isnan(pressure_to)) {
    return error_set(reader->error, STATUS_INVALID, pointer,
                     "the base has no load that rises to a pressure\nleave it out");
  }
  if (given && *pressure > pressure_to * (1 + 1e-9)) {
    return error_set(reader->error, STATUS_INVALID, pointer,
                     "%.6g kPa lies above the load of the base\nat most %.6g kPa", *pressure,
                     pressure_to);
  }
  return STATUS_OK;
}

static double scale_of(double value) {
  return value != 0 ? fabs(value) : 1;
}

static void add_target(struct study_objective *o, const char *metric, double value,
                       double pressure) {
  o->term[o->term_count++] = (struct objective_term){metric, pressure, value, scale_of(value), 1};
}

static double distance(const double *a, const double *b) {
  double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return sqrt(x * x + y * y + z * z);
}

static double length_of(const double *points, size_t count) {
  double sum = 0;
  for (size_t i = 1; i < count; i++) {
    sum += distance(points + 3 * i, points + 3 * (i - 1));
  }
  return sum;
}

/* Points at equal parts of the length of a polygon, the last its end, into out[3 x stations]. */
static void spread(const double *points, size_t count, double *out) {
  double part = length_of(points, count) / OBJECTIVE_STATIONS, behind = 0;
  size_t at = 1;
  for (int s = 0; s < OBJECTIVE_STATIONS; s++) {
    double wanted = part * (s + 1), step = distance(points + 3 * at, points + 3 * (at - 1));
    while (at + 1 < count && behind + step < wanted) {
      behind += step;
      at++;
      step = distance(points + 3 * at, points + 3 * (at - 1));
    }
    double share = step > 0 ? fmin((wanted - behind) / step, 1.0) : 0;
    for (size_t i = 0; i < 3; i++) {
      double from = points[3 * (at - 1) + i];
      out[3 * s + (int)i] = from + share * (points[3 * at + i] - from);
    }
  }
}

enum { POINTS_MAX = 1000 };

/* Points [x, y, z] in mm; 0 when there are none, too many, or others. */
static size_t read_points(const json_t *list, double *points) {
  size_t count = json_array_size(list);
  for (size_t i = 0; i < 3 * count && count <= POINTS_MAX; i++) {
    const json_t *number = json_array_get(json_array_get(list, i / 3), i % 3);
    if (!json_is_number(number)) {
      return 0;
    }
    points[i] = json_number_value(number);
  }
  return count <= POINTS_MAX ? count : 0;
}

static enum status read_profile(const struct reader *reader, const json_t *list,
                                struct study_objective *o) {
  double points[3 * POINTS_MAX];
  size_t count = read_points(list, points);
  o->kind = OBJECTIVE_PROFILE;
  o->length = length_of(points, count);
  if (!(o->length > 0)) {
    return error_set(reader->error, STATUS_INVALID, "/objective/profile",
                     "all points are one\npoints along a line\n[[0, 0, 0], [30, 0, -5], [55, 0, "
                     "-22]]");
  }
  spread(points, count, o->profile);
  return STATUS_OK;
}

static enum status read_targets(const struct reader *reader, const json_t *list, double pressure_to,
                                struct study_objective *o) {
  size_t index;
  json_t *item;
  enum status status = STATUS_OK;
  o->kind = OBJECTIVE_TARGETS;
  json_array_foreach(list, index, item) {
    char place[60];
    double pressure;
    snprintf(place, sizeof place, "/objective/targets/%zu", index);
    status = read_pressure(reader, item, pressure_to, place, &pressure);
    if (status != STATUS_OK) {
      return status;
    }
    add_target(o, json_string_value(json_object_get(item, "metric")),
               json_number_value(json_object_get(item, "value")), pressure);
  }
  return STATUS_OK;
}

static enum status read_kind(const struct reader *reader, const json_t *value, double pressure_to,
                             struct study_objective *o) {
  const json_t *targets = json_object_get(value, "targets"), *number;
  const json_t *profile = json_object_get(value, "profile");
  const char *least = json_string_value(json_object_get(value, "minimise")), *metric;
  const char *most = json_string_value(json_object_get(value, "maximise"));
  json_t *target = json_object_get(value, "target");
  int given =
      (least != NULL) + (most != NULL) + (target != NULL) + (targets != NULL) + (profile != NULL);
  if (given != 1 || (target && json_object_size(target) == 0)) {
    return error_set(reader->error, STATUS_INVALID, "/objective",
                     "there are %d objectives\none of minimise, maximise, target, targets and "
                     "profile\n{\"target\": {\"bending_angle_deg\": 60}}",
                     given == 1 ? 0 : given);
  }
  if (targets) {
    return json_object_get(value, "at_pressure")
               ? error_set(reader->error, STATUS_INVALID, "/objective/at_pressure",
                           "each of the targets has its own pressure\nleave it out here")
               : read_targets(reader, targets, pressure_to, o);
  }
  enum status status = read_pressure(reader, value, pressure_to, "/objective", &o->pressure);
  if (status != STATUS_OK || profile) {
    return status == STATUS_OK ? read_profile(reader, profile, o) : status;
  }
  o->kind = target ? OBJECTIVE_TARGETS : least ? OBJECTIVE_MINIMISE : OBJECTIVE_MAXIMISE;
  json_object_foreach(target, metric, number) {
    add_target(o, metric, json_number_value(number), o->pressure);
  }
  if (!target) {
    o->term_count = 1;
    o->term[0] = (struct objective_term){least ? least : most, o->pressure, 0, 1, least ? 1 : -1};
  }
  return STATUS_OK;
}

/* Limits on metrics; those on sums of parameters are read elsewhere. */
static enum status read_limits(const struct reader *reader, const json_t *list, double pressure_to,
                               struct study_objective *o) {
  size_t index;
  json_t *item;
  json_array_foreach(list, index, item) {
    static const char *const keys[] = {"at_most", "at_least"};
    const char *metric = json_string_value(json_object_get(item, "metric"));
    char place[60];
    double pressure;
    snprintf(place, sizeof place, "/constraints/%zu", index);
    enum status status =
        metric ? read_pressure(reader, item, pressure_to, place, &pressure) : STATUS_OK;
    for (int k = 0; k < 2 && metric && status == STATUS_OK; k++) {
      const json_t *bound = json_object_get(item, keys[k]);
      double value = json_number_value(bound);
      if (bound && !json_is_number(bound)) {
        status = error_set(reader->error, STATUS_INVALID, place,
                           "the limit of a metric is no number\na number in the unit of the "
                           "metric\n{\"metric\": \"bending_angle_deg\", \"at_least\": 60}");
      } else if (bound) {
        o->limit[o->limit_count++] =
            (struct objective_term){metric, pressure, value, scale_of(value), k == 0 ? 1 : -1};
      }
    }
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

enum status study_objective_read(const struct reader *reader, const json_t *document,
                                 double pressure_to, struct study_objective *objective) {
  *objective = (struct study_objective){.pressure = NAN};
  enum status status =
      read_kind(reader, json_object_get(document, "objective"), pressure_to, objective);
  return status == STATUS_OK
             ? read_limits(reader, json_object_get(document, "constraints"), pressure_to, objective)
             : status;
}

/* ---- properties --------------------------------------------------------------------------- */

size_t study_objective_residuals(const struct study_objective *o) {
  return o->kind == OBJECTIVE_PROFILE   ? 3 * OBJECTIVE_STATIONS
         : o->kind == OBJECTIVE_TARGETS ? o->term_count
                                        : 0;
}

size_t study_objective_functions(const struct study_objective *o) {
  size_t residuals = study_objective_residuals(o);
  return (residuals > 0 ? residuals : 1) + o->limit_count;
}

static bool has_derivative(const struct objective_term *term) {
  static const char *const everywhere[] = {
      "bending_angle_deg", "chord_angle_deg", "end_face_angle_deg", "tip_deflection_mm",
      "tip_x_mm",          "tip_y_mm",        "tip_z_mm",           "cavity_volume_mm3"};
  static const char *const at_the_end[] = {"mass_g", "sensitivity_deg_per_kPa"};
  for (size_t i = 0; i < sizeof everywhere / sizeof *everywhere; i++) {
    if (strcmp(term->metric, everywhere[i]) == 0) {
      return true;
    }
  }
  for (size_t i = 0; i < sizeof at_the_end / sizeof *at_the_end; i++) {
    if (strcmp(term->metric, at_the_end[i]) == 0) {
      return isnan(term->pressure);
    }
  }
  return false;
}

bool study_objective_differentiable(const struct study_objective *o) {
  bool all = true;
  for (size_t i = 0; i < o->term_count; i++) {
    all = all && has_derivative(&o->term[i]);
  }
  for (size_t i = 0; i < o->limit_count; i++) {
    all = all && has_derivative(&o->limit[i]);
  }
  return all;
}

const char *study_objective_name(const struct study_objective *o) {
  return o->kind == OBJECTIVE_PROFILE   ? "rms_distance_mm"
         : o->kind == OBJECTIVE_TARGETS ? "relative_deviation"
                                        : o->term[0].metric;
}

struct objective_figures study_objective_figures(const struct study_objective *o,
                                                 const double *value) {
  size_t residuals = study_objective_residuals(o), functions = study_objective_functions(o);
  struct objective_figures figures = {.max_distance = NAN};
  double sum = 0;
  for (size_t i = 0; i < residuals; i++) {
    sum += value[i] * value[i];
  }
  figures.objective = o->kind == OBJECTIVE_PROFILE    ? o->length * sqrt(sum)
                      : o->kind == OBJECTIVE_TARGETS  ? sqrt(sum)
                      : o->kind == OBJECTIVE_MAXIMISE ? -value[0]
                                                      : value[0];
  for (size_t s = 0; o->kind == OBJECTIVE_PROFILE && s < OBJECTIVE_STATIONS; s++) {
    static const double none[3] = {0, 0, 0};
    figures.max_distance = fmax(figures.max_distance, sqrt(OBJECTIVE_STATIONS) * o->length *
                                                          distance(value + 3 * s, none));
  }
  for (size_t i = functions - o->limit_count; i < functions; i++) {
    figures.violation = fmax(figures.violation, value[i]);
  }
  return figures;
}

/* ---- results ------------------------------------------------------------------------------ */

/* Where a pressure lies among recorded ones: between item `at` and the next. */
struct place {
  size_t at;
  double share; /* of the next */
};

/* The last item for NAN. False when the pressure was not reached. */
static bool find_pressure(const json_t *items, double pressure, struct place *place) {
  size_t count = json_array_size(items);
  double low = 0, high;
  *place = (struct place){count - 1, 0};
  if (count == 0 || isnan(pressure)) {
    return count > 0;
  }
  for (size_t i = 0; i < count; i++, low = high) {
    high = json_number_value(json_object_get(json_array_get(items, i), "pressure_kPa"));
    if (fabs(high - pressure) <= 1e-9 * pressure) {
      *place = (struct place){i, 0};
      return true;
    }
    if (high > pressure) {
      *place = (struct place){i > 0 ? i - 1 : 0, i > 0 ? (pressure - low) / (high - low) : 0};
      return i > 0;
    }
  }
  return false;
}

/* The number under `key` of items with pressures; NAN when it is not there. */
static double number_at(const json_t *items, const char *key, double pressure) {
  struct place place;
  if (!find_pressure(items, pressure, &place)) {
    return NAN;
  }
  const json_t *low = json_object_get(json_array_get(items, place.at), key);
  const json_t *high = json_object_get(json_array_get(items, place.at + 1), key);
  double value = json_is_number(low) ? json_number_value(low) : NAN;
  if (place.share > 0) {
    double next = json_is_number(high) ? json_number_value(high) : NAN;
    value += place.share * (next - value);
  }
  return value;
}

/* A figure of a result or of an entry of its derivatives: both have metrics and samples. */
static double figure(const json_t *object, const struct objective_term *term) {
  const json_t *metric = json_object_get(json_object_get(object, "metrics"), term->metric);
  return isnan(term->pressure) && json_is_number(metric)
             ? json_number_value(metric)
             : number_at(json_object_get(object, "samples"), term->metric, term->pressure);
}

/* The points under `key` of items with pressures; their number, 0 when they are not there. */
static size_t points_at(const json_t *items, const char *key, double pressure, double *points) {
  struct place place;
  double next[3 * POINTS_MAX];
  if (!find_pressure(items, pressure, &place)) {
    return 0;
  }
  size_t count = read_points(json_object_get(json_array_get(items, place.at), key), points);
  if (place.share > 0 &&
      read_points(json_object_get(json_array_get(items, place.at + 1), key), next) != count) {
    return 0;
  }
  for (size_t i = 0; place.share > 0 && i < 3 * count; i++) {
    points[i] += place.share * (next[i] - points[i]);
  }
  return count;
}

static const json_t *derivatives_of(const json_t *result, size_t parameter) {
  return json_array_get(json_object_get(json_object_get(result, "sensitivity"), "parameters"),
                        parameter);
}

/* sign (m - value) / scale and its derivatives. */
static bool evaluate_term(const struct objective_term *term, const json_t *result, size_t count,
                          const double *factor, double *value, double *gradient) {
  *value = term->sign * (figure(result, term) - term->value) / term->scale;
  bool known = isfinite(*value);
  for (size_t k = 0; k < count && gradient; k++) {
    gradient[k] = term->sign * factor[k] * figure(derivatives_of(result, k), term) / term->scale;
    known = known && isfinite(gradient[k]);
  }
  return known;
}

/* A step along derivatives from which those of the stations are taken, mm. */
static const double probe = 1e-4;

/* Derivatives of the stations along those of the points, d[3 x count]. */
static void differentiate_stations(const double *points, const double *d, size_t count,
                                   double *out) {
  double moved[3 * POINTS_MAX], side[2][3 * OBJECTIVE_STATIONS], most = 0;
  for (size_t i = 0; i < 3 * count; i++) {
    most = fmax(most, fabs(d[i]));
  }
  double step = most > 0 ? probe / most : 1;
  for (int s = 0; s < 2; s++) {
    for (size_t i = 0; i < 3 * count; i++) {
      moved[i] = points[i] + (s ? step : -step) * d[i];
    }
    spread(moved, count, side[s]);
  }
  for (int i = 0; i < 3 * OBJECTIVE_STATIONS; i++) {
    out[i] = (side[1][i] - side[0][i]) / (2 * step);
  }
}

/* What the result lacks, or NULL. The sum of squares of the residuals is that of the distances,
 * averaged over the stations, relative to the length. */
static const char *evaluate_profile(const struct study_objective *o, const json_t *result,
                                    size_t count, const double *factor, double *value,
                                    double *gradient) {
  double points[3 * POINTS_MAX], d[3 * POINTS_MAX], station[3 * OBJECTIVE_STATIONS];
  double scale = 1 / (o->length * sqrt(OBJECTIVE_STATIONS));
  size_t found = points_at(json_object_get(result, "midlines"), "points_mm", o->pressure, points);
  if (found < 2) {
    return "the result has no midline at this pressure";
  }
  spread(points, found, station);
  for (int i = 0; i < 3 * OBJECTIVE_STATIONS; i++) {
    value[i] = scale * (station[i] - o->profile[i]);
  }
  for (size_t k = 0; k < count && gradient; k++) {
    const json_t *samples = json_object_get(derivatives_of(result, k), "samples");
    if (points_at(samples, "midline_mm", o->pressure, d) != found) {
      return "the result has no derivatives of the midline at this pressure";
    }
    differentiate_stations(points, d, found, station);
    for (size_t i = 0; i < 3 * OBJECTIVE_STATIONS; i++) {
      gradient[i * count + k] = scale * factor[k] * station[i];
    }
  }
  return NULL;
}

const char *study_objective_evaluate(const struct study_objective *o, const json_t *result,
                                     size_t count, const double *factor, double *value,
                                     double *gradient) {
  const char *status = json_string_value(json_object_get(result, "status"));
  size_t at = 0;
  if (!status || strcmp(status, "succeeded") != 0) {
    return "the member did not come to its end";
  }
  if (o->kind == OBJECTIVE_PROFILE) {
    const char *lack = evaluate_profile(o, result, count, factor, value, gradient);
    if (lack) {
      return lack;
    }
    at = 3 * OBJECTIVE_STATIONS;
  }
  for (size_t i = 0; i < o->term_count + o->limit_count; i++, at++) {
    const struct objective_term *term =
        i < o->term_count ? &o->term[i] : &o->limit[i - o->term_count];
    if (!evaluate_term(term, result, count, factor, value + at,
                       gradient ? gradient + at * count : NULL)) {
      return "the result lacks a metric of the objective or its derivatives";
    }
  }
  /* So that the sum of squares is the mean over the targets. */
  for (size_t i = 0; o->kind == OBJECTIVE_TARGETS && i < o->term_count; i++) {
    value[i] /= sqrt((double)o->term_count);
    for (size_t k = 0; k < count && gradient; k++) {
      gradient[i * count + k] /= sqrt((double)o->term_count);
    }
  }
  return NULL;
}
