/* The columns that a plot of many of them shows. */
#ifndef PNEULAB_PLOT_STUDY_COLUMNS_H
#define PNEULAB_PLOT_STUDY_COLUMNS_H

#include "server/plot/study_axis.h"

/* Fills axes[most] with the columns whose keys `keys` lists, separated by commas, or else with the
 * parameters that vary, then `metric` (may be NULL or empty) and further metrics that vary, up to
 * three in all. STATUS_NOT_FOUND for a key that is none. Of too many the last ones are left out. */
enum status study_columns(const struct study_table *table, const char *keys,
                          const struct study_axis *metric, size_t most, struct study_axis *axes,
                          size_t *count, struct error *error);

#endif
