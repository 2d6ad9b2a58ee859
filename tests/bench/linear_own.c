#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "solver/base/clock.h"
#include "tests/bench/linear_solvers.h"

bool linear_repeat_again(struct linear_repeat *repeat) {
  return repeat->count < 1 || (repeat->count < 3 && repeat->spent < 4) ||
         (repeat->count < 40 && repeat->spent < 0.5);
}

void linear_repeat_begin(struct linear_repeat *repeat) {
  repeat->start = clock_cpu_s();
}

void linear_repeat_end(struct linear_repeat *repeat) {
  double time = clock_cpu_s() - repeat->start;
  repeat->best = repeat->count == 0 ? time : fmin(repeat->best, time);
  repeat->spent += time;
  repeat->count++;
}

void linear_run_own(const struct linear_problem *problem, struct linear_figures *figures) {
  const struct fe_model *m = problem->model;
  struct ldlt_pattern pattern = {m->dof_count,          m->mesh->node_count, m->node_of,
                                 problem->clique_count, problem->start,      problem->dofs};
  struct ldlt *ldlt = NULL;
  struct error error;
  struct linear_repeat factor = {0}, solve = {0};
  snprintf(figures->solver, sizeof figures->solver, "pneulab");
  snprintf(figures->variant, sizeof figures->variant, "multifrontal LDL'");
  double *x = calloc((size_t)m->dof_count, sizeof *x), start = clock_cpu_s();
  if (!x || ldlt_create(&pattern, &ldlt, &error) != STATUS_OK) {
    snprintf(figures->note, sizeof figures->note, "no memory");
    goto done;
  }
  figures->analysis_s = clock_cpu_s() - start;
  while (linear_repeat_again(&factor)) {
    linear_repeat_begin(&factor);
    figures->negative = ldlt_factor(ldlt, m->clique_value);
    linear_repeat_end(&factor);
  }
  while (linear_repeat_again(&solve)) {
    linear_repeat_begin(&solve);
    ldlt_solve(ldlt, problem->b, x);
    linear_repeat_end(&solve);
  }
  struct ldlt_statistics statistics = ldlt_statistics(ldlt);
  figures->solved = true;
  figures->factor_s = factor.best;
  figures->solve_s = solve.best;
  figures->residual = linear_problem_residual(problem, x);
  figures->flops = statistics.flops;
  figures->memory = (double)statistics.memory_bytes;
done:
  ldlt_destroy(ldlt);
  free(x);
}
