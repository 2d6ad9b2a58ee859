/* Panels of PANEL columns are factorised; the rows below are solved in blocks of ROWS rows, packed
 * so that the products that follow read them in order; the products run in tiles of ROWS x COLUMNS
 * that stay in registers. The same code is compiled for several instruction sets. */
#include "solver/fe/ldlt_front.h"

#include <math.h>
#include <string.h>

enum {
  PANEL = 32,
  VECTOR = 8,  /* doubles in a vector; narrower machines take several registers */
  ROWS = 16,   /* of a packed block and of a tile */
  COLUMNS = 8, /* of a tile */
  DEPTH = 256, /* columns multiplied at once, so that their packed rows stay in the cache */
  SOLVE = 4    /* columns solved at once */
};

#define INLINE static inline __attribute__((always_inline))

/* Eight doubles, aligned like one. */
typedef double vector __attribute__((vector_size(VECTOR * sizeof(double)), aligned(8)));

/* Register tile of one instruction set: vectors of rows x columns at a time. */
struct shape {
  int vectors, columns;
};

size_t ldlt_front_work(int rows, int columns) {
  size_t padded = (size_t)rows - (size_t)columns + ROWS;
  return 2 * (padded * (size_t)columns + ((size_t)columns + ROWS) * PANEL);
}

static int round_up(int n, int unit) {
  return (n + unit - 1) / unit * unit;
}

/* L S L^T of the leading block of `width` columns, held in `block` (PANEL x PANEL by columns, the
 * rest of it zero). scaled[k][m] = S_m L_km; inverse[k] = S_k / L_kk. */
INLINE int factor_block(int width, double *restrict block, double *restrict sign,
                        double (*restrict scaled)[PANEL], double *restrict inverse) {
  double scale = 0;
  int negative = 0;
  for (int k = 0; k < width; k++) {
    scale = fmax(scale, fabs(block[k * (PANEL + 1)]));
  }
  double least = 1e-300 + 1e-18 * scale;
  for (int k = 0; k < width; k++) {
    vector *column = (vector *)(block + k * PANEL);
    vector sum[PANEL / VECTOR];
    memcpy(sum, column, sizeof sum);
    for (int m = 0; m < k; m++) {
      const vector *other = (const vector *)(block + m * PANEL);
      for (int v = 0; v < PANEL / VECTOR; v++) {
        sum[v] -= scaled[k][m] * other[v];
      }
    }
    double pivot = sum[k / VECTOR][k % VECTOR];
    sign[k] = pivot >= 0 ? 1 : -1;
    negative += pivot < 0;
    double root = sqrt(fmax(fabs(pivot), least));
    inverse[k] = sign[k] / root;
    for (int v = 0; v < PANEL / VECTOR; v++) {
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
INLINE void solve_block(int width, double (*restrict scaled)[PANEL], const double *inverse,
                        double *restrict x) {
  enum { PER = ROWS / VECTOR };
  vector *row = (vector *)x;
  for (int k = 0; k < width; k += SOLVE) {
    int count = width - k < SOLVE ? width - k : SOLVE;
    if (count == SOLVE) {
      vector sum[SOLVE][PER];
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
INLINE void solve_rows(int count, int width, double *panel, size_t lead,
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
INLINE void multiply_tile(struct shape shape, int depth, const double *restrict a,
                          const double *restrict b, double *restrict c, size_t lead, bool add) {
  for (int i = 0; i < ROWS / VECTOR; i += shape.vectors) {
    for (int j = 0; j < COLUMNS; j += shape.columns) {
      vector sum[COLUMNS][ROWS / VECTOR];
      for (int q = 0; q < shape.columns; q++) {
        for (int v = 0; v < shape.vectors; v++) {
          sum[q][v] = (vector){0};
        }
      }
      for (int k = 0; k < depth; k++) {
        const vector *left = (const vector *)(a + k * ROWS) + i;
        const double *right = b + k * ROWS + j;
        for (int q = 0; q < shape.columns; q++) {
          for (int v = 0; v < shape.vectors; v++) {
            sum[q][v] += left[v] * right[q];
          }
        }
      }
      for (int q = 0; q < shape.columns; q++) {
        vector *target = (vector *)(c + (size_t)(j + q) * lead) + i;
        for (int v = 0; v < shape.vectors; v++) {
          target[v] = add ? target[v] - sum[q][v] : -sum[q][v];
        }
      }
    }
  }
}

/* The same for a tile of which only height x width lies inside the matrix. */
INLINE void multiply_part(struct shape shape, int depth, const double *a, const double *b,
                          double *c, size_t lead, bool add, int height, int width) {
  double part[ROWS * COLUMNS];
  multiply_tile(shape, depth, a, b, part, ROWS, false);
  for (int j = 0; j < width; j++) {
    double *restrict target = c + (size_t)j * lead;
    for (int i = 0; i < height; i++) {
      target[i] = add ? target[i] + part[j * ROWS + i] : part[j * ROWS + i];
    }
  }
}

/* c (height x width, lead) = [c] - a b^T, blocks of a and b `step` apart; with `triangle` only
 * what touches the lower triangle. */
INLINE void multiply(struct shape shape, int height, int width, int depth, const double *a,
                     const double *b, size_t step_a, size_t step_b, double *c, size_t lead,
                     bool add, bool triangle) {
  for (int j = 0; j < width; j += COLUMNS) {
    const double *right = b + (size_t)(j / ROWS) * step_b + j % ROWS;
    int columns = width - j < COLUMNS ? width - j : COLUMNS;
    for (int i = triangle ? j / ROWS * ROWS : 0; i < height; i += ROWS) {
      const double *left = a + (size_t)(i / ROWS) * step_a;
      double *target = c + (size_t)j * lead + i;
      if (columns == COLUMNS && height - i >= ROWS) {
        multiply_tile(shape, depth, left, right, target, lead, add);
      } else {
        multiply_part(shape, depth, left, right, target, lead, add,
                      height - i < ROWS ? height - i : ROWS, columns);
      }
    }
  }
}

/* Packed blocks with every column multiplied by its sign; `from` itself when all are positive. */
INLINE const double *with_signs(int blocks, int columns, const double *from, size_t step,
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
INLINE int eliminate_panel(struct shape shape, const struct ldlt_dense *f, int first, int width,
                           double *lower, double *upper) {
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
    int blocks = round_up(inside, ROWS) / ROWS;
    const double *right = with_signs(blocks, width, upper, PANEL * ROWS, f->sign + first, negative,
                                     upper + (size_t)blocks * PANEL * ROWS);
    double *target = f->l + (size_t)(first + width) * (lead + 1);
    multiply(shape, inside, inside, width, upper, right, PANEL * ROWS, PANEL * ROWS, target, lead,
             true, true);
    multiply(shape, below, inside, width, lower + (size_t)first * ROWS, right, step, PANEL * ROWS,
             target + inside, lead, true, false);
  }
  return negative;
}

INLINE int eliminate(struct shape shape, const struct ldlt_dense *f) {
  int below = f->rows - f->columns, blocks = round_up(below, ROWS) / ROWS, negative = 0;
  size_t step = (size_t)f->columns * ROWS, packed = (size_t)blocks * step;
  double *lower = f->pack, *upper = f->pack + 2 * packed;
  for (int b = 0; b < f->columns; b += PANEL) {
    int width = f->columns - b < PANEL ? f->columns - b : PANEL;
    negative += eliminate_panel(shape, f, b, width, lower, upper);
  }
  const double *right =
      with_signs(blocks, f->columns, lower, step, f->sign, negative, lower + packed);
  for (int k = 0; k < f->columns && below > 0; k += DEPTH) {
    int depth = f->columns - k < DEPTH ? f->columns - k : DEPTH;
    size_t skip = (size_t)k * ROWS;
    multiply(shape, below, below, depth, lower + skip, right + skip, step, step, f->update,
             (size_t)below, f->add || k > 0, true);
  }
  return negative;
}

#ifdef __x86_64__

/* 16 x 8 in 16 registers of 512 bits; 8 x 4 in 8 of 256 bits; 8 x 2 in 8 of 128 bits. */
__attribute__((target("avx512f,avx512vl,avx512dq,avx2,fma"))) static int
eliminate_512(const struct ldlt_dense *front) {
  return eliminate((struct shape){2, 8}, front);
}

__attribute__((target("avx2,fma"))) static int eliminate_256(const struct ldlt_dense *front) {
  return eliminate((struct shape){1, 4}, front);
}

static int eliminate_128(const struct ldlt_dense *front) {
  return eliminate((struct shape){1, 2}, front);
}

int ldlt_front_eliminate(const struct ldlt_dense *front) {
  bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
              __builtin_cpu_supports("avx512dq");
  if (wide) {
    return eliminate_512(front);
  }
  bool middle = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return middle ? eliminate_256(front) : eliminate_128(front);
}

#else

int ldlt_front_eliminate(const struct ldlt_dense *front) {
  return eliminate((struct shape){1, 4}, front);
}

#endif
