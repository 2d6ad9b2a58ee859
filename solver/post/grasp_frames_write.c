/* The files of a grasp, as grasp_frames.h describes them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/post/grasp_frames_internal.h"
#include "solver/post/packing.h"

static const struct {
  const char *name, *unit;
} fields_shown[FIELDS] = {{"contact_pressure", "kPa"}, {"stretch", ""}};

static const char *const moment_names[MOMENTS] = {"before", "inflated", "peak", "held"};

/* The frames that go into a file, and the limits of their numbers. */
struct choice {
  size_t frame[GRASP_FRAMES_MOST], count;
  struct packing_range range[CHANNELS], rest[PLACES];
};

static void choose(const struct grasp_frames *f, bool moments_only, struct choice *choice) {
  choice->count = 0;
  for (size_t i = 0; i < f->count; i++) {
    bool wanted = !moments_only;
    for (int m = 0; m < MOMENTS; m++) {
      wanted = wanted || f->moment[m] == (int)i;
    }
    if (wanted) {
      choice->frame[choice->count++] = i;
    }
  }
  for (int c = 0; c < CHANNELS; c++) {
    choice->range[c] = packing_range_empty();
    for (size_t k = 0; k < choice->count * f->bodies; k++) {
      size_t b = k % f->bodies;
      const float *row = grasp_frames_row(f, choice->frame[k / f->bodies], b, c);
      choice->range[c] = packing_range_with(choice->range[c], row, f->body[b].points);
    }
  }
  for (size_t i = 0; i < PLACES; i++) {
    choice->rest[i] = packing_range_empty();
    for (size_t b = 0; b < f->bodies; b++) {
      size_t points = f->body[b].points;
      choice->rest[i] = packing_range_with(choice->rest[i], f->body[b].rest + i * points, points);
    }
  }
}

/* ---- header ------------------------------------------------------------------------------ */

static json_t *frames_json(const struct grasp_frames *f, const struct choice *choice) {
  json_t *list = json_array();
  for (size_t s = 0; s < choice->count; s++) {
    json_t *frame = json_copy(f->frame[choice->frame[s]].head), *names = json_array();
    for (int m = 0; m < MOMENTS; m++) {
      if (f->moment[m] == (int)choice->frame[s]) {
        json_array_append_new(names, json_string(moment_names[m]));
      }
    }
    if (json_array_size(names) > 0) {
      json_object_set(frame, "moments", names);
    }
    json_decref(names);
    json_array_append_new(list, frame);
  }
  return list;
}

static json_t *limits_json(const struct packing_range range[PLACES], bool high) {
  json_t *list = json_array();
  for (int i = 0; i < PLACES; i++) {
    json_array_append_new(list, json_real(high ? range[i].high : range[i].low));
  }
  return list;
}

static json_t *header(const struct grasp_frames *f, const struct choice *choice) {
  json_t *fields = json_array(), *bodies = json_array();
  for (int c = 0; c < FIELDS; c++) {
    const struct packing_range *range = &choice->range[PLACES + c];
    json_array_append_new(fields,
                          json_pack("{s:s, s:s, s:f, s:f}", "name", fields_shown[c].name, "unit",
                                    fields_shown[c].unit, "low", range->low, "high", range->high));
  }
  for (size_t b = 0; b < f->bodies; b++) {
    json_array_append_new(bodies, json_pack("{s:I, s:i}", "points", (json_int_t)f->body[b].points,
                                            "quads", 4 * f->body[b].skin.face_count));
  }
  return json_pack("{s:o, s:o, s:O, s:o, s:o, s:o, s:o, s:o, s:{s:I, s:I}}", "frames",
                   frames_json(f, choice), "bodies", bodies, "fingers", f->fingers, "low_mm",
                   limits_json(choice->range, false), "high_mm", limits_json(choice->range, true),
                   "fields", fields, "rest_low_mm", limits_json(choice->rest, false),
                   "rest_high_mm", limits_json(choice->rest, true), "object", "points",
                   (json_int_t)f->object_points, "triangles", (json_int_t)f->object_triangles);
}

/* ---- stream ------------------------------------------------------------------------------ */

static size_t stream_size(const struct grasp_frames *f, const struct choice *choice) {
  size_t size = 12 * (f->object_points + f->object_triangles);
  for (size_t b = 0; b < f->bodies; b++) {
    size += 64 * (size_t)f->body[b].skin.face_count +
            2 * f->body[b].points * (CHANNELS * choice->count + PLACES);
  }
  return size;
}

static unsigned char *put_body(const struct grasp_frames *f, size_t b, const struct choice *choice,
                               unsigned char *to) {
  const struct body *body = &f->body[b];
  const size_t *frame = choice->frame;
  to = packing_quads(&body->skin, to);
  for (int c = 0; c < CHANNELS; c++) {
    for (size_t s = 0; s < choice->count; s++) {
      to = packing_row(grasp_frames_row(f, frame[s], b, c),
                       s > 0 ? grasp_frames_row(f, frame[s - 1], b, c) : NULL,
                       s > 1 ? grasp_frames_row(f, frame[s - 2], b, c) : NULL, body->points,
                       choice->range[c], to);
    }
  }
  for (size_t i = 0; i < PLACES; i++) {
    to = packing_row(body->rest + i * body->points, NULL, NULL, body->points, choice->rest[i], to);
  }
  return to;
}

static unsigned char *put_floats(const float *value, size_t count, unsigned char *to) {
  for (size_t i = 0; i < count; i++) {
    uint32_t bits;
    memcpy(&bits, &value[i], sizeof bits);
    for (size_t byte = 0; byte < sizeof bits; byte++) {
      *to++ = bits >> 8 * byte & 0xff;
    }
  }
  return to;
}

enum status grasp_frames_write(const struct grasp_frames *f, bool moments_only, FILE *file) {
  struct choice choice;
  if (f->count == 0 || f->bodies == 0) {
    return STATUS_INVALID;
  }
  choose(f, moments_only, &choice);
  size_t size = stream_size(f, &choice);
  unsigned char *stream = malloc(size + 1), *to = stream;
  if (!stream) {
    return STATUS_NO_MEMORY;
  }
  for (size_t b = 0; b < f->bodies; b++) {
    to = put_body(f, b, &choice, to);
  }
  to = put_floats(f->object, 3 * f->object_points, to);
  packing_numbers(f->triangle, 3 * f->object_triangles, to);
  enum status status = packing_write(file, header(f, &choice), stream, size);
  free(stream);
  return status;
}
