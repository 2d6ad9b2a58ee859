/* Corotational retraction: applies a linear displacement increment with finite rotations.
 *
 * A long flexible body turns its tip far in one Newton step; adding the linear increment would
 * stretch it by the square of that turn. Per axial section the increment is split into the
 * section's rigid rotation, the axial stretch between neighbouring section centres, and a local
 * remainder; the body is then rebuilt from the base outwards with finite rotations (exponential
 * map). For a small increment the result equals plain addition to first order, so Newton's
 * method stays quadratic. */
#ifndef PNEULAB_FE_RETRACTION_H
#define PNEULAB_FE_RETRACTION_H

#include "solver/mesh/mesh.h"

struct retraction;

/* Prepares for a mesh, which must outlive it. NULL when memory runs out. A mesh without
 * sections is retracted by plain addition. The caller owns the result. */
struct retraction *retraction_create(const struct mesh *mesh);
void retraction_destroy(struct retraction *retraction);

/* u <- u (+) increment, both node_count x 3 in m. */
void retraction_apply(struct retraction *retraction, double *u, const double *increment);

/* Rotation matrix r[9] and centre c[3] (m) of section s in state u: the rotation that carries
 * the bottom layer's reference positions best to the current ones. Sections of a half model
 * turn about y only. */
void retraction_frame(const struct retraction *retraction, const double *u, int section,
                      double r[9], double c[3]);

#endif
