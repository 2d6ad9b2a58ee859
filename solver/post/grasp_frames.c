#include "solver/post/grasp_frames.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/post/output.h"
#include "solver/post/packing.h"

/* Places in mm, then what the surface can be coloured by. */
enum { CHANNELS = 5, PLACES = 3, MOMENTS = 4 };

static const struct {
  const char *name, *unit;
} fields_shown[CHANNELS - PLACES] = {{"contact_pressure", "kPa"}, {"stretch", ""}};

static const char *const moment_names[MOMENTS] = {"before", "inflated", "peak", "held"};

struct frame {
  json_t *head;  /* sample and pose */
  float *value;  /* CHANNELS x bodies x points */
  double travel; /* mm: sum of the largest movements of a point from frame to frame */
};

struct grasp_frames {
  const struct mesh *mesh;
  struct skin skin;
  size_t bodies, points; /* points of one body */
  json_t *fingers;
  float *object; /* mm */
  uint32_t *triangle;
  size_t object_points, object_triangles;
  struct frame frame[GRASP_FRAMES_MOST + 1];
  size_t count;
};

/* ---- what stays the same ----------------------------------------------------------------- */

static json_t *pose_json(const struct grasp_frames_pose *pose) {
  json_t *list = json_array();
  for (int i = 0; i < 9; i++) {
    json_array_append_new(list, json_real(pose->rotation[i]));
  }
  for (int i = 0; i < 3; i++) {
    json_array_append_new(list, json_real(1e3 * pose->place[i]));
  }
  return list;
}

static enum status take_setup(struct grasp_frames *f, const struct grasp_frames_setup *setup,
                              struct error *error) {
  f->mesh = setup->mesh;
  f->bodies = (size_t)setup->body_count;
  f->object_points = (size_t)setup->object_point_count;
  f->object_triangles = (size_t)setup->object_triangle_count;
  f->object = malloc((3 * f->object_points + 1) * sizeof *f->object);
  f->triangle = malloc((3 * f->object_triangles + 1) * sizeof *f->triangle);
  f->fingers = json_array();
  if (!f->object || !f->triangle || !f->fingers) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the frames of a grasp");
  }
  for (size_t i = 0; i < 3 * f->object_points; i++) {
    f->object[i] = (float)(1e3 * setup->object_point[i]);
  }
  for (size_t i = 0; i < 3 * f->object_triangles; i++) {
    f->triangle[i] = (uint32_t)setup->object_triangle[i];
  }
  for (int i = 0; i < setup->finger_count; i++) {
    json_array_append_new(f->fingers, json_pack("{s:i, s:o}", "body", setup->finger[i].body, "pose",
                                                pose_json(&setup->finger[i].pose)));
  }
  enum status status = skin_create(setup->mesh, false, &f->skin, error);
  f->points = (size_t)f->skin.point_count;
  return status;
}

enum status grasp_frames_create(const struct grasp_frames_setup *setup, struct grasp_frames **out,
                                struct error *error) {
  struct grasp_frames *f = calloc(1, sizeof *f);
  *out = NULL;
  if (!f) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the frames of a grasp");
  }
  enum status status = take_setup(f, setup, error);
  if (status != STATUS_OK) {
    grasp_frames_destroy(f);
    return status;
  }
  *out = f;
  return STATUS_OK;
}

static void frame_release(struct frame *frame) {
  json_decref(frame->head);
  free(frame->value);
  *frame = (struct frame){0};
}

void grasp_frames_destroy(struct grasp_frames *f) {
  if (f) {
    for (size_t i = 0; i < f->count; i++) {
      frame_release(&f->frame[i]);
    }
    skin_release(&f->skin);
    json_decref(f->fingers);
    free(f->object);
    free(f->triangle);
    free(f);
  }
}

/* ---- frames ------------------------------------------------------------------------------ */

static float *row_of(const struct grasp_frames *f, size_t frame, int channel) {
  return f->frame[frame].value + (size_t)channel * f->bodies * f->points;
}

static bool is_of(const struct frame *frame, const char *stage) {
  const char *word = json_string_value(json_object_get(frame->head, "stage"));
  return word && strcmp(word, stage) == 0;
}

static double number_of(const struct frame *frame, const char *key) {
  return json_number_value(json_object_get(frame->head, key));
}

/* The frames of the moments, -1 where there is none. */
static void find_moments(const struct grasp_frames *f, int moment[MOMENTS]) {
  bool pulls = false;
  double most = 0;
  moment[0] = f->count > 0 ? 0 : -1;
  moment[1] = moment[2] = moment[3] = -1;
  for (size_t i = 0; i < f->count; i++) {
    pulls = pulls || is_of(&f->frame[i], "pull");
  }
  for (size_t i = 0; i < f->count; i++) {
    const struct frame *frame = &f->frame[i];
    bool pull = is_of(frame, "pull");
    double force = number_of(frame, "grasp_force_N");
    if (is_of(frame, "inflate")) {
      moment[1] = (int)i;
    }
    if ((pull || !pulls) && force > most) {
      most = force;
      moment[2] = (int)i;
    }
    if (pull && number_of(frame, "contact_area_mm2") > 0) {
      moment[3] = (int)i;
    }
  }
}

/* Whether a frame is a moment, or the first or last of its stage. */
static bool is_needed(const struct grasp_frames *f, size_t i, const int moment[MOMENTS]) {
  bool needed = i == 0 || i + 1 == f->count;
  for (int m = 0; m < MOMENTS; m++) {
    needed = needed || moment[m] == (int)i;
  }
  const json_t *own = json_object_get(f->frame[i].head, "stage");
  return needed || !json_equal(own, json_object_get(f->frame[i - 1].head, "stage")) ||
         !json_equal(own, json_object_get(f->frame[i + 1].head, "stage"));
}

/* Drops the frame between whose neighbours the least moves. */
static void drop_one(struct grasp_frames *f) {
  int moment[MOMENTS];
  size_t found = f->count - 2;
  double least = INFINITY;
  find_moments(f, moment);
  for (size_t i = 1; i + 1 < f->count; i++) {
    double move = f->frame[i + 1].travel - f->frame[i - 1].travel;
    if (move < least && !is_needed(f, i, moment)) {
      least = move;
      found = i;
    }
  }
  frame_release(&f->frame[found]);
  memmove(&f->frame[found], &f->frame[found + 1], (f->count - found - 1) * sizeof *f->frame);
  f->count--;
}

/* Largest movement of a point since the frame before, mm. */
static double movement(const struct grasp_frames *f, size_t frame) {
  double most = 0;
  for (size_t p = 0; p < f->bodies * f->points; p++) {
    double square = 0;
    for (int i = 0; i < PLACES; i++) {
      double d = row_of(f, frame, i)[p] - row_of(f, frame - 1, i)[p];
      square += d * d;
    }
    most = fmax(most, square);
  }
  return sqrt(most);
}

static void fill(struct grasp_frames *f, size_t frame, const struct grasp_frames_state *state) {
  for (size_t b = 0; b < f->bodies; b++) {
    for (size_t p = 0; p < f->points; p++) {
      int node = f->skin.node[p];
      double at[CHANNELS] = {[PLACES] = 1e-3 * state[b].contact[node],
                             state[b].stretch ? state[b].stretch[node] : 1};
      for (int i = 0; i < PLACES; i++) {
        at[i] = 1e3 * (f->mesh->x[3 * node + i] + state[b].u[3 * node + i]);
      }
      at[1] = f->skin.mirrored[p] ? -at[1] : at[1];
      for (int c = 0; c < CHANNELS; c++) {
        row_of(f, frame, c)[b * f->points + p] = (float)at[c];
      }
    }
  }
}

enum status grasp_frames_add(struct grasp_frames *f, const json_t *sample,
                             const struct grasp_frames_pose *object,
                             const struct grasp_frames_state *state) {
  struct frame frame = {.head = json_deep_copy(sample),
                        .value =
                            malloc(CHANNELS * f->bodies * f->points * sizeof *frame.value + 1)};
  if (!frame.value || json_object_set_new(frame.head, "pose", pose_json(object)) != 0) {
    frame_release(&frame);
    return STATUS_NO_MEMORY;
  }
  size_t place = f->count++;
  f->frame[place] = frame;
  fill(f, place, state);
  if (place > 0) {
    f->frame[place].travel = f->frame[place - 1].travel + movement(f, place);
  }
  if (f->count > GRASP_FRAMES_MOST) {
    drop_one(f);
  }
  return STATUS_OK;
}

/* ---- writing ----------------------------------------------------------------------------- */

/* The frames that go into a file. */
struct choice {
  size_t frame[GRASP_FRAMES_MOST], count;
  struct packing_range range[CHANNELS], rest[PLACES];
};

static void choose(const struct grasp_frames *f, const int moment[MOMENTS], bool moments_only,
                   struct choice *choice) {
  choice->count = 0;
  for (size_t i = 0; i < f->count; i++) {
    bool wanted = !moments_only;
    for (int m = 0; m < MOMENTS; m++) {
      wanted = wanted || moment[m] == (int)i;
    }
    if (wanted) {
      choice->frame[choice->count++] = i;
    }
  }
  for (int c = 0; c < CHANNELS; c++) {
    choice->range[c] = packing_range_empty();
    for (size_t s = 0; s < choice->count; s++) {
      choice->range[c] = packing_range_with(choice->range[c], row_of(f, choice->frame[s], c),
                                            f->bodies * f->points);
    }
  }
}

static json_t *frames_json(const struct grasp_frames *f, const int moment[MOMENTS],
                           const struct choice *choice) {
  json_t *list = json_array();
  for (size_t s = 0; s < choice->count; s++) {
    json_t *frame = json_copy(f->frame[choice->frame[s]].head), *names = json_array();
    for (int m = 0; m < MOMENTS; m++) {
      if (moment[m] == (int)choice->frame[s]) {
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

static json_t *header(const struct grasp_frames *f, const int moment[MOMENTS],
                      const struct choice *choice) {
  json_t *fields = json_array();
  for (int c = PLACES; c < CHANNELS; c++) {
    json_array_append_new(fields,
                          json_pack("{s:s, s:s, s:f, s:f}", "name", fields_shown[c - PLACES].name,
                                    "unit", fields_shown[c - PLACES].unit, "low",
                                    choice->range[c].low, "high", choice->range[c].high));
  }
  return json_pack("{s:I, s:i, s:o, s:I, s:O, s:o, s:o, s:o, s:o, s:o, s:{s:I, s:I}}", "points",
                   (json_int_t)f->points, "quads", 4 * f->skin.face_count, "frames",
                   frames_json(f, moment, choice), "bodies", (json_int_t)f->bodies, "fingers",
                   f->fingers, "low_mm", limits_json(choice->range, false), "high_mm",
                   limits_json(choice->range, true), "fields", fields, "rest_low_mm",
                   limits_json(choice->rest, false), "rest_high_mm",
                   limits_json(choice->rest, true), "object", "points",
                   (json_int_t)f->object_points, "triangles", (json_int_t)f->object_triangles);
}

/* Places of the undeformed body, PLACES x points, mm. */
static void find_rest(const struct grasp_frames *f, float *rest, struct choice *choice) {
  for (size_t p = 0; p < f->points; p++) {
    for (size_t i = 0; i < PLACES; i++) {
      double x = 1e3 * f->mesh->x[3 * (size_t)f->skin.node[p] + i];
      rest[i * f->points + p] = (float)(i == 1 && f->skin.mirrored[p] ? -x : x);
    }
  }
  for (size_t i = 0; i < PLACES; i++) {
    choice->rest[i] = packing_range_with(packing_range_empty(), rest + i * f->points, f->points);
  }
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

static unsigned char *put_rows(const struct grasp_frames *f, const struct choice *choice,
                               unsigned char *to) {
  const size_t *frame = choice->frame;
  for (int c = 0; c < CHANNELS; c++) {
    for (size_t s = 0; s < choice->count; s++) {
      to = packing_row(row_of(f, frame[s], c), s > 0 ? row_of(f, frame[s - 1], c) : NULL,
                       s > 1 ? row_of(f, frame[s - 2], c) : NULL, f->bodies * f->points,
                       choice->range[c], to);
    }
  }
  return to;
}

enum status grasp_frames_write(const struct grasp_frames *f, bool moments_only, FILE *file) {
  struct choice choice;
  int moment[MOMENTS];
  if (f->count == 0) {
    return STATUS_INVALID;
  }
  find_moments(f, moment);
  choose(f, moment, moments_only, &choice);
  size_t size = 64 * (size_t)f->skin.face_count +
                2 * f->points * (CHANNELS * choice.count * f->bodies + PLACES) +
                12 * (f->object_points + f->object_triangles);
  unsigned char *stream = malloc(size + 1);
  float *rest = malloc((PLACES * f->points + 1) * sizeof *rest);
  enum status status = stream && rest ? STATUS_OK : STATUS_NO_MEMORY;
  if (status == STATUS_OK) {
    find_rest(f, rest, &choice);
    unsigned char *to = put_rows(f, &choice, packing_quads(&f->skin, stream));
    for (size_t i = 0; i < PLACES; i++) {
      to = packing_row(rest + i * f->points, NULL, NULL, f->points, choice.rest[i], to);
    }
    to = put_floats(f->object, 3 * f->object_points, to);
    packing_numbers(f->triangle, 3 * f->object_triangles, to);
    status = packing_write(file, header(f, moment, &choice), stream, size);
  }
  free(stream);
  free(rest);
  return status;
}

enum status grasp_frames_save(const struct grasp_frames *f, const char *directory,
                              json_t *artifacts, struct error *error) {
  static const char *const names[2] = {"grasp.bin", "moments.bin"};
  enum status status = STATUS_OK;
  for (int i = 0; i < 2 && f->count > 0 && status == STATUS_OK; i++) {
    struct output output;
    status = output_open(&output, directory, names[i], error);
    if (status == STATUS_OK) {
      enum status written = grasp_frames_write(f, i == 1, output.file);
      if (written != STATUS_OK) {
        error_set(error, written, NULL, "no memory for %s", names[i]);
      }
      status = output_close(&output, written, error);
    }
    if (status == STATUS_OK) {
      json_array_append_new(artifacts, json_string(names[i]));
    }
  }
  return status;
}
