/* What the fingers of a gripper have done, together: figures for the result. */
#ifndef PNEULAB_GRASP_GRIPPER_H
#define PNEULAB_GRASP_GRIPPER_H

#include "solver/grasp/course.h"

/* One finger that was solved, and how many others see the object as it does. */
struct gripper_finger {
  bool solved; /* else it is like the finger `like` */
  int like;
  struct course_report report;
  double rotation[3][3], place[3]; /* its frame in that of the gripper, place in m */
  bool half;                       /* half of it is computed */
  int unknowns, elements;
  struct fe_statistics statistics;
};

struct gripper {
  const struct job_spec *spec;
  int count, solved; /* fingers; those that are solved */
  struct gripper_finger finger[GRASP_FINGERS_MAX];
  struct grasp_series sum;
};

/* Finds which fingers are alike, and how they lie. */
void gripper_init(struct gripper *gripper, const struct job_spec *spec);
void gripper_release(struct gripper *gripper);

/* After all have been followed: fills `sum`. STATUS_OK or NO_MEMORY. */
enum status gripper_sum(struct gripper *gripper);

/* The metrics, a new reference, NULL when memory runs out. */
json_t *gripper_metrics(const struct gripper *gripper);

/* "released": the object came free in the pull; "fell": when it was let go; "held": it did neither;
 * "never touched": there was no contact. */
const char *gripper_outcome(const struct gripper *gripper);

#endif
