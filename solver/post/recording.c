#include "solver/post/recording.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>
#include "solver/post/skin.h"
#include "solver/post/stress.h"

/* Places in mm, then what the surface can be coloured by. */
enum { CHANNELS = 6, PLACES = 3, LEVELS = 65535 };

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
  double low[CHANNELS], high[CHANNELS];
};

enum status recording_create(const struct mesh *mesh, struct recording **out, struct error *error) {
  struct recording *r = calloc(1, sizeof *r);
  *out = NULL;
  if (!r) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the surface");
  }
  r->mesh = mesh;
  for (int c = 0; c < CHANNELS; c++) {
    r->low[c] = INFINITY;
    r->high[c] = -INFINITY;
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
      r->low[c] = fmin(r->low[c], row_of(r, state, c)[p]);
      r->high[c] = fmax(r->high[c], row_of(r, state, c)[p]);
    }
  }
  return STATUS_OK;
}

/* ---- writing ----------------------------------------------------------------------------- */

static unsigned quantised(const struct recording *r, size_t state, int channel, int point) {
  double span = r->high[channel] - r->low[channel];
  double t = span > 0 ? (row_of(r, state, channel)[point] - r->low[channel]) / span : 0;
  return (unsigned)lround(LEVELS * fmin(fmax(t, 0), 1));
}

/* What a reader expects who knows all that comes before. */
static unsigned expected(const struct recording *r, size_t state, int channel, int point) {
  if (state == 0) {
    return point > 0 ? quantised(r, 0, channel, point - 1) : 0;
  }
  unsigned before = quantised(r, state - 1, channel, point);
  return state == 1 ? before : 2 * before - quantised(r, state - 2, channel, point);
}

static unsigned char *put_row(const struct recording *r, size_t state, int channel,
                              unsigned char *to) {
  int count = r->skin.point_count;
  for (int p = 0; p < count; p++) {
    unsigned difference = quantised(r, state, channel, p) - expected(r, state, channel, p);
    to[p] = difference & 0xff;
    to[count + p] = difference >> 8 & 0xff;
  }
  return to + 2 * (size_t)count;
}

static unsigned char *put_quads(const struct recording *r, unsigned char *to) {
  size_t count = 16 * (size_t)r->skin.face_count, k = 0;
  uint32_t last = 0;
  for (int f = 0; f < r->skin.face_count; f++) {
    int quads[4][4];
    skin_face_quads(&r->skin, f, quads);
    for (int n = 0; n < 16; n++, k++) {
      uint32_t corner = (uint32_t)quads[n / 4][n % 4], difference = corner - last;
      for (size_t byte = 0; byte < 4; byte++) {
        to[byte * count + k] = difference >> 8 * byte & 0xff;
      }
      last = corner;
    }
  }
  return to + 4 * count;
}

static json_t *header(const struct recording *r) {
  json_t *fields = json_array(), *pressures = json_array();
  for (size_t s = 0; s < r->state_count; s++) {
    json_array_append_new(pressures, json_real(r->pressure[s]));
  }
  for (int c = PLACES; c < CHANNELS; c++) {
    json_array_append_new(
        fields, json_pack("{s:s, s:s, s:f, s:f}", "name", fields_shown[c - PLACES].name, "unit",
                          fields_shown[c - PLACES].unit, "low", r->low[c], "high", r->high[c]));
  }
  return json_pack("{s:i, s:i, s:o, s:[fff], s:[fff], s:o}", "points", r->skin.point_count, "quads",
                   4 * r->skin.face_count, "pressures_kPa", pressures, "low_mm", r->low[0],
                   r->low[1], r->low[2], "high_mm", r->high[0], r->high[1], r->high[2], "fields",
                   fields);
}

static void write_packed(FILE *file, const char *text, const unsigned char *packed, size_t size) {
  size_t length = strlen(text);
  unsigned char bytes[4];
  for (size_t i = 0; i < sizeof bytes; i++) {
    bytes[i] = (unsigned char)(length >> 8 * i & 0xff);
  }
  fwrite("PNLSURF1", 1, 8, file);
  fwrite(bytes, 1, sizeof bytes, file);
  fwrite(text, 1, length, file);
  fwrite(packed, 1, size, file);
}

enum status recording_write(const struct recording *r, FILE *file) {
  size_t points = (size_t)r->skin.point_count, faces = (size_t)r->skin.face_count;
  size_t size = 64 * faces + 2 * CHANNELS * r->state_count * points;
  uLongf packed_size = compressBound((uLong)size);
  json_t *head = header(r);
  char *text = head ? json_dumps(head, JSON_COMPACT | JSON_REAL_PRECISION(7)) : NULL;
  unsigned char *plain = malloc(size + 1), *packed = malloc(packed_size);
  enum status status = text && plain && packed ? STATUS_OK : STATUS_NO_MEMORY;
  if (status == STATUS_OK) {
    unsigned char *to = put_quads(r, plain);
    for (int c = 0; c < CHANNELS; c++) {
      for (size_t s = 0; s < r->state_count; s++) {
        to = put_row(r, s, c, to);
      }
    }
    status = compress2(packed, &packed_size, plain, (uLong)size, 4) == Z_OK ? STATUS_OK
                                                                            : STATUS_NO_MEMORY;
  }
  if (status == STATUS_OK) {
    write_packed(file, text, packed, packed_size);
  }
  json_decref(head);
  free(text);
  free(plain);
  free(packed);
  return status;
}
