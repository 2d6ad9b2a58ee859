/* The discrete-time algebraic Riccati equation and the gains that follow from it. */
#ifndef PNEULAB_HLPV_RICCATI_H
#define PNEULAB_HLPV_RICCATI_H

#include "solver/base/error.h"

enum { RICCATI_STATES_MAX = 6, RICCATI_INPUTS_MAX = 3 };

/* x' = A x + B u with the cost sum over k of x' Q x + u' R u. Matrices row by row. */
struct riccati_problem {
  int states, inputs;
  const double *a; /* states x states */
  const double *b; /* states x inputs */
  const double *q; /* states x states, symmetric, not negative */
  const double *r; /* inputs x inputs, symmetric, positive */
};

/* The stabilising X of
 *   X = A' X A - A' X B (R + B' X B)^-1 B' X A + Q
 * into x (states x states), and the gain K = (R + B' X B)^-1 B' X A into gain (inputs x states),
 * with which u = -K x is optimal. X = U2 U1^-1 with the deflating subspace [U1; U2] of the pencil
 *   [A 0; -Q I] - mu [I B R^-1 B'; 0 A']
 * that belongs to |mu| < 1, from an ordered generalised Schur form (LAPACK dgges): T. Pappas,
 * A. J. Laub, N. R. Sandell, "On the numerical solution of the discrete-time algebraic Riccati
 * equation", 1980. A need not be regular.
 * STATUS_OK, or STATUS_DIVERGED when no gain stabilises the system or the cost does not see a mode
 * of it on the unit circle. */
enum status riccati_solve(const struct riccati_problem *problem, double *x, double *gain,
                          struct error *error);

/* Eigenvalues of a square matrix of up to RICCATI_STATES_MAX rows, real and imaginary parts (LAPACK
 * dgeev). STATUS_OK or STATUS_DIVERGED. */
enum status riccati_eigenvalues(int n, const double *matrix, double (*value)[2],
                                struct error *error);

#endif
