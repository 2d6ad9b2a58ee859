/* Multifrontal factorisation A = L S L^T of a sparse symmetric, possibly indefinite matrix that
 * is a sum of dense cliques (element and contact matrices); S is a diagonal of signs, so that
 * the inertia is known. No pivoting: the tangent of an elastic body is definite or close to it.
 *
 * The ordering (AMD or METIS) and the supernodal elimination tree come from SuiteSparse, on the
 * graph of nodes; the method is that of Duff and Reid (1983). */
#ifndef PNEULAB_FE_LDLT_H
#define PNEULAB_FE_LDLT_H

#include <stdbool.h>
#include <stddef.h>
#include "solver/base/error.h"

struct ldlt;

/* The cliques: clique c couples the unknowns dofs[start[c]] .. dofs[start[c + 1] - 1], where -1
 * marks an unknown that is held fixed. node_of[dof] groups unknowns of one node. */
struct ldlt_pattern {
  int dof_count;
  int node_count;
  const int *node_of; /* dof_count */
  int clique_count;
  const int *start; /* clique_count + 1 */
  const int *dofs;
};

struct ldlt_statistics {
  double flops;          /* of one factorisation */
  size_t factor_entries; /* doubles in L */
  size_t memory_bytes;
  int largest_front;
};

/* Orders and analyses. The pattern is copied. On success the caller owns *out (ldlt_destroy). */
enum status ldlt_create(const struct ldlt_pattern *pattern, struct ldlt **out, struct error *error);
void ldlt_destroy(struct ldlt *ldlt);

/* Whether an analysis of this pattern would be the same: then it serves the other matrix as well,
 * whose factorisations come out to the same bits. */
bool ldlt_fits(const struct ldlt *ldlt, const struct ldlt_pattern *pattern);

int ldlt_clique_count(const struct ldlt *ldlt);

/* Factorises the sum of the cliques. values[c] is the upper triangle by rows of clique c in the
 * order of its dofs, or NULL when it is absent this time. Returns the number of negative
 * pivots. */
int ldlt_factor(struct ldlt *ldlt, const double *const *values);

/* Solves A x = b with the last factor; x and b may be the same array of dof_count. */
void ldlt_solve(struct ldlt *ldlt, const double *b, double *x);

struct ldlt_statistics ldlt_statistics(const struct ldlt *ldlt);

#endif
