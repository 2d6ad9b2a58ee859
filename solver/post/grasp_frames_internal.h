/* What grasp_frames.c collects and grasp_frames_write.c writes. */
#ifndef PNEULAB_POST_GRASP_FRAMES_INTERNAL_H
#define PNEULAB_POST_GRASP_FRAMES_INTERNAL_H

#include "solver/post/grasp_frames.h"
#include "solver/post/skin.h"

/* Channels: places in mm, then what the surface can be coloured by. */
enum { PLACES = 3, FIELDS = 2, CHANNELS = PLACES + FIELDS };

enum moment { MOMENT_BEFORE, MOMENT_INFLATED, MOMENT_PEAK, MOMENT_HELD, MOMENTS };

struct body {
  struct skin skin;
  size_t points;
  float *rest;                   /* PLACES x points, mm, without displacement */
  struct grasp_frames_pose pose; /* of the first finger that moves so */
};

struct frame {
  json_t *head;                      /* sample and pose */
  float *value[GRASP_FRAMES_BODIES]; /* of each body CHANNELS x points; NULL: it is not there */
  double travel; /* mm: sum of the largest movements of a point of body 0 from frame to frame */
};

struct grasp_frames {
  struct body body[GRASP_FRAMES_BODIES];
  size_t bodies;
  json_t *fingers;
  float *object; /* mm */
  uint32_t *triangle;
  size_t object_points, object_triangles;
  struct frame frame[GRASP_FRAMES_MOST + 1];
  size_t count;
  int moment[MOMENTS]; /* numbers of frames, -1: there is none; as of grasp_frames_end */
};

static inline float *grasp_frames_row(const struct grasp_frames *f, size_t frame, size_t body,
                                      int channel) {
  return f->frame[frame].value[body] + (size_t)channel * f->body[body].points;
}

#endif
