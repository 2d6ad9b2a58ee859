/* How well a body fits the object that it touches. */
#ifndef PNEULAB_GRASP_CONFORMITY_H
#define PNEULAB_GRASP_CONFORMITY_H

#include "solver/fe/obstacle.h"
#include "solver/job/spec.h"

struct conformity {
  /* (int p dA)^2 / (A int p^2 dA) over the area A that touches, p per undeformed area: 1 where the
   * pressure is even, 0 without contact. */
  double uniformity;
  /* Angle by which the contact normal turns along the body: sum over the sections that touch, from
   * each to the next, of the angle between their mean normals, rad. Passes 180 and 360 degrees. */
  double wrap;
  /* 1 - int |ka - ko| dF / int max(|ka|, |ko|) dF over the normal force F, with the curvature ka of
   * the bottom centreline towards the object and that of the object ko along it: 1 where the body
   * takes the object's shape. 0 without contact. */
  double match;
  double suction; /* of the suckers whose rim touches all around, N, whole body */
  int sealed;     /* their number */
};

/* Whether the rim of a sucker touches the object all around, as last evaluated. */
bool conformity_sealed(const struct fe_model *model, const struct obstacle *object,
                       const struct sucker_spec *sucker);

/* Measures the state u (node_count x 3) against the object `index`, as last evaluated. spec is that
 * of the body, with its suckers. STATUS_OK or NO_MEMORY. */
enum status conformity_measure(const struct fe_model *model, const struct job_spec *spec, int index,
                               const double *u, struct conformity *conformity);

#endif
