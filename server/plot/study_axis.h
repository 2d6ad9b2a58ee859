/* Columns of a study as the axes of a plot. */
#ifndef PNEULAB_PLOT_STUDY_AXIS_H
#define PNEULAB_PLOT_STUDY_AXIS_H

#include "server/plot/study_plot.h"
#include "server/plot/ticks.h"

enum { STUDY_LABEL = 200, STUDY_VALUES = 64 };

/* A parameter or a metric. Positions on the axis are the values, or their decimal logarithms. */
struct study_axis {
  const struct study_table *table; /* NULL: no such axis */
  const struct study_column *column;
  bool metric;
  size_t index;
  bool logarithmic;
  double low, high; /* positions of the members that count; low > high: there are none */
  bool varies;
};

/* The column of a key among metrics and parameters. STATUS_NOT_FOUND, naming those there are. */
enum status study_axis_find(const struct study_table *table, const char *key,
                            struct study_axis *axis, struct error *error);

struct study_axis study_axis_metric(const struct study_table *table, size_t index);
struct study_axis study_axis_parameter(const struct study_table *table, size_t index);

/* The metric that is asked for, or the one that a reader most likely wants. STATUS_NOT_FOUND. */
enum status study_axis_choose_metric(const struct study_table *table, const char *key,
                                     struct study_axis *axis, struct error *error);

/* The parameter that is asked for, or the first that varies, is no `other` (may be NULL) and, if
 * `number`, is no word. STATUS_NOT_FOUND; without a key axis->table is NULL when there is none. */
enum status study_axis_choose_parameter(const struct study_table *table, const char *key,
                                        const struct study_axis *other, bool number,
                                        struct study_axis *axis, struct error *error);

/* Whether a row has succeeded. */
bool study_row_counts(const struct study_table *table, size_t row);
/* Whether a row has ended without success. */
bool study_row_failed(const struct study_table *table, size_t row);

/* Position of a row; NaN when it has none, and for metrics of rows that do not count. */
double study_axis_at(const struct study_axis *axis, size_t row);

/* The value at a position. */
double study_axis_value(const struct study_axis *axis, double position);

/* Position on the axis as a part of its range, 0 to 1; one half when nothing varies. */
double study_axis_part(const struct study_axis *axis, double position);

/* "Top wall (mm)" */
void study_axis_label(const struct study_axis *axis, char label[STUDY_LABEL]);

/* The value at a position as a text, "2.5 mm" with a unit. */
void study_axis_text(const struct study_axis *axis, double position, bool unit,
                     char text[STUDY_LABEL]);

/* Different positions of the rows in rising order, at most STUDY_VALUES; 0 when there are more. */
size_t study_axis_values(const struct study_axis *axis, double values[STUDY_VALUES]);

/* The index of a position among sorted values; `count` when it is none. */
size_t study_axis_place(const double *values, size_t count, double position);

#endif
