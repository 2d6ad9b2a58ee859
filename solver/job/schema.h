/* Checks documents against a JSON Schema (2020-12): the subset that the job schema uses.
 *
 * Keywords with effect: $ref (to #/$defs), oneOf, type, const, enum, properties, required,
 * additionalProperties, propertyNames, maxProperties, items, minItems, maxItems, minimum, maximum,
 * exclusiveMinimum, exclusiveMaximum, minLength, maxLength, default; and for quantities
 *   "x-unit": "mm"                      a string that units_read accepts for this unit
 *   "x-minimum", "x-maximum", "x-exclusiveMinimum": "0 mm"      its range
 * The branches of a oneOf must differ in type, or be objects that differ in a property with
 * `const`: the branch is chosen by it, so that an error speaks of the one form that was meant. */
#ifndef PNEULAB_JOB_SCHEMA_H
#define PNEULAB_JOB_SCHEMA_H

#include <jansson.h>
#include "solver/base/error.h"
#include "solver/base/units.h"

struct schema;

/* Compiles the schema in `text` into *schema, owned by the caller; `units` must outlive it.
 * STATUS_SYNTAX or STATUS_INTERNAL for text that is no schema of the subset. */
enum status schema_create(const char *text, size_t size, const struct units *units,
                          struct schema **schema, struct error *error);
void schema_destroy(struct schema *schema);

/* STATUS_OK, or STATUS_INVALID with the pointer to the first place that breaks a rule, or
 * STATUS_NO_MEMORY. First is: at a value its own keywords, the choice of a branch, maxProperties,
 * members without a name in the schema, in the order of the document, their names, missing keys,
 * minItems and maxItems, then the named members in the order of the schema, and the items; all of
 * one before the next. The error says what was found, what is allowed, the known word nearest to
 * it, and an example from the schema. */
enum status schema_check(const struct schema *schema, const json_t *value, struct error *error);

/* Adds every absent property that has a `default` to a document that schema_check has accepted.
 * STATUS_OK or STATUS_NO_MEMORY. */
enum status schema_fill(const struct schema *schema, json_t *value, struct error *error);

/* The schema of job documents, as text (with its terminating NUL, not counted in *size). */
const char *job_schema_text(size_t *size);

#endif
