/* Frictionless self-contact of a body of revolution: inner edges with inner ones, outer edges with
 * outer ones, with their images one period away, and every edge with the axis r = 0.
 *
 * Every edge is slave and master. At the Gauss points of the slave the signed distance g to the
 * closest master edge gives the potential sum w f phi(g), w = 2 pi r ds undeformed, so that the
 * traction t = -phi' per undeformed area is
 *   t = 0 (g >= delta),  eps (delta - g)^2 / (4 delta) (|g| < delta),  -eps g (g <= -delta);
 * forces and tangent are exact derivatives of it. The factor f is 1 but for points that are near
 * each other along the surface: they are neighbours and cannot be told from opponents. Penalty,
 * without multipliers: a state is a function of the displacements alone, as the continuation needs.
 */
#ifndef PNEULAB_AXI_CONTACT_H
#define PNEULAB_AXI_CONTACT_H

#include <stdbool.h>
#include "solver/axi/element.h"

enum {
  TOUCH_NODES = 2 * AXI_EDGE_NODES, /* slave, then master */
  TOUCH_DOFS = 2 * TOUCH_NODES,
  TOUCH_PACKED = TOUCH_DOFS * (TOUCH_DOFS + 1) / 2
};

struct axi_contact_edge {
  int node[AXI_EDGE_NODES];
  int before, behind;             /* neighbours on the chain, -1 */
  int chain;                      /* of edges that follow one another on one surface */
  double arc, length;             /* place of its start on the chain, undeformed, m */
  double weight[AXI_EDGE_POINTS]; /* 2 pi r ds at the Gauss points, m2 */
  double stiffness;               /* eps, Pa/m */
};

struct axi_contact_chain {
  bool inner;
  double length; /* m */
  int turn;      /* of a body that repeats along z: +1 when the way along the chain leads one period
                  * up, -1 down, else 0 */
};

/* A slave point under traction. */
struct axi_touch {
  int slave, master;        /* edges; master -1: the axis */
  int shift;                /* the master is this many periods higher than its nodes, -1, 0 or 1 */
  double gap;               /* m */
  double traction;          /* Pa, per undeformed area */
  double weight;            /* m2 */
  double stiffness;         /* second derivative of the potential by the gap, N/m */
  double force[TOUCH_DOFS]; /* d potential / d x, N: slave nodes, master nodes; the shift's part is
                             * the sum over the master's z */
  double packed[TOUCH_PACKED]; /* of a tangent: second derivatives, upper triangle by rows */
};

/* A slave point near a master edge; numbers as in struct axi_touch. */
struct axi_near {
  int slave, master, shift;
};

struct axi_contact_box;

struct axi_contact {
  const struct axi_mesh *mesh;
  int edge_count, chain_count;
  struct axi_contact_edge *edge;
  struct axi_contact_chain *chain;
  bool periodic;
  double period;         /* undeformed, m */
  double wall;           /* twice the area of the meridian over the length of its surfaces, m */
  double offset;         /* delta, m */
  double reach;          /* deepest overlap that is understood as one, m */
  int near_count;        /* of the last evaluation */
  struct axi_near *near; /* room for one a Gauss point */
  int touch_count, touch_capacity;
  struct axi_touch *touch;     /* of the last evaluation */
  double energy;               /* J */
  double min_gap;              /* +infinity where nothing is within reach; m */
  double *position;            /* node_count x 2, current */
  struct axi_contact_box *box; /* 3 x edge_count: edges and their images in the order of z */
  int box_count;
};

/* Finds the surfaces. stiffness 0: 60 times shear modulus over depth, at most a fifth of the wall,
 * of the element at an edge, the softest of all edges; offset 0: 1/200 of the wall. `mesh` must
 * outlive the contact. STATUS_NO_MEMORY, or STATUS_INVALID for an edge that belongs to no element.
 */
enum status axi_contact_create(const struct axi_mesh *mesh, double stiffness, double offset,
                               struct axi_contact **out, struct error *error);
void axi_contact_destroy(struct axi_contact *contact);

/* Finds everything that touches at displacements u[2 node + i] and elongation h; fills touch,
 * energy and min_gap. STATUS_NO_MEMORY. */
enum status axi_contact_evaluate(struct axi_contact *contact, const double *u, double elongation,
                                 bool tangent, struct error *error);

/* The closest point of a quadratic edge y[a] = (r, z), start, end, middle, to a point. */
struct axi_closest {
  double xi;                  /* -1 to 1 */
  double distance;            /* m */
  double gap;                 /* with the sign: negative behind the edge, on the body's side */
  double normal[2];           /* gradient of the gap with respect to the point */
  bool vertex;                /* an end of the edge is closest */
  bool aside;                 /* and the point is beside it rather than before or behind it */
  double tangent[2], bend[2]; /* y' and y'' */
};

struct axi_closest axi_closest_point(double y[AXI_EDGE_NODES][2], const double point[2]);

/* Shape functions of an edge, order start, end, middle, and slopes. */
void axi_edge_shape(double xi, double n[AXI_EDGE_NODES], double d[AXI_EDGE_NODES]);

#endif
