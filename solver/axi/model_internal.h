/* Inside of a model: numbering of the unknowns, cliques of the tangent, factors. */
#ifndef PNEULAB_AXI_MODEL_INTERNAL_H
#define PNEULAB_AXI_MODEL_INTERNAL_H

#include "solver/axi/model.h"
#include "solver/axi/shell.h"
#include "solver/axi/skin.h"
#include "solver/fe/ldlt.h"

/* A displacement component is x[base] (0 for -1) + plus h. */
struct axi_place {
  int base;
  int plus; /* 0 or 1; of an edge one period away also -1 or 2 */
};

enum { CLIQUE_LOCALS = AXI_DOFS, CLIQUE_DOFS = AXI_DOFS + 1 };

/* Unknowns that a small matrix couples: that of an element, of an edge under pressure, of two edges
 * in contact. */
struct axi_clique {
  int locals; /* displacement components of its nodes */
  struct axi_place place[CLIQUE_LOCALS];
  int count; /* of different unknowns, or of components when plain */
  int dof[CLIQUE_DOFS];
  signed char at[CLIQUE_LOCALS]; /* place of the component's base in dof, -1 */
  signed char elongation;        /* place of h in dof, -1 */
  bool plain;                    /* one unknown or none a component, no two the same, no h */
  double *value;                 /* packed upper triangle over dof; of the model's rooms */
};

enum { CONTACT_CLIQUE = (TOUCH_DOFS + 1) * (TOUCH_DOFS + 2) / 2 };

/* Edges that may touch, see struct axi_touch; `next` is the next one of the same slave, -1. */
struct axi_partners {
  int slave, master, shift, next;
};

struct axi_model {
  const struct axi_mesh *mesh;
  struct axi_model_options options;
  struct axi_geometry *geometry; /* of the elements */
  struct axi_shell *shell;       /* NULL: a solid */
  struct axi_place *place;       /* 2 node + component; of a shell, 3 row + component */
  int size;                      /* unknowns; h is the last one when `elongation` */
  bool elongation;
  int *node_of;   /* size: for the ordering */
  double *weight; /* size: metric whose square is the mean square displacement of the body */
  double length;  /* largest extent of the meridian, m */
  struct axi_skin skin;
  int fixed_count;  /* cliques of elements, of inner edges, of the skin's turnings */
  int clique_count; /* and of partners in contact behind them */
  int clique_capacity;
  struct axi_clique *clique;
  const double **value;          /* clique_count; NULL where partners do not touch */
  double *room;                  /* of the fixed cliques' values */
  struct axi_contact *contact;   /* NULL without */
  struct axi_partners *partners; /* clique_count - fixed_count */
  int *first_partners;           /* of every edge, -1 */
  double *contact_room;          /* CONTACT_CLIQUE doubles for each of the partners */
  struct ldlt *factor[2];        /* with h free, with h held; made when first needed */
  /* Of the last evaluation: */
  double *u;               /* 2 node + i */
  double *q;               /* 3 row + i, of a shell */
  double *force;           /* size: dW/dx */
  double *volume_gradient; /* size: dV/dx */
  double *column;          /* size: scratch */
  double volume, energy, contact_energy;
};

/* Displacement components of `count` nodes in a clique's order. */
void axi_clique_init(const struct axi_model *model, const int *node, int count,
                     struct axi_clique *clique);
/* The rest of a clique from its `locals` and `place`. */
void axi_clique_join(const struct axi_model *model, struct axi_clique *clique);

/* What component 0 or 1 of a node is; of a shell, of its row's middle node. */
struct axi_place *axi_model_place(const struct axi_model *model, int node, int component);

/* Numbers a component of a node and of what it is tied to. INVALID as axi_model_create. */
enum status axi_model_number(struct axi_model *model, int node, int component, struct error *error);

/* The same for all unknowns of a shell; the clique of the three rows from `row` on; the unknowns of
 * a row at x, and x from the displacements u of the nodes. */
enum status axi_model_number_rows(struct axi_model *model, struct error *error);
void axi_clique_init_rows(const struct axi_model *model, int row, struct axi_clique *clique);
void axi_model_row(const struct axi_model *model, const double *x, int row, double q[SHELL_ROW]);
void axi_model_gather_rows(const struct axi_model *model, const double *u, double *x);

/* Adds local forces to the forces on the unknowns. */
void axi_clique_add_force(const struct axi_model *model, const struct axi_clique *clique,
                          const double *local, double *force);

/* Adds a matrix of the components, packed by rows, to the clique's values. */
void axi_clique_add(struct axi_clique *clique, const double *local);

/* Adds the contact to energy, forces and, with `tangent`, to the cliques: partners that were never
 * seen join them, and the factors are made anew. STATUS_NO_MEMORY. */
enum status axi_model_add_contact(struct axi_model *model, const double *x, bool tangent,
                                  struct error *error);

/* W, V, dW/dx and dV/dx at x, W with the contact; with `tangent` also the cliques of d2W/dx2 -
 * pressure d2V/dx2. STATUS_INVERTED. */
enum status axi_model_evaluate(struct axi_model *model, const double *x, double pressure,
                               bool tangent, struct error *error);

/* Factorises the last tangent with h free or held; *negative receives its negative pivots.
 * DIVERGED when singular, NO_MEMORY. */
enum status axi_model_factor(struct axi_model *model, bool held, int *negative,
                             struct error *error);

/* product = tangent x v of the last tangent, over all unknowns. */
void axi_model_product(const struct axi_model *model, const double *v, double *product);

#endif
