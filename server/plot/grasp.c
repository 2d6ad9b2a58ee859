#include "server/plot/grasp.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const json_t *samples_of(const json_t *result) {
  return json_object_get(result, "samples");
}

bool grasp_is_of(const json_t *result) {
  const json_t *samples = samples_of(result);
  const json_t *last = json_array_get(samples, json_array_size(samples) - 1);
  return json_array_size(samples) > 0 && isfinite(data_number(last, "grasp_force_N"));
}

static bool is_of_stage(const json_t *sample, const char *stage) {
  const char *word = json_string_value(json_object_get(sample, "stage"));
  return !stage || (word && strcmp(word, stage) == 0);
}

bool grasp_has_stage(const json_t *result, const char *stage) {
  const json_t *samples = samples_of(result);
  bool has = false;
  for (size_t i = 0; i < json_array_size(samples) && !has; i++) {
    has = is_of_stage(json_array_get(samples, i), stage);
  }
  return has;
}

enum status grasp_curve_read(const json_t *result, const char *stage, const char *x_key,
                             const char *y_key, struct grasp_curve *curve, struct error *error) {
  const json_t *samples = samples_of(result);
  size_t recorded = json_array_size(samples);
  *curve = (struct grasp_curve){.points = malloc((recorded + 1) * sizeof *curve->points),
                                .dynamic = malloc((recorded + 1) * sizeof *curve->dynamic)};
  if (!curve->points || !curve->dynamic) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out while reading %zu samples",
                     recorded);
  }
  for (size_t i = 0; i < recorded; i++) {
    const json_t *sample = json_array_get(samples, i), *next = json_array_get(samples, i + 1);
    struct point p = {x_key ? data_number(sample, x_key) : (double)i, data_number(sample, y_key)};
    bool wanted = is_of_stage(sample, stage) || (next && is_of_stage(next, stage));
    if (isfinite(p.x) && isfinite(p.y) && wanted) {
      curve->dynamic[curve->count] =
          json_is_true(json_object_get(sample, "dynamic")) || data_number(sample, "dynamic") > 0;
      curve->points[curve->count++] = p;
    }
  }
  return STATUS_OK;
}

void grasp_curve_release(struct grasp_curve *curve) {
  free(curve->points);
  free(curve->dynamic);
  *curve = (struct grasp_curve){0};
}

size_t grasp_curve_peak(const struct grasp_curve *curve) {
  size_t peak = 0;
  for (size_t i = 1; i < curve->count; i++) {
    peak = curve->points[i].y > curve->points[peak].y ? i : peak;
  }
  return peak;
}

enum status grasp_curve_add(struct bundle *bundle, const struct grasp_curve *curve,
                            struct chart_series like, struct error *error) {
  struct chart_series dynamic = {
      .colour = colour_series(1), .width = like.width + 0.6, .name = "dynamic steps"};
  enum status status = bundle_add(bundle, like, curve->points, curve->count, error);
  for (size_t i = 1; i < curve->count && status == STATUS_OK; i++) {
    size_t end = i;
    while (end < curve->count && curve->dynamic[end]) {
      end++;
    }
    if (end > i) {
      status = bundle_add(bundle, dynamic, curve->points + i - 1, end - i + 1, error);
      dynamic.name = NULL;
      i = end;
    }
  }
  return status;
}
