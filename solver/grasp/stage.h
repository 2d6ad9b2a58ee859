/* The stages of a grasp: their order, pace and steps. */
#ifndef PNEULAB_GRASP_STAGE_H
#define PNEULAB_GRASP_STAGE_H

#include "solver/grasp/finger.h"

/* What the body and the object go through in one stage. */
struct stage {
  enum grasp_stage kind;
  int records;
  double full;    /* longest step, part of the stage */
  double seconds; /* that it takes at its rate */
};

/* The stages of the finger's grasp in their order; returns their number. */
int stages_plan(const struct finger *finger, struct stage out[STAGE_COUNT]);

/* Gives a pull along legs the pace and the longest step of the leg that the part `along` is on. */
void stage_enter_leg(struct stage *stage, const struct finger *finger, double along);

#endif
