/* Keywords about objects, arrays and alternatives. */
#include "solver/job/schema_walk.h"

#include <stdio.h>
#include <string.h>

#include "solver/base/text.h"

enum { KEYS_MAX = 64 };

/* Checks a member or item. */
static enum status check_child(struct walk *walk, const json_t *node, const json_t *value,
                               size_t mark) {
  enum status status = schema_check_node(walk, node, value);
  json_pointer_pop(&walk->pointer, mark);
  return status;
}

static enum status check_one_of(struct walk *walk, const json_t *node, const json_t *rule,
                                const json_t *value) {
  (void)node;
  const json_t *branch = schema_choose_branch(walk, rule, value);
  if (!branch) {
    return walk->error ? walk->error->status : STATUS_INVALID;
  }
  return schema_check_node(walk, branch, value);
}

/* A member of an object as an example: one with the key `key`. */
static json_t *member_example(const struct walk *walk, const json_t *property, const char *key) {
  json_t *value = schema_example(walk->schema, property);
  return value ? json_pack("{s:o}", key, value) : NULL;
}

static enum status refuse_key(struct walk *walk, const json_t *properties, const json_t *value,
                              const char *key) {
  const char *words[KEYS_MAX], *known, *absent = NULL;
  size_t count = 0;
  json_t *property;
  json_object_foreach((json_t *)properties, known, property) {
    absent = absent || json_object_get(value, known) ? absent : known;
    if (count < KEYS_MAX) {
      words[count++] = known;
    }
  }
  char list[SCHEMA_ALLOWED], quoted[60], found[SCHEMA_PHRASE];
  schema_list_words(list, sizeof list, words, count);
  const char *near = text_nearest(key, words, count);
  const char *shown = near ? near : absent ? absent : words[0];
  snprintf(found, sizeof found, "the key %s", text_quote(quoted, sizeof quoted, key));
  json_t *example = member_example(walk, json_object_get(properties, shown), shown);
  size_t mark = json_pointer_key(&walk->pointer, key);
  enum status status = schema_refuse(walk, &(struct refusal){.found = found,
                                                             .problem = "is not known here",
                                                             .verb = "known are",
                                                             .allowed = list,
                                                             .nearest = near,
                                                             .example = example});
  json_pointer_pop(&walk->pointer, mark);
  return status;
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
      return refuse_key(walk, properties, value, key);
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

static enum status refuse_size(struct walk *walk, const json_t *value, const char *problem) {
  char found[SCHEMA_PHRASE];
  return schema_refuse(
      walk, &(struct refusal){.found = schema_value_phrase(found, value), .problem = problem});
}

static enum status check_max_properties(struct walk *walk, const json_t *node, const json_t *rule,
                                        const json_t *value) {
  (void)node;
  size_t most = (size_t)json_integer_value(rule);
  if (json_object_size(value) <= most) {
    return STATUS_OK;
  }
  return refuse_size(walk, value, "is too large");
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
    char found[SCHEMA_PHRASE], allowed[SCHEMA_ALLOWED];
    snprintf(found, sizeof found, "the key \"%s\"", key);
    return schema_refuse(
        walk, &(struct refusal){.found = found,
                                .problem = "is missing",
                                .allowed = schema_describe(walk->schema, property, allowed),
                                .example = member_example(walk, property, key)});
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
  return refuse_size(walk, value, "is too short");
}

static enum status check_max_items(struct walk *walk, const json_t *node, const json_t *rule,
                                   const json_t *value) {
  (void)node;
  size_t most = (size_t)json_integer_value(rule);
  if (json_array_size(value) <= most) {
    return STATUS_OK;
  }
  return refuse_size(walk, value, "is too long");
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
