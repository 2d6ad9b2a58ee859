/* Simple bodies: mapped blocks of hexahedra, joined where their nodes coincide. */
#ifndef PNEULAB_VERIFY_BODY_H
#define PNEULAB_VERIFY_BODY_H

#include "solver/fe/model.h"

/* Blocks of cells[0] x cells[1] x cells[2] elements over the unit cube. */
struct body {
  int blocks;
  int cells[3];
  bool cavity; /* the face s[0] = 0 of every block bounds a cavity */
  /* Place x of the point s of a block, 0 <= s <= 1; right-handed. */
  void (*map)(const void *context, int block, const double s[3], double x[3]);
  const void *context;
};

enum { HOLD_X = 1, HOLD_Y = 2, HOLD_Z = 4, HOLD_ALL = 7 };

/* Builds the mesh, without sections; boundary faces are those of the blocks, also where two
 * blocks meet. Released with mesh_release, also after a failure: STATUS_NO_MEMORY. */
enum status body_build(const struct body *body, struct mesh *mesh);

/* Holds the components of the nodes whose coordinate `axis` is `at`; axis -1 means all nodes. */
void body_hold(struct mesh *mesh, int axis, double at, int components);

/* on_boundary[n] = 1 for nodes on a face of some block, else 0. */
void body_mark_boundary(const struct mesh *mesh, unsigned char *on_boundary);

/* Adds a dead traction (Pa) to the dead load, on the boundary faces whose nodes all have the
 * coordinate x[axis] = at. */
void body_add_traction(struct fe_model *model, int axis, double at, const double traction[3]);

/* The same on those of the faces whose nodes have no other coordinate above `limit`. */
void body_add_traction_within(struct fe_model *model, int axis, double at, double limit,
                              const double traction[3]);

/* Node nearest to x. */
int body_node(const struct mesh *mesh, double x, double y, double z);

/* Reproducible pseudo-random number in [-1, 1]. */
double body_random(unsigned *seed);

#endif
