#include "solver/job/schema_walk.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/text.h"

/* ---- creation --------------------------------------------------------------------------- */

static bool is_known_keyword(const char *name) {
  static const char *const annotations[] = {"$schema", "$id",         "$defs",   "$comment",
                                            "title",   "description", "default", "examples"};
  for (size_t i = 0; i < sizeof annotations / sizeof *annotations; i++) {
    if (strcmp(name, annotations[i]) == 0) {
      return true;
    }
  }
  const struct schema_keyword *tables[] = {schema_value_keywords, schema_container_keywords};
  for (size_t t = 0; t < 2; t++) {
    for (const struct schema_keyword *keyword = tables[t]; keyword->name; keyword++) {
      if (strcmp(name, keyword->name) == 0) {
        return true;
      }
    }
  }
  return strcmp(name, "$ref") == 0;
}

static enum status check_schema_node(const struct schema *schema, const json_t *node,
                                     struct error *error);

static enum status check_schema_map(const struct schema *schema, const json_t *map,
                                    struct error *error) {
  const char *key;
  json_t *child;
  json_object_foreach((json_t *)map, key, child) {
    enum status status = check_schema_node(schema, child, error);
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

/* A keyword that is silently ignored would be a rule that nobody enforces. */
static enum status check_schema_node(const struct schema *schema, const json_t *node,
                                     struct error *error) {
  if (json_is_boolean(node)) {
    return STATUS_OK;
  }
  if (!json_is_object(node) || !schema_resolve(schema, node)) {
    return error_set(error, STATUS_INTERNAL, NULL, "a schema node is no object or has a bad $ref");
  }
  const char *key;
  json_t *rule;
  json_object_foreach((json_t *)node, key, rule) {
    enum status status = STATUS_OK;
    if (!is_known_keyword(key)) {
      status = error_set(error, STATUS_INTERNAL, NULL, "unsupported schema keyword \"%s\"", key);
    } else if (strcmp(key, "properties") == 0 || strcmp(key, "$defs") == 0) {
      status = check_schema_map(schema, rule, error);
    } else if (strcmp(key, "items") == 0 || strcmp(key, "additionalProperties") == 0 ||
               strcmp(key, "propertyNames") == 0) {
      status = check_schema_node(schema, rule, error);
    } else if (strcmp(key, "oneOf") == 0) {
      size_t index;
      json_t *branch;
      json_array_foreach(rule, index, branch) {
        status = status == STATUS_OK ? check_schema_node(schema, branch, error) : status;
      }
    }
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

enum status schema_create(const char *text, size_t size, const struct units *units,
                          struct schema **schema, struct error *error) {
  struct schema *created = calloc(1, sizeof *created);
  if (!created) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the schema");
  }
  created->units = units;
  enum status status = json_text_read(text, size, &created->root, error);
  if (status == STATUS_OK) {
    status = check_schema_node(created, created->root, error);
  }
  if (status != STATUS_OK) {
    schema_destroy(created);
    return status;
  }
  *schema = created;
  return STATUS_OK;
}

void schema_destroy(struct schema *schema) {
  if (!schema) {
    return;
  }
  json_decref(schema->root);
  free(schema);
}

/* ---- choosing a branch ------------------------------------------------------------------ */

const json_t *schema_resolve(const struct schema *schema, const json_t *node) {
  static const char prefix[] = "#/$defs/";
  for (int hops = 0; hops < 8; hops++) {
    const char *reference = json_string_value(json_object_get(node, "$ref"));
    if (!reference) {
      return node;
    }
    if (strncmp(reference, prefix, sizeof prefix - 1) != 0) {
      return NULL;
    }
    node = json_object_get(json_object_get(schema->root, "$defs"), reference + sizeof prefix - 1);
    if (!node) {
      return NULL;
    }
  }
  return NULL;
}

const json_t *schema_rule(const struct schema *schema, const json_t *node, const char *keyword) {
  const json_t *own = json_object_get(node, keyword);
  return own ? own : json_object_get(schema_resolve(schema, node), keyword);
}

/* The type that a branch accepts: its `type`, or that of its `const`. */
static bool branch_takes(const json_t *branch, const json_t *value) {
  const json_t *fixed = json_object_get(branch, "const");
  if (fixed) {
    return json_is_number(fixed) ? json_is_number(value) : json_typeof(fixed) == json_typeof(value);
  }
  const char *type = json_string_value(json_object_get(branch, "type"));
  return !type || schema_has_type(value, type);
}

/* The name of the property by which an object branch is told from its siblings, or NULL. */
static const char *discriminator(const json_t *branch) {
  const char *key;
  json_t *property;
  json_object_foreach(json_object_get(branch, "properties"), key, property) {
    if (json_object_get(property, "const")) {
      return key;
    }
  }
  return NULL;
}

static const json_t *branch_const(const json_t *branch, const char *key) {
  return json_object_get(json_object_get(json_object_get(branch, "properties"), key), "const");
}

enum { BRANCHES_MAX = 32 };

static const json_t *choose_by_property(struct walk *walk, const json_t *const *candidates,
                                        size_t count, const char *key, const json_t *value) {
  const json_t *given = json_object_get(value, key);
  const char *words[BRANCHES_MAX];
  for (size_t i = 0; i < count; i++) {
    const json_t *fixed = branch_const(candidates[i], key);
    if (given && fixed && json_equal(given, fixed)) {
      return candidates[i];
    }
    words[i] = fixed && json_is_string(fixed) ? json_string_value(fixed) : "?";
  }
  char list[SCHEMA_ALLOWED], found[SCHEMA_PHRASE], problem[SCHEMA_PHRASE];
  schema_list_words(list, sizeof list, words, count);
  if (!given) {
    snprintf(found, sizeof found, "the key \"%s\"", key);
    schema_refuse(walk, &(struct refusal){.found = found,
                                          .problem = "is missing",
                                          .allowed = list,
                                          .example = json_pack("{s:s}", key, words[0])});
    return NULL;
  }
  const char *word = json_string_value(given);
  const char *near = word ? text_nearest(word, words, count) : NULL;
  snprintf(problem, sizeof problem, "is not a known %s", key);
  size_t mark = json_pointer_key(&walk->pointer, key);
  schema_refuse(walk, &(struct refusal){.found = schema_value_phrase(found, given),
                                        .problem = problem,
                                        .allowed = list,
                                        .nearest = near,
                                        .example = json_string(near ? near : words[0])});
  json_pointer_pop(&walk->pointer, mark);
  return NULL;
}

const json_t *schema_choose_branch(struct walk *walk, const json_t *branches, const json_t *value) {
  const json_t *candidates[BRANCHES_MAX];
  const json_t *quantity = NULL;
  size_t count = 0, index;
  json_t *branch;
  json_array_foreach(branches, index, branch) {
    const json_t *resolved = schema_resolve(walk->schema, branch);
    quantity = json_object_get(resolved, "x-unit") ? resolved : quantity;
    if (branch_takes(resolved, value) && count < BRANCHES_MAX) {
      candidates[count++] = resolved;
    }
  }
  /* A bare number where a quantity may stand is answered with the form of the quantity. */
  if (json_is_number(value) && quantity) {
    const json_t *fixed = count > 0 ? json_object_get(candidates[0], "const") : NULL;
    bool equal = fixed && json_number_value(fixed) == json_number_value(value);
    return equal ? candidates[0] : quantity;
  }
  if (count == 0) {
    char found[SCHEMA_PHRASE];
    schema_refuse(walk, &(struct refusal){.found = schema_value_phrase(found, value),
                                          .problem = "is not possible here"});
    return NULL;
  }
  const char *key = json_is_object(value) ? discriminator(candidates[0]) : NULL;
  return key ? choose_by_property(walk, candidates, count, key, value) : candidates[0];
}

/* ---- walking ---------------------------------------------------------------------------- */

static enum status check_keywords(struct walk *walk, const json_t *node, const json_t *value) {
  const json_t *target = schema_resolve(walk->schema, node);
  if (target != node) {
    enum status status = check_keywords(walk, target, value);
    if (status != STATUS_OK) {
      return status;
    }
  }
  const struct schema_keyword *tables[] = {schema_value_keywords, schema_container_keywords};
  for (size_t t = 0; t < 2; t++) {
    for (const struct schema_keyword *keyword = tables[t]; keyword->name; keyword++) {
      const json_t *rule = json_object_get(node, keyword->name);
      if (!rule || !keyword->check) {
        continue;
      }
      enum status status = keyword->check(walk, node, rule, value);
      if (status != STATUS_OK) {
        return status;
      }
    }
  }
  return STATUS_OK;
}

enum status schema_check_node(struct walk *walk, const json_t *node, const json_t *value) {
  const json_t *outer = walk->node;
  walk->node = node;
  enum status status = check_keywords(walk, node, value);
  walk->node = outer;
  return status;
}

enum status schema_check(const struct schema *schema, const json_t *value, struct error *error) {
  struct walk walk = {.schema = schema, .error = error};
  return schema_check_node(&walk, schema->root, value);
}

/* ---- defaults --------------------------------------------------------------------------- */

static enum status fill_node(struct walk *walk, const json_t *node, json_t *value);

static enum status fill_object(struct walk *walk, const json_t *properties, json_t *value) {
  const char *key;
  json_t *property;
  json_object_foreach((json_t *)properties, key, property) {
    json_t *standard = json_object_get(property, "default");
    if (standard && !json_object_get(value, key) &&
        json_object_set_new(value, key, json_deep_copy(standard)) != 0) {
      return error_set(walk->error, STATUS_NO_MEMORY, NULL, "no memory for the defaults");
    }
    json_t *member = json_object_get(value, key);
    enum status status = member ? fill_node(walk, property, member) : STATUS_OK;
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

/* Members that have no names of their own in the schema. */
static enum status fill_others(struct walk *walk, const json_t *node, json_t *value) {
  const json_t *properties = json_object_get(node, "properties");
  const json_t *others = json_object_get(node, "additionalProperties");
  const char *key;
  json_t *member;
  enum status status = STATUS_OK;
  json_object_foreach(value, key, member) {
    if (json_is_object(others) && !json_object_get(properties, key) && status == STATUS_OK) {
      status = fill_node(walk, others, member);
    }
  }
  return status;
}

static enum status fill_node(struct walk *walk, const json_t *node, json_t *value) {
  node = schema_resolve(walk->schema, node);
  const json_t *branches = json_object_get(node, "oneOf");
  if (branches) {
    node = schema_choose_branch(walk, branches, value);
  }
  if (json_is_object(value)) {
    enum status status = fill_object(walk, json_object_get(node, "properties"), value);
    return status == STATUS_OK ? fill_others(walk, node, value) : status;
  }
  const json_t *items = json_object_get(node, "items");
  size_t index;
  json_t *item;
  if (items && json_is_array(value)) {
    json_array_foreach(value, index, item) {
      enum status status = fill_node(walk, items, item);
      if (status != STATUS_OK) {
        return status;
      }
    }
  }
  return STATUS_OK;
}

enum status schema_fill(const struct schema *schema, json_t *value, struct error *error) {
  struct walk walk = {.schema = schema, .node = schema->root, .error = error};
  return fill_node(&walk, schema->root, value);
}
