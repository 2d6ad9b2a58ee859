#include "solver/hlpv/riccati.h"

#include <math.h>
#include <string.h>

#include "solver/base/lapack.h"

enum {
  N = RICCATI_STATES_MAX,
  M = RICCATI_INPUTS_MAX,
  PENCIL = 2 * N,
  WORK = 8 * PENCIL + 16 + 64
};

static int is_stable(const double *alpha_r, const double *alpha_i, const double *beta) {
  return hypot(*alpha_r, *alpha_i) < fabs(*beta);
}

/* c = a b, or a b' when transposed; a: rows x inner. All row by row. */
static void multiply(int rows, int inner, int columns, const double *a, const double *b, double *c,
                     int transposed) {
  for (int i = 0; i < rows; i++) {
    for (int j = 0; j < columns; j++) {
      double sum = 0;
      for (int k = 0; k < inner; k++) {
        sum += a[i * inner + k] * (transposed ? b[j * inner + k] : b[k * columns + j]);
      }
      c[i * columns + j] = sum;
    }
  }
}

/* Replaces `right` (n x columns, row by row) by matrix^-1 right. */
static enum status solve(int n, int columns, const double *matrix, double *right,
                         struct error *error) {
  double a[N * N], b[N * PENCIL];
  int pivot[N], info = 0;
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      a[j * n + i] = matrix[i * n + j];
    }
    for (int j = 0; j < columns; j++) {
      b[j * n + i] = right[i * columns + j];
    }
  }
  dgesv_(&n, &columns, a, &n, pivot, b, &n, &info);
  if (info != 0) {
    return error_set(error, STATUS_DIVERGED, NULL, "a matrix of the Riccati equation is singular");
  }
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < columns; j++) {
      right[i * columns + j] = b[j * n + i];
    }
  }
  return STATUS_OK;
}

/* The pencil, column by column, 2n x 2n. */
static enum status build_pencil(const struct riccati_problem *p, double *f, double *g,
                                struct error *error) {
  int n = p->states, m = p->inputs, rows = 2 * n;
  double weighted[M * N], s[N * N];
  for (int i = 0; i < m; i++) {
    for (int j = 0; j < n; j++) {
      weighted[i * n + j] = p->b[j * m + i];
    }
  }
  enum status status = solve(m, n, p->r, weighted, error);
  if (status != STATUS_OK) {
    return status;
  }
  multiply(n, m, n, p->b, weighted, s, 0);
  memset(f, 0, (size_t)(rows * rows) * sizeof *f);
  memset(g, 0, (size_t)(rows * rows) * sizeof *g);
  for (int i = 0; i < n; i++) {
    f[(n + i) * rows + n + i] = g[i * rows + i] = 1.0;
    for (int j = 0; j < n; j++) {
      f[j * rows + i] = p->a[i * n + j];
      f[j * rows + n + i] = -p->q[i * n + j];
      g[(n + j) * rows + i] = s[i * n + j];
      g[(n + j) * rows + n + i] = p->a[j * n + i];
    }
  }
  return STATUS_OK;
}

/* X = U2 U1^-1, symmetric, from the first n columns of the subspace: X' = U1'^-1 U2'. */
static enum status quotient(int n, const double *subspace, double *x, struct error *error) {
  double upper[N * N] = {0}, lower[N * N] = {0};
  int rows = 2 * n;
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      upper[i * n + j] = subspace[i * rows + j];
      lower[i * n + j] = subspace[i * rows + n + j];
    }
  }
  enum status status = solve(n, n, upper, lower, error);
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      x[i * n + j] = 0.5 * (lower[i * n + j] + lower[j * n + i]);
    }
  }
  return status;
}

/* K = (R + B' X B)^-1 B' X A. */
static enum status feedback(const struct riccati_problem *p, const double *x, double *gain,
                            struct error *error) {
  int n = p->states, m = p->inputs;
  double transposed[M * N], bx[M * N], bxb[M * M];
  for (int i = 0; i < m; i++) {
    for (int j = 0; j < n; j++) {
      transposed[i * n + j] = p->b[j * m + i];
    }
  }
  multiply(m, n, n, transposed, x, bx, 0);
  multiply(m, n, m, bx, p->b, bxb, 0);
  for (int i = 0; i < m * m; i++) {
    bxb[i] += p->r[i];
  }
  multiply(m, n, n, bx, p->a, gain, 0);
  return solve(m, n, bxb, gain, error);
}

enum status riccati_solve(const struct riccati_problem *problem, double *x, double *gain,
                          struct error *error) {
  double f[PENCIL * PENCIL], g[PENCIL * PENCIL], subspace[PENCIL * PENCIL], none[1];
  double alpha_r[PENCIL], alpha_i[PENCIL], beta[PENCIL], work[WORK];
  int rows = 2 * problem->states, selected = 0, flags[PENCIL], one = 1, size = WORK, info = 0;
  enum status status = build_pencil(problem, f, g, error);
  if (status != STATUS_OK) {
    return status;
  }
  dgges_("N", "V", "S", is_stable, &rows, f, &rows, g, &rows, &selected, alpha_r, alpha_i, beta,
         none, &one, subspace, &rows, work, &size, flags, &info);
  if (info != 0 || selected != problem->states) {
    return error_set(error, STATUS_DIVERGED, NULL,
                     "the Riccati equation has no stabilising solution: %d of %d eigenvalues are "
                     "inside the unit circle",
                     selected, problem->states);
  }
  status = quotient(problem->states, subspace, x, error);
  return status == STATUS_OK ? feedback(problem, x, gain, error) : status;
}

enum status riccati_eigenvalues(int n, const double *matrix, double (*value)[2],
                                struct error *error) {
  double a[N * N], real[N], imaginary[N], work[WORK], none[1];
  int one = 1, size = WORK, info = 0;
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      a[j * n + i] = matrix[i * n + j];
    }
  }
  dgeev_("N", "N", &n, a, &n, real, imaginary, none, &one, none, &one, work, &size, &info);
  for (int i = 0; i < n; i++) {
    value[i][0] = real[i];
    value[i][1] = imaginary[i];
  }
  return info == 0 ? STATUS_OK
                   : error_set(error, STATUS_DIVERGED, NULL, "eigenvalues do not converge");
}
