/* The mirror image of a job about y = 0. */
#include <stdlib.h>
#include <string.h>

#include "solver/job/study.h"

static bool swap(json_t *object, const char *left, const char *right) {
  json_t *a = json_incref(json_object_get(object, left));
  json_t *b = json_incref(json_object_get(object, right));
  bool good = true;
  if (a || b) {
    json_object_del(object, left);
    json_object_del(object, right);
    good = (!b || json_object_set(object, left, b) == 0) &&
           (!a || json_object_set(object, right, a) == 0);
  }
  json_decref(a);
  json_decref(b);
  return good;
}

/* "-9.8 m/s2" for "9.8 m/s2" and the other way round; nothing keeps its sign. */
static json_t *negated(const json_t *value) {
  if (json_is_integer(value)) {
    return json_integer(-json_integer_value(value));
  }
  if (json_is_real(value)) {
    return json_real(-json_real_value(value));
  }
  const char *text = json_string_value(value);
  if (!text || strtod(text, NULL) == 0.0) {
    return json_deep_copy(value);
  }
  bool sign = *text == '-' || *text == '+';
  return json_sprintf("%s%s", *text == '-' ? "" : "-", text + sign);
}

/* Turns round the second component of a vector, where there is one. */
static bool negate_across(json_t *vector) {
  json_t *across = json_array_get(vector, 1);
  return !across || json_array_set_new(vector, 1, negated(across)) == 0;
}

json_t *job_mirror(const json_t *document) {
  json_t *sensitivity = json_object_get(document, "sensitivity");
  if (sensitivity && !json_is_false(sensitivity)) {
    return NULL;
  }
  json_t *mirrored = json_deep_copy(document);
  json_t *load = json_object_get(mirrored, "load");
  json_t *taper = json_object_get(json_object_get(mirrored, "actuator"), "taper");
  bool good = mirrored && swap(taper, "left", "right") &&
              swap(json_object_get(load, "pressure"), "left", "right") &&
              negate_across(json_object_get(load, "gravity"));
  size_t index;
  json_t *plane;
  json_array_foreach(json_object_get(mirrored, "planes"), index, plane) {
    good = good && negate_across(json_object_get(plane, "point")) &&
           negate_across(json_object_get(plane, "normal"));
  }
  if (!good) {
    json_decref(mirrored);
    mirrored = NULL;
  }
  return mirrored;
}
