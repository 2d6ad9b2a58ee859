#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/base64.h"
#include "solver/job/grasp.h"
#include "solver/job/grasp_shape.h"
#include "solver/job/reader.h"

static bool has_word(const json_t *object, const char *key, const char *word) {
  const char *given = json_string_value(json_object_get(object, key));
  return given && strcmp(given, word) == 0;
}

static enum status no_memory(const struct reader *reader) {
  return error_set(reader->error, STATUS_NO_MEMORY, NULL, "no memory for the grasp");
}

/* ---- vectors ------------------------------------------------------------------------------ */

void reader_vector(const struct reader *reader, const json_t *value, double out[3]) {
  for (size_t i = 0; i < 3; i++) {
    out[i] = reader_quantity(reader, json_array_get(value, i), "mm");
  }
}

enum status reader_direction(const struct reader *reader, const json_t *value, const char *pointer,
                             const char *what, double out[3]) {
  double square = 0;
  for (size_t i = 0; i < 3; i++) {
    out[i] = json_number_value(json_array_get(value, i));
    square += out[i] * out[i];
  }
  if (square == 0) {
    return error_set(reader->error, STATUS_INVALID, pointer,
                     "%s has no length\nat least one number that is not 0\n[0, 0, 1]", what);
  }
  for (int i = 0; i < 3; i++) {
    out[i] /= sqrt(square);
  }
  return STATUS_OK;
}

/* ---- shape -------------------------------------------------------------------------------- */

static void read_profile(const struct reader *reader, const json_t *value,
                         struct grasp_shape *shape) {
  size_t index;
  const json_t *point;
  shape->smooth = has_word(value, "curve", "smooth");
  json_array_foreach(json_object_get(value, "profile"), index, point) {
    double *p = shape->profile[shape->profile_count++];
    p[0] = reader_quantity(reader, json_array_get(point, 0), "mm");
    p[1] = reader_quantity(reader, json_array_get(point, 1), "mm");
  }
}

static enum status read_stl(const struct reader *reader, const json_t *value,
                            struct grasp_shape *shape) {
  static const char place[] = "/object/shape/stl/base64";
  const json_t *text = json_object_get(json_object_get(value, "stl"), "base64");
  size_t length = json_string_length(text);
  shape->stl = malloc(length / 4 * 3 + 1);
  if (!shape->stl) {
    return no_memory(reader);
  }
  if (!base64_decode(json_string_value(text), length, shape->stl, &shape->stl_size)) {
    return error_set(reader->error, STATUS_INVALID, place,
                     "the text is not base64\nthe content of an STL file in base64; "
                     "\"pneulab-solve --embed JOB.json\" writes it for { \"file\": \"part.stl\" }");
  }
  shape->stl_unit = has_word(value, "unit", "m")    ? 1
                    : has_word(value, "unit", "cm") ? 1e-2
                    : has_word(value, "unit", "in") ? 25.4e-3
                                                    : 1e-3;
  shape->crease = reader_member(reader, value, "crease", "deg", RIGID_CREASE);
  return STATUS_OK;
}

/* Reads the shape, and makes it once, to see whether it can be made. */
static enum status read_shape(const struct reader *reader, const json_t *value,
                              struct grasp_shape *shape) {
  static const char *const forms[] = {
      [GRASP_SPHERE] = "sphere",  [GRASP_CYLINDER] = "cylinder", [GRASP_FRUSTUM] = "frustum",
      [GRASP_BOX] = "box",        [GRASP_PLANE] = "plane",       [GRASP_REVOLUTION] = "revolution",
      [GRASP_SURFACE] = "surface"};
  for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
    shape->form = has_word(value, "form", forms[i]) ? (enum grasp_form)i : shape->form;
  }
  const char *rounding = shape->form == GRASP_BOX ? "edge" : "rim";
  shape->diameter = reader_member(reader, value, "diameter", "mm", 0.0);
  shape->length = reader_member(reader, value, "length", "mm", 0.0);
  shape->base_diameter = reader_member(reader, value, "base_diameter", "mm", 0.0);
  shape->tip_diameter = reader_member(reader, value, "tip_diameter", "mm", 0.0);
  shape->rounding = reader_member(reader, value, rounding, "mm", 0.0);
  reader_vector(reader, json_object_get(value, "size"), shape->size);
  read_profile(reader, value, shape);
  enum status status = shape->form == GRASP_SURFACE ? read_stl(reader, value, shape) : STATUS_OK;
  struct rigid_shape *made = NULL;
  if (status == STATUS_OK) {
    status = grasp_shape_create(shape, &made, reader->error);
  }
  rigid_shape_destroy(made);
  return status;
}

/* ---- object ------------------------------------------------------------------------------- */

/* rotation <- R(axis of length 1, angle) rotation (Rodrigues). */
static void rotate(double rotation[3][3], const double axis[3], double angle) {
  double c = cos(angle), s = sin(angle), turned[3][3];
  for (int j = 0; j < 3; j++) {
    double v[3] = {rotation[0][j], rotation[1][j], rotation[2][j]};
    double along = axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
    for (int i = 0; i < 3; i++) {
      int k = (i + 1) % 3, l = (i + 2) % 3;
      turned[i][j] = c * v[i] + s * (axis[k] * v[l] - axis[l] * v[k]) + (1 - c) * along * axis[i];
    }
  }
  memcpy(rotation, turned, sizeof turned);
}

/* The shortest rotation from z to the axis; half a turn about x for -z. */
static void turn_to(const double axis[3], double rotation[3][3]) {
  double across = hypot(axis[0], axis[1]);
  double about[3] = {1, 0, 0};
  if (across > 0) {
    about[0] = -axis[1] / across;
    about[1] = axis[0] / across;
  }
  rotate(rotation, about, atan2(across, axis[2]));
}

static enum status read_object(const struct reader *reader, const json_t *value,
                               struct grasp_object *object) {
  static const double unturned[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  double axis[3];
  const json_t *rotation = json_object_get(value, "rotation");
  reader_vector(reader, json_object_get(value, "position"), object->place);
  object->friction = json_number_value(json_object_get(value, "friction"));
  object->free = has_word(value, "motion", "free");
  object->mass = reader_member(reader, value, "mass", "g", 0.0);
  memcpy(object->rotation, unturned, sizeof unturned);
  enum status status = reader_direction(reader, json_object_get(value, "axis"), "/object/axis",
                                        "the axis of the object", axis);
  if (status != STATUS_OK) {
    return status;
  }
  turn_to(axis, object->rotation);
  if (rotation) {
    status = reader_direction(reader, json_object_get(rotation, "axis"), "/object/rotation/axis",
                              "the axis of the rotation", axis);
    if (status != STATUS_OK) {
      return status;
    }
    rotate(object->rotation, axis, reader_member(reader, rotation, "angle", "deg", 0.0));
  }
  return read_shape(reader, json_object_get(value, "shape"), &object->shape);
}

/* ---- course ------------------------------------------------------------------------------- */

/* The plate becomes the object; where it is, the mesh has to say: its place is that from the end of
 * the bottom centreline. */
static enum status read_blocked(const struct reader *reader, const json_t *value,
                                struct grasp_spec *spec) {
  double *to = spec->blocked_direction;
  enum status status = reader_direction(reader, json_object_get(value, "direction"),
                                        "/grasp/blocked/direction", "the direction", to);
  if (status != STATUS_OK) {
    return status;
  }
  double back[3] = {-to[0], -to[1], -to[2]}, rotation[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  turn_to(back, rotation);
  spec->blocked = true;
  spec->blocked_distance = reader_member(reader, value, "distance", "mm", 0.0);
  spec->object = (struct grasp_object){
      .shape.form = GRASP_PLANE,
      .friction = json_number_value(json_object_get(value, "friction")),
  };
  for (int i = 0; i < 3; i++) {
    spec->object.place[i] = spec->blocked_distance * to[i];
  }
  memcpy(spec->object.rotation, rotation, sizeof rotation);
  return STATUS_OK;
}

static enum status read_ways(const struct reader *reader, const json_t *course,
                             struct grasp_spec *spec) {
  const json_t *approach = json_object_get(course, "approach");
  reader_vector(reader, json_object_get(approach, "from"), spec->approach.from);
  spec->approach.rate = reader_member(reader, approach, "rate", "mm/s", 0.0);
  spec->approach.steps = reader_count(approach, "steps", 0);
  spec->inflation_time = reader_member(reader, course, "inflation_time", "s", 0.0);
  spec->release = json_is_true(json_object_get(course, "release"));
  return reader_grasp_pull(reader, json_object_get(course, "pull"), &spec->pull);
}

static void read_rest(const struct reader *reader, const json_t *course, struct grasp_spec *spec) {
  const json_t *fingers = json_object_get(course, "fingers");
  const json_t *dynamics = json_object_get(course, "dynamics");
  const json_t *numerics = json_object_get(course, "numerics");
  spec->fingers.count = reader_count(fingers, "count", 1);
  spec->fingers.radius = reader_member(reader, fingers, "radius", "mm", 0.0);
  spec->fingers.tilt = reader_member(reader, fingers, "tilt", "deg", 0.0);
  spec->dynamics = !has_word(dynamics, "use", "never");
  spec->damping_time = reader_member(reader, dynamics, "damping_time", "s", NAN);
  spec->longest_step = reader_member(reader, numerics, "longest_step", "mm", 0.0);
  spec->stiffness = json_number_value(json_object_get(numerics, "stiffness"));
}

/* What excludes each other. */
static enum status check_course(const struct reader *reader, const json_t *document) {
  const json_t *course = json_object_get(document, "grasp");
  const json_t *object = json_object_get(document, "object");
  static const char *const of_objects[] = {"approach", "pull", "fingers"};
  if (!json_object_get(course, "blocked")) {
    return object
               ? STATUS_OK
               : error_set(reader->error, STATUS_INVALID, "",
                           "the key \"object\" is missing\nan object, or \"blocked\" in \"grasp\" "
                           "for a plate\n{\"object\": {\"shape\": {\"form\": \"sphere\", "
                           "\"diameter\": \"40 mm\"}, \"friction\": 0.6}}");
  }
  if (object) {
    return error_set(reader->error, STATUS_INVALID, "/grasp/blocked",
                     "there is an object, and a plate in its place\none of the two");
  }
  for (size_t i = 0; i < sizeof of_objects / sizeof *of_objects; i++) {
    if (json_object_get(course, of_objects[i])) {
      char pointer[40];
      snprintf(pointer, sizeof pointer, "/grasp/%s", of_objects[i]);
      return error_set(reader->error, STATUS_INVALID, pointer,
                       "a blocked tip has no such stage\nleave out it or \"blocked\"");
    }
  }
  return STATUS_OK;
}

enum status reader_grasp(const struct reader *reader, const json_t *document,
                         struct job_spec *job) {
  const json_t *course = json_object_get(document, "grasp");
  const json_t *blocked = json_object_get(course, "blocked");
  enum status status = check_course(reader, document);
  if (status != STATUS_OK) {
    return status;
  }
  struct grasp_spec *spec = calloc(1, sizeof *spec);
  if (!spec) {
    return no_memory(reader);
  }
  job->kind = JOB_GRASP;
  job->grasp = spec;
  memcpy(spec->gravity, job->load.gravity, sizeof spec->gravity);
  read_rest(reader, course, spec);
  status = read_ways(reader, course, spec);
  if (status == STATUS_OK) {
    status = blocked ? read_blocked(reader, blocked, spec)
                     : read_object(reader, json_object_get(document, "object"), &spec->object);
  }
  return status == STATUS_OK ? reader_grasp_check(reader, document, job) : status;
}
