/* The pull of a grasp: straight, along a path, or by a force. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/job/grasp.h"
#include "solver/job/reader.h"

/* Recorded steps of a whole path. */
enum { STEPS_MAX = 1000 };

/* How fast a leg turns that does not say how long it takes, rad/s. */
static const double usual_turn = M_PI / 4;

/* What leads the object; in the order of the schema. */
static const char *const kinds[] = {"distance", "path", "force"};
enum { KINDS = sizeof kinds / sizeof *kinds };

static enum status check_kind(const struct reader *reader, const json_t *pull) {
  int given = 0;
  for (size_t i = 0; i < KINDS; i++) {
    given += json_object_get(pull, kinds[i]) != NULL;
  }
  if (given != 1) {
    return error_set(
        reader->error, STATUS_INVALID, "/grasp/pull",
        "the pull has %s \"distance\", \"path\" and \"force\"\none of them: a straight "
        "way, several legs, or, of a free object, a force\n{\"direction\": [1, 0, 0], "
        "\"distance\": \"30 mm\"}",
        given == 0 ? "none of" : "several of");
  }
  bool path = json_object_get(pull, "path") != NULL;
  if (path == (json_object_get(pull, "direction") == NULL)) {
    return STATUS_OK;
  }
  return path ? error_set(reader->error, STATUS_INVALID, "/grasp/pull/direction",
                          "a path has a direction in each of its legs\nleave it out")
              : error_set(reader->error, STATUS_INVALID, "/grasp/pull",
                          "the key \"direction\" is missing\na direction of any length\n[1, 0, 0]");
}

/* Fills one leg from the item `index` of the path. */
static enum status read_leg(const struct reader *reader, const json_t *item, int index, double rate,
                            struct grasp_leg *leg) {
  char pointer[60];
  const json_t *turn = json_object_get(item, "turn");
  reader_vector(reader, json_object_get(item, "move"), leg->move);
  if (turn) {
    snprintf(pointer, sizeof pointer, "/grasp/pull/path/%d/turn/axis", index);
    enum status status = reader_direction(reader, json_object_get(turn, "axis"), pointer,
                                          "the axis of the turn", leg->turn);
    if (status != STATUS_OK) {
      return status;
    }
    double angle = reader_member(reader, turn, "angle", "deg", 0.0);
    for (int i = 0; i < 3; i++) {
      leg->turn[i] *= angle;
    }
  }
  double way = vec3_norm(leg->move), angle = vec3_norm(leg->turn);
  leg->seconds = reader_member(reader, item, "duration", "s", fmax(way / rate, angle / usual_turn));
  snprintf(pointer, sizeof pointer, "/grasp/pull/path/%d", index);
  return way > 0 || angle > 0
             ? STATUS_OK
             : error_set(
                   reader->error, STATUS_INVALID, pointer,
                   "the leg neither moves nor turns the object\na \"move\" or a \"turn\" that "
                   "is not 0\n{\"move\": [\"20 mm\", 0, 0]}");
}

static enum status read_path(const struct reader *reader, const json_t *path, double rate,
                             struct grasp_pull *pull) {
  size_t index;
  const json_t *item;
  enum status status = STATUS_OK;
  json_array_foreach(path, index, item) {
    status = status == STATUS_OK
                 ? read_leg(reader, item, (int)index, rate, &pull->leg[pull->leg_count++])
                 : status;
  }
  if (status == STATUS_OK && pull->steps * pull->leg_count > STEPS_MAX) {
    return error_set(reader->error, STATUS_INVALID, "/grasp/pull/steps",
                     "%d legs of %d steps are %d recorded steps\nat most %d in all: up to %d here",
                     pull->leg_count, pull->steps, pull->steps * pull->leg_count, STEPS_MAX,
                     STEPS_MAX / pull->leg_count);
  }
  pull->steps *= pull->leg_count;
  return status;
}

enum status reader_grasp_pull(const struct reader *reader, const json_t *value,
                              struct grasp_pull *pull) {
  if (!value) {
    return STATUS_OK;
  }
  const json_t *path = json_object_get(value, "path");
  double rate = reader_member(reader, value, "rate", "mm/s", 0.0);
  double distance = reader_member(reader, value, "distance", "mm", 0.0);
  pull->force = reader_member(reader, value, "force", "N", 0.0);
  pull->steps = reader_count(value, "steps", 0);
  pull->after_contact = json_number_value(json_object_get(value, "after_contact"));
  enum status status = check_kind(reader, value);
  if (status != STATUS_OK || path) {
    return status == STATUS_OK ? read_path(reader, path, rate, pull) : status;
  }
  status = reader_direction(reader, json_object_get(value, "direction"), "/grasp/pull/direction",
                            "the direction of the pull", pull->direction);
  if (distance > 0) {
    pull->leg_count = 1;
    pull->leg[0].seconds = distance / rate;
    for (int i = 0; i < 3; i++) {
      pull->leg[0].move[i] = distance * pull->direction[i];
    }
  }
  return status;
}
