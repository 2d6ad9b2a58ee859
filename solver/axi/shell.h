/* Shell of revolution on the mesh of a wall: nodes in rows through the wall, straight and of the
 * same number, move as a rigid row each (Reissner 1950; Ahmad, Irons, Zienkiewicz 1970, with
 * rotations of any size). A row has three unknowns, the displacement of its middle node and the
 * turn of the row:
 *   u_node = (q_r, q_z) + offset (R(q_turn) D - D),   D the unit vector along the row,
 * so that the displacements of all nodes, surfaces and volumes follow. R turns anticlockwise in the
 * (r, z) plane.
 *
 * The wall thins as the stress normal to it vanishes: at every point the stretch along the row is
 * the one of least energy. Two Gauss points along an element and two through each layer keep it
 * free of locking. Transverse shear is that of the material, without a correction factor. Nothing
 * of a solid is left out but what straight rows and the plane stress exclude: in a folded hinge,
 * as thick as its radius, just that is the error. */
#ifndef PNEULAB_AXI_SHELL_H
#define PNEULAB_AXI_SHELL_H

#include <stdbool.h>
#include "solver/axi/element.h"

enum {
  SHELL_ROW = 3,              /* unknowns of a row */
  SHELL_DOFS = 3 * SHELL_ROW, /* of the rows of an element or edge, in rising order */
  SHELL_PACKED = SHELL_DOFS * (SHELL_DOFS + 1) / 2
};

struct axi_shell;

/* Takes the nodes k row_nodes .. (k + 1) row_nodes - 1 of the mesh as row k; row_nodes is odd. The
 * mesh is borrowed and must outlive *out, which the caller owns. STATUS_GEOMETRY when rows are not
 * straight, elements do not connect three neighbouring rows or are turned inside out; NO_MEMORY. */
enum status axi_shell_create(const struct axi_mesh *mesh, int row_nodes, struct axi_shell **out,
                             struct error *error);
void axi_shell_destroy(struct axi_shell *shell);

/* Displacements u[2 node + i] of the nodes of a row, for all nodes of the mesh. */
void axi_shell_expand(const struct axi_shell *shell, int row, const double q[SHELL_ROW], double *u);
/* The unknowns of a row that come nearest to the displacements of its nodes. */
void axi_shell_gather(const struct axi_shell *shell, int row, const double *u, double q[SHELL_ROW]);

/* du/dq_2 of a node in the undeformed state, along r (direction 0) or z (1). */
double axi_shell_lever(const struct axi_shell *shell, int node, int direction);

/* The lowest of the three rows that an element or an inner edge connects. */
int axi_shell_element_row(const struct axi_shell *shell, int element);
int axi_shell_edge_row(const struct axi_shell *shell, int edge);

/* Energy (J), residual[3 a + i] = dW/dq and, unless NULL, tangent = d2W/dq2, the upper triangle by
 * rows, of an element. False when a point is turned inside out: nothing is then written. */
bool axi_shell_element(const struct axi_shell *shell, int element, const double q[SHELL_DOFS],
                       double *energy, double residual[SHELL_DOFS], double *tangent);

/* Share of an inner edge in the volume, as axi_edge_volume, by the unknowns of its rows. */
double axi_shell_volume(const struct axi_shell *shell, int edge, const double q[SHELL_DOFS],
                        double gradient[SHELL_DOFS], double second[SHELL_PACKED]);

#endif
