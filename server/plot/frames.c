#include "server/plot/frames.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "server/plot/artifact.h"
#include "server/plot/data.h"
#include "solver/job/json.h"

/* No picture shows more; with these limits no product of sizes overflows. */
enum {
  POINTS_MOST = 1 << 20,
  BODIES_MOST = 16,
  SHOTS_MOST = 64,
  FIELDS_MOST = 16,
  STREAM_MOST = 256 << 20,
  MARK = 8
};

/* The unpacked stream and how far it has been read. */
struct stream {
  unsigned char *bytes;
  size_t size, at;
};

static enum status damaged(struct error *error, const char *what) {
  return error_set(error, STATUS_SYNTAX, NULL, "moments.bin is damaged: %s", what);
}

static enum status no_memory(struct error *error) {
  return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for moments.bin");
}

/* ---- header ------------------------------------------------------------------------------ */

static bool read_count(const json_t *object, const char *key, size_t most, size_t *count) {
  const json_t *value = json_object_get(object, key);
  json_int_t number = json_is_integer(value) ? json_integer_value(value) : -1;
  *count = number > 0 ? (size_t)number : 0;
  return number >= 0 && (size_t)number <= most;
}

static bool read_pose(const json_t *list, struct frames_pose *pose) {
  bool fine = json_array_size(list) == 12;
  for (size_t i = 0; i < 12; i++) {
    double value = data_element(list, i);
    fine = fine && isfinite(value);
    *(i < 9 ? &pose->rotation[i] : &pose->place[i - 9]) = value;
  }
  return fine;
}

static enum status read_bodies(struct frames *f, struct error *error) {
  const json_t *list = json_object_get(f->head, "bodies");
  f->bodies = calloc(f->body_count, sizeof *f->bodies);
  if (!f->bodies) {
    return no_memory(error);
  }
  for (size_t b = 0; b < f->body_count; b++) {
    const json_t *entry = json_array_get(list, b);
    struct frames_body *body = &f->bodies[b];
    if (!read_count(entry, "points", POINTS_MOST, &body->point_count) ||
        !read_count(entry, "quads", POINTS_MOST, &body->quad_count) || body->quad_count == 0) {
      return damaged(error, "a body has no size, or an impossible one");
    }
    body->first = f->point_count;
    f->point_count += body->point_count;
    body->rest = malloc((body->point_count + 1) * sizeof *body->rest);
    if (!body->rest) {
      return no_memory(error);
    }
  }
  return STATUS_OK;
}

static enum status read_sizes(struct frames *f, struct error *error) {
  const json_t *object = json_object_get(f->head, "object");
  f->body_count = json_array_size(json_object_get(f->head, "bodies"));
  f->shot_count = json_array_size(json_object_get(f->head, "frames"));
  f->finger_count = json_array_size(json_object_get(f->head, "fingers"));
  if (!read_count(object, "points", POINTS_MOST, &f->object_point_count) ||
      !read_count(object, "triangles", POINTS_MOST, &f->object_quad_count) ||
      f->body_count > BODIES_MOST || f->shot_count > SHOTS_MOST || f->finger_count > BODIES_MOST ||
      json_array_size(json_object_get(f->head, "fields")) > FIELDS_MOST) {
    return damaged(error, "its header gives no sizes, or impossible ones");
  }
  if (f->body_count == 0 || f->shot_count == 0 || f->finger_count == 0) {
    return damaged(error, "it has no body or no frames");
  }
  return read_bodies(f, error);
}

static enum status read_fingers(struct frames *f, struct error *error) {
  f->fingers = calloc(f->finger_count, sizeof *f->fingers);
  if (!f->fingers) {
    return no_memory(error);
  }
  for (size_t i = 0; i < f->finger_count; i++) {
    const json_t *finger = json_array_get(json_object_get(f->head, "fingers"), i);
    if (!read_count(finger, "body", f->body_count - 1, &f->fingers[i].body) ||
        !read_pose(json_object_get(finger, "pose"), &f->fingers[i].pose)) {
      return damaged(error, "a finger has no body or no pose");
    }
  }
  return STATUS_OK;
}

/* ---- stream ------------------------------------------------------------------------------ */

static enum status unpack(const unsigned char *packed, size_t packed_size, const struct frames *f,
                          struct stream *stream, struct error *error) {
  size_t fields = json_array_size(json_object_get(f->head, "fields"));
  size_t size = 2 * f->point_count * ((3 + fields) * f->shot_count + 3) +
                12 * (f->object_point_count + f->object_quad_count);
  for (size_t b = 0; b < f->body_count; b++) {
    size += 16 * f->bodies[b].quad_count;
  }
  uLongf length = (uLongf)size;
  if (size > STREAM_MOST) {
    return error_set(error, STATUS_TOO_LARGE, NULL,
                     "moments.bin has %zu bytes unpacked; up to %d are drawn", size, STREAM_MOST);
  }
  stream->bytes = malloc(size);
  if (!stream->bytes) {
    return no_memory(error);
  }
  int problem = uncompress(stream->bytes, &length, packed, (uLong)packed_size);
  stream->size = size;
  if (problem == Z_MEM_ERROR) {
    return no_memory(error);
  }
  return problem == Z_OK && length == size ? STATUS_OK
                                           : damaged(error, "it does not unpack to its size");
}

/* The next `count` numbers of 4 bytes, stored as differences in rows of bytes. */
static uint32_t take_number(const struct stream *stream, size_t count, size_t place,
                            uint32_t last) {
  const unsigned char *from = stream->bytes + stream->at + place;
  uint32_t difference = 0;
  for (unsigned byte = 0; byte < 4; byte++) {
    difference |= (uint32_t)from[byte * count] << 8 * byte;
  }
  return last + difference;
}

/* Reads corners, `own` of them a face; what is missing to four is the last one once more. */
static enum status read_corners(struct stream *stream, size_t faces, size_t own, size_t points,
                                size_t (**quads)[4], struct error *error) {
  uint32_t corner = 0;
  *quads = malloc((faces + 1) * sizeof **quads);
  if (!*quads) {
    return no_memory(error);
  }
  for (size_t k = 0; k < own * faces; k++) {
    corner = take_number(stream, own * faces, k, corner);
    if (corner >= points) {
      return damaged(error, "a face names a point that does not exist");
    }
    (*quads)[k / own][k % own] = corner;
    (*quads)[k / own][3] = corner;
  }
  stream->at += 4 * own * faces;
  return STATUS_OK;
}

/* Reads the states of one channel, `count` numbers each, into value[state][count x stride] from
 * `start` on; value[state] NULL: passed over. */
static enum status read_channel(struct stream *stream, size_t states, size_t count,
                                const double limits[2], double *const *value, size_t stride,
                                struct error *error) {
  uint16_t *rows = malloc((3 * count + 1) * sizeof *rows);
  if (!rows) {
    return no_memory(error);
  }
  double scale = (limits[1] - limits[0]) / 65535;
  for (size_t s = 0; s < states; s++) {
    uint16_t *row = rows + s % 3 * count, *one = rows + (s + 2) % 3 * count;
    const uint16_t *two = rows + (s + 1) % 3 * count;
    const unsigned char *from = stream->bytes + stream->at;
    for (size_t p = 0; p < count; p++) {
      unsigned expected = s > 1 ? 2u * one[p] - two[p] : s == 1 ? one[p] : p > 0 ? row[p - 1] : 0;
      row[p] = (uint16_t)(expected + from[p] + 256u * from[count + p]);
      if (value[s]) {
        value[s][p * stride] = limits[0] + scale * row[p];
      }
    }
    stream->at += 2 * count;
  }
  free(rows);
  return STATUS_OK;
}

static bool read_limits(const json_t *low, const json_t *high, double limits[2]) {
  limits[0] = json_is_number(low) ? json_number_value(low) : NAN;
  limits[1] = json_is_number(high) ? json_number_value(high) : NAN;
  return fabs(limits[0]) <= 1e9 && fabs(limits[1]) <= 1e9;
}

static enum status read_places(struct frames *f, const struct frames_body *body,
                               struct stream *stream, struct error *error) {
  const json_t *low = json_object_get(f->head, "low_mm"),
               *high = json_object_get(f->head, "high_mm");
  enum status status = STATUS_OK;
  for (size_t axis = 0; axis < 3 && status == STATUS_OK; axis++) {
    double limits[2], *value[SHOTS_MOST];
    for (size_t s = 0; s < f->shot_count; s++) {
      value[s] = (double *)(f->shots[s].place + body->first) + axis;
    }
    if (!read_limits(json_array_get(low, axis), json_array_get(high, axis), limits)) {
      return damaged(error, "its places have no limits");
    }
    status = read_channel(stream, f->shot_count, body->point_count, limits, value, 3, error);
  }
  return status;
}

static enum status read_fields(struct frames *f, const struct frames_body *body,
                               struct stream *stream, struct error *error) {
  size_t index;
  json_t *field;
  enum status status = STATUS_OK;
  json_array_foreach(json_object_get(f->head, "fields"), index, field) {
    const char *name = json_string_value(json_object_get(field, "name"));
    bool wanted = name && strcmp(name, "contact_pressure") == 0;
    double limits[2], *value[SHOTS_MOST];
    for (size_t s = 0; s < f->shot_count; s++) {
      value[s] = wanted ? f->shots[s].contact + body->first : NULL;
    }
    if (!read_limits(json_object_get(field, "low"), json_object_get(field, "high"), limits)) {
      return damaged(error, "a field has no limits");
    }
    if (status == STATUS_OK) {
      status = read_channel(stream, f->shot_count, body->point_count, limits, value, 1, error);
    }
  }
  return status;
}

static enum status read_rest(struct frames *f, const struct frames_body *body,
                             struct stream *stream, struct error *error) {
  const json_t *low = json_object_get(f->head, "rest_low_mm");
  const json_t *high = json_object_get(f->head, "rest_high_mm");
  enum status status = STATUS_OK;
  for (size_t axis = 0; axis < 3 && status == STATUS_OK; axis++) {
    double limits[2], *value = (double *)body->rest + axis;
    if (!read_limits(json_array_get(low, axis), json_array_get(high, axis), limits)) {
      return damaged(error, "its body at rest has no limits");
    }
    status = read_channel(stream, 1, body->point_count, limits, &value, 3, error);
  }
  return status;
}

static enum status read_body(struct frames *f, struct frames_body *body, struct stream *stream,
                             struct error *error) {
  enum status status =
      read_corners(stream, body->quad_count, 4, body->point_count, &body->quads, error);
  status = status == STATUS_OK ? read_places(f, body, stream, error) : status;
  status = status == STATUS_OK ? read_fields(f, body, stream, error) : status;
  return status == STATUS_OK ? read_rest(f, body, stream, error) : status;
}

static enum status read_object(struct frames *f, struct stream *stream, struct error *error) {
  f->object = malloc((f->object_point_count + 1) * sizeof *f->object);
  if (!f->object) {
    return no_memory(error);
  }
  for (size_t i = 0; i < f->object_point_count; i++) {
    float at[3];
    for (size_t k = 0; k < 3; k++, stream->at += 4) {
      const unsigned char *from = stream->bytes + stream->at;
      uint32_t bits = (uint32_t)from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 |
                      (uint32_t)from[3] << 24;
      memcpy(&at[k], &bits, sizeof bits);
      if (!(fabsf(at[k]) <= 1e9f)) {
        return damaged(error, "a point of the object is not three finite numbers");
      }
    }
    f->object[i] = (struct skin_point){at[0], at[1], at[2]};
  }
  return read_corners(stream, f->object_quad_count, 3, f->object_point_count, &f->object_quads,
                      error);
}

/* ---- the whole --------------------------------------------------------------------------- */

static enum status make_shots(struct frames *f, struct error *error) {
  f->shots = calloc(f->shot_count, sizeof *f->shots);
  if (!f->shots) {
    return no_memory(error);
  }
  for (size_t s = 0; s < f->shot_count; s++) {
    struct frames_shot *shot = &f->shots[s];
    shot->head = json_array_get(json_object_get(f->head, "frames"), s);
    shot->place = malloc((f->point_count + 1) * sizeof *shot->place);
    shot->contact = calloc(f->point_count + 1, sizeof *shot->contact);
    if (!shot->place || !shot->contact) {
      return no_memory(error);
    }
    if (!read_pose(json_object_get(shot->head, "pose"), &shot->pose)) {
      return damaged(error, "a frame does not say where the object is");
    }
  }
  return STATUS_OK;
}

static enum status read_parts(const char *data, size_t size, struct frames *f,
                              struct stream *stream, struct error *error) {
  const unsigned char *bytes = (const unsigned char *)data;
  size_t start = MARK + 4;
  if (size < start || memcmp(data, "PNLSURF1", MARK) != 0) {
    return damaged(error, "it does not start like one");
  }
  size_t length = bytes[MARK] | (size_t)bytes[MARK + 1] << 8 | (size_t)bytes[MARK + 2] << 16 |
                  (size_t)bytes[MARK + 3] << 24;
  if (length > size - start) {
    return damaged(error, "its header is longer than the file");
  }
  f->head = json_read(data + start, length, JSON_REJECT_DUPLICATES, NULL);
  if (!f->head) {
    return errno == ENOMEM ? no_memory(error) : damaged(error, "its header is no JSON");
  }
  enum status status = read_sizes(f, error);
  status = status == STATUS_OK ? read_fingers(f, error) : status;
  status = status == STATUS_OK ? make_shots(f, error) : status;
  status = status == STATUS_OK
               ? unpack(bytes + start + length, size - start - length, f, stream, error)
               : status;
  for (size_t b = 0; b < f->body_count && status == STATUS_OK; b++) {
    status = read_body(f, &f->bodies[b], stream, error);
  }
  return status == STATUS_OK ? read_object(f, stream, error) : status;
}

enum status frames_read(const char *directory, struct frames *frames, struct error *error) {
  struct stream stream = {0};
  char *data;
  size_t size;
  *frames = (struct frames){0};
  enum status status = artifact_read(directory, "moments.bin", "the grasp", &data, &size, error);
  if (status == STATUS_OK) {
    status = read_parts(data, size, frames, &stream, error);
  }
  free(stream.bytes);
  free(data);
  return status;
}

void frames_release(struct frames *f) {
  for (size_t s = 0; f->shots && s < f->shot_count; s++) {
    free(f->shots[s].place);
    free(f->shots[s].contact);
  }
  for (size_t b = 0; f->bodies && b < f->body_count; b++) {
    free(f->bodies[b].quads);
    free(f->bodies[b].rest);
  }
  free(f->shots);
  free(f->bodies);
  free(f->fingers);
  free(f->object);
  free(f->object_quads);
  json_decref(f->head);
  *f = (struct frames){0};
}

const struct frames_shot *frames_moment(const struct frames *frames, const char *moment) {
  for (size_t s = 0; s < frames->shot_count; s++) {
    const json_t *names = json_object_get(frames->shots[s].head, "moments");
    for (size_t i = 0; i < json_array_size(names); i++) {
      const char *name = json_string_value(json_array_get(names, i));
      if (name && strcmp(name, moment) == 0) {
        return &frames->shots[s];
      }
    }
  }
  return NULL;
}

struct skin_point frames_moved(const struct frames_pose *pose, struct skin_point p) {
  const double *r = pose->rotation, *t = pose->place;
  return (struct skin_point){r[0] * p.x + r[1] * p.y + r[2] * p.z + t[0],
                             r[3] * p.x + r[4] * p.y + r[5] * p.z + t[1],
                             r[6] * p.x + r[7] * p.y + r[8] * p.z + t[2]};
}
