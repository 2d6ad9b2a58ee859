#include "config.h"
#include "tests/bench/linear_solvers.h"

#include <stdio.h>

#ifdef HAVE_MUMPS

#include <dmumps_c.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/clock.h"

enum { JOB_BEGIN = -1, JOB_END = -2, JOB_ANALYSE = 1, JOB_FACTOR, JOB_SOLVE, WORLD = -987654 };

/* Arrays lent to MUMPS. */
struct input {
  int *first, *second; /* rows and columns, or starts and unknowns of the elements; from 1 */
  int *place;          /* of every unknown in an order that is given; from 1 */
  double *value, *x;
};

static void input_release(struct input *in) {
  free(in->first);
  free(in->second);
  free(in->place);
  free(in->value);
  free(in->x);
}

/* Element matrices without the unknowns that are held. */
static bool element_pattern(const struct linear_problem *p, struct input *in, DMUMPS_STRUC_C *id) {
  size_t values = 0;
  in->first = calloc((size_t)p->clique_count + 1, sizeof *in->first);
  in->second = calloc((size_t)p->start[p->clique_count] + 1, sizeof *in->second);
  if (!in->first || !in->second) {
    return false;
  }
  int next = 0;
  in->first[0] = 1;
  for (int c = 0; c < p->clique_count; c++) {
    int begin = next;
    for (int i = p->start[c]; i < p->start[c + 1]; i++) {
      if (p->dofs[i] >= 0) {
        in->second[next++] = p->dofs[i] + 1;
      }
    }
    in->first[c + 1] = next + 1;
    values += (size_t)(next - begin) * (size_t)(next - begin + 1) / 2;
  }
  in->value = calloc(values + 1, sizeof *in->value);
  id->nelt = p->clique_count;
  id->eltptr = in->first;
  id->eltvar = in->second;
  id->a_elt = in->value;
  return in->value != NULL;
}

/* MUMPS takes lower triangles by columns, which are our upper triangles by rows. */
static void fill_elements(const struct linear_problem *p, double *value) {
  for (int c = 0; c < p->clique_count; c++) {
    const double *from = p->model->clique_value[c];
    const int *dofs = p->dofs + p->start[c];
    int size = p->start[c + 1] - p->start[c];
    for (int i = 0; i < size; i++) {
      for (int j = i; j < size; j++) {
        double entry = from ? *from++ : 0;
        if (dofs[i] >= 0 && dofs[j] >= 0) {
          *value++ = entry;
        }
      }
    }
  }
}

static bool assembled_pattern(const struct linear_matrix *matrix, struct input *in,
                              DMUMPS_STRUC_C *id) {
  int entries = matrix->start[matrix->order];
  in->first = malloc(((size_t)entries + 1) * sizeof *in->first);
  in->second = malloc(((size_t)entries + 1) * sizeof *in->second);
  if (!in->first || !in->second) {
    return false;
  }
  for (int j = 0; j < matrix->order; j++) {
    for (int q = matrix->start[j]; q < matrix->start[j + 1]; q++) {
      in->first[q] = matrix->row[q] + 1;
      in->second[q] = j + 1;
    }
  }
  id->nnz = entries;
  id->irn = in->first;
  id->jcn = in->second;
  id->a = matrix->value;
  return true;
}

static bool give_order(const struct linear_matrix *matrix, struct input *in, DMUMPS_STRUC_C *id) {
  in->place = calloc((size_t)matrix->order + 1, sizeof *in->place);
  if (!in->place || !linear_metis_order(matrix, in->place)) {
    return false;
  }
  for (int i = 0; i < matrix->order; i++) {
    in->place[i]++;
  }
  id->perm_in = in->place;
  return true;
}

static void configure(DMUMPS_STRUC_C *id, const struct mumps_choice *choice) {
  for (int k = 0; k < 4; k++) {
    id->icntl[k] = k == 3 ? 0 : -1; /* silent */
  }
  id->icntl[4] = choice->elements;
  id->icntl[5] = 0; /* no matching, no scaling: the matrix is near definite */
  id->icntl[6] = choice->ordering;
  id->icntl[7] = 0;
  id->icntl[11] = 1; /* order the matrix as it is */
  id->icntl[12] = 1; /* all pivots count for the inertia */
  id->icntl[13] = 60;
  id->cntl[0] = choice->threshold;
}

static bool call(DMUMPS_STRUC_C *id, int job, struct linear_figures *figures) {
  id->job = job;
  dmumps_c(id);
  if (id->infog[0] < 0) {
    snprintf(figures->note, sizeof figures->note, "MUMPS error %d (%d)", id->infog[0],
             id->infog[1]);
  }
  return id->infog[0] >= 0;
}

static bool factor_and_solve(const struct linear_problem *problem, struct linear_matrix *matrix,
                             const struct mumps_choice *choice, struct input *in,
                             DMUMPS_STRUC_C *id, struct linear_figures *figures) {
  struct linear_repeat gather = {0}, factor = {0}, solve = {0};
  while (linear_repeat_again(&gather)) {
    linear_repeat_begin(&gather);
    if (choice->elements) {
      fill_elements(problem, in->value);
    } else {
      linear_matrix_fill(problem, matrix);
    }
    linear_repeat_end(&gather);
  }
  while (linear_repeat_again(&factor)) {
    linear_repeat_begin(&factor);
    if (!call(id, JOB_FACTOR, figures)) {
      return false;
    }
    linear_repeat_end(&factor);
  }
  figures->memory = 1e6 * id->infog[21];
  figures->flops = id->rinfog[2];
  figures->negative = id->infog[11];
  id->rhs = in->x;
  while (linear_repeat_again(&solve)) {
    memcpy(in->x, problem->b, sizeof *in->x * (size_t)id->n);
    linear_repeat_begin(&solve);
    if (!call(id, JOB_SOLVE, figures)) {
      return false;
    }
    linear_repeat_end(&solve);
  }
  figures->gather_s = gather.best;
  figures->factor_s = factor.best;
  figures->solve_s = solve.best;
  figures->residual = linear_problem_residual(problem, in->x);
  return true;
}

void linear_run_mumps(const struct linear_problem *problem, struct linear_matrix *matrix,
                      const struct mumps_choice *choice, struct linear_figures *figures) {
  DMUMPS_STRUC_C id = {.sym = 2, .par = 1, .comm_fortran = WORLD};
  struct input in = {0};
  snprintf(figures->solver, sizeof figures->solver, "MUMPS");
  snprintf(figures->variant, sizeof figures->variant, "%s", choice->name);
  figures->negative = -1;
  if (!call(&id, JOB_BEGIN, figures)) {
    return;
  }
  configure(&id, choice);
  id.n = matrix->order;
  in.x = calloc((size_t)id.n, sizeof *in.x);
  bool ready = in.x && (choice->elements ? element_pattern(problem, &in, &id)
                                         : assembled_pattern(matrix, &in, &id));
  double start = clock_cpu_s();
  if (ready && choice->ordering == MUMPS_ORDER_GIVEN) {
    ready = give_order(matrix, &in, &id);
  }
  if (!ready) {
    snprintf(figures->note, sizeof figures->note, "no memory");
    goto done;
  }
  if (!call(&id, JOB_ANALYSE, figures)) {
    goto done;
  }
  figures->analysis_s = clock_cpu_s() - start;
  if (id.infog[6] != choice->ordering) {
    snprintf(figures->note, sizeof figures->note, "not in this MUMPS: it took ordering %d",
             id.infog[6]);
    goto done;
  }
  figures->solved = factor_and_solve(problem, matrix, choice, &in, &id, figures);
done:
  call(&id, JOB_END, &(struct linear_figures){0});
  input_release(&in);
}

#else

void linear_run_mumps(const struct linear_problem *problem, struct linear_matrix *matrix,
                      const struct mumps_choice *choice, struct linear_figures *figures) {
  (void)problem;
  (void)matrix;
  snprintf(figures->solver, sizeof figures->solver, "MUMPS");
  snprintf(figures->variant, sizeof figures->variant, "%s", choice->name);
  snprintf(figures->note, sizeof figures->note, "not in this build");
}

#endif
