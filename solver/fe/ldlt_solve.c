/* Substitution with the factor. The work is one sweep over L each way, so it is bound by the
 * memory: every front is read once from its first to its last column or back, several columns at a
 * time. The same code is compiled for several instruction sets. */
#include <string.h>
#include "solver/fe/lanes.h"
#include "solver/fe/ldlt_internal.h"

enum { WIDE = 4 }; /* columns at a time */

/* x -= L of the first columns, which are solved on the way; x holds all rows of the front. */
LANES_INLINE void forward(int rows, int columns, const double *restrict l, double *restrict x) {
  size_t lead = (size_t)rows;
  int k = 0;
  for (; k + WIDE <= columns; k += WIDE) {
    const double *a = l + (size_t)k * lead, *b = a + lead, *c = b + lead, *d = c + lead;
    double x0 = x[k] / a[k];
    double x1 = (x[k + 1] - a[k + 1] * x0) / b[k + 1];
    double x2 = (x[k + 2] - a[k + 2] * x0 - b[k + 2] * x1) / c[k + 2];
    double x3 = (x[k + 3] - a[k + 3] * x0 - b[k + 3] * x1 - c[k + 3] * x2) / d[k + 3];
    x[k] = x0;
    x[k + 1] = x1;
    x[k + 2] = x2;
    x[k + 3] = x3;
#pragma omp simd
    for (int i = k + WIDE; i < rows; i++) {
      x[i] -= a[i] * x0 + b[i] * x1 + c[i] * x2 + d[i] * x3;
    }
  }
  for (; k < columns; k++) {
    const double *a = l + (size_t)k * lead;
    double x0 = x[k] /= a[k];
#pragma omp simd
    for (int i = k + 1; i < rows; i++) {
      x[i] -= a[i] * x0;
    }
  }
}

/* Solves the first columns with the transpose of L from the last to the first; x holds all rows. */
LANES_INLINE void backward(int rows, int columns, const double *restrict l, double *restrict x) {
  size_t lead = (size_t)rows;
  int k = columns;
  for (; k % WIDE != 0; k--) {
    const double *a = l + (size_t)(k - 1) * lead;
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (int i = k; i < rows; i++) {
      sum += a[i] * x[i];
    }
    x[k - 1] = (x[k - 1] - sum) / a[k - 1];
  }
  for (k -= WIDE; k >= 0; k -= WIDE) {
    const double *a = l + (size_t)k * lead, *b = a + lead, *c = b + lead, *d = c + lead;
    double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
#pragma omp simd reduction(+ : s0, s1, s2, s3)
    for (int i = k + WIDE; i < rows; i++) {
      s0 += a[i] * x[i];
      s1 += b[i] * x[i];
      s2 += c[i] * x[i];
      s3 += d[i] * x[i];
    }
    double x3 = (x[k + 3] - s3) / d[k + 3];
    double x2 = (x[k + 2] - s2 - c[k + 3] * x3) / c[k + 2];
    double x1 = (x[k + 1] - s1 - b[k + 2] * x2 - b[k + 3] * x3) / b[k + 1];
    x[k] = (x[k] - s0 - a[k + 1] * x1 - a[k + 2] * x2 - a[k + 3] * x3) / a[k];
    x[k + 1] = x1;
    x[k + 2] = x2;
    x[k + 3] = x3;
  }
}

/* y in elimination order; x is work for the rows of a front. */
LANES_INLINE void substitute(const struct ldlt *f, double *restrict y, double *restrict x) {
  for (int k = 0; k < f->front_count; k++) {
    const struct front *front = &f->front[k];
    const int *row = f->row + front->row;
    size_t head = sizeof *x * (size_t)front->columns;
    memcpy(x, y + front->first, head);
    memset(x + front->columns, 0, sizeof *x * (size_t)(front->rows - front->columns));
    forward(front->rows, front->columns, f->value + front->value, x);
    memcpy(y + front->first, x, head);
    for (int i = front->columns; i < front->rows; i++) {
      y[row[i]] += x[i];
    }
  }
  for (int i = 0; i < f->dof_count; i++) {
    y[i] *= f->sign[i];
  }
  for (int k = f->front_count - 1; k >= 0; k--) {
    const struct front *front = &f->front[k];
    const int *row = f->row + front->row;
    size_t head = sizeof *x * (size_t)front->columns;
    memcpy(x, y + front->first, head);
    for (int i = front->columns; i < front->rows; i++) {
      x[i] = y[row[i]];
    }
    backward(front->rows, front->columns, f->value + front->value, x);
    memcpy(y + front->first, x, head);
  }
}

LANES_TARGET_512 static void substitute_512(const struct ldlt *f, double *y, double *x) {
  substitute(f, y, x);
}

LANES_TARGET_256 static void substitute_256(const struct ldlt *f, double *y, double *x) {
  substitute(f, y, x);
}

static void substitute_128(const struct ldlt *f, double *y, double *x) {
  substitute(f, y, x);
}

void ldlt_solve(struct ldlt *f, const double *b, double *x) {
  double *y = f->vector, *work = f->vector + f->dof_count;
  for (int i = 0; i < f->dof_count; i++) {
    y[f->position[i]] = b[i];
  }
  switch (lanes_width()) {
  case 512:
    substitute_512(f, y, work);
    break;
  case 256:
    substitute_256(f, y, work);
    break;
  default:
    substitute_128(f, y, work);
  }
  for (int i = 0; i < f->dof_count; i++) {
    x[i] = y[f->position[i]];
  }
}
