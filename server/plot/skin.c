#include "server/plot/skin.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "server/plot/artifact.h"
#include "server/plot/data.h"
#include "solver/job/json.h"

static enum status damaged(struct error *error, const char *what) {
  return error_set(error, STATUS_SYNTAX, NULL, "surface.json is damaged: %s", what);
}

static enum status no_memory(struct error *error) {
  return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for surface.json");
}

static enum status load(const char *directory, json_t **root, struct error *error) {
  json_error_t problem;
  char *text;
  size_t size;
  enum status status =
      artifact_read(directory, "surface.json", "the deformed body", &text, &size, error);
  if (status != STATUS_OK) {
    return status;
  }
  *root = json_read(text, size, JSON_REJECT_DUPLICATES, &problem);
  bool starved = !*root && errno == ENOMEM;
  free(text);
  if (*root) {
    return STATUS_OK;
  }
  return starved ? no_memory(error) : damaged(error, problem.text);
}

static enum status read_quads(const json_t *list, struct skin *skin, struct error *error) {
  skin->quad_count = json_array_size(list);
  if (skin->quad_count == 0) {
    return damaged(error, "it has no quads");
  }
  skin->quads = malloc(skin->quad_count * sizeof *skin->quads);
  if (!skin->quads) {
    return no_memory(error);
  }
  for (size_t i = 0; i < skin->quad_count; i++) {
    const json_t *quad = json_array_get(list, i);
    if (json_array_size(quad) != 4) {
      return damaged(error, "a quad does not have four corners");
    }
    for (size_t k = 0; k < 4; k++) {
      const json_t *corner = json_array_get(quad, k);
      json_int_t index = json_is_integer(corner) ? json_integer_value(corner) : -1;
      if (index < 0 || (size_t)index >= skin->point_count) {
        return damaged(error, "a quad names a point that does not exist");
      }
      skin->quads[i][k] = (size_t)index;
    }
  }
  return STATUS_OK;
}

static enum status read_points(const json_t *state, struct skin *skin, struct skin_point **points,
                               struct error *error) {
  const json_t *list = json_object_get(state, "points_mm");
  if (json_array_size(list) != skin->point_count) {
    return damaged(error, "its states do not have the same points");
  }
  *points = malloc(skin->point_count * sizeof **points);
  if (!*points) {
    return no_memory(error);
  }
  for (size_t i = 0; i < skin->point_count; i++) {
    const json_t *p = json_array_get(list, i);
    struct skin_point at = {data_element(p, 0), data_element(p, 1), data_element(p, 2)};
    if (!isfinite(at.x) || !isfinite(at.y) || !isfinite(at.z)) {
      return damaged(error, "a point is not three finite numbers");
    }
    (*points)[i] = at;
  }
  return STATUS_OK;
}

/* The colours are dropped as a whole when one of them is missing. */
static enum status read_stretch(const json_t *state, struct skin *skin, struct error *error) {
  const json_t *list = json_object_get(state, "stretch");
  if (json_array_size(list) != skin->point_count) {
    return STATUS_OK;
  }
  skin->stretch = malloc(skin->point_count * sizeof *skin->stretch);
  if (!skin->stretch) {
    return no_memory(error);
  }
  for (size_t i = 0; i < skin->point_count; i++) {
    skin->stretch[i] = data_element(list, i);
    if (!isfinite(skin->stretch[i])) {
      free(skin->stretch);
      skin->stretch = NULL;
      break;
    }
  }
  return STATUS_OK;
}

enum status plot_skin_read(const char *directory, struct skin *skin, struct error *error) {
  json_t *root = NULL;
  *skin = (struct skin){0};
  enum status status = load(directory, &root, error);
  if (status != STATUS_OK) {
    goto done;
  }
  const json_t *states = json_object_get(root, "states");
  size_t count = json_array_size(states);
  if (count == 0) {
    status = damaged(error, "it has no states");
    goto done;
  }
  const json_t *first = json_array_get(states, 0), *last = json_array_get(states, count - 1);
  skin->point_count = json_array_size(json_object_get(last, "points_mm"));
  skin->rest_kPa = data_number(first, "pressure_kPa");
  skin->bent_kPa = data_number(last, "pressure_kPa");
  status = read_quads(json_object_get(root, "quads"), skin, error);
  if (status == STATUS_OK) {
    status = read_points(first, skin, &skin->rest, error);
  }
  if (status == STATUS_OK) {
    status = read_points(last, skin, &skin->bent, error);
  }
  if (status == STATUS_OK) {
    status = read_stretch(last, skin, error);
  }
done:
  json_decref(root);
  return status;
}

void plot_skin_release(struct skin *skin) {
  free(skin->quads);
  free(skin->rest);
  free(skin->bent);
  free(skin->stretch);
  *skin = (struct skin){0};
}
