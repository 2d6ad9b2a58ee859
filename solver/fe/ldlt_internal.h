/* What the symbolic and the numeric half of the multifrontal factorisation share. */
#ifndef PNEULAB_FE_LDLT_INTERNAL_H
#define PNEULAB_FE_LDLT_INTERNAL_H

#include "solver/fe/ldlt.h"

/* A supernode: consecutive columns of L with the same rows below. Its front is the dense
 * matrix over its rows; the first `columns` of them are eliminated there. */
struct front {
  int first; /* first column, in elimination order */
  int columns;
  int rows;                       /* columns + rows below */
  int parent;                     /* -1 for a root */
  size_t row;                     /* into ldlt.row and ldlt.parent_row */
  size_t value;                   /* into ldlt.value: rows x columns, column-major */
  int level;                      /* depth in the tree modulo 2: which stack it uses */
  size_t stack;                   /* where its update matrix lies in ldlt.stack[level] */
  int clique_first, clique_count; /* into ldlt.clique */
};

struct ldlt {
  int dof_count, front_count, clique_count;
  int *pattern; /* node_of, start and dofs of the pattern */
  size_t pattern_count;
  int *position;       /* dof -> place in elimination order */
  struct front *front; /* in postorder */
  int *row;            /* rows of every front, in elimination order */
  int *parent_row;     /* for a row below: its index in the parent's front */
  int *clique;         /* cliques ordered by the front that takes them */
  int *clique_start;   /* clique_count + 1, into clique_row */
  int *clique_row;     /* per unknown of a clique: row in its front, -1 when fixed */
  double *value;       /* L */
  double *sign;        /* dof_count, in elimination order */
  double *work;        /* of the dense elimination */
  double **column;     /* where the columns of the current front begin, less their row */
  int *run;            /* largest front + 1 */
  double *stack[2];    /* update matrices waiting for their parents, by level: a front's own never
                        * lies over those of its children */
  double *vector;      /* 2 x dof_count */
  int *pending;        /* stack of fronts whose update matrix waits */
  struct ldlt_statistics statistics;
};

#endif
