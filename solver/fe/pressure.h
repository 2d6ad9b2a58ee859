/* Follower pressure on 9-node faces. */
#ifndef PNEULAB_FE_PRESSURE_H
#define PNEULAB_FE_PRESSURE_H

#include "solver/fe/hex27.h"

enum { FACE_DOFS = 3 * QUAD9_NODES }; /* index 3 m + i */

/* Force of unit pressure on a face with current nodes x[9][3] (m): force[3 m + i] =
 * side int N_m (x,s x x,t)_i ds dt, m2, along the outward normal of the element (pressure acts
 * against it, so the residual gains +P force). Returns the face's share of the enclosed volume,
 * -1/3 int x . n da (m3), for a cavity whose solid side the element is. */
double pressure_face(const struct quad9_tables *tables, double x[QUAD9_NODES][3], int side,
                     double force[FACE_DOFS]);

/* Symmetric part of d force / d x, 27 x 27 row-major, m. On a closed surface, or one whose rim
 * is fixed or slides in planes of symmetry, the skew parts of neighbouring faces cancel and the
 * sum is the exact tangent (Bufler 1984). */
void pressure_face_tangent(const struct quad9_tables *tables, double x[QUAD9_NODES][3], int side,
                           double tangent[FACE_DOFS * FACE_DOFS]);

#endif
