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

/* Adds a series like `like` with copies of `count` points and of its errors and band, if it has
 * any. STATUS_NO_MEMORY. */
enum status bundle_add(struct bundle *bundle, struct chart_series like, const struct point *points,
                       size_t count, struct error *error);
/* Adds a thin level line at zero behind what the bundle has, wide enough to cross every axis that
 * shows it. STATUS_NO_MEMORY. */
enum status bundle_add_zero(struct bundle *bundle, struct error *error);

void bundle_release(struct bundle *bundle);

#endif
