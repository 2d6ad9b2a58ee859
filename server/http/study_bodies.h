/* Bent centrelines of the members that the plot "shapes" of a study shows. */
#ifndef PNEULAB_HTTP_STUDY_BODIES_H
#define PNEULAB_HTTP_STUDY_BODIES_H

#include "server/plot/study_plot.h"

struct store;

struct study_bodies {
  struct study_shape *shape;
  size_t count;
};

/* Reads the last midline of each member that study_plot_cells names, x along and z across the body;
 * members without one are left out. The caller clears *bodies in either case. A study without two
 * parameters has none. STATUS_NOT_FOUND for a column that is none, STATUS_NO_MEMORY, STATUS_IO. */
enum status study_bodies_read(struct store *store, const struct study_table *table,
                              const struct study_plot_options *options, struct study_bodies *bodies,
                              struct error *error);
void study_bodies_clear(struct study_bodies *bodies);

#endif
