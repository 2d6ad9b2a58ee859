/* Keywords about objects, arrays and alternatives. */
#include "solver/job/schema_walk.h"

#include <string.h>

#include "solver/base/text.h"

enum { KEYS_MAX = 64 };

/* Checks a member or item; the example in hand belongs to its container and is set aside. */
static enum status check_child(struct walk *walk, const json_t *node, const json_t *value,
                               size_t mark) {
  const json_t *example = walk->example;
  walk->example = NULL;
  enum status status = schema_check_node(walk, node, value);
  walk->example = example;
  json_pointer_pop(&walk->pointer, mark);
  return status;
}

static enum status check_one_of(struct walk *walk, const json_t *node, const json_t *rule,
                                const json_t *value) {
  (void)node;
  const json_t *branch = schema_choose_branch(walk, rule, value);
  return branch ? schema_check_node(walk, branch, value) : STATUS_INVALID;
}

static enum status refuse_key(struct walk *walk, const json_t *properties, const char *key) {
  const char *words[KEYS_MAX];
  size_t count = 0;
  const char *known;
  json_t *property;
  json_object_foreach((json_t *)properties, known, property) {
    if (count < KEYS_MAX) {
      words[count++] = known;
    }
  }
  char list[240], quoted[60];
  schema_list_words(list, sizeof list, words, count);
  const char *near = text_nearest(key, words, count);
  walk->example = NULL;
  size_t mark = json_pointer_key(&walk->pointer, key);
  schema_refuse(walk, "the key %s is not known here%s%s%s; known are %s",
                text_quote(quoted, sizeof quoted, key), near ? ", did you mean \"" : "",
                near ? near : "", near ? "\"?" : "", list);
  json_pointer_pop(&walk->pointer, mark);
  return STATUS_INVALID;
}

/* Comes before `required`, so that a misspelt key is not reported as a missing one. */
static enum status check_additional(struct walk *walk, const json_t *node, const json_t *rule,
                                    const json_t *value) {
  const json_t *properties = json_object_get(node, "properties");
  const char *key;
  json_t *member;
  json_object_foreach((json_t *)value, key, member) {
    if (json_object_get(properties, key)) {
      continue;
    }
    if (json_is_false(rule)) {
      return refuse_key(walk, properties, key);
    }
    enum status status = check_child(walk, rule, member, json_pointer_key(&walk->pointer, key));
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

static enum status check_property_names(struct walk *walk, const json_t *node, const json_t *rule,
                                        const json_t *value) {
  (void)node;
  const char *key;
  json_t *member;
  json_object_foreach((json_t *)value, key, member) {
    json_t *name = json_string(key);
    enum status status =
        name ? check_child(walk, rule, name, json_pointer_key(&walk->pointer, key))
             : error_set(walk->error, STATUS_NO_MEMORY, NULL, "no memory to check a key");
    json_decref(name);
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

static enum status check_max_properties(struct walk *walk, const json_t *node, const json_t *rule,
                                        const json_t *value) {
  (void)node;
  size_t most = (size_t)json_integer_value(rule);
  if (json_object_size(value) <= most) {
    return STATUS_OK;
  }
  walk->example = NULL;
  return schema_refuse(walk, "has %zu members; at most %zu are allowed", json_object_size(value),
                       most);
}

static enum status check_required(struct walk *walk, const json_t *node, const json_t *rule,
                                  const json_t *value) {
  size_t index;
  json_t *name;
  json_array_foreach(rule, index, name) {
    const char *key = json_string_value(name);
    if (!json_is_object(value) || json_object_get(value, key)) {
      continue;
    }
    const json_t *property = json_object_get(json_object_get(node, "properties"), key);
    const json_t *examples = json_object_get(property, "examples");
    if (!examples) {
      examples = json_object_get(schema_resolve(walk->schema, property), "examples");
    }
    walk->example = examples ? json_array_get(examples, 0) : json_object_get(property, "const");
    return schema_refuse(walk, "the key \"%s\" is missing", key);
  }
  return STATUS_OK;
}

static enum status check_properties(struct walk *walk, const json_t *node, const json_t *rule,
                                    const json_t *value) {
  (void)node;
  const char *key;
  json_t *property;
  json_object_foreach((json_t *)rule, key, property) {
    const json_t *member = json_object_get(value, key);
    if (!member) {
      continue;
    }
    enum status status = check_child(walk, property, member, json_pointer_key(&walk->pointer, key));
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

static enum status check_items(struct walk *walk, const json_t *node, const json_t *rule,
                               const json_t *value) {
  (void)node;
  size_t index;
  json_t *item;
  json_array_foreach(value, index, item) {
    enum status status = check_child(walk, rule, item, json_pointer_index(&walk->pointer, index));
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

static enum status check_min_items(struct walk *walk, const json_t *node, const json_t *rule,
                                   const json_t *value) {
  (void)node;
  size_t least = (size_t)json_integer_value(rule);
  if (!json_is_array(value) || json_array_size(value) >= least) {
    return STATUS_OK;
  }
  return schema_refuse(walk, "must have at least %zu item%s, not %zu", least, least == 1 ? "" : "s",
                       json_array_size(value));
}

static enum status check_max_items(struct walk *walk, const json_t *node, const json_t *rule,
                                   const json_t *value) {
  (void)node;
  size_t most = (size_t)json_integer_value(rule);
  if (json_array_size(value) <= most) {
    return STATUS_OK;
  }
  return schema_refuse(walk, "has %zu items; at most %zu are allowed", json_array_size(value),
                       most);
}

const struct schema_keyword schema_container_keywords[] = {
    {"oneOf", check_one_of},
    {"maxProperties", check_max_properties},
    {"additionalProperties", check_additional},
    {"propertyNames", check_property_names},
    {"required", check_required},
    {"minItems", check_min_items},
    {"maxItems", check_max_items},
    {"properties", check_properties},
    {"items", check_items},
    {NULL, NULL},
};
