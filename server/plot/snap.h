/* Equilibrium paths of bistable actuators for their plots. */
#ifndef PNEULAB_PLOT_SNAP_H
#define PNEULAB_PLOT_SNAP_H

#include <jansson.h>
#include <stdbool.h>
#include "server/plot/bundle.h"

/* Under which load a path was followed. */
enum snap_load { SNAP_PRESSURE, SNAP_FORCE };

/* How a path is drawn: `key` of its points over another one, in a colour of its own; stable
 * stretches are solid lines, the others dashed. names: of both in the legend, NULL for none. */
struct snap_look {
  const char *x_key, *y_key;
  struct colour colour;
  const char *stable_name, *unstable_name;
  double width; /* of the solid lines, design units */
};

/* The load of a path: its pressure unless that stays what it was, within a thousandth of a kPa. */
enum snap_load snap_load_of(const json_t *path);

/* The path called `name`, or NULL. */
const json_t *snap_path(const json_t *result, const char *name);

/* Adds the stretches of a path. The first of either kind takes the name, until *named says that it
 * is taken. STATUS_NO_MEMORY. */
enum status snap_add_path(struct bundle *bundle, const json_t *path, const struct snap_look *look,
                          bool named[2], struct error *error);

#endif
