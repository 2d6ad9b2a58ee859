/* The moving picture of a grasp: the surfaces of fingers and object from approach to release, for
 * the page (grasp.bin: all frames) and for pictures (moments.bin: few of them).
 *
 * The files are of the format of surface.bin (see recording.h) with a header of
 *   frames   [S]: the sample of each frame (stage, time_s, pressure_kPa, displacement_mm, ...)
 *            with `pose`, 12 numbers: the rotation of the object, row by row, and its place in mm;
 *            and, where the frame is one, `moments`: "before", "inflated", "peak", "held"
 *   bodies   [{ points, quads }, ...]: fingers that were computed, each in its own frame
 *   fingers  [{ body, pose }, ...]: the fingers to be shown, with the poses of those frames
 *   low_mm, high_mm [3], fields [{ name, unit, low, high }, ...]: of all bodies
 *   rest_low_mm, rest_high_mm [3]
 *   object   { points, triangles }
 * and a stream of: for each body its quadrilaterals, the rows of x, y, z and of the fields in all
 * frames, and three rows more, the places x, y, z without displacement, between the limits of rest;
 * then the object in its own frame, 3 x points floats of 4 bytes (mm), and 3 x triangles uint32,
 * stored like the corners of quadrilaterals. */
#ifndef PNEULAB_POST_GRASP_FRAMES_H
#define PNEULAB_POST_GRASP_FRAMES_H

#include <jansson.h>
#include <stdio.h>
#include "solver/fe/model.h"

enum {
  GRASP_FRAMES_MOST = 48, /* frames kept; of more, those that show the least motion are left out */
  GRASP_FRAMES_BODIES = 6
};

struct grasp_frames;

/* Where something is: x = rotation X + place. */
struct grasp_frames_pose {
  double place[3];    /* m */
  double rotation[9]; /* row by row */
};

/* The surface of the object in its own frame; read when it is given. */
struct grasp_frames_object {
  int point_count;
  const double *point; /* point_count x 3, m */
  int triangle_count;
  const int *triangle; /* triangle_count x 3, outward by the right-hand rule */
};

/* A body in one frame, over the nodes of its mesh. */
struct grasp_frames_state {
  const double *u;       /* displacement, m */
  const double *contact; /* pressure on the object, Pa */
  const double *stretch; /* largest principal stretch (shape_stretch), or NULL */
};

/* The caller owns *out. STATUS_NO_MEMORY. */
enum status grasp_frames_create(const struct grasp_frames_object *object, struct grasp_frames **out,
                                struct error *error);
void grasp_frames_destroy(struct grasp_frames *frames);

/* Begins the next body, at most GRASP_FRAMES_BODIES: its mesh, which need not outlive the call, and
 * the fingers of the gripper that move as it does, by the poses of their frames (of a single
 * finger, the identity). The frames that follow are of this body. STATUS_NO_MEMORY. */
enum status grasp_frames_begin(struct grasp_frames *frames, const struct mesh *mesh,
                               const struct grasp_frames_pose *finger, int finger_count,
                               struct error *error);

/* Takes in the next frame of a body, one for each recorded state or more often. `sample` is its row
 * of samples (borrowed, copied), of which are read: stage ("approach", "inflation", "pull", ...),
 * pressure_kPa, displacement_mm, grasp_force_N and contact_area_mm2. object: its pose in the frame
 * of the body. Of every body but the first a frame counts when one of the first has the same stage,
 * pressure and displacement. STATUS_NO_MEMORY. */
enum status grasp_frames_add(struct grasp_frames *frames, const json_t *sample,
                             const struct grasp_frames_pose *object,
                             const struct grasp_frames_state *state);

/* Ends the frames: those that some body does not have are dropped, and of a gripper the samples of
 * the others are exchanged for the rows of `samples`, those of the result, that agree with them in
 * stage, pressure and displacement. Then marks the moments: the first frame ("before"), the last of
 * stage "inflation" ("inflated"), that of the largest force in the pull, without a pull of all
 * ("peak"), and the last of the pull in which object and body touch ("held"). */
void grasp_frames_end(struct grasp_frames *frames, const json_t *samples);

/* Writes all frames, or only those of the moments. Failures of writing are left to the caller's
 * ferror. STATUS_NO_MEMORY; STATUS_INVALID without frames. */
enum status grasp_frames_write(const struct grasp_frames *frames, bool moments_only, FILE *file);

/* Ends the frames, writes grasp.bin and moments.bin into a directory and appends their names to
 * `artifacts`; without frames nothing is written. STATUS_IO, STATUS_NO_MEMORY. */
enum status grasp_frames_save(struct grasp_frames *frames, const json_t *samples,
                              const char *directory, json_t *artifacts, struct error *error);

#endif
