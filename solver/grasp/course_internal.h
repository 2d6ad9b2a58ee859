/* What the parts of the course of a grasp share. */
#ifndef PNEULAB_GRASP_COURSE_INTERNAL_H
#define PNEULAB_GRASP_COURSE_INTERNAL_H

#include "solver/grasp/course.h"
#include "solver/grasp/guess.h"
#include "solver/grasp/stage.h"

struct course {
  struct finger *f;
  const struct course_visit *visit;
  struct course_report *report;
  struct error *error;
  struct stage stage;
  double along;        /* of the last converged state */
  double step;         /* part of the stage */
  double pulled;       /* part of the pull that has passed when the release begins */
  double time;         /* s */
  double pace;         /* of the nodes in the last step, rms, m for the whole stage */
  bool leaps;          /* a step over a place without equilibrium is tried */
  int steps, jumps;    /* of the stage */
  double stages;       /* number of stages that have passed */
  double moving;       /* of these in motion */
  bool touched;        /* in the pull, and not free since */
  int unrest;          /* carryings since a step in equilibrium that was not short */
  int short_steps;     /* in equilibrium, since one that was not */
  bool afoot;          /* the state moves */
  enum status failure; /* of the last attempt */
  struct guess guess;  /* in the pull */
};

/* Load at a part of the stage. */
struct fe_load course_load_at(const struct course *course, double along);

/* Leads the object to where it is then, or puts on a free one what draws on it. */
void course_place_object(struct course *course, double along);

/* With a verbose solver: a line of the ledger and one of what was spent. */
void course_tell_energy(const struct course *course);

/* Follows the motion to `target`, and on until the body rests or the object has left; where the
 * body has hardly rested of late it is left afoot. Returns as dynamics_carry. */
enum status course_carry(struct course *course, double target);

#endif
