/* Panels of PANEL columns are factorised; the rows below are solved in blocks of ROWS rows, packed
 * so that the products that follow read them in order; the products run in tiles of ROWS x COLUMNS
 * in parts that stay in registers. Included once by the file of each instruction set, which
 * defines LANES and the part: VECTORS of rows by SIDE columns. */
#include <math.h>
#include <string.h>
#include "solver/fe/lanes.h"
#include "solver/fe/ldlt_front_internal.h"

enum {
  COLUMNS = 8,                      /* of a tile */
  DEPTH = 256,                      /* columns multiplied at once, so that their packed rows stay
                                     * in the cache */
  SOLVE = LANES > 2 ? LANES / 2 : 1 /* columns solved at once */
};

/* L S L^T of the leading block of `width` columns, held in `block` (PANEL x PANEL by columns, the
 * rest of it zero). scaled[k][m] = S_m L_km; inverse[k] = S_k / L_kk. */
LANES_INLINE int factor_block(int width, double *restrict block, double *restrict sign,
                              double (*restrict scaled)[PANEL], double *restrict inverse) {
  double scale = 0;
  int negative = 0;
  for (int k = 0; k < width; k++) {
    scale = fmax(scale, fabs(block[k * (PANEL + 1)]));
  }
  double least = 1e-300 + 1e-18 * scale;
  for (int k = 0; k < width; k++) {
    lanes *column = (lanes *)(block + k * PANEL);
    lanes sum[PANEL / LANES];
    memcpy(sum, column, sizeof sum);
    for (int m = 0; m < k; m++) {
      const lanes *other = (const lanes *)(block + m * PANEL);
      for (int v = 0; v < PANEL / LANES; v++) {
        sum[v] -= scaled[k][m] * other[v];
      }
    }
    double pivot = sum[k / LANES][k % LANES];
    sign[k] = pivot >= 0 ? 1 : -1;
    negative += pivot < 0;
    double root = sqrt(fmax(fabs(pivot), least));
    inverse[k] = sign[k] / root;
    for (int v = 0; v < PANEL / LANES; v++) {
      column[v] = sum[v] * inverse[k];
    }
    block[k * (PANEL + 1)] = root;
    for (int i = k + 1; i < width; i++) {
      scaled[i][k] = sign[k] * block[k * PANEL + i];
    }
  }
  return negative;
}

/* x_k = (a_k - sum_m x_m scaled[k][m]) inverse[k] for one packed block of rows. */
LANES_INLINE void solve_block(int width, double (*restrict scaled)[PANEL], const double *inverse,
                              double *restrict x) {
  enum { PER = ROWS / LANES };
  lanes *row = (lanes *)x;
  for (int k = 0; k < width; k += SOLVE) {
    int count = width - k < SOLVE ? width - k : SOLVE;
    if (count == SOLVE) {
      lanes sum[SOLVE][PER];
      memcpy(sum, row + k * PER, sizeof sum);
      for (int m = 0; m < k; m++) {
        for (int c = 0; c < SOLVE; c++) {
          for (int v = 0; v < PER; v++) {
            sum[c][v] -= scaled[k + c][m] * row[m * PER + v];
          }
        }
      }
      memcpy(row + k * PER, sum, sizeof sum);
    }
    for (int c = 0; c < count; c++) {
      for (int m = count == SOLVE ? k : 0; m < k + c; m++) {
        for (int v = 0; v < PER; v++) {
          row[(k + c) * PER + v] -= scaled[k + c][m] * row[m * PER + v];
        }
      }
      for (int v = 0; v < PER; v++) {
        row[(k + c) * PER + v] *= inverse[k + c];
      }
    }
  }
}

/* Solves `count` rows of a panel in place and leaves them packed: block i of ROWS rows starts at
 * pack + i * step, one row of ROWS values for every column; missing rows are zero. */
LANES_INLINE void solve_rows(int count, int width, double *panel, size_t lead,
                             double (*restrict scaled)[PANEL], const double *inverse, double *pack,
                             size_t step) {
  for (int i = 0; i < count; i += ROWS, pack += step) {
    size_t bytes = sizeof *pack * (size_t)(count - i < ROWS ? count - i : ROWS);
    for (int k = 0; k < width; k++) {
      double *to = pack + k * ROWS;
      const double *from = panel + (size_t)k * lead + i;
      if (bytes == sizeof *pack * ROWS) {
        memcpy(to, from, sizeof *pack * ROWS);
      } else {
        memset(to, 0, sizeof *pack * ROWS);
        memcpy(to, from, bytes);
      }
    }
    solve_block(width, scaled, inverse, pack);
    for (int k = 0; k < width; k++) {
      double *to = panel + (size_t)k * lead + i;
      if (bytes == sizeof *pack * ROWS) {
        memcpy(to, pack + k * ROWS, sizeof *pack * ROWS);
      } else {
        memcpy(to, pack + k * ROWS, bytes);
      }
    }
  }
}

/* c (ROWS x COLUMNS by columns, lead) = [c] - a b^T over `depth` packed columns. */
LANES_INLINE void multiply_tile(int depth, const double *restrict a, const double *restrict b,
                                double *restrict c, size_t lead, bool add) {
  for (int i = 0; i < ROWS / LANES; i += VECTORS) {
    for (int j = 0; j < COLUMNS; j += SIDE) {
      lanes sum[COLUMNS][ROWS / LANES];
      for (int q = 0; q < SIDE; q++) {
        for (int v = 0; v < VECTORS; v++) {
          sum[q][v] = (lanes){0};
        }
      }
      for (int k = 0; k < depth; k++) {
        const lanes *left = (const lanes *)(a + k * ROWS) + i;
        const double *right = b + k * ROWS + j;
        for (int q = 0; q < SIDE; q++) {
          for (int v = 0; v < VECTORS; v++) {
            sum[q][v] += left[v] * right[q];
          }
        }
      }
      for (int q = 0; q < SIDE; q++) {
        lanes *target = (lanes *)(c + (size_t)(j + q) * lead) + i;
        for (int v = 0; v < VECTORS; v++) {
          target[v] = add ? target[v] - sum[q][v] : -sum[q][v];
        }
      }
    }
  }
}

/* The same for a tile of which only height x width lies inside the matrix. */
LANES_INLINE void multiply_part(int depth, const double *a, const double *b, double *c, size_t lead,
                                bool add, int height, int width) {
  double part[ROWS * COLUMNS];
  multiply_tile(depth, a, b, part, ROWS, false);
  for (int j = 0; j < width; j++) {
    double *restrict target = c + (size_t)j * lead;
    for (int i = 0; i < height; i++) {
      target[i] = add ? target[i] + part[j * ROWS + i] : part[j * ROWS + i];
    }
  }
}

/* c (height x width, lead) = [c] - a b^T, blocks of a and b `step` apart; with `triangle` only
 * what touches the lower triangle. */
LANES_INLINE void multiply(int height, int width, int depth, const double *a, const double *b,
                           size_t step_a, size_t step_b, double *c, size_t lead, bool add,
                           bool triangle) {
  for (int j = 0; j < width; j += COLUMNS) {
    const double *right = b + (size_t)(j / ROWS) * step_b + j % ROWS;
    int columns = width - j < COLUMNS ? width - j : COLUMNS;
    for (int i = triangle ? j / ROWS * ROWS : 0; i < height; i += ROWS) {
      const double *left = a + (size_t)(i / ROWS) * step_a;
      double *target = c + (size_t)j * lead + i;
      if (columns == COLUMNS && height - i >= ROWS) {
        multiply_tile(depth, left, right, target, lead, add);
      } else {
        multiply_part(depth, left, right, target, lead, add, height - i < ROWS ? height - i : ROWS,
                      columns);
      }
    }
  }
}

/* Packed blocks with every column multiplied by its sign; `from` itself when all are positive. */
LANES_INLINE const double *with_signs(int blocks, int columns, const double *from, size_t step,
                                      const double *sign, int negative, double *to) {
  if (negative == 0) {
    return from;
  }
  for (int i = 0; i < blocks; i++) {
    for (int k = 0; k < columns; k++) {
      for (int r = 0; r < ROWS; r++) {
        to[(size_t)i * step + (size_t)(k * ROWS + r)] =
            sign[k] * from[(size_t)i * step + (size_t)(k * ROWS + r)];
      }
    }
  }
  return to;
}

/* Factorises the panel of `width` columns that starts at column `first`, and updates the columns
 * of the front that follow it. `lower` takes the packed rows below all columns. */
LANES_INLINE int eliminate_panel(const struct ldlt_dense *f, int first, int width, double *lower,
                                 double *upper) {
  size_t lead = (size_t)f->rows, step = (size_t)f->columns * ROWS;
  int inside = f->columns - first - width, below = f->rows - f->columns;
  double block[PANEL * PANEL], scaled[PANEL][PANEL], inverse[PANEL];
  double *panel = f->l + (size_t)first * (lead + 1);
  memset(block, 0, sizeof block);
  for (int k = 0; k < width; k++) {
    memcpy(block + k * (PANEL + 1), panel + (size_t)k * (lead + 1),
           sizeof *block * (size_t)(width - k));
  }
  int negative = factor_block(width, block, f->sign + first, scaled, inverse);
  for (int k = 0; k < width; k++) {
    memcpy(panel + (size_t)k * (lead + 1), block + k * (PANEL + 1),
           sizeof *block * (size_t)(width - k));
  }
  solve_rows(inside, width, panel + width, lead, scaled, inverse, upper, PANEL * ROWS);
  solve_rows(below, width, panel + width + inside, lead, scaled, inverse,
             lower + (size_t)first * ROWS, step);
  if (inside > 0) {
    int blocks = (inside + ROWS - 1) / ROWS;
    const double *right = with_signs(blocks, width, upper, PANEL * ROWS, f->sign + first, negative,
                                     upper + (size_t)blocks * PANEL * ROWS);
    double *target = f->l + (size_t)(first + width) * (lead + 1);
    multiply(inside, inside, width, upper, right, PANEL * ROWS, PANEL * ROWS, target, lead, true,
             true);
    multiply(below, inside, width, lower + (size_t)first * ROWS, right, step, PANEL * ROWS,
             target + inside, lead, true, false);
  }
  return negative;
}

LANES_INLINE int eliminate(const struct ldlt_dense *f) {
  int below = f->rows - f->columns, blocks = (below + ROWS - 1) / ROWS, negative = 0;
  size_t step = (size_t)f->columns * ROWS, packed = (size_t)blocks * step;
  double *lower = f->pack, *upper = f->pack + 2 * packed;
  for (int b = 0; b < f->columns; b += PANEL) {
    int width = f->columns - b < PANEL ? f->columns - b : PANEL;
    negative += eliminate_panel(f, b, width, lower, upper);
  }
  const double *right =
      with_signs(blocks, f->columns, lower, step, f->sign, negative, lower + packed);
  for (int k = 0; k < f->columns && below > 0; k += DEPTH) {
    int depth = f->columns - k < DEPTH ? f->columns - k : DEPTH;
    size_t skip = (size_t)k * ROWS;
    multiply(below, below, depth, lower + skip, right + skip, step, step, f->update, (size_t)below,
             f->add || k > 0, true);
  }
  return negative;
}
