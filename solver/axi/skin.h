/* A skin on the surfaces of a body of revolution that bends, but does not stretch: it keeps the
 * folds of a soft surface wider than the elements.
 *
 * A rubber surface that is compressed by more than about a third creases, at any wave length (Biot
 * 1963; Hong, Zhao, Suo 2009): finite elements then fold edge by edge, each mesh in its own way.
 * The bending stiffness B = mu l^3/3 per width, that of an incompressible layer of thickness l,
 * gives the folds a width of a few l. Its energy is that of an elastic chain (Bergou et al. 2008):
 * over the turnings theta inside the edges and from edge to edge along the meridian, with w = 2 pi
 * r, sum w B/(2 s) (q - q0)^2,   q = 2 tan(theta/2), s the undeformed length that turns (a quarter
 * of it from edge to edge, which should not turn); it grows beyond bounds as an edge folds back. */
#ifndef PNEULAB_AXI_SKIN_H
#define PNEULAB_AXI_SKIN_H

#include "solver/axi/element.h"

enum {
  SKIN_NODES = 2 * AXI_EDGE_NODES,
  SKIN_DOFS = 2 * SKIN_NODES,
  SKIN_PACKED = SKIN_DOFS * (SKIN_DOFS + 1) / 2
};

/* The turning from the tangent sum from[a] x[a] to the tangent sum to[a] x[a]. */
struct axi_turning {
  int count; /* nodes: of one edge, or of two that follow one another */
  int node[SKIN_NODES];
  double from[SKIN_NODES], to[SKIN_NODES];
  double stiffness; /* w B / s, J */
  double rest;      /* q0 */
};

struct axi_skin {
  int count;
  struct axi_turning *turning;
};

/* The skin of thickness `thickness` (m, > 0) on all edges of the mesh. STATUS_NO_MEMORY, or INVALID
 * for an edge that belongs to no element. */
enum status axi_skin_create(const struct axi_mesh *mesh, double thickness, struct axi_skin *skin,
                            struct error *error);
void axi_skin_release(struct axi_skin *skin);

/* Energy *energy (J), force[2 a + i] (N) and, unless NULL, tangent (N/m, upper triangle by rows, of
 * 2 count components) at the node positions x. False when an edge has folded back. */
bool axi_skin_evaluate(const struct axi_turning *turning, double x[SKIN_NODES][2], double *energy,
                       double force[SKIN_DOFS], double *tangent);

#endif
