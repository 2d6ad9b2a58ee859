#include "server/plot/bundle.h"

#include <stdlib.h>
#include <string.h>

/* Makes room for one more series; false when memory ran out. */
static bool grow(struct bundle *bundle) {
  if (bundle->count < bundle->room) {
    return true;
  }
  size_t room = bundle->room ? 2 * bundle->room : 16;
  struct chart_series *grown = realloc(bundle->series, room * sizeof *grown);
  if (grown) {
    bundle->series = grown;
    bundle->room = room;
  }
  return grown != NULL;
}

enum status bundle_add(struct bundle *bundle, struct chart_series like, const struct point *points,
                       size_t count, struct error *error) {
  struct point *copy = malloc((count + 1) * sizeof *copy);
  if (!copy || !grow(bundle)) {
    free(copy);
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu points of a curve",
                     count);
  }
  if (count > 0) {
    memcpy(copy, points, count * sizeof *copy);
  }
  like.points = copy;
  like.count = count;
  bundle->series[bundle->count++] = like;
  return STATUS_OK;
}

void bundle_release(struct bundle *bundle) {
  for (size_t i = 0; i < bundle->count; i++) {
    free((struct point *)bundle->series[i].points);
  }
  free(bundle->series);
  *bundle = (struct bundle){.series = NULL};
}
