/* The moments of a grasp, as the solver leaves them in moments.bin (solver/post/grasp_frames.h). */
#ifndef PNEULAB_PLOT_FRAMES_H
#define PNEULAB_PLOT_FRAMES_H

#include <jansson.h>
#include "server/plot/solid.h"

/* x = rotation X + place: the rotation, row by row, and the place in mm. */
struct frames_pose {
  double rotation[9], place[3];
};

/* A finger that was computed, in its own frame. */
struct frames_body {
  size_t point_count, quad_count;
  size_t first;            /* its first point in the arrays of the shots */
  size_t (*quads)[4];      /* every index is below point_count */
  struct skin_point *rest; /* without displacement */
};

/* A finger as it is to be shown. */
struct frames_finger {
  size_t body; /* below body_count */
  struct frames_pose pose;
};

struct frames_shot {
  const json_t *head;       /* its sample, with "moments"; belongs to the frames */
  struct skin_point *place; /* point_count, those of body after body, finite, mm */
  double *contact;          /* point_count, kPa: pressure on the object */
  struct frames_pose pose;  /* of the object */
};

struct frames {
  json_t *head;
  size_t point_count; /* of all bodies */
  size_t body_count, shot_count, finger_count;
  struct frames_body *bodies;
  struct frames_finger *fingers;
  struct frames_shot *shots;
  size_t object_point_count, object_quad_count;
  struct skin_point *object; /* in its own frame */
  size_t (*object_quads)[4]; /* triangles: the last two corners are one */
};

/* Reads `directory`/moments.bin into *frames, which frames_release frees in any case.
 * Errors: STATUS_NOT_FOUND (no such file), STATUS_SYNTAX (damaged, with what is wrong),
 * STATUS_TOO_LARGE (above 64 MiB, or 256 MiB unpacked), STATUS_NO_MEMORY. */
enum status frames_read(const char *directory, struct frames *frames, struct error *error);
void frames_release(struct frames *frames);

/* The shot of a moment ("before", "inflated", "peak", "held"), NULL: there is none. */
const struct frames_shot *frames_moment(const struct frames *frames, const char *moment);

struct skin_point frames_moved(const struct frames_pose *pose, struct skin_point p);

#endif
