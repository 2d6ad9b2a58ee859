/* What solver/axi/harmonic*.c share. Forms of one element, one edge and one touching point:
 * unknowns in the order of the nodes, (u_r, u_z, u_t) each; matrices are full, row-major. */
#ifndef PNEULAB_AXI_HARMONIC_INTERNAL_H
#define PNEULAB_AXI_HARMONIC_INTERNAL_H

#include "solver/axi/element.h"
#include "solver/axi/harmonic.h"
#include "solver/fe/ldlt.h"

enum {
  HARMONIC_ELEMENT = HARMONIC_PARTS * AXI_NODES,
  HARMONIC_EDGE = HARMONIC_PARTS * AXI_EDGE_NODES,
  HARMONIC_TOUCH = HARMONIC_PARTS * HARMONIC_TOUCH_NODES
};

/* Second variation of the elastic energy of an element at the displacements u of all nodes. False
 * when a point is turned inside out. */
bool harmonic_element(const struct axi_mesh *mesh, const struct axi_geometry *geometry, int element,
                      const double *u, int n, double form[HARMONIC_ELEMENT * HARMONIC_ELEMENT]);

/* Second variation of -p V of an edge of the cavity. */
void harmonic_edge(const struct axi_mesh *mesh, int edge, const double *u, double pressure, int n,
                   double form[HARMONIC_EDGE * HARMONIC_EDGE]);

/* Second variation of the energy of a touching point: HARMONIC_PARTS x count unknowns. */
void harmonic_touch(const struct harmonic_touch *touch, int n, double *form);

/* Of a point in contact: (u_r, u_z, u_t) of the slave's nodes, then of the master's if there is
 * one. */
void harmonic_contact(const struct axi_touch *touch, int n, double *form);

/* Of a turning of the skin at the displacements u of all nodes: HARMONIC_PARTS x count unknowns.
 * False when an edge has folded back. */
bool harmonic_skin(const struct axi_mesh *mesh, const struct axi_turning *turning, const double *u,
                   int n, double *form);

/* A component of a node is at most the sum of two unknowns: that of its master and h. */
enum { HARMONIC_TERMS = 2, HARMONIC_KINDS = 3 };

struct harmonic_term {
  int dof[HARMONIC_TERMS]; /* -1: none */
  double factor[HARMONIC_TERMS];
};

/* The unknowns for n = 0, n = 1 or n >= 2, and the factorisation of the form. */
struct harmonic_system {
  int dof_count;
  int elongation;             /* the unknown h, -1 */
  struct harmonic_term *term; /* node_count x HARMONIC_PARTS */
  int *node_of;               /* dof -> node; common unknowns of the plate belong to one more */
  int clique_count;
  int *start, *dofs; /* as in ldlt_pattern */
  double *store;     /* the cliques' values */
  double **values;   /* clique_count, into store */
  double *mass;      /* dof_count, m3: volume lumped to the unknowns */
  struct ldlt *ldlt;
};

struct harmonic {
  const struct axi_mesh *mesh;
  enum harmonic_plate plate;
  struct axi_geometry *geometry; /* element_count */
  double *volume;                /* element_count x AXI_NODES: the nodes' shares, m3 */
  double small;                  /* radius of nodes on the axis, m */
  struct harmonic_system
      system[HARMONIC_KINDS]; /* without touching points; made when first needed */
};

/* The system for n >= 0: the one kept by h, or made into own[] (cleared at first) when there are
 * springs, skins or points in contact; contact is evaluated before. STATUS_NO_MEMORY. */
enum status harmonic_system_get(struct harmonic *h, const struct harmonic_state *state, int n,
                                struct harmonic_system own[HARMONIC_KINDS],
                                struct harmonic_system **out, struct error *error);

/* Factorises the form of n less shift times the mass; *negative receives the negative pivots, 0
 * without unknowns. STATUS_INVERTED. */
enum status harmonic_system_factor(const struct harmonic *h, struct harmonic_system *s,
                                   const struct harmonic_state *state, int n, double shift,
                                   int *negative, struct error *error);

/* *value = v K v over all components of the nodes; contact is evaluated before. STATUS_INVERTED. */
enum status harmonic_system_product(const struct harmonic *h, const struct harmonic_state *state,
                                    int n, const double *v, double *value, struct error *error);

void harmonic_systems_release(struct harmonic_system system[HARMONIC_KINDS]);

#endif
