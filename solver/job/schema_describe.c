/* Words about values and nodes: what was found, what is allowed, and what would be right. */
#include "solver/job/schema_walk.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/text.h"

enum { WORDS_MAX = 64, BRANCHES_DEEP = 4 };

/* ---- text that grows in a field ----------------------------------------------------------- */

struct phrase {
  char *text;
  size_t size;
};

static void add(struct phrase *phrase, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static void add(struct phrase *phrase, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  int length = vsnprintf(phrase->text, phrase->size, format, arguments);
  va_end(arguments);
  size_t used = (size_t)length < phrase->size ? (size_t)length : phrase->size - 1;
  phrase->text += used;
  phrase->size -= used;
}

const char *schema_list_words(char *out, size_t size, const char *const *words, size_t count) {
  size_t length = 0;
  out[0] = '\0';
  for (size_t i = 0; i < count; i++) {
    const char *join = i == 0 ? "" : i + 1 == count ? " or " : ", ";
    if (length + strlen(join) + strlen(words[i]) + 8 > size) {
      snprintf(out + length, size - length, ", ...");
      break;
    }
    length += (size_t)snprintf(out + length, size - length, "%s\"%s\"", join, words[i]);
  }
  return out;
}

/* ---- what was found ------------------------------------------------------------------------ */

const char *schema_value_phrase(char *out, const json_t *value) {
  size_t count = json_is_array(value) ? json_array_size(value) : json_object_size(value);
  switch (json_typeof(value)) {
  case JSON_STRING:
    return text_quote(out, SCHEMA_PHRASE, json_string_value(value));
  case JSON_INTEGER:
    snprintf(out, SCHEMA_PHRASE, "the number %lld", (long long)json_integer_value(value));
    break;
  case JSON_REAL:
    snprintf(out, SCHEMA_PHRASE, "the number %.12g", json_real_value(value));
    break;
  case JSON_ARRAY:
    snprintf(out, SCHEMA_PHRASE, "an array of %zu item%s", count, count == 1 ? "" : "s");
    break;
  case JSON_OBJECT:
    snprintf(out, SCHEMA_PHRASE, "an object of %zu member%s", count, count == 1 ? "" : "s");
    break;
  default:
    snprintf(out, SCHEMA_PHRASE, "%s",
             json_is_null(value)   ? "null"
             : json_is_true(value) ? "true"
                                   : "false");
  }
  return out;
}

/* ---- what is allowed ----------------------------------------------------------------------- */

/* The type that a node names, or that its other keywords are about; NULL when any value will do. */
static const char *node_type(const struct schema *schema, const json_t *node) {
  static const struct {
    const char *keyword, *type;
  } implied[] = {
      {"minimum", "number"},          {"maximum", "number"},   {"exclusiveMinimum", "number"},
      {"exclusiveMaximum", "number"}, {"minLength", "string"}, {"maxLength", "string"},
      {"minItems", "array"},          {"maxItems", "array"},   {"maxProperties", "object"}};
  const char *type = json_string_value(schema_rule(schema, node, "type"));
  for (size_t i = 0; !type && i < sizeof implied / sizeof *implied; i++) {
    type = schema_rule(schema, node, implied[i].keyword) ? implied[i].type : NULL;
  }
  return type;
}

/* The limits of a size or a number: " from 1 to 64", " of at least 1 item", " of 2 items". */
static void add_limits(struct phrase *phrase, const json_t *least, const json_t *most,
                       const char *noun) {
  double low = json_number_value(least), high = json_number_value(most);
  bool single = (most ? high : low) == 1.0;
  if (least && most && low == high) {
    add(phrase, " of %.12g%s", low, noun);
  } else if (least && most) {
    add(phrase, " %s%.12g to %.12g%s", noun[0] ? "of " : "from ", low, high, noun);
  } else if (least) {
    add(phrase, " of at least %.12g%s", low, noun);
  } else if (most) {
    add(phrase, " of at most %.12g%s", high, noun);
  }
  if ((least || most) && noun[0] && !single) {
    add(phrase, "s");
  }
}

static void add_number(const struct schema *schema, struct phrase *phrase, const json_t *node,
                       const char *type) {
  const json_t *above = schema_rule(schema, node, "exclusiveMinimum");
  const json_t *below = schema_rule(schema, node, "exclusiveMaximum");
  const json_t *most = schema_rule(schema, node, "maximum");
  add(phrase, strcmp(type, "integer") == 0 ? "a whole number" : "a number");
  if (above) {
    add(phrase, " above %.12g", json_number_value(above));
  }
  if (below) {
    add(phrase, "%s below %.12g", above ? " and" : "", json_number_value(below));
  }
  if (above && most) {
    add(phrase, " and at most %.12g", json_number_value(most));
  } else {
    add_limits(phrase, schema_rule(schema, node, "minimum"), most, "");
  }
}

static void add_quantity(const struct schema *schema, struct phrase *phrase, const json_t *node,
                         const char *unit) {
  static const struct {
    const char *keyword, *words;
  } bounds[] = {
      {"x-minimum", "at least"}, {"x-exclusiveMinimum", "more than"}, {"x-maximum", "at most"}};
  add(phrase, "%s with its unit", units_dimension(schema->units, unit));
  const char *join = ", ";
  for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++) {
    const json_t *bound = schema_rule(schema, node, bounds[i].keyword);
    if (bound) {
      add(phrase, "%s%s %s", join, bounds[i].words, json_string_value(bound));
      join = " and ";
    }
  }
}

static void add_type(const struct schema *schema, struct phrase *phrase, const json_t *node,
                     const char *type) {
  switch (type[0]) {
  case 'o':
    add(phrase, "an object");
    add_limits(phrase, NULL, schema_rule(schema, node, "maxProperties"), " member");
    break;
  case 'a':
    add(phrase, "an array");
    add_limits(phrase, schema_rule(schema, node, "minItems"), schema_rule(schema, node, "maxItems"),
               " item");
    break;
  case 's':
    add(phrase, "a string");
    add_limits(phrase, schema_rule(schema, node, "minLength"),
               schema_rule(schema, node, "maxLength"), " character");
    break;
  case 'b':
    add(phrase, "true or false");
    break;
  default:
    add_number(schema, phrase, node, type);
  }
}

static void add_words(struct phrase *phrase, const json_t *options) {
  const char *words[WORDS_MAX];
  char list[SCHEMA_ALLOWED];
  size_t count = 0, index;
  json_t *option;
  json_array_foreach(options, index, option) {
    if (json_is_string(option) && count < WORDS_MAX) {
      words[count++] = json_string_value(option);
    }
  }
  add(phrase, "%s",
      schema_list_words(list, phrase->size < sizeof list ? phrase->size : sizeof list, words,
                        count));
}

static void add_node(const struct schema *schema, struct phrase *phrase, const json_t *node,
                     int deep) {
  const json_t *fixed = schema_rule(schema, node, "const");
  const json_t *options = schema_rule(schema, node, "enum");
  const json_t *branches = schema_rule(schema, node, "oneOf");
  const char *unit = json_string_value(schema_rule(schema, node, "x-unit"));
  const char *type = node_type(schema, node);
  const char *before = phrase->text, *join = "";
  if (json_is_string(fixed)) {
    add(phrase, "\"%s\"", json_string_value(fixed));
  } else if (fixed) {
    add(phrase, "%.12g", json_number_value(fixed));
  } else if (options) {
    add_words(phrase, options);
  } else if (unit) {
    add_quantity(schema, phrase, node, unit);
  } else if (branches && deep < BRANCHES_DEEP) {
    size_t index;
    json_t *branch;
    json_array_foreach(branches, index, branch) {
      char text[SCHEMA_ALLOWED] = "";
      struct phrase part = {text, sizeof text};
      add_node(schema, &part, branch, deep + 1);
      if (!strstr(before, text) && strlen(text) + 4 < phrase->size) {
        add(phrase, "%s%s", join, text);
        join = " or ";
      }
    }
  } else if (type) {
    add_type(schema, phrase, node, type);
  } else {
    add(phrase, "any value");
  }
}

const char *schema_describe(const struct schema *schema, const json_t *node, char *out) {
  struct phrase phrase = {out, SCHEMA_ALLOWED};
  out[0] = '\0';
  add_node(schema, &phrase, node, 0);
  text_repair(out);
  return out;
}

/* ---- what would be right ------------------------------------------------------------------- */

static json_t *make_object(const struct schema *schema, const json_t *node) {
  const json_t *properties = schema_rule(schema, node, "properties");
  json_t *made = json_object();
  size_t index;
  json_t *name;
  json_array_foreach(schema_rule(schema, node, "required"), index, name) {
    const char *key = json_string_value(name);
    json_object_set_new(made, key, schema_example(schema, json_object_get(properties, key)));
  }
  return made;
}

static json_t *make_array(const struct schema *schema, const json_t *node) {
  const json_t *items = schema_rule(schema, node, "items");
  json_int_t least = json_integer_value(schema_rule(schema, node, "minItems"));
  json_t *made = json_array();
  for (json_int_t i = 0; items && i < least; i++) {
    json_array_append_new(made, schema_example(schema, items));
  }
  return made;
}

/* The node has a type, or takes anything. */
static json_t *make_value(const struct schema *schema, const json_t *node) {
  const char *type = node_type(schema, node);
  const char *unit = json_string_value(schema_rule(schema, node, "x-unit"));
  const json_t *least = schema_rule(schema, node, "minimum");
  if (unit) {
    return json_sprintf("1 %s", unit);
  }
  switch (type ? type[0] : 'b') {
  case 'o':
    return make_object(schema, node);
  case 'a':
    return make_array(schema, node);
  case 's':
    return json_string("text");
  case 'b':
    return json_true();
  default:
    return least ? json_deep_copy(least) : json_integer(1);
  }
}

json_t *schema_example(const struct schema *schema, const json_t *node) {
  const json_t *examples = schema_rule(schema, node, "examples");
  const json_t *given = json_array_get(examples, 0);
  given = given ? given : schema_rule(schema, node, "const");
  given = given ? given : schema_rule(schema, node, "default");
  given = given ? given : json_array_get(schema_rule(schema, node, "enum"), 0);
  if (given) {
    return json_deep_copy(given);
  }
  const json_t *branch = json_array_get(schema_rule(schema, node, "oneOf"), 0);
  return branch ? schema_example(schema, branch) : make_value(schema, node);
}

/* ---- the refusal --------------------------------------------------------------------------- */

/* The example, as text that fits into its field. */
static enum status take_example(struct walk *walk, const struct refusal *refusal) {
  struct error *error = walk->error;
  json_t *example = refusal->example;
  if (!example && walk->node) {
    example = schema_example(walk->schema, walk->node);
  }
  char *text = example ? json_dumps(example, JSON_ENCODE_ANY | JSON_REAL_PRECISION(12)) : NULL;
  if (text && strlen(text) < sizeof error->example) {
    memcpy(error->example, text, strlen(text) + 1);
  }
  enum status status = text ? STATUS_OK : STATUS_NO_MEMORY;
  free(text);
  json_decref(example);
  return status;
}

enum status schema_refuse(struct walk *walk, const struct refusal *refusal) {
  struct error *error = walk->error;
  if (!error) {
    json_decref(refusal->example);
    return STATUS_INVALID;
  }
  char described[SCHEMA_ALLOWED];
  const char *allowed =
      refusal->allowed ? refusal->allowed : schema_describe(walk->schema, walk->node, described);
  const char *nearest = refusal->nearest;
  *error = (struct error){.status = STATUS_INVALID};
  if (take_example(walk, refusal) != STATUS_OK) {
    return error_set(error, STATUS_NO_MEMORY, walk->pointer.text, "no memory to describe an error");
  }
  memcpy(error->pointer, walk->pointer.text, sizeof walk->pointer.text);
  snprintf(error->found, sizeof error->found, "%s", refusal->found);
  snprintf(error->allowed, sizeof error->allowed, "%s", allowed);
  snprintf(error->nearest, sizeof error->nearest, "%s", nearest ? nearest : "");
  snprintf(error->message, sizeof error->message, "%s%s%s%s%s%s: %s %s%s%s", refusal->found,
           refusal->problem[0] ? " " : "", refusal->problem, nearest ? " (did you mean \"" : "",
           nearest ? nearest : "", nearest ? "\"?)" : "",
           refusal->verb ? refusal->verb : "it must be", allowed,
           error->example[0] ? "; for example " : "", error->example);
  text_repair(error->message);
  return STATUS_INVALID;
}
