/* A cell in closed form that snaps back in its length: an inner spring that is bistable in x, in a
 * row with a linear one of stiffness K. Pressure acts on the area A over the length h and on B over
 * the inner elongation x:
 *   W = U(x) + K/2 (h - x)^2,  V = V0 + A h + B x,  U' = a x (x - x1) (x - x2).
 * In equilibrium h = x + (U' - p B) / K and the pull is F = U' - p (A + B); h turns back where
 * U'' < -K. */
#ifndef PNEULAB_TESTS_PHYSICS_FOLD_LAW_H
#define PNEULAB_TESTS_PHYSICS_FOLD_LAW_H

#include "solver/job/bistable.h"

struct fold {
  double a, x1, x2, K, A, B, V0;
};

/* A cell with the trigger at 34.9 kPa, 0.81 N/kPa and two elongations without force that are 8.45
 * mm apart; it folds. */
extern const struct fold fold_pair;

/* State of the cell at an inner elongation: h, F, V, W. */
void fold_state(const struct fold *fold, double x, double p, double state[4]);

/* The inner elongation at the elongation h on the compressed (0) or stretched (1) side. */
double fold_inner(const struct fold *fold, int side, double h, double p);

/* h at which the side ends, where dh/dx = 0; NAN where the cell does not fold. */
double fold_end(const struct fold *fold, int side, double p);

/* Fills the table with paths of `points` points from x = from to x = to; to be released. */
void fold_table(const struct fold *fold, int levels, const double pressure[], size_t points,
                double from, double to, struct law_table *table);

#endif
