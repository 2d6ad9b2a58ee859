/* A state of a grasp in numbers, and a series of them over the course of the grasp. */
#ifndef PNEULAB_GRASP_SAMPLE_H
#define PNEULAB_GRASP_SAMPLE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include "solver/base/error.h"

enum grasp_stage {
  STAGE_GRAVITY,
  STAGE_APPROACH,
  STAGE_INFLATION,
  STAGE_SUCTION,
  STAGE_LETTING_GO,
  STAGE_PULL,
  STAGE_RELEASE,
  STAGE_COUNT
};

/* What is known of a state, in SI, of whole fingers. Forces are on the object. */
enum grasp_number {
  GRASP_TIME,     /* s, since the course began; states at rest take no time of their own */
  GRASP_PRESSURE, /* Pa */
  GRASP_SHIFT,    /* way of the object from its position along the pull, or, of a free one, distance
                   * from where it was let go, m */
  GRASP_TURNED,   /* sum of the angles by which the pull has turned it, rad */
  GRASP_FORCE_X,  /* N */
  GRASP_FORCE_Y,
  GRASP_FORCE_Z,
  GRASP_MOMENT_X, /* about the origin of the object's frame, N m */
  GRASP_MOMENT_Y,
  GRASP_MOMENT_Z,
  GRASP_HOLD,       /* against the pull, or the weight: its direction times minus the force, N */
  GRASP_TWIST,      /* against the turn of the pull: its axis times minus the moment, N m */
  GRASP_NORMAL,     /* sum of the normal forces, N */
  GRASP_FRICTION,   /* sum of the friction forces, N */
  GRASP_AREA,       /* deformed, m2 */
  GRASP_PEAK,       /* largest contact pressure, Pa */
  GRASP_UNIFORMITY, /* mean pressure squared by mean square of the pressure, 0 to 1 */
  GRASP_SLIP,       /* share of the normal force where the body slips */
  GRASP_WRAP,       /* angle by which the contact normal turns along the body, rad */
  GRASP_MATCH,      /* of the curvatures of body and object where they touch, up to 1 */
  GRASP_SUCTION, /* of suckers that hold, N: up to the inflation what those with a closed rim would
                  */
  GRASP_RUBBED,  /* work of friction since the start, J */
  GRASP_BENDING, /* bending angle, rad */
  GRASP_NUMBERS
};

struct grasp_sample {
  enum grasp_stage stage;
  double along;  /* part of the stage that has passed, 0 to 1 */
  bool dynamic;  /* reached in motion */
  bool recorded; /* one of the steps that the job asks for */
  double value[GRASP_NUMBERS];
};

/* In the order of the course. Zero is an empty one. */
struct grasp_series {
  size_t count, room;
  struct grasp_sample *sample;
};

/* Appends a copy. STATUS_NO_MEMORY. */
enum status grasp_series_add(struct grasp_series *series, const struct grasp_sample *sample);
void grasp_series_release(struct grasp_series *series);

/* "pull". Static storage. */
const char *grasp_stage_word(enum grasp_stage stage);

/* The sample as an object of the result: numbers in the units of their keys. A new reference, NULL
 * when memory runs out. */
json_t *grasp_sample_object(const struct grasp_sample *sample);

/* One finger of a gripper: what it has seen, in its own frame, and how its frame lies. */
struct grasp_share {
  const struct grasp_series *series;
  double rotation[3][3]; /* from the finger's frame to the gripper's */
};

/* What all fingers do together, in the gripper's frame: forces and areas are summed, pressures and
 * angles the largest. There is a state wherever one of the fingers has one, up to where each of
 * them came; those of the others are interpolated. The caller releases *sum. STATUS_NO_MEMORY. */
enum status grasp_series_sum(const struct grasp_share *share, int count, struct grasp_series *sum);

#endif
