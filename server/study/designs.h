/* The members of a study as JSON: columns for programs, rows for people. */
#ifndef PNEULAB_STUDY_DESIGNS_H
#define PNEULAB_STUDY_DESIGNS_H

#include <jansson.h>

#include "server/study/table.h"

/* All of the table as text, column by column: "columns", "members", "jobs", "states", "reasons",
 * "names" and "values", of which each has one array a column; null where there is no value, of a
 * categorical column the index of the word. malloc'd, NULL without memory. */
char *designs_columns(const struct study_table *table, size_t *size);

/* A column as an object, a new reference. role: "parameter" or "metric". */
json_t *designs_column(const struct study_column *column, const char *role);

/* What rows can be sorted by: "member", "name", "state" or the key of a column; with a minus in
 * front the largest first. Rows without a value come last. False when the table has no such key. */
struct designs_order {
  enum { ORDER_MEMBER, ORDER_NAME, ORDER_STATE, ORDER_PARAMETER, ORDER_METRIC } by;
  size_t column;
  bool descending;
};
bool designs_order(const struct study_table *table, const char *key, struct designs_order *order);

/* Up to `count` rows from place `from` of the order on, as an array of objects; a new reference,
 * NULL without memory. */
json_t *designs_rows(const struct study_table *table, const struct designs_order *order,
                     size_t from, size_t count);

#endif
