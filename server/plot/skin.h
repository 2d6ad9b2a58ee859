/* The boundary of a body in several states, as the solver leaves it in surface.json. */
#ifndef PNEULAB_PLOT_SKIN_H
#define PNEULAB_PLOT_SKIN_H

#include <stddef.h>
#include "solver/base/error.h"

struct skin_point {
  double x, y, z; /* mm */
};

/* Two states of one skin: the first and the last recorded one (the same when there is one). */
struct skin {
  size_t point_count, quad_count;
  size_t (*quads)[4];        /* corners in turn; every index is below point_count */
  struct skin_point *rest;   /* first state; finite */
  struct skin_point *bent;   /* last state; finite */
  double *stretch;           /* largest principal stretch at every point of the last state, or NULL
                                when the file has none; finite */
  double rest_kPa, bent_kPa; /* NaN when not given */
};

/* Reads `directory`/surface.json into *skin, which plot_skin_release frees in any case.
 * Errors: STATUS_NOT_FOUND (no such file), STATUS_SYNTAX (damaged, with what is wrong),
 * STATUS_TOO_LARGE (above 64 MiB), STATUS_NO_MEMORY. */
enum status plot_skin_read(const char *directory, struct skin *skin, struct error *error);
void plot_skin_release(struct skin *skin);

#endif
