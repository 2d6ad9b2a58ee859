/* Two legs that stick out of a bar side by side, as a U: bodies that touch themselves where no gap
 * of the mesh needs to say so. Shear modulus 1 Pa, legs 1 m thick and 8 m long from x = 1 m on;
 * nothing moves along z at z = 0. */
#ifndef PNEULAB_TESTS_PHYSICS_LEGS_H
#define PNEULAB_TESTS_PHYSICS_LEGS_H

#include "solver/fe/path.h"

struct legs_shape {
  bool half;    /* the leg at y > 0 and its half of the bar */
  bool facing;  /* the mesh lists the faces that look at each other across the gap */
  double gap;   /* between the legs, m */
  int along;    /* elements along a leg; one through its thickness for every 8 of them */
  double upper; /* dead traction on the outer face of the leg at y > 0, towards the other, Pa */
  double lower; /* the same of the leg at y < 0 */
};

struct legs {
  struct legs_shape shape;
  struct mesh mesh;
  struct fe_model *model;
  struct equilibrium *solver;
  struct fe_state state;
};

/* Builds the body and loads it step by step; fails the test when that does not succeed. */
void legs_load(struct legs *legs, const struct legs_shape *shape);
void legs_close(struct legs *legs);

/* Displacement of the middle of the end of the leg at y > 0 along `axis`, m. */
double legs_tip(const struct legs *legs, int axis);
/* The same of the other leg. */
double legs_lower_tip(const struct legs *legs, int axis);

#endif
