/* Inside of an optimisation, shared by its files. */
#ifndef PNEULAB_EXPLORE_OPTIMISE_INTERNAL_H
#define PNEULAB_EXPLORE_OPTIMISE_INTERNAL_H

#include <stdint.h>
#include "solver/explore/optimise.h"

#define OPTIMISE_NONE SIZE_MAX

/* One evaluation. The three share one piece of memory, at x. */
struct optimise_record {
  double *x;        /* n */
  double *value;    /* functions; of one that failed, what stands in for it */
  double *gradient; /* functions x n; likewise */
  bool solved;
};

/* Why no further evaluation is made. */
enum optimise_end {
  OPTIMISE_END_NONE,
  OPTIMISE_END_HALTED,
  OPTIMISE_END_SPENT,
  OPTIMISE_END_LOST,
  OPTIMISE_END_MEMORY
};

struct optimise_search {
  const struct optimise_problem *problem;
  size_t n, functions;
  struct optimise_record *record; /* as many as the budget */
  size_t count;
  size_t best;  /* of those solved, or OPTIMISE_NONE */
  double worst; /* largest objective of those solved */
  bool reached; /* the target */
  enum optimise_end end;
};

/* The record of x, put into the box and evaluated when it is a new one. NULL when no further
 * evaluation is made: see search->end. */
struct optimise_record *optimise_look(struct optimise_search *search, const double *x);

/* What is minimised, and its gradient[n] unless NULL. */
double optimise_objective(const struct optimise_search *search,
                          const struct optimise_record *record, double *gradient);

/* Largest violation of limits and side conditions, 0 for none. */
double optimise_violation(const struct optimise_search *search,
                          const struct optimise_record *record);

/* Gauss-Newton with a trust region; `first` is the evaluated start. STATUS_OK or NO_MEMORY. */
enum status optimise_gauss_newton(struct optimise_search *search,
                                  const struct optimise_record *first, struct error *error);

#endif
