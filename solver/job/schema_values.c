/* Keywords about single values: types, fixed words, numbers, strings, quantities. */
#include "solver/job/schema_walk.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/base/text.h"

enum { WORDS_MAX = 64 };

static bool is_integral(const json_t *value) {
  return json_is_integer(value) ||
         (json_is_real(value) && json_real_value(value) == floor(json_real_value(value)));
}

bool schema_has_type(const json_t *value, const char *type) {
  switch (type[0]) {
  case 'o':
    return json_is_object(value);
  case 'a':
    return json_is_array(value);
  case 's':
    return json_is_string(value);
  case 'b':
    return json_is_boolean(value);
  case 'i':
    return is_integral(value);
  default:
    return json_is_number(value);
  }
}

/* ---- quantities ------------------------------------------------------------------------- */

static enum status check_bound(struct walk *walk, const json_t *node, const char *keyword,
                               const char *unit, double si, const char *given) {
  const char *limit = json_string_value(json_object_get(node, keyword));
  if (!limit) {
    return STATUS_OK;
  }
  double bound = 0.0;
  if (units_read(walk->schema->units, limit, unit, &bound, walk->error) != STATUS_OK) {
    return STATUS_INTERNAL;
  }
  bool exclusive = strstr(keyword, "exclusive") != NULL;
  bool lower = strstr(keyword, "inimum") != NULL;
  if (lower ? (exclusive ? si > bound : si >= bound) : si <= bound) {
    return STATUS_OK;
  }
  char quoted[80];
  return schema_refuse(walk, "%s is out of range: it must be %s %s",
                       text_quote(quoted, sizeof quoted, given),
                       !lower      ? "at most"
                       : exclusive ? "more than"
                                   : "at least",
                       limit);
}

static enum status check_unit(struct walk *walk, const json_t *node, const json_t *rule,
                              const json_t *value) {
  const char *unit = json_string_value(rule);
  if (json_is_number(value)) {
    char number[32];
    snprintf(number, sizeof number, "%.12g", json_number_value(value));
    walk->example = NULL;
    return schema_refuse(walk, "the number %s has no unit: write \"%s %s\"", number, number, unit);
  }
  if (!json_is_string(value)) {
    return schema_refuse(walk, "must be a quantity with its unit in a string, not %s",
                         json_type_phrase(value));
  }
  double si = 0.0;
  const char *given = json_string_value(value);
  enum status status = units_read(walk->schema->units, given, unit, &si, walk->error);
  if (status != STATUS_OK) {
    if (walk->error) {
      memcpy(walk->error->pointer, walk->pointer.text, sizeof walk->pointer.text);
    }
    return status;
  }
  static const char *const bounds[] = {"x-minimum", "x-exclusiveMinimum", "x-maximum"};
  for (size_t i = 0; i < 3 && status == STATUS_OK; i++) {
    status = check_bound(walk, node, bounds[i], unit, si, given);
  }
  return status;
}

/* ---- types and fixed values ------------------------------------------------------------- */

static enum status check_type(struct walk *walk, const json_t *node, const json_t *rule,
                              const json_t *value) {
  (void)node;
  const char *type = json_string_value(rule);
  if (schema_has_type(value, type)) {
    return STATUS_OK;
  }
  if (strcmp(type, "integer") == 0 && json_is_number(value)) {
    return schema_refuse(walk, "must be a whole number");
  }
  const char *phrase = strcmp(type, "boolean") == 0   ? "true or false"
                       : strcmp(type, "integer") == 0 ? "a whole number"
                       : strchr("ao", type[0])        ? "an "
                                                      : "a ";
  bool complete = strcmp(type, "boolean") == 0 || strcmp(type, "integer") == 0;
  return schema_refuse(walk, "must be %s%s, not %s", phrase, complete ? "" : type,
                       json_type_phrase(value));
}

static bool is_equal(const json_t *a, const json_t *b) {
  return json_is_number(a) && json_is_number(b) ? json_number_value(a) == json_number_value(b)
                                                : json_equal(a, b);
}

static enum status check_const(struct walk *walk, const json_t *node, const json_t *rule,
                               const json_t *value) {
  (void)node;
  if (is_equal(rule, value)) {
    return STATUS_OK;
  }
  walk->example = rule;
  return schema_refuse(walk, "has a value that is not possible here");
}

static enum status check_enum(struct walk *walk, const json_t *node, const json_t *rule,
                              const json_t *value) {
  (void)node;
  const char *words[WORDS_MAX];
  size_t count = 0, index;
  json_t *option;
  json_array_foreach(rule, index, option) {
    if (is_equal(option, value)) {
      return STATUS_OK;
    }
    if (json_is_string(option) && count < WORDS_MAX) {
      words[count++] = json_string_value(option);
    }
  }
  char list[280], quoted[60];
  schema_list_words(list, sizeof list, words, count);
  walk->example = NULL;
  if (!json_is_string(value)) {
    return schema_refuse(walk, "must be %s, not %s", list, json_type_phrase(value));
  }
  const char *near = text_nearest(json_string_value(value), words, count);
  return schema_refuse(walk, "%s is not known%s%s%s: it must be %s",
                       text_quote(quoted, sizeof quoted, json_string_value(value)),
                       near ? " (did you mean \"" : "", near ? near : "", near ? "\"?)" : "", list);
}

/* ---- numbers and strings ---------------------------------------------------------------- */

static enum status check_number(struct walk *walk, const json_t *rule, const json_t *value,
                                bool (*fits)(double value, double bound), const char *phrase) {
  if (!json_is_number(value) || fits(json_number_value(value), json_number_value(rule))) {
    return STATUS_OK;
  }
  return schema_refuse(walk, "%.12g is out of range: it must be %s %.12g", json_number_value(value),
                       phrase, json_number_value(rule));
}

static bool is_at_least(double value, double bound) {
  return value >= bound;
}

static bool is_at_most(double value, double bound) {
  return value <= bound;
}

static bool is_more(double value, double bound) {
  return value > bound;
}

static bool is_less(double value, double bound) {
  return value < bound;
}

static enum status check_minimum(struct walk *walk, const json_t *node, const json_t *rule,
                                 const json_t *value) {
  (void)node;
  return check_number(walk, rule, value, is_at_least, "at least");
}

static enum status check_maximum(struct walk *walk, const json_t *node, const json_t *rule,
                                 const json_t *value) {
  (void)node;
  return check_number(walk, rule, value, is_at_most, "at most");
}

static enum status check_exclusive_minimum(struct walk *walk, const json_t *node,
                                           const json_t *rule, const json_t *value) {
  (void)node;
  return check_number(walk, rule, value, is_more, "more than");
}

static enum status check_exclusive_maximum(struct walk *walk, const json_t *node,
                                           const json_t *rule, const json_t *value) {
  (void)node;
  return check_number(walk, rule, value, is_less, "less than");
}

static json_int_t count_characters(const char *text) {
  json_int_t count = 0;
  for (; *text; text++) {
    count += ((unsigned char)*text & 0xC0) != 0x80;
  }
  return count;
}

static enum status check_min_length(struct walk *walk, const json_t *node, const json_t *rule,
                                    const json_t *value) {
  (void)node;
  json_int_t least = json_integer_value(rule);
  if (!json_is_string(value) || count_characters(json_string_value(value)) >= least) {
    return STATUS_OK;
  }
  return schema_refuse(walk, "must have at least %lld characters", (long long)least);
}

static enum status check_max_length(struct walk *walk, const json_t *node, const json_t *rule,
                                    const json_t *value) {
  (void)node;
  json_int_t most = json_integer_value(rule);
  if (!json_is_string(value) || count_characters(json_string_value(value)) <= most) {
    return STATUS_OK;
  }
  return schema_refuse(walk, "has %lld characters; at most %lld are allowed",
                       (long long)count_characters(json_string_value(value)), (long long)most);
}

const struct schema_keyword schema_value_keywords[] = {
    {"x-unit", check_unit},
    {"x-minimum", NULL},
    {"x-maximum", NULL},
    {"x-exclusiveMinimum", NULL},
    {"type", check_type},
    {"const", check_const},
    {"enum", check_enum},
    {"minimum", check_minimum},
    {"maximum", check_maximum},
    {"exclusiveMinimum", check_exclusive_minimum},
    {"exclusiveMaximum", check_exclusive_maximum},
    {"minLength", check_min_length},
    {"maxLength", check_max_length},
    {NULL, NULL},
};
