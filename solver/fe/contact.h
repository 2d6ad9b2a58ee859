/* Frictionless contact of the body's outer surface with itself and with rigid planes.
 *
 * The surface is the set of FACE_OUTER and FACE_BASE faces. At every Gauss point of a slave face
 * the gap g to the closest point of a master face gives an augmented Lagrangian traction t(g -
 * lambda/eps) (Alart, Curnier 1991), smoothed over +-delta so that the potential is twice
 * differentiable: t(x) = 0 (x >= delta), eps (delta - x)^2 / (4 delta) (|x| < delta), -eps x (x <=
 * -delta). The tangent is the exact Hessian of that potential, with the curvature of the master
 * face.
 *
 * Who can meet whom: faces that look at each other across a gap of the mesh (mesh->facing) are
 * paired from the start; every other pair is found by contact_search. */
#ifndef PNEULAB_FE_CONTACT_H
#define PNEULAB_FE_CONTACT_H

#include "solver/fe/hex27.h"

enum {
  CONTACT_NODES = 2 * QUAD9_NODES, /* slave nodes, then master nodes */
  CONTACT_DOFS = 3 * CONTACT_NODES,
  CONTACT_PACKED = CONTACT_DOFS * (CONTACT_DOFS + 1) / 2,
  CONTACT_PLANES = 8
};

/* A face of the surface. role: +1 slave, -1 master of a gap of the mesh, 0 neither. */
struct contact_face {
  struct mesh_face face;
  signed char role;
};

/* Faces that may touch, as numbers of contact->face. */
struct contact_pair {
  int slave, master;
};

struct contact_point {
  double area;     /* reference area, m2 */
  double lambda;   /* multiplier, Pa, >= 0 */
  double change;   /* traction - multiplier at the last update of the multipliers, Pa */
  double gap;      /* last evaluated, m; negative when penetrating */
  double traction; /* last evaluated, Pa */
  double xi[2];    /* closest point on the master face */
  int pair;        /* its partner, -1 for none; unused by points of planes */
  bool valid;      /* the gap is that of a point on the (slightly extended) partner */
  double gain;     /* 0, or how much faster the traction changes: see contact_follow */
  double anchor;   /* with a gain: the traction about which it changes faster, Pa */
};

/* Rigid half space: the body stays where normal . (x - point) >= 0. */
struct contact_plane {
  double point[3];  /* m */
  double normal[3]; /* unit vector out of the obstacle */
  bool symmetry;    /* the plane of symmetry of a half model */
};

struct contact {
  const struct mesh *mesh;
  const struct quad9_tables *tables;
  int face_count;
  struct contact_face *face; /* the slaves of mesh->facing first, in its order */
  int point_count;
  struct contact_point *point; /* 9 a face; then, plane by plane, 9 a face again */
  int pair_count, pair_capacity;
  struct contact_pair *pair; /* those of mesh->facing first, in its order */
  int plane_count;
  struct contact_plane plane[CONTACT_PLANES];
  double stiffness;                   /* eps, Pa/m */
  double smoothing;                   /* delta, m */
  double reach;                       /* distance at which faces begin to be watched, m */
  struct contact_search_data *search; /* owned by contact_search */
};

/* Summary of one evaluation over all points. */
struct contact_summary {
  double min_gap;       /* between faces, m, +infinity without a valid point */
  double min_plane_gap; /* to planes other than that of symmetry, m, +infinity without */
  double penetration;   /* largest over everything, m, >= 0 */
  int active;           /* points with traction */
  double force;         /* sum of the normal forces between faces, N */
  double area;          /* reference area of the points that carry traction between faces, m2 */
  double max_traction;  /* Pa, per reference area */
  double plane_force[CONTACT_PLANES][3]; /* on the body from each plane, N */
};

/* tables and mesh must outlive the contact. On failure STATUS_NO_MEMORY. */
enum status contact_init(struct contact *contact, const struct mesh *mesh,
                         const struct quad9_tables *tables, struct error *error);
void contact_release(struct contact *contact);

/* Adds a rigid plane; its normal (not zero) need not be of unit length. STATUS_NO_MEMORY, or
 * STATUS_TOO_LARGE beyond CONTACT_PLANES. */
enum status contact_add_plane(struct contact *contact, const struct contact_plane *plane);

/* Finds the partner of every surface point at displacements u (node_count x 3): by a tree of
 * boxes over the faces, then by closest-point projection. *changed tells whether the list of
 * pairs is another one than before. STATUS_NO_MEMORY. */
enum status contact_search(struct contact *contact, const double *u, bool *changed);

/* Deepest penetration (m, >= 0) among pairs other than those of mesh->facing: large when a load
 * step has carried one part of the body into another. */
double contact_intrusion(const struct contact *contact);

/* Whether faces other than those of mesh->facing press on each other: a multiplier of theirs is
 * not zero. */
bool contact_folded(const struct contact *contact);

/* Nodes of pair p: 9 of the slave face, then 9 of the master face. */
void contact_nodes(const struct contact *contact, int pair, int nodes[CONTACT_NODES]);

/* Evaluates pair p at current node positions x[18][3]: renews gap and traction of its points,
 * writes the residual r[3 a + i] (N) and, unless packed is NULL, the tangent's upper triangle
 * by rows. Returns false when no point carries traction: r and packed are then not written. */
bool contact_evaluate(struct contact *contact, int pair, double x[CONTACT_NODES][3],
                      double r[CONTACT_DOFS], double *packed);

/* Evaluates one face against plane k at current node positions x[9][3]: renews its points, and
 * writes the residual r[3 a + i] (N) and stiffness[9][9], so that the tangent is
 * stiffness[a][b] normal_i normal_j. Returns false when no point carries traction. */
bool contact_plane_evaluate(struct contact *contact, int plane, int face, double x[QUAD9_NODES][3],
                            double r[3 * QUAD9_NODES], double stiffness[QUAD9_NODES][QUAD9_NODES]);

struct contact_summary contact_summarise(const struct contact *contact);

/* Moves the multipliers towards the tractions: lambda <- max(0, lambda + w (t - lambda)).
 * *relaxation is w: 0 on entry starts a sequence of updates with w = 1; later calls extrapolate
 * the sequence by Aitken's rule for vectors (Irons, Tuck 1969), 1 <= w <= 10. Returns the largest
 * |t - lambda| before the update in Pa. */
double contact_update_multipliers(struct contact *contact, double *relaxation);

/* Prepares for derivatives of a state whose multipliers have settled. There they follow the
 * tractions, d lambda = dt, so that the traction changes 1 / (1 - slope/eps) times as fast as with
 * held multipliers. Each point gets that gain about its traction t0 at its last gap: the traction
 * becomes t0 + gain (t - t0). A closed point is rigid and gets `cap` (> 1). cap = 0 brings the
 * ordinary law back. */
void contact_follow(struct contact *contact, double cap);

#endif
