#include <cblas.h>
#include <math.h>
#include <string.h>
#include "solver/fe/ldlt_internal.h"

/* Columns eliminated between two updates of the rest of a front. */
enum { PANEL = 32 };

/* Adds a clique's upper triangle by rows to the lower triangle of the front. */
static void add_clique(const int *row, int count, const double *values, double *front,
                       size_t height) {
  for (int i = 0; i < count; i++) {
    int r = row[i];
    if (r < 0) {
      values += count - i;
      continue;
    }
    double *column = front + (size_t)r * height;
    for (int j = i; j < count; j++) {
      int c = row[j];
      if (c >= r) {
        column[c] += *values;
      } else if (c >= 0) {
        front[(size_t)r + (size_t)c * height] += *values;
      }
      values++;
    }
  }
}

/* Adds the update matrix of a child to its parent's front. */
static void extend_add(const struct ldlt *f, const struct front *child, double *front,
                       size_t height) {
  int below = child->rows - child->columns;
  const int *to = f->parent_row + child->row + child->columns;
  const double *update = f->stack + child->stack;
  for (int j = 0; j < below; j++) {
    double *column = front + (size_t)to[j] * height;
    const double *from = update + (size_t)j * (size_t)below;
    /* Rows that stay neighbours in the parent are added in one run. */
    for (int i = j; i < below;) {
      int shift = to[i] - i, first = i;
      while (i < below && to[i] - i == shift) {
        i++;
      }
      double *restrict target = column + shift;
      for (int t = first; t < i; t++) {
        target[t] += from[t];
      }
    }
  }
}

/* Unblocked L S L^T of the leading n x n block. Returns the number of negative pivots. A pivot
 * that vanishes against the block's scale is replaced by that scale's round-off. */
static int factor_block(int n, double *a, size_t lead, double *sign) {
  int negative = 0;
  double scale = 0;
  for (int j = 0; j < n; j++) {
    scale = fmax(scale, fabs(a[(size_t)j * (lead + 1)]));
  }
  double least = 1e-300 + 1e-18 * scale;
  for (int j = 0; j < n; j++) {
    double *restrict column = a + (size_t)j * lead;
    double pivot = column[j];
    sign[j] = pivot >= 0 ? 1 : -1;
    negative += pivot < 0;
    double root = sqrt(fmax(fabs(pivot), least));
    column[j] = root;
    double inverse = sign[j] / root;
    for (int i = j + 1; i < n; i++) {
      column[i] *= inverse;
    }
    for (int k = j + 1; k < n; k++) {
      double factor = sign[j] * column[k];
      double *restrict target = a + (size_t)k * lead;
      for (int i = k; i < n; i++) {
        target[i] -= factor * column[i];
      }
    }
  }
  return negative;
}

/* target -= L S L^T for `columns` columns of L (height rows, leading dimension lead), of which
 * the columns with sign -1 are added back twice. Only the lower triangle counts. */
static void rank_update(int height, int columns, const double *l, size_t lead, const double *sign,
                        int negative, double *target) {
  int ld = (int)lead;
  cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, height, columns, -1, l, ld, 1, target, ld);
  for (int j = 0; negative > 0 && j < columns; j++) {
    if (sign[j] < 0) {
      cblas_dsyr(CblasColMajor, CblasLower, height, 2, l + (size_t)j * lead, 1, target, ld);
    }
  }
}

/* The same for the rectangle below the triangle: target (height x width) -= L2 S L1^T. */
static void rectangle_update(int height, int width, int columns, const double *l1, const double *l2,
                             size_t lead, const double *sign, int negative, double *target) {
  int ld = (int)lead;
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, height, width, columns, -1, l2, ld, l1, ld,
              1, target, ld);
  for (int j = 0; negative > 0 && j < columns; j++) {
    if (sign[j] < 0) {
      cblas_dger(CblasColMajor, height, width, 2, l2 + (size_t)j * lead, 1, l1 + (size_t)j * lead,
                 1, target, ld);
    }
  }
}

/* Eliminates the columns of a front panel by panel; the update matrix is left in the trailing
 * square. Returns the number of negative pivots. */
static int eliminate(const struct front *front, double *a, double *sign) {
  size_t lead = (size_t)front->rows;
  int total = 0, below = front->rows - front->columns;
  for (int b = 0; b < front->columns; b += PANEL) {
    int width = front->columns - b < PANEL ? front->columns - b : PANEL;
    double *diagonal = a + (size_t)b * (lead + 1);
    int negative = factor_block(width, diagonal, lead, sign + b);
    total += negative;
    int rest = front->rows - b - width;
    if (rest == 0) {
      continue;
    }
    double *panel = diagonal + width;
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, rest, width, 1,
                diagonal, (int)lead, panel, (int)lead);
    for (int j = 0; negative > 0 && j < width; j++) {
      if (sign[b + j] < 0) {
        cblas_dscal(rest, -1, panel + (size_t)j * lead, 1);
      }
    }
    int inside = front->columns - b - width;
    if (inside > 0) {
      double *target = panel + (size_t)width * lead;
      rank_update(inside, width, panel, lead, sign + b, negative, target);
      if (below > 0) {
        rectangle_update(below, inside, width, panel, panel + inside, lead, sign + b, negative,
                         target + inside);
      }
    }
  }
  if (below > 0) {
    rank_update(below, front->columns, a + front->columns, lead, sign, total,
                a + (size_t)front->columns * (lead + 1));
  }
  return total;
}

/* Moves L to its place and the update matrix to the stack. */
static void store_front(struct ldlt *f, const struct front *front) {
  size_t lead = (size_t)front->rows, columns = (size_t)front->columns;
  double *value = f->value + front->value;
  for (size_t j = 0; j < columns; j++) {
    memcpy(value + j * lead + j, f->work + j * lead + j, sizeof *value * (lead - j));
  }
  if (front->parent < 0) {
    return;
  }
  size_t below = lead - columns;
  double *update = f->stack + front->stack;
  for (size_t j = 0; j < below; j++) {
    memcpy(update + j * below + j, f->work + (columns + j) * (lead + 1),
           sizeof *update * (below - j));
  }
}

int ldlt_factor(struct ldlt *f, const double *const *values) {
  int negative = 0, waiting = 0;
  for (int k = 0; k < f->front_count; k++) {
    const struct front *front = &f->front[k];
    size_t lead = (size_t)front->rows;
    for (size_t j = 0; j < lead; j++) {
      memset(f->work + j * (lead + 1), 0, sizeof *f->work * (lead - j));
    }
    for (int q = 0; q < front->clique_count; q++) {
      int c = f->clique[front->clique_first + q];
      if (values[c]) {
        add_clique(f->clique_row + f->clique_start[c], f->clique_start[c + 1] - f->clique_start[c],
                   values[c], f->work, lead);
      }
    }
    while (waiting > 0 && f->front[f->pending[waiting - 1]].parent == k) {
      extend_add(f, &f->front[f->pending[--waiting]], f->work, lead);
    }
    negative += eliminate(front, f->work, f->sign + front->first);
    store_front(f, front);
    if (front->parent >= 0) {
      f->pending[waiting++] = k;
    }
  }
  return negative;
}

void ldlt_solve(struct ldlt *f, const double *b, double *x) {
  double *y = f->vector, *part = f->vector + f->dof_count;
  for (int i = 0; i < f->dof_count; i++) {
    y[f->position[i]] = b[i];
  }
  for (int k = 0; k < f->front_count; k++) {
    const struct front *front = &f->front[k];
    const double *l = f->value + front->value;
    int lead = front->rows, below = front->rows - front->columns;
    double *head = y + front->first;
    cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, front->columns, l, lead,
                head, 1);
    if (below > 0) {
      const int *row = f->row + front->row + front->columns;
      cblas_dgemv(CblasColMajor, CblasNoTrans, below, front->columns, 1, l + front->columns, lead,
                  head, 1, 0, part, 1);
      for (int i = 0; i < below; i++) {
        y[row[i]] -= part[i];
      }
    }
  }
  for (int i = 0; i < f->dof_count; i++) {
    y[i] *= f->sign[i];
  }
  for (int k = f->front_count - 1; k >= 0; k--) {
    const struct front *front = &f->front[k];
    const double *l = f->value + front->value;
    int lead = front->rows, below = front->rows - front->columns;
    double *head = y + front->first;
    if (below > 0) {
      const int *row = f->row + front->row + front->columns;
      for (int i = 0; i < below; i++) {
        part[i] = y[row[i]];
      }
      cblas_dgemv(CblasColMajor, CblasTrans, below, front->columns, -1, l + front->columns, lead,
                  part, 1, 1, head, 1);
    }
    cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, front->columns, l, lead, head,
                1);
  }
  for (int i = 0; i < f->dof_count; i++) {
    x[i] = y[f->position[i]];
  }
}
