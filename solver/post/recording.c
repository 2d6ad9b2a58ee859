#include "solver/post/recording.h"

#include <jansson.h>
#include <stdlib.h>
#include "solver/post/packing.h"
#include "solver/post/stress.h"

/* Places in mm, then what the surface can be coloured by. */
enum { CHANNELS = 6, PLACES = 3 };

static const struct {
  const char *name, *unit;
} fields_shown[CHANNELS - PLACES] = {
    {"stretch", ""}, {"von_mises", "kPa"}, {"contact_pressure", "kPa"}};

struct recording {
  const struct mesh *mesh;
  struct skin skin;
  size_t state_count, room;
  float *value;     /* state_count x CHANNELS x points */
  double *pressure; /* state_count, kPa */
  struct packing_range range[CHANNELS];
};

enum status recording_create(const struct mesh *mesh, struct recording **out, struct error *error) {
  struct recording *r = calloc(1, sizeof *r);
  *out = NULL;
  if (!r) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the surface");
  }
  r->mesh = mesh;
  for (int c = 0; c < CHANNELS; c++) {
    r->range[c] = packing_range_empty();
  }
  enum status status = skin_create(mesh, false, &r->skin, error);
  if (status != STATUS_OK) {
    free(r);
    return status;
  }
  *out = r;
  return STATUS_OK;
}

void recording_destroy(struct recording *r) {
  if (r) {
    skin_release(&r->skin);
    free(r->value);
    free(r->pressure);
    free(r);
  }
}

/* Room for one state more. */
static enum status grow(struct recording *r) {
  if (r->state_count < r->room) {
    return STATUS_OK;
  }
  size_t room = 2 * r->room + 8, size = CHANNELS * (size_t)r->skin.point_count + 1;
  float *value = realloc(r->value, room * size * sizeof *value);
  r->value = value ? value : r->value;
  double *pressure = realloc(r->pressure, room * sizeof *pressure);
  r->pressure = pressure ? pressure : r->pressure;
  if (!value || !pressure) {
    return STATUS_NO_MEMORY;
  }
  r->room = room;
  return STATUS_OK;
}

static float *row_of(const struct recording *r, size_t state, int channel) {
  return r->value + (CHANNELS * state + (size_t)channel) * (size_t)r->skin.point_count;
}

enum status recording_add(struct recording *r, const struct fields *fields, double pressure) {
  if (grow(r) != STATUS_OK) {
    return STATUS_NO_MEMORY;
  }
  size_t state = r->state_count;
  r->pressure[r->state_count++] = pressure;
  for (int p = 0; p < r->skin.point_count; p++) {
    int node = r->skin.node[p];
    double at[CHANNELS] = {[PLACES] = fields->stretch[node],
                           1e-3 * stress_von_mises(fields->stress[node]),
                           1e-3 * fields->contact[node]};
    for (int i = 0; i < PLACES; i++) {
      at[i] = 1e3 * (r->mesh->x[3 * node + i] + fields->u[3 * node + i]);
    }
    at[1] = r->skin.mirrored[p] ? -at[1] : at[1];
    for (int c = 0; c < CHANNELS; c++) {
      row_of(r, state, c)[p] = (float)at[c];
    }
  }
  for (int c = 0; c < CHANNELS; c++) {
    r->range[c] = packing_range_with(r->range[c], row_of(r, state, c), (size_t)r->skin.point_count);
  }
  return STATUS_OK;
}

/* ---- writing ----------------------------------------------------------------------------- */

static json_t *header(const struct recording *r) {
  const struct packing_range *range = r->range;
  json_t *fields = json_array(), *pressures = json_array();
  for (size_t s = 0; s < r->state_count; s++) {
    json_array_append_new(pressures, json_real(r->pressure[s]));
  }
  for (int c = PLACES; c < CHANNELS; c++) {
    json_array_append_new(fields,
                          json_pack("{s:s, s:s, s:f, s:f}", "name", fields_shown[c - PLACES].name,
                                    "unit", fields_shown[c - PLACES].unit, "low", range[c].low,
                                    "high", range[c].high));
  }
  return json_pack("{s:i, s:i, s:o, s:[fff], s:[fff], s:o}", "points", r->skin.point_count, "quads",
                   4 * r->skin.face_count, "pressures_kPa", pressures, "low_mm", range[0].low,
                   range[1].low, range[2].low, "high_mm", range[0].high, range[1].high,
                   range[2].high, "fields", fields);
}

enum status recording_write(const struct recording *r, FILE *file) {
  size_t points = (size_t)r->skin.point_count, faces = (size_t)r->skin.face_count;
  size_t size = 64 * faces + 2 * CHANNELS * r->state_count * points;
  unsigned char *stream = malloc(size + 1);
  if (!stream) {
    return STATUS_NO_MEMORY;
  }
  unsigned char *to = packing_quads(&r->skin, stream);
  for (int c = 0; c < CHANNELS; c++) {
    for (size_t s = 0; s < r->state_count; s++) {
      to = packing_row(row_of(r, s, c), s > 0 ? row_of(r, s - 1, c) : NULL,
                       s > 1 ? row_of(r, s - 2, c) : NULL, points, r->range[c], to);
    }
  }
  enum status status = packing_write(file, header(r), stream, size);
  free(stream);
  return status;
}
