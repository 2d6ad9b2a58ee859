#include "solver/post/grasp_frames.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/post/grasp_frames_internal.h"
#include "solver/post/output.h"

enum status grasp_frames_create(const struct grasp_frames_object *object, struct grasp_frames **out,
                                struct error *error) {
  struct grasp_frames *f = calloc(1, sizeof *f);
  *out = f;
  if (f) {
    f->object_points = (size_t)object->point_count;
    f->object_triangles = (size_t)object->triangle_count;
    f->object = malloc((3 * f->object_points + 1) * sizeof *f->object);
    f->triangle = malloc((3 * f->object_triangles + 1) * sizeof *f->triangle);
    f->fingers = json_array();
  }
  if (!f || !f->object || !f->triangle || !f->fingers) {
    grasp_frames_destroy(f);
    *out = NULL;
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the frames of a grasp");
  }
  for (size_t i = 0; i < 3 * f->object_points; i++) {
    f->object[i] = (float)(1e3 * object->point[i]);
  }
  for (size_t i = 0; i < 3 * f->object_triangles; i++) {
    f->triangle[i] = (uint32_t)object->triangle[i];
  }
  return STATUS_OK;
}

static void frame_release(struct frame *frame) {
  json_decref(frame->head);
  for (size_t b = 0; b < GRASP_FRAMES_BODIES; b++) {
    free(frame->value[b]);
  }
  *frame = (struct frame){0};
}

void grasp_frames_destroy(struct grasp_frames *f) {
  if (f) {
    for (size_t i = 0; i < f->count; i++) {
      frame_release(&f->frame[i]);
    }
    for (size_t b = 0; b < f->bodies; b++) {
      skin_release(&f->body[b].skin);
      free(f->body[b].rest);
    }
    json_decref(f->fingers);
    free(f->object);
    free(f->triangle);
    free(f);
  }
}

/* ---- bodies ------------------------------------------------------------------------------ */

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

/* Where something is that has pose b in a frame with pose a. */
static struct grasp_frames_pose composed(const struct grasp_frames_pose *a,
                                         const struct grasp_frames_pose *b) {
  struct grasp_frames_pose pose = *a;
  for (size_t i = 0; i < 3; i++) {
    for (size_t k = 0; k < 3; k++) {
      const double *row = a->rotation + 3 * i;
      pose.rotation[3 * i + k] =
          row[0] * b->rotation[k] + row[1] * b->rotation[3 + k] + row[2] * b->rotation[6 + k];
      pose.place[i] += row[k] * b->place[k];
    }
  }
  return pose;
}

enum status grasp_frames_begin(struct grasp_frames *f, const struct mesh *mesh,
                               const struct grasp_frames_pose *finger, int finger_count,
                               struct error *error) {
  if (f->bodies == GRASP_FRAMES_BODIES) {
    return error_set(error, STATUS_INTERNAL, NULL, "more than %d bodies in one picture",
                     GRASP_FRAMES_BODIES);
  }
  struct body *body = &f->body[f->bodies];
  enum status status = skin_create(mesh, false, &body->skin, error);
  if (status != STATUS_OK) {
    return status;
  }
  body->points = (size_t)body->skin.point_count;
  body->rest = malloc((PLACES * body->points + 1) * sizeof *body->rest);
  f->bodies++;
  if (!body->rest) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the frames of a grasp");
  }
  for (size_t p = 0; p < body->points; p++) {
    for (size_t i = 0; i < PLACES; i++) {
      double x = 1e3 * mesh->x[3 * (size_t)body->skin.node[p] + i];
      body->rest[i * body->points + p] = (float)(i == 1 && body->skin.mirrored[p] ? -x : x);
    }
  }
  body->pose = finger[0];
  for (int k = 0; k < finger_count; k++) {
    json_array_append_new(f->fingers, json_pack("{s:i, s:o}", "body", (int)f->bodies - 1, "pose",
                                                pose_json(&finger[k])));
  }
  return STATUS_OK;
}

/* ---- frames ------------------------------------------------------------------------------ */

static bool is_of(const struct frame *frame, const char *stage) {
  const char *word = json_string_value(json_object_get(frame->head, "stage"));
  return word && strcmp(word, stage) == 0;
}

static double number_of(const json_t *sample, const char *key) {
  return json_number_value(json_object_get(sample, key));
}

/* Whether two samples are at the same point of the course. */
static bool agree(const json_t *a, const json_t *b) {
  static const char *const keys[] = {"pressure_kPa", "displacement_mm"};
  bool same = json_equal(json_object_get(a, "stage"), json_object_get(b, "stage"));
  for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
    double left = number_of(a, keys[k]), right = number_of(b, keys[k]);
    same = same && fabs(left - right) <= 1e-6 * (1 + fabs(left));
  }
  return same;
}

static void find_moments(struct grasp_frames *f) {
  bool pulls = false;
  double most = 0;
  for (int m = 0; m < MOMENTS; m++) {
    f->moment[m] = m == MOMENT_BEFORE && f->count > 0 ? 0 : -1;
  }
  for (size_t i = 0; i < f->count; i++) {
    pulls = pulls || is_of(&f->frame[i], "pull");
  }
  for (size_t i = 0; i < f->count; i++) {
    const struct frame *frame = &f->frame[i];
    bool pull = is_of(frame, "pull");
    double force = number_of(frame->head, "grasp_force_N");
    if (is_of(frame, "inflation")) {
      f->moment[MOMENT_INFLATED] = (int)i;
    }
    if ((pull || !pulls) && force > most) {
      most = force;
      f->moment[MOMENT_PEAK] = (int)i;
    }
    if (pull && number_of(frame->head, "contact_area_mm2") > 0) {
      f->moment[MOMENT_HELD] = (int)i;
    }
  }
}

/* Whether a frame is a moment, or the first or last of its stage. */
static bool is_needed(const struct grasp_frames *f, size_t i) {
  bool needed = i == 0 || i + 1 == f->count;
  for (int m = 0; m < MOMENTS; m++) {
    needed = needed || f->moment[m] == (int)i;
  }
  const json_t *own = json_object_get(f->frame[i].head, "stage");
  return needed || !json_equal(own, json_object_get(f->frame[i - 1].head, "stage")) ||
         !json_equal(own, json_object_get(f->frame[i + 1].head, "stage"));
}

static void drop(struct grasp_frames *f, size_t frame) {
  frame_release(&f->frame[frame]);
  memmove(&f->frame[frame], &f->frame[frame + 1], (f->count - frame - 1) * sizeof *f->frame);
  f->count--;
}

/* Drops the frame between whose neighbours the least moves. */
static void drop_one(struct grasp_frames *f) {
  size_t found = f->count - 2;
  double least = INFINITY;
  find_moments(f);
  for (size_t i = 1; i + 1 < f->count; i++) {
    double move = f->frame[i + 1].travel - f->frame[i - 1].travel;
    if (move < least && !is_needed(f, i)) {
      least = move;
      found = i;
    }
  }
  drop(f, found);
}

/* Largest movement of a point of body 0 since the frame before, mm. */
static double movement(const struct grasp_frames *f, size_t frame) {
  double most = 0;
  for (size_t p = 0; p < f->body[0].points; p++) {
    double square = 0;
    for (int i = 0; i < PLACES; i++) {
      double d = grasp_frames_row(f, frame, 0, i)[p] - grasp_frames_row(f, frame - 1, 0, i)[p];
      square += d * d;
    }
    most = fmax(most, square);
  }
  return sqrt(most);
}

/* The channels of a body in a state; NULL without memory. */
static float *channels_of(const struct body *body, const struct grasp_frames_state *state) {
  size_t points = body->points;
  float *value = malloc((CHANNELS * points + 1) * sizeof *value);
  for (size_t p = 0; value && p < points; p++) {
    size_t node = (size_t)body->skin.node[p];
    for (size_t i = 0; i < PLACES; i++) {
      double moved = 1e3 * state->u[3 * node + i];
      moved = i == 1 && body->skin.mirrored[p] ? -moved : moved;
      value[i * points + p] = (float)(body->rest[i * points + p] + moved);
    }
    value[PLACES * points + p] = (float)(1e-3 * state->contact[node]);
    value[(PLACES + 1) * points + p] = (float)(state->stretch ? state->stretch[node] : 1);
  }
  return value;
}

/* Adds a frame of the first body; value and head become those of the frames. */
static void append(struct grasp_frames *f, json_t *head, float *value) {
  size_t place = f->count++;
  f->frame[place] = (struct frame){.head = head, .value = {value}};
  if (place > 0) {
    f->frame[place].travel = f->frame[place - 1].travel + movement(f, place);
  }
  if (f->count > GRASP_FRAMES_MOST) {
    drop_one(f);
  }
}

enum status grasp_frames_add(struct grasp_frames *f, const json_t *sample,
                             const struct grasp_frames_pose *object,
                             const struct grasp_frames_state *state) {
  size_t last = f->bodies - 1, place = 0;
  const struct body *body = &f->body[last];
  while (last > 0 && place < f->count &&
         (f->frame[place].value[last] || !agree(f->frame[place].head, sample))) {
    place++;
  }
  if (last > 0 && place == f->count) {
    return STATUS_OK; /* the first body has no such frame, or has lost it */
  }
  float *value = channels_of(body, state);
  if (!value) {
    return STATUS_NO_MEMORY;
  }
  if (last > 0) {
    f->frame[place].value[last] = value;
    return STATUS_OK;
  }
  struct grasp_frames_pose pose = composed(&body->pose, object);
  json_t *head = json_deep_copy(sample);
  if (!head || json_object_set_new(head, "pose", pose_json(&pose)) != 0) {
    json_decref(head);
    free(value);
    return STATUS_NO_MEMORY;
  }
  append(f, head, value);
  return STATUS_OK;
}

/* ---- the end ----------------------------------------------------------------------------- */

/* Exchanges the numbers of a frame for those of a sample that agrees with it. */
static void take_sample(struct frame *frame, const json_t *samples) {
  for (size_t i = 0; i < json_array_size(samples); i++) {
    json_t *sample = json_array_get(samples, i);
    if (agree(frame->head, sample)) {
      json_object_update(frame->head, sample);
      return;
    }
  }
}

void grasp_frames_end(struct grasp_frames *f, const json_t *samples) {
  for (size_t i = f->count; i-- > 0;) {
    bool whole = true;
    for (size_t b = 0; b < f->bodies; b++) {
      whole = whole && f->frame[i].value[b];
    }
    if (!whole) {
      drop(f, i);
    }
  }
  for (size_t i = 0; i < f->count && json_array_size(f->fingers) > 1; i++) {
    take_sample(&f->frame[i], samples);
  }
  find_moments(f);
}

enum status grasp_frames_save(struct grasp_frames *f, const json_t *samples, const char *directory,
                              json_t *artifacts, struct error *error) {
  static const char *const names[2] = {"grasp.bin", "moments.bin"};
  enum status status = STATUS_OK;
  grasp_frames_end(f, samples);
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
