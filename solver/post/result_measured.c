#include "solver/post/result_measured.h"

#include <gsl/gsl_spline.h>
#include <math.h>
#include <stdlib.h>

#include "solver/job/measured.h"

/* The simulated curve at the recorded states, in kPa and degrees, by rising pressure. */
struct simulated {
  size_t count;
  struct simulated_point {
    double pressure, angle;
  } * point;
};

static int by_pressure(const void *a, const void *b) {
  const struct simulated_point *p = a, *q = b;
  return (p->pressure > q->pressure) - (p->pressure < q->pressure);
}

static enum status collect(const json_t *samples, const char *metric, struct simulated *curve) {
  size_t kept = 0, index;
  json_t *sample;
  curve->point = calloc(json_array_size(samples) + 1, sizeof *curve->point);
  if (!curve->point) {
    return STATUS_NO_MEMORY;
  }
  json_array_foreach((json_t *)samples, index, sample) {
    const json_t *angle = json_object_get(sample, metric);
    if (json_is_number(angle)) {
      curve->point[curve->count++] = (struct simulated_point){
          json_number_value(json_object_get(sample, "pressure_kPa")), json_number_value(angle)};
    }
  }
  qsort(curve->point, curve->count, sizeof *curve->point, by_pressure);
  for (size_t i = 0; i < curve->count; i++) {
    if (kept == 0 || curve->point[i].pressure > curve->point[kept - 1].pressure) {
      curve->point[kept++] = curve->point[i];
    }
  }
  curve->count = kept;
  return STATUS_OK;
}

/* A spline through the curve, or NULL when memory runs out; at least two points. */
static gsl_spline *spline_of(const struct simulated *curve) {
  const gsl_interp_type *type = curve->count >= 3 ? gsl_interp_steffen : gsl_interp_linear;
  double *x = calloc(2 * curve->count, sizeof *x), *y = x ? x + curve->count : NULL;
  gsl_spline *spline = x ? gsl_spline_alloc(type, curve->count) : NULL;
  for (size_t i = 0; spline && i < curve->count; i++) {
    x[i] = curve->point[i].pressure;
    y[i] = curve->point[i].angle;
  }
  if (spline) {
    gsl_spline_init(spline, x, y, curve->count);
  }
  free(x);
  return spline;
}

static void warn(json_t *document, json_t *sentence) {
  json_array_append_new(json_object_get(document, "warnings"), sentence);
}

/* Fills `rows` and the metrics with what the two curves have in common. */
static void compare(const struct simulated *simulated, const struct measured_curve *measured,
                    const gsl_spline *spline, json_t *rows, json_t *metrics) {
  double low = simulated->point[0].pressure, square = 0.0, worst = 0.0, mean = 0.0, about = 0.0;
  double high = simulated->point[simulated->count - 1].pressure, margin = 1e-9 * fabs(high);
  size_t index;
  json_t *row;
  for (size_t i = 0; i < measured->count; i++) {
    double pressure = 1e-3 * measured->pressure[i], angle = measured->angle[i] * 180.0 / M_PI;
    if (pressure < low - margin || pressure > high + margin) {
      continue;
    }
    double value = gsl_spline_eval(spline, fmin(fmax(pressure, low), high), NULL);
    square += (value - angle) * (value - angle);
    worst = fmax(worst, fabs(value - angle));
    mean += angle;
    json_array_append_new(rows,
                          json_pack("{s:f, s:f, s:f, s:f}", "pressure_kPa", pressure, "measured",
                                    angle, "simulated", value, "error", value - angle));
  }
  double n = (double)json_array_size(rows);
  if (n == 0.0) {
    return;
  }
  json_array_foreach(rows, index, row) {
    double off = json_number_value(json_object_get(row, "measured")) - mean / n;
    about += off * off;
  }
  json_object_set_new(metrics, "measured_rmse_deg", json_real(sqrt(square / n)));
  json_object_set_new(metrics, "measured_max_error_deg", json_real(worst));
  if (about > 0.0) {
    json_object_set_new(metrics, "measured_r_squared", json_real(1.0 - square / about));
  }
}

enum status result_measured_store(const struct job_spec *spec, json_t *document,
                                  struct error *error) {
  const char *metric = spec->measured.metric;
  struct simulated simulated = {.count = 0};
  struct measured_curve measured = {.count = 0};
  gsl_spline *spline = NULL;
  json_t *rows = NULL;
  if (metric[0] == '\0') {
    return STATUS_OK;
  }
  enum status status = measured_read(spec->document, spec, &measured, error);
  if (status == STATUS_OK) {
    status = collect(json_object_get(document, "samples"), metric, &simulated);
  }
  if (status != STATUS_OK) {
    goto done;
  }
  rows = json_array();
  if (simulated.count >= 2) {
    spline = spline_of(&simulated);
    status = spline && rows ? STATUS_OK : STATUS_NO_MEMORY;
  }
  if (status != STATUS_OK) {
    goto done;
  }
  if (spline) {
    compare(&simulated, &measured, spline, rows, json_object_get(document, "metrics"));
  }
  size_t left_out = measured.count - json_array_size(rows);
  if (left_out > 0) {
    warn(document, json_sprintf("%zu of %zu measured points lie beyond the simulated pressures and "
                                "are left out of the comparison",
                                left_out, measured.count));
  }
  bool stored = json_object_set(document, "measured", rows) == 0 &&
                json_object_set_new(document, "measured_metric", json_string(metric)) == 0;
  status = stored ? STATUS_OK : STATUS_NO_MEMORY;
done:
  if (status == STATUS_NO_MEMORY) {
    error_set(error, status, NULL, "no memory for the measured curve");
  }
  gsl_spline_free(spline);
  json_decref(rows);
  free(simulated.point);
  measured_release(&measured);
  return status;
}
