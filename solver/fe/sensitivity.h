/* Derivatives of a converged state to dimensions and coefficients, from one factorisation.
 *
 * A state in equilibrium satisfies R(u, theta) = 0. A quantity m(u, theta) then changes with the
 * parameter theta by (adjoint method, the tangent K being symmetric)
 *   dm/dtheta = m,theta - z . R,theta,   K z = m,u.
 * m,theta and R,theta are differences between two variants of the body at the same u. The element
 * pressures are condensed; contact multipliers follow the tractions (contact_follow), so that the
 * derivatives are those of the settled contact. */
#ifndef PNEULAB_FE_SENSITIVITY_H
#define PNEULAB_FE_SENSITIVITY_H

#include "solver/fe/equilibrium.h"

/* The same body with other dimensions or coefficients: the mesh keeps its topology. */
struct variant {
  const double *x;                  /* node_count x 3, m */
  double gap_width, wall_thickness; /* as in struct mesh */
  const struct material_spec *material;
};

struct sensitivity {
  struct fe_model *model; /* of the variant that was placed last */
  struct equilibrium *solver;
  struct fe_state state;   /* linearised about */
  struct fe_load load;     /* of that state */
  struct mesh mesh;        /* shares all but x with the mesh it was created from */
  struct variant original; /* the body itself */
  double *x;               /* of the original */
  double gravity[3];
  double stiffness, smoothing; /* of the contact of the original */
  double length;               /* extent of the body, m */
  double cap;                  /* stiffness of closed contact relative to its penalty */
  double doubt;                /* of the last linearisation: see there */
  double *vector;              /* 2 x dof_count */
};

/* Prepares for states of `model`, with a model of its own that has the same mesh, material, contact
 * and planes, under gravity (m/s2). The given one must outlive the result, which the caller owns.
 * STATUS_OK or the failures of model_create. */
enum status sensitivity_create(const struct fe_model *model, const double gravity[3],
                               struct sensitivity **out, struct error *error);
void sensitivity_destroy(struct sensitivity *s);

/* Factorises the tangent at a converged state, having brought a copy of it (s->state) closer to
 * equilibrium than the load path needs. The body is then the original. Where multipliers creep on
 * without end, s->doubt is the relative change of the body's response between soft and rigid
 * contact, else 0. STATUS_OK; the failures of equilibrium_solve; or DIVERGED when the doubt is too
 * great. */
enum status sensitivity_linearise(struct sensitivity *s, const struct fe_state *state,
                                  const struct fe_load *load);

/* z = K^-1 gradient, both dof_count; they may be the same array. */
void sensitivity_adjoint(struct sensitivity *s, const double *gradient, double *z);

/* Gives s->model the nodes and the material of a variant; the state stays. STATUS_GEOMETRY when
 * an element of it is turned inside out. */
enum status sensitivity_place(struct sensitivity *s, const struct variant *variant);

/* Residual of the variant in place at s->state into s->model->residual: only differences between
 * variants mean something. STATUS_OK or INVERTED. */
enum status sensitivity_residual(struct sensitivity *s);

#endif
