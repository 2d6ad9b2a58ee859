#include <string.h>
#include "solver/fe/ldlt_front.h"
#include "solver/fe/ldlt_internal.h"

/* Runs shorter than this on average are added value by value. */
enum { LONG_RUN = 8 };

/* Adds a clique's upper triangle by rows to the lower triangle of the front. */
static void add_clique(const int *row, int count, const double *values, double *const *column) {
  for (int i = 0; i < count; i++) {
    int r = row[i];
    if (r >= 0) {
      for (int j = i; j < count; j++) {
        int c = row[j], low = c < r ? c : r;
        if (low >= 0) {
          column[low][c < r ? r : c] += values[j - i];
        }
      }
    }
    values += count - i;
  }
}

/* Where the runs of rows begin that stay neighbours in the parent; run[] ends with `below`.
 * Returns their number. */
static int find_runs(const int *to, int below, int *run) {
  int count = 0;
  for (int i = 0; i < below; i++) {
    if (i == 0 || to[i] != to[i - 1] + 1) {
      run[count++] = i;
    }
  }
  run[count] = below;
  return count;
}

/* Adds columns first .. last - 1 of the update matrix of a child to its parent's front. */
static void extend_add(const struct ldlt *f, const struct front *child, int first, int last) {
  int below = child->rows - child->columns;
  const int *to = f->parent_row + child->row + child->columns;
  const double *update = f->stack[child->level] + child->stack;
  int runs = find_runs(to, below, f->run), at = 0;
  for (int j = first; j < last; j++) {
    double *column = f->column[to[j]];
    const double *from = update + (size_t)j * (size_t)below;
    if (below < LONG_RUN * runs) {
      for (int i = j; i < below; i++) {
        column[to[i]] += from[i];
      }
      continue;
    }
    while (f->run[at + 1] <= j) {
      at++;
    }
    for (int q = at, i = j; q < runs; i = f->run[++q]) {
      double *restrict target = column + to[i] - i;
      for (int end = f->run[q + 1]; i < end; i++) {
        target[i] += from[i];
      }
    }
  }
}

/* Columns of a child's update matrix that its parent eliminates. */
static int columns_taken(const struct ldlt *f, const struct front *child, const struct front *to) {
  const int *row = f->parent_row + child->row + child->columns;
  int count = 0, below = child->rows - child->columns;
  while (count < below && row[count] < to->columns) {
    count++;
  }
  return count;
}

/* Clears a front and adds its cliques. */
static void open_front(struct ldlt *f, const struct front *front, const double *const *values) {
  size_t lead = (size_t)front->rows, below = (size_t)(front->rows - front->columns);
  double *l = f->value + front->value, *update = f->stack[front->level] + front->stack;
  memset(l, 0, sizeof *l * lead * (size_t)front->columns);
  for (int j = 0; j < front->rows; j++) {
    f->column[j] = j < front->columns
                       ? l + (size_t)j * lead
                       : update + (size_t)(j - front->columns) * below - front->columns;
  }
  if (front->clique_count > 0) {
    memset(update, 0, sizeof *update * below * below);
  }
  for (int q = 0; q < front->clique_count; q++) {
    int c = f->clique[front->clique_first + q];
    if (values[c]) {
      add_clique(f->clique_row + f->clique_start[c], f->clique_start[c + 1] - f->clique_start[c],
                 values[c], f->column);
    }
  }
}

int ldlt_factor(struct ldlt *f, const double *const *values) {
  int negative = 0, waiting = 0;
  for (int k = 0; k < f->front_count; k++) {
    const struct front *front = &f->front[k];
    int first = waiting;
    open_front(f, front, values);
    while (first > 0 && f->front[f->pending[first - 1]].parent == k) {
      const struct front *child = &f->front[f->pending[--first]];
      extend_add(f, child, 0, columns_taken(f, child, front));
    }
    struct ldlt_dense dense = {.rows = front->rows,
                               .columns = front->columns,
                               .l = f->value + front->value,
                               .update = f->stack[front->level] + front->stack,
                               .add = front->clique_count > 0,
                               .sign = f->sign + front->first,
                               .pack = f->work};
    negative += ldlt_front_eliminate(&dense);
    /* What goes to the update matrix is added after it was written, which saves clearing it. */
    while (waiting > first) {
      const struct front *child = &f->front[f->pending[--waiting]];
      extend_add(f, child, columns_taken(f, child, front), child->rows - child->columns);
    }
    if (front->parent >= 0) {
      f->pending[waiting++] = k;
    }
  }
  return negative;
}
