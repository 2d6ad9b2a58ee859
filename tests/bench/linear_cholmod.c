#include <stdio.h>
#include <string.h>
#include <suitesparse/cholmod.h>
#include "solver/base/clock.h"
#include "tests/bench/linear_solvers.h"

static void configure(cholmod_common *c, const struct cholmod_choice *choice) {
  c->print = 0;
  c->nmethods = 1;
  c->method[0].ordering = choice->ordering;
  c->postorder = 1;
  c->supernodal = choice->supernodal ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
  c->final_ll = choice->supernodal;
  c->quick_return_if_not_posdef = 1;
  for (int k = 0; choice->nrelax[0] > 0 && k < 3; k++) {
    c->nrelax[k] = choice->nrelax[k];
    c->zrelax[k] = choice->zrelax[k];
  }
}

/* Negative entries of D of a simplicial factorisation. */
static int negative_pivots(const cholmod_factor *l) {
  const int *start = l->p;
  const double *value = l->x;
  int count = 0;
  for (size_t j = 0; j < l->n; j++) {
    count += value[start[j]] < 0;
  }
  return count;
}

static bool factor(const struct linear_problem *problem, struct linear_matrix *matrix,
                   cholmod_sparse *a, cholmod_factor *l, cholmod_common *c,
                   struct linear_figures *figures) {
  struct linear_repeat gather = {0}, factors = {0};
  while (linear_repeat_again(&gather)) {
    linear_repeat_begin(&gather);
    linear_matrix_fill(problem, matrix);
    linear_repeat_end(&gather);
  }
  figures->gather_s = gather.best;
  while (linear_repeat_again(&factors)) {
    linear_repeat_begin(&factors);
    cholmod_factorize(a, l, c);
    linear_repeat_end(&factors);
    if (c->status != CHOLMOD_OK) {
      snprintf(figures->note, sizeof figures->note, "%s at column %zu of %zu",
               c->status == CHOLMOD_NOT_POSDEF ? "not positive definite" : "failed", l->minor,
               l->n);
      return false;
    }
  }
  figures->factor_s = factors.best;
  return true;
}

static bool solve(const struct linear_problem *problem, cholmod_factor *l, cholmod_common *c,
                  struct linear_figures *figures) {
  cholmod_dense b = {.nrow = l->n, .ncol = 1, .nzmax = l->n, .d = l->n, .x = problem->b};
  cholmod_dense *x = NULL, *y = NULL, *e = NULL;
  struct linear_repeat solves = {0};
  bool solved = true;
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  while (solved && linear_repeat_again(&solves)) {
    linear_repeat_begin(&solves);
    solved = cholmod_solve2(CHOLMOD_A, l, &b, NULL, &x, NULL, &y, &e, c);
    linear_repeat_end(&solves);
  }
  if (solved) {
    figures->solve_s = solves.best;
    figures->residual = linear_problem_residual(problem, x->x);
  }
  cholmod_free_dense(&x, c);
  cholmod_free_dense(&y, c);
  cholmod_free_dense(&e, c);
  return solved;
}

static cholmod_sparse sparse_view(const struct linear_matrix *matrix) {
  size_t order = (size_t)matrix->order;
  cholmod_sparse a = {.nrow = order, .ncol = order, .nzmax = (size_t)matrix->start[matrix->order]};
  a.p = matrix->start;
  a.i = matrix->row;
  a.x = matrix->value;
  a.stype = -1;
  a.itype = CHOLMOD_INT;
  a.xtype = CHOLMOD_REAL;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = a.packed = 1;
  return a;
}

bool linear_metis_order(const struct linear_matrix *matrix, int *place) {
  cholmod_common c;
  cholmod_start(&c);
  configure(&c, &(struct cholmod_choice){.ordering = CHOLMOD_METIS});
  cholmod_sparse a = sparse_view(matrix);
  cholmod_factor *l = cholmod_analyze(&a, &c);
  const int *order = l ? l->Perm : NULL;
  for (int k = 0; l && k < matrix->order; k++) {
    place[order[k]] = k;
  }
  bool ordered = l != NULL;
  cholmod_free_factor(&l, &c);
  cholmod_finish(&c);
  return ordered;
}

void linear_run_cholmod(const struct linear_problem *problem, struct linear_matrix *matrix,
                        const struct cholmod_choice *choice, struct linear_figures *figures) {
  cholmod_common c;
  cholmod_start(&c);
  configure(&c, choice);
  cholmod_sparse a = sparse_view(matrix);
  snprintf(figures->solver, sizeof figures->solver, "CHOLMOD");
  snprintf(figures->variant, sizeof figures->variant, "%s", choice->name);
  figures->negative = -1;
  double start = clock_cpu_s();
  cholmod_factor *l = cholmod_analyze(&a, &c);
  figures->analysis_s = clock_cpu_s() - start;
  if (!l) {
    snprintf(figures->note, sizeof figures->note, "the analysis failed");
  } else {
    figures->flops = c.fl;
    figures->solved = factor(problem, matrix, &a, l, &c, figures) && solve(problem, l, &c, figures);
  }
  if (figures->solved) {
    figures->negative = choice->supernodal ? 0 : negative_pivots(l);
  }
  figures->memory = (double)c.memory_usage;
  cholmod_free_factor(&l, &c);
  cholmod_finish(&c);
}
