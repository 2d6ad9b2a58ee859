/* Dense elimination inside one front of the multifrontal factorisation. */
#ifndef PNEULAB_FE_LDLT_FRONT_H
#define PNEULAB_FE_LDLT_FRONT_H

#include <stdbool.h>
#include <stddef.h>

/* One front: `rows` unknowns, the first `columns` of which are eliminated. */
struct ldlt_dense {
  int rows, columns;
  double *l;      /* rows x columns by columns: on entry the matrix, on return L; only the lower
                   * trapezoid counts, entries above it are overwritten */
  double *update; /* below x below by columns, below = rows - columns: the update matrix; its lower
                   * triangle counts */
  bool add;       /* the update is added to what `update` holds; else that is overwritten */
  double *sign;   /* columns: signs of the pivots */
  double *pack;   /* work, ldlt_front_work doubles */
};

/* Doubles of work that a front of this size needs. */
size_t ldlt_front_work(int rows, int columns);

/* A = L S L^T of the first columns and update -= L2 S L2^T for the rows below them, with the
 * vector instructions that the processor has. A pivot that vanishes against the scale of its
 * block is replaced by that scale's round-off. Returns the number of negative pivots. */
int ldlt_front_eliminate(const struct ldlt_dense *front);

#endif
