/* Second variation of the total potential W - p V - F h about an axisymmetric equilibrium, for
 * perturbations that wind n times around the axis:
 *   (u_r cos n t, u_z cos n t, u_t sin n t),  t the angle around the axis.
 * Different n do not couple, so that each has its own form on the meridian mesh (Q2, three
 * unknowns a node). An equilibrium is stable where every form is positive; a negative pivot says
 * that a deformation with that n lets the body give way. n = 0 is without torsion.
 *
 * The form is that of the mixed element in three dimensions: the pressure follows from the
 * element's projection of kappa (J - 1) onto linear functions of the element's coordinates, times
 * cos n t for the perturbation, and is condensed. Pressure acts on the deformed inner surface
 * (follower), which has a potential because the volume is closed by plates, by the axis or by the
 * next pair of an endless row.
 *
 * A skin bends along the meridian alone. Points in contact keep, at every angle, the stiffness that
 * they have in the meridian; that the surfaces slide around the axis on each other, and turn, is
 * left out, so that folds that touch are known a little worse than the rest. */
#ifndef PNEULAB_AXI_HARMONIC_H
#define PNEULAB_AXI_HARMONIC_H

#include "solver/axi/contact.h"
#include "solver/axi/skin.h"

enum { HARMONIC_PARTS = 3, HARMONIC_TOUCH_NODES = 6 };

/* A spring on a displacement that is a sum of weight . (u_r, u_z) over nodes of a circle, constant
 * around the axis: a weak one takes a free motion away. */
struct harmonic_touch {
  int count;
  int node[HARMONIC_TOUCH_NODES];
  double weight[HARMONIC_TOUCH_NODES][2];
  double stiffness; /* of the whole ring, N/m: second derivative of the energy by the sum */
};

/* What the upper plate (AXI_PLATE nodes that are held radially) may do for n = 1. For n = 0 it
 * moves along the axis, for n >= 2 it cannot move. */
enum harmonic_plate {
  HARMONIC_GUIDED, /* nothing */
  HARMONIC_SWAYING /* shift sideways without tilting */
};

struct harmonic_state {
  const double *u; /* node_count x 2, m: the equilibrium */
  double pressure; /* Pa, of the cavity; the axial force is dead and does not enter */
  const struct harmonic_touch *touch;
  int touch_count;
  struct axi_contact *contact; /* of the surfaces, NULL without; evaluated anew */
  double elongation;           /* h of the state, for contact with the next period */
  const struct axi_skin *skin; /* NULL without */
};

struct harmonic;

/* Prepares the forms of a mesh. Nodes on the axis keep the perturbation smooth: only u_z for
 * n = 0, only a common shift for n = 1, nothing for n >= 2. Where u_r is held or tied, so is u_t.
 * The mesh is borrowed and must outlive *out, which the caller owns. STATUS_GEOMETRY for elements
 * turned inside out, STATUS_NO_MEMORY. */
enum status harmonic_create(const struct axi_mesh *mesh, enum harmonic_plate plate,
                            struct harmonic **out, struct error *error);
void harmonic_destroy(struct harmonic *harmonic);

/* count[n - first] = number of independent deformations with n waves, 0 <= first <= n <= last, that
 * lower the potential: the negative pivots of the form. STATUS_INVERTED when a point of the base
 * state is turned inside out, STATUS_NO_MEMORY. */
enum status harmonic_negative(struct harmonic *harmonic, const struct harmonic_state *state,
                              int first, int last, int *count, struct error *error);

/* The deformation of the lowest stiffness per mass: mode[node_count x 3] = (u_r, u_z, u_t) with
 * the largest component 1, and *stiffness = v K v in N/m, negative where the state is unstable.
 * Errors as above, and STATUS_DIVERGED when the iteration does not settle. */
enum status harmonic_mode(struct harmonic *harmonic, const struct harmonic_state *state, int n,
                          double *mode, double *stiffness, struct error *error);

/* *value = v K v (J per m2) of any perturbation v[node_count x 3], whatever the plates and ties
 * hold, without a change of h: twice the second-order change of the potential. STATUS_INVERTED,
 * STATUS_NO_MEMORY. */
enum status harmonic_quadratic(const struct harmonic *harmonic, const struct harmonic_state *state,
                               int n, const double *v, double *value, struct error *error);

#endif
