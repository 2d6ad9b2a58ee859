/* What an analysis of a study is asked for, as texts of a query say it:
 * "max:bending_angle_deg:0.4", "bending_angle_deg>=60". */
#ifndef PNEULAB_STUDY_CRITERIA_H
#define PNEULAB_STUDY_CRITERIA_H

#include "server/study/table.h"

enum { CRITERIA_MAX = 10, CONDITIONS_MAX = 8 };

/* A metric and which way is better. */
struct criterion {
  size_t metric; /* column of the table */
  bool maximise;
  double number; /* its weight, or the reference; NaN when the text has none */
};

/* A column of the table: a parameter or a metric. */
struct quantity_of {
  bool parameter;
  size_t column;
};

/* A limit on a number, in the unit in which it is shown. */
struct condition {
  struct quantity_of of;
  bool at_least; /* else at most */
  double limit;
};

/* The column of the metric `key`. STATUS_INVALID, naming metrics that there are. NULL asks for the
 * error that says so. */
enum status criteria_metric(const struct study_table *table, const char *key, size_t *column,
                            struct error *error);

/* The same for a parameter by its pointer. */
enum status criteria_parameter(const struct study_table *table, const char *key, size_t *column,
                               struct error *error);

/* A metric by its name, or a parameter that has numbers by its pointer. */
enum status criteria_quantity(const struct study_table *table, const char *key,
                              struct quantity_of *of, struct error *error);

/* "max:KEY[:NUMBER],min:KEY[:NUMBER],...": 1 to CRITERIA_MAX different metrics. STATUS_INVALID. */
enum status criteria_read(const struct study_table *table, const char *text,
                          struct criterion criteria[CRITERIA_MAX], size_t *count,
                          struct error *error);

/* "KEY>=NUMBER,KEY<=NUMBER,...": up to CONDITIONS_MAX; NULL and "" are none. STATUS_INVALID. */
enum status conditions_read(const struct study_table *table, const char *text,
                            struct condition conditions[CONDITIONS_MAX], size_t *count,
                            struct error *error);

/* The number of a row; NaN when it has none, and of a metric also when the member has not
 * succeeded. */
double quantity_value(const struct study_table *table, struct quantity_of of, size_t row);

/* The column itself. */
const struct study_column *quantity_column(const struct study_table *table, struct quantity_of of);

/* Whether a member counts in an analysis: it has succeeded. */
bool row_counts(const struct study_table *table, size_t row);

#endif
