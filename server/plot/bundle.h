/* Curves of a chart that own their points, as many as a document has. */
#ifndef PNEULAB_PLOT_BUNDLE_H
#define PNEULAB_PLOT_BUNDLE_H

#include "server/plot/chart.h"
#include "solver/base/error.h"

/* Start from a zeroed one. */
struct bundle {
  struct chart_series *series;
  size_t count, room;
};

/* Adds a series like `like` with a copy of `count` points. STATUS_NO_MEMORY. */
enum status bundle_add(struct bundle *bundle, struct chart_series like, const struct point *points,
                       size_t count, struct error *error);
void bundle_release(struct bundle *bundle);

#endif
