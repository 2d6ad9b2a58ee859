/* Our counterparts of published values. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/figure.h"
#include "tools/reproduction.h"

static const struct work *find_work(const struct works *works, const char *name, size_t length) {
  for (int w = 0; w < works->count; w++) {
    if (strlen(works->item[w].name) == length && strncmp(works->item[w].name, name, length) == 0) {
      return &works->item[w];
    }
  }
  return NULL;
}

const json_t *works_result(const struct works *works, const char *from) {
  size_t length = strcspn(from, "#");
  const struct work *work = find_work(works, from, length);
  if (!work || !from[length]) {
    return work ? work->result : NULL;
  }
  size_t index;
  json_t *member;
  json_array_foreach(json_object_get(work->result, "members"), index, member) {
    const char *name = json_string_value(json_object_get(member, "name"));
    if (name && strcmp(name, from + length + 1) == 0) {
      return member;
    }
  }
  return NULL;
}

/* The value that `pointer` (no escapes) with `suffix` at its end names, or NULL. */
static const json_t *at_pointer(const json_t *value, const char *pointer, const char *suffix) {
  char part[128];
  while (value && *pointer == '/') {
    size_t length = strcspn(pointer + 1, "/");
    bool last = !pointer[1 + length];
    snprintf(part, sizeof part, "%.*s%s", (int)length, pointer + 1, last ? suffix : "");
    value = json_is_array(value) ? json_array_get(value, strtoul(part, NULL, 10))
                                 : json_object_get(value, part);
    pointer += 1 + length;
  }
  return value;
}

/* Value of `y` where `x` passes `at`, the first or the last time, linear between samples; NAN when
 * it does not. */
static double interpolate(const json_t *samples, const char *x, const char *y, double at,
                          bool last) {
  double found = NAN;
  for (size_t i = 0; i + 1 < json_array_size(samples) && (last || isnan(found)); i++) {
    const json_t *a = json_array_get(samples, i), *b = json_array_get(samples, i + 1);
    double x0 = figure_number(a, x), x1 = figure_number(b, x);
    if ((x0 - at) * (x1 - at) <= 0 && x0 != x1) {
      double t = (at - x0) / (x1 - x0);
      found = (1 - t) * figure_number(a, y) + t * figure_number(b, y);
    }
  }
  return found;
}

static double extreme(const json_t *samples, const char *key, bool largest) {
  double found = NAN;
  size_t index;
  json_t *sample;
  json_array_foreach(samples, index, sample) {
    double value = figure_number(sample, key);
    found = isnan(found) || (largest ? value > found : value < found) ? value : found;
  }
  return found;
}

/* The samples of a result, or the points of one of its paths. */
static const json_t *samples_of(const json_t *result, const char *path) {
  size_t index;
  const json_t *entry;
  if (!path) {
    return json_object_get(result, "samples");
  }
  json_array_foreach(json_object_get(result, "paths"), index, entry) {
    const char *name = json_string_value(json_object_get(entry, "name"));
    if (name && strcmp(name, path) == 0) {
      return json_object_get(entry, "points");
    }
  }
  return NULL;
}

static double from_samples(const json_t *result, const json_t *rule, const char *key) {
  const json_t *samples = samples_of(result, json_string_value(json_object_get(rule, "path")));
  const char *end = json_string_value(json_object_get(rule, "extreme"));
  double at = figure_number(rule, "at_kPa"), reaches = figure_number(rule, "reaches");
  bool last = json_is_true(json_object_get(rule, "last"));
  return end          ? extreme(samples, key, strcmp(end, "largest") == 0)
         : !isnan(at) ? interpolate(samples, "pressure_kPa", key, at, last)
                      : interpolate(samples, key, "pressure_kPa", reaches, last);
}

/* Why a result does not give the value. Of a grasp that did not come to its end it is told how far
 * that went: forces rise on the way. */
static void say_missing(const json_t *result, struct finding *finding) {
  const char *status = json_string_value(json_object_get(result, "status"));
  const char *reason = json_string_value(json_object_get(result, "reason"));
  const char *kind = json_string_value(json_object_get(result, "kind"));
  bool grasp = kind && strcmp(kind, "grasp") == 0 && isfinite(finding->value);
  char until[40] = "";
  if (grasp) {
    snprintf(until, sizeof until, "; until there %.4g", finding->value);
  }
  snprintf(finding->missing, sizeof finding->missing, "missing: %.40s%s%.60s%s",
           status ? status : "?", reason && reason[0] ? ", " : "", reason ? reason : "", until);
}

/* Our value of a rule that names a result. */
static struct finding from_result(const struct works *works, const json_t *rule) {
  struct finding finding = {.error = -1};
  const char *from = json_string_value(json_object_get(rule, "from"));
  const char *pointer = json_string_value(json_object_get(rule, "value"));
  const char *key = json_string_value(json_object_get(rule, "key"));
  double factor = figure_number(rule, "factor");
  factor = isnan(factor) ? 1 : factor;
  const json_t *result = from ? works_result(works, from) : NULL;
  if (!result) {
    snprintf(finding.missing, sizeof finding.missing, "missing: %s has not been run",
             from ? from : "no job");
    return finding;
  }
  const json_t *value = pointer ? at_pointer(result, pointer, "") : NULL;
  finding.value = factor * (key                     ? from_samples(result, rule, key)
                            : json_is_number(value) ? json_number_value(value)
                                                    : NAN);
  finding.found = isfinite(finding.value);
  const json_t *error = pointer ? at_pointer(result, pointer, "_error") : NULL;
  finding.error = json_is_number(error) ? fabs(factor) * json_number_value(error) : -1;
  const char *status = json_string_value(json_object_get(result, "status"));
  const char *kind = json_string_value(json_object_get(result, "kind"));
  bool of_states =
      kind && strcmp(kind, "snap") == 0; /* its metrics are of states that were found */
  if (pointer && status && strcmp(status, "succeeded") != 0 && !of_states) {
    finding.found = false; /* metrics of a path that was cut short are those of another load */
  }
  if (!finding.found) {
    say_missing(result, &finding);
  }
  return finding;
}

/* The findings of `count` rules; false, with why in *first, when one is missing. */
static bool find_all(const struct works *works, const json_t *rules, size_t count,
                     struct finding *found) {
  for (size_t i = 0; i < count; i++) {
    found[i] = finding_from(works, json_array_get(rules, i));
    if (!found[i].found) {
      found[0] = found[i];
      return false;
    }
  }
  return true;
}

/* Errors add up: nothing is known of how they go together. */
static struct finding difference_of(struct finding a, struct finding b) {
  bool known = a.error >= 0 && b.error >= 0;
  return (struct finding){
      .found = true, .value = a.value - b.value, .error = known ? a.error + b.error : -1};
}

static struct finding ratio_of(struct finding a, struct finding b) {
  bool known = a.error >= 0 && b.error >= 0;
  struct finding ratio = {.found = b.value != 0, .value = a.value / b.value, .error = -1};
  if (known && ratio.found) {
    ratio.error = (a.error + fabs(ratio.value) * b.error) / fabs(b.value);
  }
  if (!ratio.found) {
    snprintf(ratio.missing, sizeof ratio.missing, "missing: what it is compared with is 0");
  }
  return ratio;
}

static struct finding size_of(struct finding a) {
  a.value = fabs(a.value);
  return a;
}

struct finding finding_from(const struct works *works, const json_t *rule) {
  const json_t *difference = json_object_get(rule, "difference");
  const json_t *ratio = json_object_get(rule, "ratio");
  const json_t *shifts = json_object_get(rule, "shift_ratio");
  struct finding found[4];
  if (shifts) {
    return find_all(works, shifts, 4, found) ? ratio_of(size_of(difference_of(found[1], found[0])),
                                                        size_of(difference_of(found[3], found[2])))
                                             : found[0];
  }
  if (difference || ratio) {
    return !find_all(works, difference ? difference : ratio, 2, found) ? found[0]
           : difference ? difference_of(found[0], found[1])
                        : ratio_of(found[0], found[1]);
  }
  return from_result(works, rule);
}
