/* Inside of the schema checker, shared by its files; not for others. */
#ifndef PNEULAB_JOB_SCHEMA_WALK_H
#define PNEULAB_JOB_SCHEMA_WALK_H

#include "solver/job/json.h"
#include "solver/job/schema.h"

struct schema {
  json_t *root;
  const struct units *units;
};

/* One check on its way through a document. */
struct walk {
  const struct schema *schema;
  struct json_pointer pointer; /* of the value in hand */
  const json_t *example;       /* of the value in hand, NULL when the schema gives none */
  struct error *error;
};

/* Checks `value` against one node of the schema and all below. */
enum status schema_check_node(struct walk *walk, const json_t *node, const json_t *value);

/* The node that `node` stands for once its $ref is followed. */
const json_t *schema_resolve(const struct schema *schema, const json_t *node);

/* The branch of the oneOf array `branches` that `value` is meant to follow, or NULL when it can
 * be none; then *walk's error is filled unless it is NULL. */
const json_t *schema_choose_branch(struct walk *walk, const json_t *branches, const json_t *value);

/* Fills the error of *walk at its pointer: the sentence, then the example of the value in hand.
 * Returns STATUS_INVALID. */
enum status schema_refuse(struct walk *walk, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* A keyword with effect: `rule` is its value in `node`. */
struct schema_keyword {
  const char *name;
  enum status (*check)(struct walk *walk, const json_t *node, const json_t *rule,
                       const json_t *value);
};

/* Keywords about single values and about containers, in the order in which they are checked;
 * each table ends with a NULL name. A keyword without a function is read by another one. */
extern const struct schema_keyword schema_value_keywords[];
extern const struct schema_keyword schema_container_keywords[];

/* Whether the JSON type of `value` is the one that a `type` keyword names. */
bool schema_has_type(const json_t *value, const char *type);

/* Lists words as "a", "b" or "c" into `out`, as many as fit. Returns `out`. */
const char *schema_list_words(char *out, size_t size, const char *const *words, size_t count);

#endif
