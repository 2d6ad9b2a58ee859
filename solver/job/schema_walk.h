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
  const json_t *node;          /* of the schema, for the value in hand, before its $ref */
  struct error *error;         /* NULL: only the verdict is wanted */
};

/* Checks `value` against one node of the schema and all below. */
enum status schema_check_node(struct walk *walk, const json_t *node, const json_t *value);

/* The node that `node` stands for once its $ref is followed. */
const json_t *schema_resolve(const struct schema *schema, const json_t *node);

/* What a keyword says of a node, or of the one that it stands for; NULL when neither has it. */
const json_t *schema_rule(const struct schema *schema, const json_t *node, const char *keyword);

/* The branch of the oneOf array `branches` that `value` is meant to follow, or NULL when it can
 * be none; then *walk's error is filled unless it is NULL. */
const json_t *schema_choose_branch(struct walk *walk, const json_t *branches, const json_t *value);

/* ---- schema_describe.c: what is said about values and nodes -------------------------------- */

enum { SCHEMA_PHRASE = 80, SCHEMA_ALLOWED = 400 };

/* What is wrong with a value. Parts that are left out follow from the node in hand. */
struct refusal {
  const char *found;   /* "the number 5" */
  const char *problem; /* "has no unit", after what was found; "" when that says it */
  const char *verb;    /* before what is allowed: "it must be" */
  const char *allowed;
  const char *nearest; /* known word that may have been meant, or NULL */
  json_t *example;     /* taken over */
};

/* Fills the error of *walk at its pointer: "found problem (did you mean nearest?): verb allowed;
 * for example example". Returns STATUS_INVALID, or STATUS_NO_MEMORY. */
enum status schema_refuse(struct walk *walk, const struct refusal *refusal);

/* Writes "the number 5", "an array of 3 items", ... into `out` of SCHEMA_PHRASE bytes; returns it.
 */
const char *schema_value_phrase(char *out, const json_t *value);

/* Writes what a node takes, "a whole number from 1 to 64", into `out` of SCHEMA_ALLOWED bytes, cut
 * where it does not fit; returns `out`. */
const char *schema_describe(const struct schema *schema, const json_t *node, char *out);

/* A value that follows the node: its example, or one made for it. A new reference, NULL without
 * memory. */
json_t *schema_example(const struct schema *schema, const json_t *node);

/* Lists words as "a", "b" or "c" into `out`, as many as fit. Returns `out`. */
const char *schema_list_words(char *out, size_t size, const char *const *words, size_t count);

/* ---- keywords ------------------------------------------------------------------------------ */

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

#endif
