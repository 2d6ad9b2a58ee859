/* Keywords about single values: types, fixed words, numbers, strings, quantities. */
#include "solver/job/schema_walk.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/base/text.h"

enum { WORDS_MAX = 64 };

bool schema_has_type(const json_t *value, const char *type) {
  static const char *const types[] = {
      [JSON_OBJECT] = "object",   [JSON_ARRAY] = "array", [JSON_STRING] = "string",
      [JSON_INTEGER] = "integer", [JSON_REAL] = "number", [JSON_TRUE] = "boolean",
      [JSON_FALSE] = "boolean",   [JSON_NULL] = "null",
  };
  json_type own = json_typeof(value);
  if (strcmp(type, types[own]) == 0) {
    return true;
  }
  /* Numbers without a fraction are integers, and integers are numbers. */
  return own == JSON_INTEGER ? strcmp(type, "number") == 0
                             : own == JSON_REAL && strcmp(type, "integer") == 0 &&
                                   json_real_value(value) == floor(json_real_value(value));
}

/* ---- quantities ------------------------------------------------------------------------- */

/* The value and what is wrong with it; the rest follows from the schema. */
static enum status refuse(struct walk *walk, const json_t *value, const char *problem) {
  char found[SCHEMA_PHRASE];
  return schema_refuse(
      walk, &(struct refusal){.found = schema_value_phrase(found, value), .problem = problem});
}

static enum status check_bound(struct walk *walk, const json_t *node, const char *keyword,
                               const char *unit, double si, const json_t *value) {
  const char *limit = json_string_value(json_object_get(node, keyword));
  double bound = 0.0;
  if (!limit) {
    return STATUS_OK;
  }
  enum status status = units_read(walk->schema->units, limit, unit, &bound, walk->error);
  if (status != STATUS_OK) {
    return status == STATUS_NO_MEMORY ? status : STATUS_INTERNAL;
  }
  bool exclusive = strstr(keyword, "exclusive") != NULL;
  bool lower = strstr(keyword, "inimum") != NULL;
  return (lower ? (exclusive ? si > bound : si >= bound) : si <= bound)
             ? STATUS_OK
             : refuse(walk, value, lower ? "is too small" : "is too large");
}

/* Whether a quantity reads well and is within the bounds; fills the error otherwise. */
static enum status check_quantity(struct walk *walk, const json_t *node, const char *unit,
                                  const json_t *value) {
  static const char *const bounds[] = {"x-minimum", "x-exclusiveMinimum", "x-maximum"};
  double si = 0.0;
  enum status status =
      units_read(walk->schema->units, json_string_value(value), unit, &si, walk->error);
  for (size_t i = 0; i < 3 && status == STATUS_OK; i++) {
    status = check_bound(walk, node, bounds[i], unit, si, value);
  }
  return status;
}

/* The quantity in `text`, a new reference, where the node takes it, otherwise NULL. */
static json_t *right_quantity(const struct walk *walk, const json_t *node, const char *unit,
                              const char *text) {
  struct walk quiet = {.schema = walk->schema, .node = node};
  json_t *quantity = json_string(text);
  if (quantity && check_quantity(&quiet, node, unit, quantity) != STATUS_OK) {
    json_decref(quantity);
    quantity = NULL;
  }
  return quantity;
}

/* units_read has filled the error with a sentence about the text, and an example. */
static enum status refuse_text(struct walk *walk, const json_t *node, const char *unit) {
  if (!walk->error) {
    return STATUS_INVALID;
  }
  const struct error read = *walk->error;
  json_t *example = json_read(read.example, strlen(read.example), JSON_DECODE_ANY, NULL);
  json_t *right = right_quantity(walk, node, unit, json_string_value(example));
  json_decref(example);
  return schema_refuse(walk,
                       &(struct refusal){.found = read.found, .problem = "", .example = right});
}

static enum status check_unit(struct walk *walk, const json_t *node, const json_t *rule,
                              const json_t *value) {
  const char *unit = json_string_value(rule);
  if (json_is_number(value)) {
    char found[SCHEMA_PHRASE], text[SCHEMA_PHRASE];
    snprintf(text, sizeof text, "%.12g %s", json_number_value(value), unit);
    return schema_refuse(walk,
                         &(struct refusal){.found = schema_value_phrase(found, value),
                                           .problem = "has no unit",
                                           .example = right_quantity(walk, node, unit, text)});
  }
  if (!json_is_string(value)) {
    return refuse(walk, value, "is not possible here");
  }
  double ignored;
  enum status status =
      units_read(walk->schema->units, json_string_value(value), unit, &ignored, walk->error);
  return status == STATUS_INVALID ? refuse_text(walk, node, unit)
         : status == STATUS_OK    ? check_quantity(walk, node, unit, value)
                                  : status;
}

/* ---- types and fixed values ------------------------------------------------------------- */

static enum status check_type(struct walk *walk, const json_t *node, const json_t *rule,
                              const json_t *value) {
  (void)node;
  const char *type = json_string_value(rule);
  bool fraction = strcmp(type, "integer") == 0 && json_is_number(value);
  return schema_has_type(value, type)
             ? STATUS_OK
             : refuse(walk, value, fraction ? "is not whole" : "is not possible here");
}

static bool is_equal(const json_t *a, const json_t *b) {
  return json_is_number(a) && json_is_number(b) ? json_number_value(a) == json_number_value(b)
                                                : json_equal(a, b);
}

static enum status check_const(struct walk *walk, const json_t *node, const json_t *rule,
                               const json_t *value) {
  (void)node;
  return is_equal(rule, value) ? STATUS_OK : refuse(walk, value, "is not possible here");
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
  if (!json_is_string(value)) {
    return refuse(walk, value, "is not possible here");
  }
  char found[SCHEMA_PHRASE];
  const char *near = text_nearest(json_string_value(value), words, count);
  return schema_refuse(walk, &(struct refusal){.found = schema_value_phrase(found, value),
                                               .problem = "is not known",
                                               .nearest = near,
                                               .example = near ? json_string(near) : NULL});
}

/* ---- numbers and strings ---------------------------------------------------------------- */

static enum status check_number(struct walk *walk, const json_t *rule, const json_t *value,
                                bool (*fits)(double value, double bound), const char *problem) {
  return !json_is_number(value) || fits(json_number_value(value), json_number_value(rule))
             ? STATUS_OK
             : refuse(walk, value, problem);
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
  return check_number(walk, rule, value, is_at_least, "is too small");
}

static enum status check_maximum(struct walk *walk, const json_t *node, const json_t *rule,
                                 const json_t *value) {
  (void)node;
  return check_number(walk, rule, value, is_at_most, "is too large");
}

static enum status check_exclusive_minimum(struct walk *walk, const json_t *node,
                                           const json_t *rule, const json_t *value) {
  (void)node;
  return check_number(walk, rule, value, is_more, "is too small");
}

static enum status check_exclusive_maximum(struct walk *walk, const json_t *node,
                                           const json_t *rule, const json_t *value) {
  (void)node;
  return check_number(walk, rule, value, is_less, "is too large");
}

static json_int_t count_characters(const char *text) {
  json_int_t count = 0;
  for (; *text; text++) {
    count += ((unsigned char)*text & 0xC0) != 0x80;
  }
  return count;
}

static enum status refuse_length(struct walk *walk, const json_t *value, const char *problem) {
  char found[SCHEMA_PHRASE];
  json_int_t count = count_characters(json_string_value(value));
  snprintf(found, sizeof found, "a string of %lld character%s", (long long)count,
           count == 1 ? "" : "s");
  return schema_refuse(walk, &(struct refusal){.found = found, .problem = problem});
}

static enum status check_min_length(struct walk *walk, const json_t *node, const json_t *rule,
                                    const json_t *value) {
  (void)node;
  return !json_is_string(value) ||
                 count_characters(json_string_value(value)) >= json_integer_value(rule)
             ? STATUS_OK
             : refuse_length(walk, value, "is too short");
}

static enum status check_max_length(struct walk *walk, const json_t *node, const json_t *rule,
                                    const json_t *value) {
  (void)node;
  return !json_is_string(value) ||
                 count_characters(json_string_value(value)) <= json_integer_value(rule)
             ? STATUS_OK
             : refuse_length(walk, value, "is too long");
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
