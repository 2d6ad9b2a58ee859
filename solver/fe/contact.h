/* Frictionless contact between faces that look at each other across a gap.
 *
 * At every Gauss point of a slave face the gap g to the closest point of the master face gives
 * an augmented Lagrangian traction t(g - lambda/eps) (Alart, Curnier 1991), smoothed over
 * +-delta so that the potential is twice differentiable:
 *   t(x) = 0 (x >= delta), eps (delta - x)^2 / (4 delta) (|x| < delta), -eps x (x <= -delta).
 * The tangent is the exact Hessian of that potential, with the curvature of the master face. */
#ifndef PNEULAB_FE_CONTACT_H
#define PNEULAB_FE_CONTACT_H

#include "solver/fe/hex27.h"

enum {
  CONTACT_NODES = 2 * QUAD9_NODES, /* slave nodes, then master nodes */
  CONTACT_DOFS = 3 * CONTACT_NODES,
  CONTACT_PACKED = CONTACT_DOFS * (CONTACT_DOFS + 1) / 2
};

struct contact_point {
  double area;     /* reference area, m2 */
  double lambda;   /* multiplier, Pa, >= 0 */
  double change;   /* traction - multiplier at the last update of the multipliers, Pa */
  double gap;      /* last evaluated, m; negative when penetrating */
  double traction; /* last evaluated, Pa */
  double xi[2];    /* closest point on the master face */
  bool valid;      /* the closest point lies on the (slightly extended) master face */
  double gain;     /* 0, or how much faster the traction changes: see contact_follow */
};

struct contact {
  const struct mesh *mesh;
  const struct quad9_tables *tables;
  int pair_count;              /* mesh->facing_count */
  struct contact_point *point; /* pair_count x 9 */
  double stiffness;            /* eps, Pa/m */
  double smoothing;            /* delta, m */
};

/* Summary of one evaluation over all pairs. */
struct contact_summary {
  double min_gap; /* m, +infinity without a valid point */
  int active;     /* points with traction */
};

/* tables and mesh must outlive the contact. On failure STATUS_NO_MEMORY. */
enum status contact_init(struct contact *contact, const struct mesh *mesh,
                         const struct quad9_tables *tables, struct error *error);
void contact_release(struct contact *contact);

/* Nodes of pair p: 9 of the slave face, then 9 of the master face. */
void contact_nodes(const struct contact *contact, int pair, int nodes[CONTACT_NODES]);

/* Evaluates pair p at current node positions x[18][3]: renews gap and traction of its points,
 * writes the residual r[3 a + i] (N) and, unless packed is NULL, the tangent's upper triangle
 * by rows. Returns false when no point carries traction: r and packed are then not written. */
bool contact_evaluate(struct contact *contact, int pair, double x[CONTACT_NODES][3],
                      double r[CONTACT_DOFS], double *packed);

struct contact_summary contact_summarise(const struct contact *contact);

/* Moves the multipliers towards the tractions: lambda <- max(0, lambda + w (t - lambda)).
 * *relaxation is w: 0 on entry starts a sequence of updates with w = 1; later calls extrapolate
 * the sequence by Aitken's rule for vectors (Irons, Tuck 1969), 1 <= w <= 10. Returns the largest
 * |t - lambda| before the update in Pa. */
double contact_update_multipliers(struct contact *contact, double *relaxation);

/* Prepares for derivatives of a state whose multipliers have settled. There they follow the
 * tractions, d lambda = dt, so that the traction changes 1 / (1 - slope/eps) times as fast as with
 * held multipliers. Each point gets that gain, taken at its last gap: its traction becomes
 * lambda + gain (t - lambda). A closed point is rigid and gets `cap` (> 1). cap = 0 brings the
 * ordinary law back. */
void contact_follow(struct contact *contact, double cap);

#endif
