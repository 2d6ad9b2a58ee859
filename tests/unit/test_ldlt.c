/* Multifrontal factorisation against dense LAPACK on random sums of cliques. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/lapack.h"
#include "solver/fe/ldlt.h"
#include "tests/unit/suite.h"

enum { NODE_DOFS = 3, CLIQUE_NODES = 6, CLIQUE_DOFS = CLIQUE_NODES * NODE_DOFS };

/* A chain of nodes with cliques of neighbours and some far ones; dense is the same matrix. */
struct problem {
  int nodes, dofs, cliques;
  int *equation; /* nodes x 3, -1 where held */
  int *node_of;
  int *start, *list;
  double **value;
  double *dense;
  unsigned seed;
};

static double uniform(unsigned *seed) {
  *seed = *seed * 1664525u + 1013904223u;
  return (*seed >> 8) / (double)(1u << 23) - 1;
}

static void *allocate(size_t count, size_t size) {
  void *memory = calloc(count, size);
  ck_assert_ptr_nonnull(memory);
  return memory;
}

static void problem_open(struct problem *p, int nodes, unsigned seed) {
  *p = (struct problem){.nodes = nodes, .cliques = 2 * nodes, .seed = seed};
  p->equation = allocate((size_t)nodes * NODE_DOFS, sizeof *p->equation);
  p->node_of = allocate((size_t)nodes * NODE_DOFS, sizeof *p->node_of);
  for (int i = 0; i < nodes * NODE_DOFS; i++) {
    bool held = i / NODE_DOFS % 7 == 3 || uniform(&p->seed) > 0.9;
    p->equation[i] = held ? -1 : p->dofs;
    if (!held) {
      p->node_of[p->dofs++] = i / NODE_DOFS;
    }
  }
  p->start = allocate((size_t)p->cliques + 1, sizeof *p->start);
  p->list = allocate((size_t)p->cliques * CLIQUE_DOFS, sizeof *p->list);
  p->value = allocate((size_t)p->cliques, sizeof *p->value);
  p->dense = allocate((size_t)p->dofs * (size_t)p->dofs, sizeof *p->dense);
  for (int c = 0; c < p->cliques; c++) {
    p->start[c + 1] = p->start[c] + CLIQUE_DOFS;
    for (int i = 0; i < CLIQUE_NODES; i++) {
      /* The last node of the second half of the cliques lies anywhere but on the others. */
      int node = (c % nodes + i) % nodes;
      if (c >= nodes && i == CLIQUE_NODES - 1) {
        node = (node + (int)((uniform(&p->seed) + 1) * 0.5 * (nodes - CLIQUE_NODES))) % nodes;
      }
      for (int d = 0; d < NODE_DOFS; d++) { /* dofs in an order of their own */
        p->list[p->start[c] + CLIQUE_NODES * d + i] = p->equation[NODE_DOFS * node + d];
      }
    }
  }
}

static void problem_close(struct problem *p) {
  for (int c = 0; c < p->cliques; c++) {
    free(p->value[c]);
  }
  free(p->value);
  free(p->equation);
  free(p->node_of);
  free(p->start);
  free(p->list);
  free(p->dense);
}

static void create(const struct problem *p, struct ldlt **ldlt) {
  struct ldlt_pattern pattern = {p->dofs, p->nodes, p->node_of, p->cliques, p->start, p->list};
  struct error error;
  ck_assert_int_eq(ldlt_create(&pattern, ldlt, &error), STATUS_OK);
}

/* Fills the cliques with sum_k sign_k g_k g_k^T + diagonal, some of them absent, and adds them
 * up in `dense`. part(dof) is the sign of a dof: the matrix gets the form (H, A; A^T, -G) with H
 * and G positive definite, which any order of elimination can factorise (Vanderbei 1995). */
static void fill(struct problem *p, const signed char *part) {
  memset(p->dense, 0, sizeof *p->dense * (size_t)p->dofs * (size_t)p->dofs);
  for (int c = 0; c < p->cliques; c++) {
    free(p->value[c]);
    p->value[c] = NULL;
    if (c >= p->nodes && uniform(&p->seed) > 0.5) {
      continue;
    }
    double g[CLIQUE_DOFS][CLIQUE_DOFS],
        *value = allocate(CLIQUE_DOFS * (CLIQUE_DOFS + 1) / 2, sizeof(double));
    p->value[c] = value;
    for (int i = 0; i < CLIQUE_DOFS * CLIQUE_DOFS; i++) {
      g[i / CLIQUE_DOFS][i % CLIQUE_DOFS] = uniform(&p->seed);
    }
    const int *dofs = p->list + p->start[c];
    for (int i = 0; i < CLIQUE_DOFS; i++) {
      for (int j = i; j < CLIQUE_DOFS; j++) {
        double sum = i == j ? 0.5 : 0;
        for (int k = 0; k < CLIQUE_DOFS; k++) {
          sum += g[i][k] * g[j][k];
        }
        if (dofs[i] >= 0 && dofs[j] >= 0) {
          signed char a = part[dofs[i]], b = part[dofs[j]];
          sum = a == b ? a * sum : uniform(&p->seed);
          p->dense[dofs[i] * p->dofs + dofs[j]] += sum;
          p->dense[dofs[j] * p->dofs + dofs[i]] += i != j ? sum : 0;
        }
        *value++ = sum; /* values of held dofs have to be ignored */
      }
    }
  }
}

static double largest(int n, const double *v) {
  double most = 0;
  for (int i = 0; i < n; i++) {
    most = fmax(most, fabs(v[i]));
  }
  return most;
}

/* Solves with both and compares solution, residual and inertia. */
static void compare(struct problem *p, struct ldlt *ldlt) {
  int n = p->dofs, one = 1, info, work_size = 64 * n, expected = 0;
  size_t size = (size_t)n;
  double *b = allocate(size, sizeof(double)), *x = allocate(size, sizeof(double)),
         *y = allocate(size, sizeof(double));
  double *copy = allocate(size * size, sizeof(double)), *work = allocate(64 * size, sizeof(double));
  int *pivot = allocate(size, sizeof *pivot);
  for (int i = 0; i < n; i++) {
    b[i] = y[i] = uniform(&p->seed);
  }
  int negative = ldlt_factor(ldlt, (const double *const *)p->value);
  ldlt_solve(ldlt, b, x);
  memcpy(copy, p->dense, size * size * sizeof(double));
  dsysv_("U", &n, &one, copy, &n, pivot, y, &n, work, &work_size, &info);
  ck_assert_int_eq(info, 0);
  double difference = 0, residual = 0;
  for (int i = 0; i < n; i++) {
    double sum = -b[i];
    for (int j = 0; j < n; j++) {
      sum += p->dense[i * n + j] * x[j];
    }
    residual = fmax(residual, fabs(sum));
    difference = fmax(difference, fabs(x[i] - y[i]));
  }
  double scale = largest(n * n, p->dense) * largest(n, x);
  ck_assert_msg(residual <= 1e-12 * scale, "residual %.2e of %.2e", residual, scale);
  ck_assert_msg(difference <= 1e-8 * largest(n, y), "difference %.2e", difference);
  memcpy(copy, p->dense, size * size * sizeof(double));
  dsyev_("N", "U", &n, copy, &n, y, work, &work_size, &info);
  ck_assert_int_eq(info, 0);
  for (int i = 0; i < n; i++) {
    expected += y[i] < 0;
  }
  ck_assert_int_eq(negative, expected);
  ldlt_solve(ldlt, b, b); /* in place */
  ck_assert_mem_eq(b, x, size * sizeof(double));
  free(b);
  free(x);
  free(y);
  free(copy);
  free(work);
  free(pivot);
}

static const int sizes[] = {6, 13, 60, 150};

/* Share of the dofs with a negative block: none, few, half, all. */
START_TEST(agrees_with_lapack) {
  static const double shares[] = {0, 0.05, 0.5, 1};
  struct problem p;
  struct ldlt *ldlt;
  problem_open(&p, sizes[_i / 4], (unsigned)(7 + _i));
  create(&p, &ldlt);
  signed char *part = allocate((size_t)p.dofs, 1);
  for (int round = 0; round < 2; round++) { /* new values, some cliques come and go */
    int negative = 0;
    for (int d = 0; d < p.dofs; d++) {
      part[d] = 0.5 * (uniform(&p.seed) + 1) < shares[_i % 4] ? -1 : 1;
      negative += part[d] < 0;
    }
    fill(&p, part);
    compare(&p, ldlt);
    ck_assert_int_eq(ldlt_factor(ldlt, (const double *const *)p.value), negative);
  }
  free(part);
  ldlt_destroy(ldlt);
  problem_close(&p);
}
END_TEST

/* A definite matrix shifted by a multiple of the unit matrix: the inertia counts eigenvalues. */
START_TEST(inertia_counts_eigenvalues) {
  struct problem p;
  struct ldlt *ldlt;
  problem_open(&p, 40, 3);
  create(&p, &ldlt);
  signed char *part = allocate((size_t)p.dofs, 1);
  memset(part, 1, (size_t)p.dofs);
  for (double shift = 5; shift < 10; shift++) {
    fill(&p, part);
    for (int c = 0; c < p.cliques; c++) { /* every clique loses `shift` on its diagonal */
      double *value = p.value[c];
      for (int i = 0; value && i < CLIQUE_DOFS; i++) {
        int dof = p.list[p.start[c] + i];
        *value -= shift;
        if (dof >= 0) {
          p.dense[dof * p.dofs + dof] -= shift;
        }
        value += CLIQUE_DOFS - i;
      }
    }
    int n = p.dofs, info, work_size = 64 * n, expected = 0;
    double *value = allocate((size_t)n, sizeof(double)),
           *work = allocate(64 * (size_t)n, sizeof(double));
    dsyev_("N", "U", &n, p.dense, &n, value, work, &work_size, &info);
    for (int i = 0; i < n; i++) {
      expected += value[i] < 0;
    }
    ck_assert_int_eq(ldlt_factor(ldlt, (const double *const *)p.value), expected);
    ck_assert_int_gt(expected, 0);
    free(value);
    free(work);
  }
  free(part);
  ldlt_destroy(ldlt);
  problem_close(&p);
}
END_TEST

START_TEST(statistics_count_a_dense_matrix) {
  int start[2] = {0, 30}, dofs[30], node_of[30];
  for (int i = 0; i < 30; i++) {
    dofs[i] = i;
    node_of[i] = i / 3;
  }
  struct ldlt_pattern pattern = {30, 10, node_of, 1, start, dofs};
  struct ldlt *ldlt;
  ck_assert_int_eq(ldlt_create(&pattern, &ldlt, NULL), STATUS_OK);
  struct ldlt_statistics s = ldlt_statistics(ldlt);
  ck_assert_int_eq(s.largest_front, 30);
  ck_assert_uint_ge(s.factor_entries, 30 * 31 / 2);
  ck_assert_double_ge(s.flops, 30.0 * 30 * 30 / 3);
  ck_assert_double_le(s.flops, 2 * 30.0 * 30 * 30 / 3);
  ldlt_destroy(ldlt);
  ldlt_destroy(NULL);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("ldlt");
  TCase *ldlt = tcase_create("ldlt");
  tcase_set_timeout(ldlt, 60);
  tcase_add_loop_test(ldlt, agrees_with_lapack, 0, 16);
  tcase_add_test(ldlt, inertia_counts_eigenvalues);
  tcase_add_test(ldlt, statistics_count_a_dense_matrix);
  suite_add_tcase(suite, ldlt);
  return suite_run(suite);
}
