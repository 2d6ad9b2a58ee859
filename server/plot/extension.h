/* Extension and force of several bistable actuators against pressure. */
#ifndef PNEULAB_PLOT_EXTENSION_H
#define PNEULAB_PLOT_EXTENSION_H

#include <jansson.h>
#include <stdbool.h>
#include "server/plot/canvas.h"

/* One actuator: the result of a job, or a member of a study. */
struct extension_source {
  const json_t *result;
  const char *name;
};

struct extension_heading {
  const char *subtitle, *notice;
};

/* Whether a result has what can be drawn: held set-points of a hybrid model, or paths under
 * pressure. */
bool extension_is_of(const json_t *result);

/* Draws the extension ratio (the elongation in mm when some actuator has no ratio), and below it
 * the force at the natural length when any has one. STATUS_NO_MEMORY. */
enum status extension_draw(struct canvas *canvas, const struct extension_source *sources,
                           size_t count, const struct extension_heading *heading,
                           struct error *error);

#endif
