#include "server/plot/data.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double finite_number(const json_t *value) {
  double number = json_is_number(value) ? json_number_value(value) : NAN;
  return fabs(number) <= 1e9 ? number : NAN;
}

double data_number(const json_t *object, const char *key) {
  return finite_number(json_object_get(object, key));
}

double data_element(const json_t *array, size_t index) {
  return finite_number(json_array_get(array, index));
}

enum status data_samples(const json_t *result, const char *x_key, const char *y_key,
                         struct point **points, size_t *count, struct error *error) {
  const json_t *samples = json_object_get(result, "samples");
  size_t recorded = json_array_size(samples);
  *points = NULL;
  *count = 0;
  if (recorded == 0) {
    return STATUS_OK;
  }
  *points = malloc(recorded * sizeof **points);
  if (!*points) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out while reading %zu samples",
                     recorded);
  }
  for (size_t i = 0; i < recorded; i++) {
    const json_t *sample = json_array_get(samples, i);
    struct point p = {data_number(sample, x_key), data_number(sample, y_key)};
    if (isfinite(p.x) && isfinite(p.y)) {
      (*points)[(*count)++] = p;
    }
  }
  return STATUS_OK;
}

size_t data_thin(struct point *points, size_t count, double dx, double dy) {
  size_t used = 0, kept = 0;
  struct point before = {0, 0};
  for (size_t i = 0; i < count; i++) {
    struct point p = points[i], last = used ? points[used - 1] : p;
    bool far = fabs(p.x - last.x) > dx || fabs(p.y - last.y) > dy;
    /* The point before a move is its corner; it lies behind what has been kept. */
    if (used > 0 && far && kept + 1 < i) {
      points[used++] = before;
    }
    if (used == 0 || far || i + 1 == count) {
      points[used++] = p;
      kept = i;
    }
    before = p;
  }
  return used;
}

void data_subtitle(const struct plot_input *input, char text[DATA_HEADING]) {
  const char *title = input->title ? input->title : "";
  if (input->job_id > 0) {
    snprintf(text, DATA_HEADING, "job %lld%s%s", input->job_id, *title ? " · " : "", title);
  } else {
    snprintf(text, DATA_HEADING, "%s", title);
  }
}

void data_name(const struct plot_input *input, char text[DATA_HEADING]) {
  const char *title = input->title ? input->title : "";
  if (input->job_id > 0) {
    snprintf(text, DATA_HEADING, "%lld%s%s", input->job_id, *title ? " · " : "", title);
  } else {
    snprintf(text, DATA_HEADING, "%s", *title ? title : "unnamed");
  }
}

void data_notice(const json_t *result, char text[DATA_HEADING]) {
  const char *status = json_string_value(json_object_get(result, "status"));
  const char *reason = json_string_value(json_object_get(result, "reason"));
  const json_t *samples = json_object_get(result, "samples");
  text[0] = '\0';
  if (!status || strcmp(status, "succeeded") == 0) {
    return;
  }
  char words[100];
  snprintf(words, sizeof words, "%s", reason && *reason ? reason : status);
  for (char *c = words; *c; c++) {
    *c = *c == '_' ? ' ' : *c;
  }
  size_t count = json_array_size(samples);
  const json_t *last = count ? json_array_get(samples, count - 1) : NULL;
  double time = data_number(last, "time_s");
  double reached = isfinite(time) ? time : data_number(last, "pressure_kPa");
  if (isfinite(reached)) {
    char number[TICKS_TEXT];
    ticks_plain(reached, 3, number);
    snprintf(text, DATA_HEADING, "Stopped early at %s %s: %s", number, isfinite(time) ? "s" : "kPa",
             words);
  } else {
    snprintf(text, DATA_HEADING, "Stopped early: %s", words);
  }
}
