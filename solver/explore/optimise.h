/* Minimises functions that are costly to evaluate, under bounds and limits, one start at a time.
 *
 * Parameters live in the unit box. What is minimised is one function f, or half the sum of squares
 * of residuals r; limits g <= 0 are functions of the same evaluation, side conditions s <= 0 are
 * known without one. An evaluation may fail (a design that cannot be built, or whose solve
 * diverges): the search steps back from it.
 *
 * Methods:
 * - GAUSS_NEWTON, residuals without limits: least squares of the linearised residuals within a box
 *   about the best point, the bounds and the side conditions, by NLopt's SLSQP; the box grows and
 *   shrinks with the quality of the prediction (Fletcher 1987, Practical Methods of Optimization,
 *   section 5.5; Nocedal and Wright 2006, algorithm 4.1);
 * - SLSQP, Kraft (1994), with derivatives;
 * - MMA, the globally convergent method of moving asymptotes, Svanberg (2002), with derivatives;
 * - COBYLA, Powell (1994), without derivatives.
 *
 * All are deterministic: equal answers lead to equal questions. */
#ifndef PNEULAB_EXPLORE_OPTIMISE_H
#define PNEULAB_EXPLORE_OPTIMISE_H

#include <stdbool.h>
#include <stddef.h>
#include "solver/base/error.h"

enum { OPTIMISE_PARAMETERS_MAX = 32, OPTIMISE_BUDGET_MAX = 10000 };

enum optimise_method { OPTIMISE_GAUSS_NEWTON, OPTIMISE_SLSQP, OPTIMISE_MMA, OPTIMISE_COBYLA };

/* What an evaluation comes to. */
enum optimise_reply {
  OPTIMISE_SOLVED,
  OPTIMISE_FAILED, /* there is nothing at this point */
  OPTIMISE_HALT    /* the answer is not known (yet): end the search here */
};

enum optimise_ending {
  OPTIMISE_REACHED,   /* the residuals are as small as wanted */
  OPTIMISE_CONVERGED, /* no further improvement within the tolerance */
  OPTIMISE_SPENT,     /* the budget */
  OPTIMISE_HALTED,    /* by an evaluation */
  OPTIMISE_LOST       /* the start itself could not be evaluated */
};

struct optimise_problem {
  enum optimise_method method;
  size_t parameters; /* n: 1 .. OPTIMISE_PARAMETERS_MAX */
  size_t residuals;  /* 0: the first function is minimised; else as many residuals */
  size_t limits;     /* functions that have to be 0 or less, about 1 in size */
  size_t sides;      /* side conditions, likewise */
  size_t budget;     /* evaluations, failed ones included; at most OPTIMISE_BUDGET_MAX */
  double tolerance;  /* of the parameters, and of limits and side conditions */
  double target;     /* residuals of this norm are small enough */
  /* The functions at x[n]: f or residuals, then limits, into value[]; their derivatives, function
   * by function, into gradient[functions x n]. COBYLA leaves the gradient alone. x lies in the box.
   */
  enum optimise_reply (*evaluate)(void *context, const double *x, double *value, double *gradient);
  /* The side condition `which` at x; gradient[n] unless NULL. May be NULL without any. */
  double (*side)(void *context, size_t which, const double *x, double *gradient);
  void *context;
};

struct optimise_outcome {
  enum optimise_ending ending;
  size_t evaluations;
  size_t best;                       /* the evaluation behind x, from 0 */
  double x[OPTIMISE_PARAMETERS_MAX]; /* least objective within the limits, or least violation */
  double objective;                  /* f, or half the sum of squares; NAN when nothing is known */
  double violation;                  /* largest of the limits there, 0 for none */
};

/* Functions of an evaluation. */
size_t optimise_functions(const struct optimise_problem *problem);

/* Searches from `start`[n] in the box. GAUSS_NEWTON without residuals or with limits is taken for
 * SLSQP. STATUS_OK, with *outcome filled; STATUS_INVALID for a problem outside of the ranges above;
 * STATUS_NO_MEMORY. */
enum status optimise_run(const struct optimise_problem *problem, const double *start,
                         struct optimise_outcome *outcome, struct error *error);

#endif
