/* The course of a grasp for one finger: its stages one after the other.
 *
 *   gravity    the weight comes on, the object stands where the approach begins
 *   approach   the object moves in a straight line to its position
 *   inflation  the pressure rises
 *   suction    cups whose rims are closed are evacuated
 *   letting go what holds a free object is taken away: the finger bears it alone, or it falls
 *   pull       the object moves along the pull, or a force draws on it, at full pressure
 *   release    the pressure falls to 0
 *
 * Each goes in steps of equilibrium that shrink where it is not found and grow where that was easy.
 * Where the steps get too short the body jumps: its motion is followed (solver/fe/dynamics_carry.h)
 * while the stage goes on at its rate, until the body rests; then on in equilibrium. Where it
 * hardly rests any more it is followed over several steps at a time, and a step that fails is not
 * tried shorter. A pull ends early some way after the object came free, the course when a free
 * object has left the finger. Every stage has limits of steps and of carryings. */
#ifndef PNEULAB_GRASP_COURSE_H
#define PNEULAB_GRASP_COURSE_H

#include "solver/grasp/finger.h"

/* Called for every state of the series, with the finger in it. A status other than OK ends the
 * course. */
struct course_visit {
  enum status (*visit)(void *context, const struct finger *finger,
                       const struct grasp_sample *sample);
  void *context;
};

/* How a course went. */
struct course_report {
  struct grasp_series series; /* owned: course_report_release */
  enum grasp_stage stage;     /* the last one that was begun */
  double along;               /* part of it that has passed */
  bool came_free;             /* contact was lost in the pull */
  double free_at;             /* part of the pull then */
  double in_motion;           /* part of all stages that was followed in motion, 0 to 1 */
  int carried;                /* jumps that were followed */
  double energy_error;        /* |what the ledger of energies misses| by the works done, 0 to 1 */
};

/* Follows the course from the undeformed finger. Returns STATUS_OK when it came to its end, which
 * may be that the object came free; else the reason with *error saying how far it came:
 * STEP_MINIMUM, TIMEOUT, CANCELLED, NO_MEMORY. The report is filled in either case. */
enum status course_follow(struct finger *finger, const struct course_visit *visit,
                          struct course_report *report, struct error *error);

void course_report_release(struct course_report *report);

#endif
