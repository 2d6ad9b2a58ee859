#include "server/plot/snap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/data.h"

enum snap_load snap_load_of(const json_t *path) {
  const json_t *points = json_object_get(path, "points");
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < json_array_size(points); i++) {
    double pressure = data_number(json_array_get(points, i), "pressure_kPa");
    low = fmin(low, pressure);
    high = fmax(high, pressure);
  }
  return high - low > 1e-3 ? SNAP_PRESSURE : SNAP_FORCE;
}

const json_t *snap_path(const json_t *result, const char *name) {
  size_t index;
  const json_t *path;
  json_array_foreach(json_object_get(result, "paths"), index, path) {
    const char *its = json_string_value(json_object_get(path, "name"));
    if (name && its && strcmp(its, name) == 0) {
      return path;
    }
  }
  return NULL;
}

/* Adds the points of one stretch. */
static enum status add_stretch(struct bundle *bundle, const struct point *points, size_t count,
                               bool stable, const struct snap_look *look, bool named[2],
                               struct error *error) {
  const char *name = stable ? look->stable_name : look->unstable_name;
  struct chart_series like = {.colour = look->colour,
                              .width = stable ? look->width : 1.5,
                              .dash = stable ? DASH_SOLID : DASH_SHORT,
                              .name = named[stable] ? NULL : name};
  if (count < 2) {
    return STATUS_OK;
  }
  named[stable] = true;
  return bundle_add(bundle, like, points, count, error);
}

enum status snap_add_path(struct bundle *bundle, const json_t *path, const struct snap_look *look,
                          bool named[2], struct error *error) {
  const json_t *list = json_object_get(path, "points");
  enum status status = STATUS_OK;
  struct point *points = malloc((json_array_size(list) + 1) * sizeof *points);
  size_t count = 0, index;
  const json_t *entry;
  bool stable = true;
  if (!points) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a path");
  }
  json_array_foreach(list, index, entry) {
    struct point p = {data_number(entry, look->x_key), data_number(entry, look->y_key)};
    bool now = json_is_true(json_object_get(entry, "stable"));
    if (!isfinite(p.x) || !isfinite(p.y) || status != STATUS_OK) {
      continue;
    }
    if (count > 0 && now != stable) {
      /* The limit point lies between the two: the stretch that is stable ends at its last state. */
      struct point last = points[count - 1];
      if (stable) {
        status = add_stretch(bundle, points, count, true, look, named, error);
        points[0] = last;
        count = 1;
      } else {
        points[count++] = p;
        status = add_stretch(bundle, points, count, false, look, named, error);
        count = 0;
      }
    }
    points[count++] = p;
    stable = now;
  }
  if (status == STATUS_OK) {
    status = add_stretch(bundle, points, count, stable, look, named, error);
  }
  free(points);
  return status;
}
