/* A slender strip of length 1 along x, clamped at x = 0 so that its section may contract. */
#ifndef PNEULAB_VERIFY_STRIP_H
#define PNEULAB_VERIFY_STRIP_H

#include "solver/mesh/mesh.h"

/* Square section of edge `height`, `cells` elements along it, with axial sections so that the
 * retraction works. plane_strain holds every y, else only those of y = 0. mesh_release it also
 * after a failure: STATUS_NO_MEMORY. */
enum status strip_build(double height, int cells, bool plane_strain, struct mesh *mesh);

#endif
