#include "solver/job/study_range.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum status study_range_refuse(const struct reader *reader, size_t parameter, const char *key,
                               const char *sentence) {
  struct json_pointer at = {.text = ""};
  json_pointer_key(&at, "parameters");
  json_pointer_index(&at, parameter);
  if (key) {
    json_pointer_key(&at, key);
  }
  return error_set(reader->error, STATUS_INVALID, at.text, "%s", sentence);
}

bool study_range_split(const json_t *value, double *number, const char **unit) {
  char *end;
  *unit = "";
  if (json_is_number(value)) {
    *number = json_number_value(value);
    return true;
  }
  const char *text = json_string_value(value);
  *number = text ? strtod(text, &end) : NAN;
  *unit = text ? end : "";
  return text && end != text && isfinite(*number);
}

enum status study_range_read(const struct reader *reader, size_t index, const json_t *parameter,
                             struct study_range *range) {
  const json_t *from = json_object_get(parameter, "from"), *to = json_object_get(parameter, "to");
  const char *scale = json_string_value(json_object_get(parameter, "scale")), *other;
  *range = (struct study_range){.values = json_object_get(parameter, "values")};
  if ((range->values != NULL) == (from != NULL) || (from != NULL) != (to != NULL) ||
      (scale && !from)) {
    return study_range_refuse(
        reader, index, NULL,
        "this is neither a choice nor a range\neither values to choose from, or from and "
        "to\n{\"pointer\": \"/actuator/chamber_gap\", \"from\": \"1 mm\", \"to\": \"3 mm\"}");
  }
  if (range->values) {
    return STATUS_OK;
  }
  range->whole = json_is_integer(from) && json_is_integer(to);
  range->logarithmic = scale && strcmp(scale, "log") == 0;
  if (!study_range_split(from, &range->from, &range->unit)) {
    return study_range_refuse(reader, index, "from",
                              "this is no number with a unit\na number with its unit\n\"1 mm\"");
  }
  if (!study_range_split(to, &range->to, &other) || json_is_string(from) != json_is_string(to) ||
      strcmp(range->unit, other) != 0) {
    return study_range_refuse(
        reader, index, "to",
        "this is written in another way than \"from\"\nboth with the same unit, as \"1 "
        "mm\" and \"3 mm\"");
  }
  if (!(range->from < range->to)) {
    return study_range_refuse(reader, index, "to",
                              "the range is empty\nthis has to be more than \"from\"");
  }
  if (range->logarithmic && range->from <= 0.0) {
    return study_range_refuse(reader, index, "from",
                              "the range begins at 0 or below\na logarithmic range begins above 0");
  }
  return STATUS_OK;
}

json_t *study_range_value(const struct study_range *range, double u, int digits) {
  char text[96];
  if (range->values) {
    size_t count = json_array_size(range->values), which = (size_t)(u * (double)count);
    return json_incref(json_array_get(range->values, which < count ? which : count - 1));
  }
  double width = range->to - range->from + (range->whole ? 1.0 : 0.0);
  double value =
      range->logarithmic ? range->from * pow(range->to / range->from, u) : range->from + u * width;
  if (range->whole) {
    return json_integer((json_int_t)fmin(floor(value), range->to));
  }
  snprintf(text, sizeof text, "%.*g%s", digits, value, range->unit);
  return range->unit[0] ? json_string(text) : json_real(strtod(text, NULL));
}
