/* Mass of a body, and what inertia and viscosity add to the equilibrium of one step in time.
 *
 * The mass matrix is the consistent one, int rho N_a N_b dV in the reference body: it never
 * changes, and for the same weight in all three directions it is kept once an element. A method of
 * the Newmark family turns the balance of momentum at the end of a step into r(u) + M (c (u - u0) +
 * b) + f(C(u)) = 0 with r the residual of the body at rest, u0 the displacements at the start of
 * the step, c and b of the method, and f the forces of a viscous stress (struct element_viscosity).
 * All of it has a potential, so that the tangent stays symmetric. */
#ifndef PNEULAB_FE_INERTIA_H
#define PNEULAB_FE_INERTIA_H

#include "solver/fe/model.h"

enum { INERTIA_PACKED = HEX27_NODES * (HEX27_NODES + 1) / 2 };

struct inertia {
  const struct mesh *mesh;
  double (*mass)[INERTIA_PACKED];      /* per element: upper triangle by rows, kg */
  double total;                        /* mass of the (modelled) body, kg */
  double *start;                       /* node_count x 3: u0, m */
  double *offset;                      /* node_count x 3: b, m/s2 */
  double stiffness;                    /* c, 1/s2 */
  bool viscous;                        /* the viscosity counts */
  struct element_viscosity *viscosity; /* element_count */
};

/* The mass of a model whose material has a density, which must outlive it; nothing is added to
 * equilibrium until c, b, u0 and the viscosity are set. STATUS_INVALID for a body without density,
 * NO_MEMORY. The caller owns *out (inertia_destroy). */
enum status inertia_create(const struct fe_model *model, struct inertia **out, struct error *error);
void inertia_destroy(struct inertia *inertia);

/* y = M x for vectors node_count x 3. */
void inertia_multiply(const struct inertia *inertia, const double *x, double *y);

/* v . M v / 2 for a velocity (node_count x 3, m/s), J of the modelled body. */
double inertia_kinetic(const struct inertia *inertia, const double *velocity);

/* Adds c M to the packed tangents of the elements, which are set to zero first: with the cliques of
 * the model they are then the mass alone, for model_factor. */
void inertia_only(const struct inertia *inertia, struct fe_model *model);

/* Sets the history of C over the step to those of the displacements: history = now C(now) + before
 * C(before) (`before` may be NULL), and the stiffness (Pa). */
void inertia_set_viscosity(struct inertia *inertia, const struct fe_model *model, double stiffness,
                           double share_now, const double *now, double share_before,
                           const double *before);

/* What model_evaluate adds for element e at displacements u (node_count x 3): to its residual
 * (index 27 i + a, N) and, unless NULL, its packed tangent. */
void inertia_add(const struct inertia *inertia, const struct mesh *mesh, int e, const double *u,
                 double residual[ELEMENT_DOFS], double *packed);

/* The viscosity of element e, or NULL. */
const struct element_viscosity *inertia_viscosity(const struct inertia *inertia, int e);

#endif
