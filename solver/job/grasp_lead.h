/* Where a pull leads the object of a grasp. */
#ifndef PNEULAB_JOB_GRASP_LEAD_H
#define PNEULAB_JOB_GRASP_LEAD_H

#include "solver/job/grasp.h"
#include "solver/rigid/pose.h"

struct grasp_lead {
  struct rigid_pose pose;
  double way, turned;  /* sums of the lengths of all shifts and of all angles so far, m, rad */
  double direction[3]; /* of the shift, and axis of the turn, of the leg that it is on: each of */
  double axis[3];      /* length 1, or 0 where there is none; at the end of a leg those of it */
};

/* The object at its position, shifted by `away` (m) and led along the pull up to the part `along`
 * of it, 0 to 1; every leg is the same part. A pull by a force leads nowhere: only its direction is
 * told. */
void grasp_lead_at(const struct grasp_spec *spec, const double away[3], double along,
                   struct grasp_lead *lead);

/* Number of the leg that the part `along` of a pull with legs belongs to. */
int grasp_lead_leg(const struct grasp_pull *pull, double along);

#endif
