/* What a free object asks of its grasp. */
#include <math.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/job/grasp.h"
#include "solver/job/reader.h"

/* Differences of directions that are rounding. */
static const double same_direction = 1e-9;

static enum status refuse(const struct reader *reader, const char *pointer, const char *message) {
  return error_set(reader->error, STATUS_INVALID, pointer, "%s", message);
}

/* Of objects that are not free. */
static enum status check_fixed(const struct reader *reader, const json_t *object,
                               const struct grasp_spec *spec) {
  if (json_object_get(object, "mass")) {
    return refuse(reader, "/object/mass",
                  "a fixed object needs no mass: it moves only as the course says\nleave it out, "
                  "or let the object go\n{\"motion\": \"free\", \"mass\": \"50 g\"}");
  }
  if (spec->pull.force > 0) {
    return refuse(reader, "/grasp/pull/force",
                  "a force draws a free object only\na \"distance\" or a \"path\", or an object "
                  "that is let go\n{\"motion\": \"free\", \"mass\": \"50 g\"}");
  }
  return STATUS_OK;
}

static bool along_axis(const double v[3]) {
  return hypot(v[1], v[2]) <= same_direction * fmax(1, vec3_norm(v));
}

/* Fingers that are computed one by one meet through the object; only where all are alike, and each
 * of them symmetric, is it known how it moves: along their axis. */
static enum status check_fingers(const struct reader *reader, const struct job_spec *job) {
  const struct grasp_spec *spec = job->grasp;
  struct grasp_spec first = grasp_of_finger(spec, 0);
  struct job_spec finger = *job;
  if (!along_axis(spec->gravity)) {
    return refuse(
        reader, "/load/gravity",
        "the weight of a free object has to act along the axis of the gripper\n[\"9.80665 "
        "m/s2\", 0, 0] or its opposite\n{\"gravity\": [\"9.80665 m/s2\", 0, 0]}");
  }
  if (!along_axis(spec->approach.from)) {
    return refuse(reader, "/grasp/approach/from",
                  "a free object has to come along the axis of the gripper\n[\"80 mm\", 0, 0]");
  }
  if (spec->pull.force > 0 && !along_axis(spec->pull.direction)) {
    return refuse(reader, "/grasp/pull/direction",
                  "a free object has to be drawn along the axis of the gripper\n[1, 0, 0] or [-1, "
                  "0, 0]");
  }
  memcpy(finger.load.gravity, first.gravity, sizeof finger.load.gravity);
  finger.whole_model = false;
  bool alike = reader_half_model(&finger) && grasp_symmetric(&first);
  for (int k = 1; k < spec->fingers.count; k++) {
    struct grasp_spec seen = grasp_of_finger(spec, k);
    alike = alike && grasp_same(&first, &seen);
  }
  return alike ? STATUS_OK
               : refuse(reader, "/object",
                        "the fingers do not all see the free object alike\n"
                        "fingers share a free object only when all see it alike and left and "
                        "right: a shape of revolution about the gripper's axis (or a box between "
                        "two fingers), in the middle; one finger, or a fixed object, may be as "
                        "they are");
}

enum status reader_grasp_check(const struct reader *reader, const json_t *document,
                               const struct job_spec *job) {
  const struct grasp_spec *spec = job->grasp;
  const json_t *object = json_object_get(document, "object");
  if (spec->blocked || !spec->object.free) {
    return spec->blocked ? STATUS_OK : check_fixed(reader, object, spec);
  }
  if (!json_object_get(object, "mass")) {
    return refuse(reader, "/object",
                  "a free object has a weight: the key \"mass\" is missing\na mass above 0\n"
                  "{\"motion\": \"free\", \"mass\": \"50 g\"}");
  }
  if (spec->object.shape.form == GRASP_PLANE) {
    return refuse(reader, "/object/motion",
                  "a plane has no end and no volume, so it cannot be free\n\"fixed\", or another "
                  "shape");
  }
  if (spec->pull.leg_count > 0) {
    return refuse(reader, "/grasp/pull",
                  "a free object is not led: a distance or a path would hold it\na \"force\" that "
                  "rises, or no pull\n{\"direction\": [1, 0, 0], \"force\": \"2 N\"}");
  }
  if (vec3_norm(spec->gravity) == 0 && spec->pull.force == 0) {
    return refuse(reader, "/object/motion",
                  "nothing draws on the free object\ngravity in the load, or a pull by a force\n"
                  "{\"gravity\": [\"9.80665 m/s2\", 0, 0]}");
  }
  return spec->fingers.count > 1 ? check_fingers(reader, job) : STATUS_OK;
}
