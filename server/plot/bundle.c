#include "server/plot/bundle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void series_free(struct chart_series *series) {
  free((struct point *)series->points);
  free((double *)series->errors);
  free((double *)series->band);
}

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

/* A copy of `size` bytes, NULL of nothing; *good becomes false when memory ran out. */
static void *copy_of(const void *from, size_t size, bool *good) {
  void *copy = from ? malloc(size + 1) : NULL;
  if (copy) {
    memcpy(copy, from, size);
  }
  *good = *good && (copy || !from);
  return copy;
}

enum status bundle_add(struct bundle *bundle, struct chart_series like, const struct point *points,
                       size_t count, struct error *error) {
  static const struct point none;
  bool good = grow(bundle);
  like.points = copy_of(points ? points : &none, count * sizeof *points, &good);
  like.errors = copy_of(like.errors, count * sizeof *like.errors, &good);
  like.band = copy_of(like.band, count * sizeof *like.band, &good);
  like.count = count;
  if (!good) {
    series_free(&like);
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu points of a curve",
                     count);
  }
  bundle->series[bundle->count++] = like;
  return STATUS_OK;
}

enum status bundle_add_zero(struct bundle *bundle, struct error *error) {
  struct chart_series like = {.guide = true, .colour = {.role = COLOUR_EDGE}, .width = 1.0};
  double reach = 0;
  for (size_t s = 0; s < bundle->count; s++) {
    for (size_t i = 0; i < bundle->series[s].count; i++) {
      reach = fmax(reach, fabs(bundle->series[s].points[i].x));
    }
  }
  reach = 20 * (reach > 0 ? reach : 1);
  const struct point ends[2] = {{-reach, 0}, {reach, 0}};
  return bundle_add(bundle, like, ends, 2, error);
}

void bundle_release(struct bundle *bundle) {
  for (size_t i = 0; i < bundle->count; i++) {
    series_free(&bundle->series[i]);
  }
  free(bundle->series);
  *bundle = (struct bundle){.series = NULL};
}
