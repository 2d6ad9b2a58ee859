/* Equilibrium of a body of revolution under a pressure p in its cavity, an axial force F on the
 * upper plate, and contact of its surfaces: states and paths.
 *
 * Total potential W(u) - p V(u) - F h. V is the volume of the cavity, integral of pi r^2 dz along
 * the inner edges; h is the elongation, the motion of the upper plate, an unknown like the others.
 * F > 0 pulls longer, p > 0 inflates. SI units throughout. */
#ifndef PNEULAB_AXI_MODEL_H
#define PNEULAB_AXI_MODEL_H

#include "solver/axi/contact.h"
#include "solver/axi/continuation.h"
#include "solver/axi/element.h"

struct axi_model;
struct axi_skin;

struct axi_model_options {
  bool contact; /* of inner edges with inner ones, outer with outer ones, and the axis */
  double contact_stiffness; /* Pa/m; 0: chosen from the stiffness of the surface's elements */
  double contact_offset;    /* thickness at which touching begins, m; 0: from the element size */
  double skin; /* thickness of a skin that bends on all surfaces (solver/axi/skin.h), m; 0: none */
  int row_nodes; /* of a shell (solver/axi/shell.h): nodes of a row through the wall, whose middle
                  * one is held and tied for it, and does not touch; 0: a solid */
};

/* Checks the mesh and numbers the unknowns. `mesh` must outlive the model; options NULL: no
 * contact. On success the caller owns *out (axi_model_destroy). Returns STATUS_GEOMETRY for
 * elements turned inside out or of negative radius and rows that are not straight, INVALID for ties
 * that do not end in a free or fixed node and for a shell with contact, NO_MEMORY. */
enum status axi_model_create(const struct axi_mesh *mesh, const struct axi_model_options *options,
                             struct axi_model **out, struct error *error);
void axi_model_destroy(struct axi_model *model);

const struct axi_mesh *axi_model_mesh(const struct axi_model *model);
/* Of an element, for strains and second variations. Owned by the model. */
const struct axi_geometry *axi_model_geometry(const struct axi_model *model, int element);
/* Number of unknowns; with a plate or nodes ahead the last one is h. */
int axi_model_size(const struct axi_model *model);
bool axi_model_has_elongation(const struct axi_model *model);
/* Unknown of component i of a node, -1 where it is fixed (or given by h alone). */
int axi_model_equation(const struct axi_model *model, int node, int component);
/* Displacements u[2 node + i] of the unknowns x, and back (what ties hide is dropped). */
void axi_model_expand(const struct axi_model *model, const double *x, double *u);
void axi_model_gather(const struct axi_model *model, const double *u, double *x);
/* Node coordinates 2 node + i of an element or edge: u of its nodes. */
void axi_element_displacements(const struct axi_mesh *mesh, int element, const double *u,
                               double local[AXI_DOFS]);

/* Contact of the surfaces, with what touched in the last evaluation (a state's, during a visit);
 * NULL for a model without contact. Owned by the model. */
struct axi_contact *axi_model_contact(const struct axi_model *model);

/* The skin, NULL without. Owned by the model. */
const struct axi_skin *axi_model_skin(const struct axi_model *model);

struct axi_load {
  double pressure;   /* Pa */
  double force;      /* N, where h is free */
  double elongation; /* m, where h is held */
};

/* Loads linear in lambda: from + lambda (to - from). */
struct axi_ramp {
  struct axi_load from, to;
  bool held; /* h is prescribed, the force is its reaction; else the force is given */
};

/* A state in equilibrium. */
struct axi_state {
  double *x; /* unknowns */
  double *u; /* 2 node + i, m */
  double lambda;
  double pressure, force, elongation; /* Pa, N (applied or reaction), m */
  double volume;                      /* V, m3 */
  double energy;                      /* W of the body and its skin without contact, J */
  double contact_energy;              /* J */
  double contact_overlap;             /* deepest penetration, m; 0 where nothing touches */
  bool touching;
  int negative_free; /* negative pivots at fixed pressure and force: 0 is stable under load */
  int negative_held; /* at fixed pressure and elongation: 0 is stable in length control; equal to
                      * negative_free without an elongation */
  double stiffness;  /* dF/dh at fixed pressure, N/m; NaN without an elongation */
};

/* The undeformed state. The caller owns it (axi_state_destroy). STATUS_NO_MEMORY. */
enum status axi_state_create(const struct axi_model *model, struct axi_state *state,
                             struct error *error);
void axi_state_destroy(struct axi_state *state);
/* Both of the same model. */
void axi_state_copy(const struct axi_model *model, const struct axi_state *from,
                    struct axi_state *to);

/* Options whose lengths are those of the mesh: see continuation_defaults. Deadline and cancellation
 * are fields of theirs. */
struct continuation_options axi_defaults(const struct axi_model *model);

/* Equilibrium at a fixed load (h prescribed if `held`) by Newton's method with line search, from
 * state->x, which may be any guess (an inverted shape, say); where h is held, it is brought from
 * the guess's own to the load's, in several steps when one fails. Fills the state but for lambda.
 * Returns as continuation_correct; STATUS_INVALID when an elongation is held that the mesh does not
 * have. */
enum status axi_equilibrium(struct axi_model *model, const struct axi_load *load, bool held,
                            const struct continuation_options *options, struct axi_state *state,
                            int *iterations, struct error *error);

/* Sees every state of a path; `point` tells events and rates. False ends the path. */
typedef bool axi_visit(void *context, const struct axi_state *state,
                       const struct continuation_point *point);

/* Follows the equilibrium path of a ramp from state->x at state->lambda in the direction of rising
 * (1) or falling (-1) lambda, or along `along` (see continuation_follow), until the visitor ends
 * it; the state receives the last one. Targets and watches of the options hold; the watch context
 * is the caller's. Returns as continuation_follow. */
enum status axi_follow(struct axi_model *model, const struct axi_ramp *ramp,
                       const struct continuation_options *options, int direction,
                       const double *along, axi_visit *visit, void *visit_context,
                       struct axi_state *state, struct error *error);

/* Fills everything of the state but x, lambda and the load (pressure, and force or elongation) by
 * an evaluation and a factorisation at state->x: for states made elsewhere. *residual (may be NULL)
 * receives the largest nodal force out of balance, N. */
enum status axi_assess(struct axi_model *model, bool held, struct axi_state *state,
                       double *residual, struct error *error);

/* Potential of the loads and its derivatives, for tests and extensions: residual[size] at fixed
 * pressure and force, and product = tangent * direction (both may be NULL). STATUS_INVERTED. */
enum status axi_evaluate(struct axi_model *model, const double *x, const struct axi_load *load,
                         double *potential, double *residual, const double *direction,
                         double *product, struct error *error);

#endif
