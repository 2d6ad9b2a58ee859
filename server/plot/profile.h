/* Force profiles of several grasps in one chart. */
#ifndef PNEULAB_PLOT_PROFILE_H
#define PNEULAB_PLOT_PROFILE_H

#include <jansson.h>
#include "server/plot/canvas.h"

/* One grasp: the result of a job, or a member of a study. */
struct profile_source {
  const json_t *result;
  const char *name;
};

struct profile_heading {
  const char *subtitle, *notice;
};

/* Draws the grasp force over the displacement of those that pull, with peak and mean in the legend;
 * when none does, over the pressure. STATUS_NO_MEMORY. */
enum status profile_draw(struct canvas *canvas, const struct profile_source *sources, size_t count,
                         const struct profile_heading *heading, struct error *error);

#endif
