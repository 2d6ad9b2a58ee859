/* The solvers that are compared, each on one thread. */
#ifndef PNEULAB_TESTS_LINEAR_SOLVERS_H
#define PNEULAB_TESTS_LINEAR_SOLVERS_H

#include "tests/bench/linear_problem.h"

/* What one solver did with one problem. Times are CPU s, the best of several. */
struct linear_figures {
  char solver[24], variant[48];
  bool solved;
  char note[64];     /* why it was not solved, or what is special */
  double analysis_s; /* ordering and symbolic factorisation, once per pattern */
  double gather_s;   /* element matrices to the solver's own form of the matrix */
  double factor_s, solve_s;
  double residual; /* ||A x - b|| / ||b|| */
  double flops;    /* of one factorisation, as the solver counts them */
  double memory;   /* largest amount in use, bytes; 0 when unknown */
  int negative;    /* negative pivots; -1 when the solver does not say */
};

/* Times of repeated work: `again` is true until half a second and three repetitions are spent, but
 * not beyond four seconds or forty repetitions. */
struct linear_repeat {
  int count;
  double spent, start, best;
};
bool linear_repeat_again(struct linear_repeat *repeat);
void linear_repeat_begin(struct linear_repeat *repeat);
void linear_repeat_end(struct linear_repeat *repeat);

/* Our own multifrontal LDL^T (solver/fe/ldlt.h). */
void linear_run_own(const struct linear_problem *problem, struct linear_figures *figures);

struct cholmod_choice {
  const char *name;
  int ordering; /* CHOLMOD_AMD, CHOLMOD_METIS */
  bool supernodal;
  size_t nrelax[3]; /* 0: CHOLMOD's own */
  double zrelax[3];
};
void linear_run_cholmod(const struct linear_problem *problem, struct linear_matrix *matrix,
                        const struct cholmod_choice *choice, struct linear_figures *figures);

/* CHOLMOD's METIS order of the matrix: place[unknown], from 0. False when it fails. */
bool linear_metis_order(const struct linear_matrix *matrix, int *place);

enum { MUMPS_ORDER_AMD = 0, MUMPS_ORDER_GIVEN = 1, MUMPS_ORDER_AMF = 2, MUMPS_ORDER_PORD = 4 };

struct mumps_choice {
  const char *name;
  int ordering; /* ICNTL(7); MUMPS_ORDER_GIVEN takes linear_metis_order */
  bool elements;
  double threshold; /* CNTL(1): 0 takes every pivot as it comes */
};
/* Sets figures->note and nothing else in a build without MUMPS. */
void linear_run_mumps(const struct linear_problem *problem, struct linear_matrix *matrix,
                      const struct mumps_choice *choice, struct linear_figures *figures);

#endif
