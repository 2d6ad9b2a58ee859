/* The moving picture of a grasp: the surfaces of fingers and object from approach to release, for
 * the page (grasp.bin: all frames) and for pictures (moments.bin: few of them).
 *
 * The files are of the format of surface.bin (see recording.h) with these differences. Instead of
 * pressures_kPa the header has
 *   frames   [S]: the sample of each frame (stage, time_s, pressure_kPa, displacement_mm, ...)
 *            with `pose`, 12 numbers: the rotation of the object, row by row, and its place in mm;
 *            and, where the frame is one, `moments`: "before", "inflated", "peak", "held"
 *   bodies   B: fingers that were computed; a row has B x P numbers, those of body 0 first
 *   fingers  [{ body, pose }, ...]: the fingers to be shown, with the poses of their bodies
 *   rest_low_mm [3], rest_high_mm [3]
 *   object   { points, triangles }
 * and the stream goes on with three rows of P numbers, the places x, y, z of the undeformed body,
 * between those limits; then 3 x points floats of 4 bytes, the object in its own frame, mm; then 3
 * x triangles uint32, stored like the corners of quadrilaterals. */
#ifndef PNEULAB_POST_GRASP_FRAMES_H
#define PNEULAB_POST_GRASP_FRAMES_H

#include <jansson.h>
#include <stdio.h>
#include "solver/fe/model.h"

enum {
  GRASP_FRAMES_MOST = 48 /* frames kept; with more, those that show the least motion are left out */
};

struct grasp_frames;

/* Where something is: x = rotation X + place. */
struct grasp_frames_pose {
  double place[3];    /* m */
  double rotation[9]; /* row by row */
};

/* A finger of the gripper. */
struct grasp_frames_finger {
  int body; /* the computed one that it shows: of a symmetric gripper all show the same */
  struct grasp_frames_pose pose; /* of that body's frame */
};

/* All of it is read during grasp_frames_create alone, but the mesh, which outlives the frames. */
struct grasp_frames_setup {
  const struct mesh *mesh; /* of each body, without displacement */
  int body_count;
  int finger_count;
  const struct grasp_frames_finger *finger;
  int object_point_count;
  const double *object_point; /* object_point_count x 3, m, in the object's frame */
  int object_triangle_count;
  const int *object_triangle; /* object_triangle_count x 3, outward by the right-hand rule */
};

/* One body in one frame, over the nodes of the mesh. */
struct grasp_frames_state {
  const double *u;       /* displacement, m */
  const double *contact; /* pressure on the object, Pa */
  const double *stretch; /* largest principal stretch (shape_stretch), or NULL */
};

/* The caller owns *out. STATUS_NO_MEMORY. */
enum status grasp_frames_create(const struct grasp_frames_setup *setup, struct grasp_frames **out,
                                struct error *error);
void grasp_frames_destroy(struct grasp_frames *frames);

/* Takes in the next frame, one for each recorded state or more often. `sample` is its row of the
 * result's samples (borrowed, copied), of which are read: stage ("approach", "inflate", "pull",
 * "release"), grasp_force_N and contact_area_mm2. object: its pose, in the frame in which
 * the fingers have theirs. state[body_count]: of the bodies. STATUS_NO_MEMORY. */
enum status grasp_frames_add(struct grasp_frames *frames, const json_t *sample,
                             const struct grasp_frames_pose *object,
                             const struct grasp_frames_state *state);

/* Writes all frames, or only those of the moments: the first one ("before"), the last of stage
 * "inflate" ("inflated"), the one with the largest force while it pulls, without a pull of all
 * ("peak"), and the last one of the pull in which object and body touch ("held"). Failures of
 * writing are left to the caller's ferror. STATUS_NO_MEMORY; STATUS_INVALID without frames. */
enum status grasp_frames_write(const struct grasp_frames *frames, bool moments_only, FILE *file);

/* Writes grasp.bin and moments.bin into a directory and appends their names to `artifacts`. Without
 * frames nothing is written. STATUS_IO, STATUS_NO_MEMORY. */
enum status grasp_frames_save(const struct grasp_frames *frames, const char *directory,
                              json_t *artifacts, struct error *error);

#endif
