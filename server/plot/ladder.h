/* The states of a hybrid model at the ends of its held set-points. */
#ifndef PNEULAB_PLOT_LADDER_H
#define PNEULAB_PLOT_LADDER_H

#include <jansson.h>
#include <stdbool.h>
#include "server/plot/chart.h"
#include "solver/base/error.h"

enum { LADDER_RUNS = 60 };

/* Set-points in kPa with the states at their ends, and the runs in which these only rise or fall.
 */
struct ladder {
  struct point *points;
  size_t count;
  struct ladder_run {
    size_t first, last; /* neighbouring runs share a point */
    bool falling;
  } run[LADDER_RUNS];
  size_t run_count;
};

/* Reads the number at `key` of every hold of a result. The caller releases *ladder in any case.
 * STATUS_NO_MEMORY. */
enum status ladder_read(const json_t *result, const char *key, struct ladder *ladder,
                        struct error *error);
void ladder_release(struct ladder *ladder);

#endif
