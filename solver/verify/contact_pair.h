/* Two cubes of edge 1 that look at each other along x, and one pair of faces between them. */
#ifndef PNEULAB_VERIFY_CONTACT_PAIR_H
#define PNEULAB_VERIFY_CONTACT_PAIR_H

#include "solver/fe/contact.h"
#include "solver/verify/body.h"

/* The cubes, `gap` apart, of 1 x cells x cells elements each; their faces are paired. mesh_release
 * it also after a failure: STATUS_NO_MEMORY. */
enum status contact_blocks_build(int cells, double gap, struct mesh *mesh);

struct contact_pair_case {
  struct mesh mesh;
  struct quad9_tables tables;
  struct contact contact;
  double x[CONTACT_NODES][3];                  /* the state */
  double v[CONTACT_DOFS], exact[CONTACT_DOFS]; /* a direction, and the tangent along it */
};

/* Faces `gap` apart; the master is curved and tilted by `crooked`, the slave follows it. All points
 * have the multiplier `lambda`. Close it also after a failure. */
enum status contact_pair_open(struct contact_pair_case *c, double gap, double crooked,
                              double lambda);
void contact_pair_close(struct contact_pair_case *c);

/* Residual at x + h v; false when nothing touches. */
bool contact_pair_residual(struct contact_pair_case *c, double h, double r[CONTACT_DOFS]);

/* Fills exact. STATUS_DIVERGED when nothing touches, NO_MEMORY. */
enum status contact_pair_tangent(struct contact_pair_case *c);

/* Relative error of the central difference with step h. */
double contact_pair_error(void *pair_case, double h);

#endif
