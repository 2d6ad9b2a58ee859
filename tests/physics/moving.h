/* A body with all that it takes to move it. */
#ifndef PNEULAB_TESTS_PHYSICS_MOVING_H
#define PNEULAB_TESTS_PHYSICS_MOVING_H

#include "solver/fe/dynamics.h"
#include "solver/verify/body.h"

struct moving {
  struct mesh mesh; /* built and held by the caller before moving_open */
  struct fe_model *model;
  struct equilibrium *solver;
  struct dynamics *dynamics; /* without damping, every oscillation kept */
  struct fe_state state;
  struct motion motion;
};

void moving_open(struct moving *b, const struct material_spec *material);
/* The same with a rigid obstacle, whose number *index receives. */
void moving_open_with(struct moving *b, const struct material_spec *material,
                      const struct rigid_shape *shape, double friction, int *index);
void moving_close(struct moving *b);

/* A block from `low` to `high` of cells[] elements, nothing held. */
void moving_block(struct moving *b, const double low[3], const double high[3], const int cells[3]);

/* Lowest angular frequency of small vibrations about the state without load, 1/s, by inverse
 * iteration; mode (node_count x 3) has the largest entry 1. */
double moving_frequency(struct moving *b, double *mode);

/* Takes `count` steps of length h without load. */
void moving_march(struct moving *b, double h, int count, struct energy *energy);

/* Strain and kinetic energy now, J. */
double moving_energy(const struct moving *b);

#endif
