/* Evaluation of one element, in three steps: the response at the Gauss points, LANES of them at a
 * time, pulled back to the parent coordinates; the sums over the points, which factor into three
 * sums over one direction each, since shape functions and points are products; the condensation.
 * Included once by the file of each instruction set, which defines LANES. */
#include <string.h>
#include "solver/fe/element_evaluate.h"

#define REAL lanes
#define LAW(name) lanes_##name
#include "solver/fe/hyperelastic_law.h"

#define ALIGNED __attribute__((aligned(64)))

enum {
  PAIRS = 6, /* 00 01 02 11 12 22 */
  BLOCKS = HEX27_STRIDE / LANES,
  SLACK = LANES, /* read, but not used, behind a row that is read from its middle */
  TAIL = 4,      /* last rows of the packed tangent, too short for whole vectors */
  RIGHT = 16     /* columns of residual and coupling, 3 m + i, padded; m = 0 is the residual */
};

static const double j_minimum = 0.02;

/* What the sums over the points take, weighted; i and k are directions in space, d and e those of
 * the parent coordinates. */
struct response {
  double stress[9][HEX27_STRIDE];          /* total first Piola-Kirchhoff, 3 i + d */
  double volume[9][HEX27_STRIDE];          /* dJ/dF, 3 i + d */
  double tangent[9 * PAIRS][HEX27_STRIDE]; /* 9 pair + 3 d + e */
  double excess[HEX27_STRIDE];             /* J - 1 - p / kappa */
};

/* y = x^(-1/3) for normal x > 0: a guess from the exponent, good to 4 %, and two steps of fourth
 * order. */
LANES_INLINE void inverse_cube_root(const lanes *x, lanes *y) {
  lanes_bits bits;
  memcpy(&bits, x, sizeof bits);
  bits = (0x553ef0ffULL - (((bits >> 32) * 0x55555556ULL) >> 32)) << 32;
  memcpy(y, &bits, sizeof bits);
  for (int step = 0; step < 2; step++) {
    lanes h = 1.0 - *x * *y * *y * *y;
    *y += *y * h * (1.0 / 3 + h * (2.0 / 9 + h * (14.0 / 81)));
  }
}

/* F = I + (sum_a u_a dN_a/dxi) dxi/dX at the points of a block. */
LANES_INLINE void deformation(const struct element_geometry *geometry, int block,
                              double u[3][HEX27_STRIDE], lanes f[9]) {
  const struct hex27_tables *tables = geometry->tables;
  lanes h[9];
  for (int i = 0; i < 9; i++) {
    h[i] = (lanes){0};
  }
  for (int a = 0; a < HEX27_NODES; a++) {
    for (int d = 0; d < 3; d++) {
      lanes n = *(const lanes *)(tables->by_node[a][d] + LANES * block);
      for (int i = 0; i < 3; i++) {
        h[3 * i + d] += u[i][a] * n;
      }
    }
  }
  for (int j = 0; j < 3; j++) {
    for (int i = 0; i < 3; i++) {
      f[3 * i + j] = (lanes){0} + (i == j ? 1.0 : 0.0);
      for (int d = 0; d < 3; d++) {
        f[3 * i + j] +=
            h[3 * i + d] * *(const lanes *)(geometry->inverse[3 * d + j] + LANES * block);
      }
    }
  }
}

/* Ogden's law point by point. */
static void ogden_points(const struct material_spec *material, const struct lanes_point *x,
                         double *stress, double *tangent) {
  for (int v = 0; v < LANES; v++) {
    struct kinematics k = {.j = x->j[v]};
    double s[9], a[81];
    for (int i = 0; i < 9; i++) {
      k.f[i] = x->f[i][v];
      k.cofactor[i] = x->g[i][v];
    }
    hyperelastic_isochoric(material, &k, s, tangent ? a : NULL);
    for (int i = 0; i < 9; i++) {
      stress[LANES * i + v] = s[i];
    }
    double *pair = tangent;
    for (int m = 0; tangent && m < 9; m++) {
      int i = m / 3, k2 = m % 3;
      for (int n = 0; i <= k2 && n < 9; n++, pair += LANES) {
        pair[v] = a[9 * (3 * i + n / 3) + 3 * k2 + n % 3];
      }
    }
  }
}

/* Total stress P = P_iso + p J G and tangent A = A_iso + p J (G_iJ G_kL - G_kJ G_iL). */
LANES_INLINE void add_volumetric(const lanes *pj, const lanes g[9], lanes stress[9],
                                 lanes *tangent) {
  for (int i = 0; i < 9; i++) {
    stress[i] += *pj * g[i];
  }
  for (int i = 0; tangent && i < 3; i++) {
    for (int k = i; k < 3; k++, tangent += 9) {
      for (int j = 0; j < 3; j++) {
        lanes own = *pj * g[3 * i + j], other = *pj * g[3 * k + j];
        for (int l = 0; l < 3 && i != k; l++) {
          tangent[3 * j + l] += own * g[3 * k + l] - other * g[3 * i + l];
        }
      }
    }
  }
}

/* With S = stiffness (C - history): stress F S, and tangent
 *   d_ik S_JL + stiffness (F_iL F_kJ + B_ik d_JL),   B = F F^T */
LANES_INLINE void add_viscous(const struct element_viscosity *viscosity, int block,
                              const lanes f[9], lanes stress[9], lanes *tangent) {
  lanes second[9];
  double stiffness = viscosity->stiffness;
  int row = 0;
  for (int j = 0; j < 3; j++) {
    for (int l = j; l < 3; l++, row++) {
      lanes c = f[j] * f[l] + f[3 + j] * f[3 + l] + f[6 + j] * f[6 + l];
      c = stiffness * (c - *(const lanes *)(viscosity->history[row] + LANES * block));
      second[3 * j + l] = second[3 * l + j] = c;
    }
  }
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      for (int l = 0; l < 3; l++) {
        stress[3 * i + j] += f[3 * i + l] * second[3 * l + j];
      }
    }
  }
  for (int i = 0; tangent && i < 3; i++) {
    for (int k = i; k < 3; k++, tangent += 9) {
      lanes b = f[3 * i] * f[3 * k] + f[3 * i + 1] * f[3 * k + 1] + f[3 * i + 2] * f[3 * k + 2];
      for (int j = 0; j < 3; j++) {
        tangent[4 * j] += stiffness * b;
        for (int l = 0; l < 3; l++) {
          tangent[3 * j + l] += stiffness * f[3 * i + l] * f[3 * k + j];
          if (i == k) {
            tangent[3 * j + l] += second[3 * j + l];
          }
        }
      }
    }
  }
}

/* to_id = weight sum_J dxi_d/dX_J from_iJ */
LANES_INLINE void pull_back(const lanes scaled[9], const lanes from[9], int block,
                            double (*to)[HEX27_STRIDE]) {
  for (int i = 0; i < 3; i++) {
    for (int d = 0; d < 3; d++) {
      *(lanes *)(to[3 * i + d] + LANES * block) = scaled[3 * d] * from[3 * i] +
                                                  scaled[3 * d + 1] * from[3 * i + 1] +
                                                  scaled[3 * d + 2] * from[3 * i + 2];
    }
  }
}

/* to_de = sum_JL dxi_d/dX_J dxi_e/dX_L from_JL for every pair, the one of the factors weighted */
LANES_INLINE void pull_back_twice(const lanes scaled[9], const lanes inverse[9],
                                  const lanes tangent[9 * PAIRS], int block,
                                  double (*to)[HEX27_STRIDE]) {
  for (int pair = 0; pair < PAIRS; pair++, tangent += 9, to += 9) {
    for (int d = 0; d < 3; d++) {
      lanes half[3];
      for (int l = 0; l < 3; l++) {
        half[l] = scaled[3 * d] * tangent[l] + scaled[3 * d + 1] * tangent[3 + l] +
                  scaled[3 * d + 2] * tangent[6 + l];
      }
      for (int e = 0; e < 3; e++) {
        *(lanes *)(to[3 * d + e] + LANES * block) =
            half[0] * inverse[3 * e] + half[1] * inverse[3 * e + 1] + half[2] * inverse[3 * e + 2];
      }
    }
  }
}

/* The response at the points of a block; false when one of them is turned inside out. */
LANES_INLINE bool respond(const struct element_geometry *geometry,
                          const struct material_spec *material, double bulk_modulus,
                          const struct element_viscosity *viscosity, int block,
                          double u[3][HEX27_STRIDE], const double p[ELEMENT_PRESSURES],
                          bool with_tangent, struct response *r) {
  struct lanes_point x;
  lanes energy, stress[9], inverse[9], scaled[9], tangent[9 * PAIRS];
  lanes weight = *(const lanes *)(geometry->weight + LANES * block), pressure = {0};
  deformation(geometry, block, u, x.f);
  lanes_invert(&x);
  bool good = true;
  for (int v = 0; v < LANES; v++) {
    good = good && x.j[v] > j_minimum;
  }
  if (!good) {
    return false;
  }
  for (int i = 0; i < 9; i++) {
    inverse[i] = *(const lanes *)(geometry->inverse[i] + LANES * block);
    scaled[i] = weight * inverse[i];
  }
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    pressure += p[m] * *(const lanes *)(geometry->phi[m] + LANES * block);
  }
  if (material->model == MATERIAL_OGDEN) {
    ogden_points(material, &x, (double *)stress, with_tangent ? (double *)tangent : NULL);
  } else {
    inverse_cube_root(&x.j, &x.root);
    lanes_isochoric(material, &x, &energy, stress, with_tangent ? tangent : NULL);
  }
  if (viscosity) {
    add_viscous(viscosity, block, x.f, stress, with_tangent ? tangent : NULL);
  }
  lanes pj = pressure * x.j;
  add_volumetric(&pj, x.g, stress, with_tangent ? tangent : NULL);
  pull_back(scaled, stress, block, r->stress);
  *(lanes *)(r->excess + LANES * block) = weight * (x.j - 1.0 - pressure / bulk_modulus);
  if (with_tangent) {
    for (int i = 0; i < 9; i++) {
      x.g[i] *= x.j;
    }
    pull_back(scaled, x.g, block, r->volume);
    pull_back_twice(scaled, inverse, tangent, block, r->tangent);
  }
  return true;
}

/* The quadratic functions and their slopes at the three points of a direction, transposed:
 * y_a = sum_q N_a(q) x_q and y_a = sum_q N_a'(q) x_q, g = sqrt(3/5) the place of the point. */
#define GAUSS 0.77459666924148337704

LANES_INLINE void values(const lanes *x, int step, lanes y[3]) {
  const double near = 0.3 + 0.5 * GAUSS, far = 0.3 - 0.5 * GAUSS;
  lanes first = x[0], last = x[2 * step];
  y[0] = near * first + far * last;
  y[1] = x[step] + 0.4 * (first + last);
  y[2] = far * first + near * last;
}

LANES_INLINE void slopes(const lanes *x, int step, lanes y[3]) {
  const double near = GAUSS + 0.5, far = GAUSS - 0.5;
  lanes first = x[0], last = x[2 * step], half = 0.5 * x[step];
  y[0] = far * last - near * first - half;
  y[1] = 2 * GAUSS * (first - last);
  y[2] = near * last - far * first + half;
}

/* The sums over the second and the first direction: to[a] = sum of from[9 q1 + 3 q2 + q3][d], of
 * which the third is done: from[(3 q12 + d) 3 + a3]. `to` moves by `stride` doubles a node. */
LANES_INLINE void sum_rest(const lanes from[81], double *to, int stride) {
  lanes along[27], across[27]; /* 9 q1 + 3 a2 + a3: d = 0, and d = 1 and 2 together */
  for (int q = 0; q < 3; q++) {
    for (int a = 0; a < 3; a++) {
      const lanes *x = from + 27 * q + a;
      lanes y[3][3];
      values(x, 9, y[0]);
      slopes(x + 3, 9, y[1]);
      values(x + 6, 9, y[2]);
      for (int b = 0; b < 3; b++) {
        along[9 * q + 3 * b + a] = y[0][b];
        across[9 * q + 3 * b + a] = y[1][b] + y[2][b];
      }
    }
  }
  for (int a = 0; a < 9; a++) {
    lanes y[2][3];
    slopes(along + a, 9, y[0]);
    values(across + a, 9, y[1]);
    for (int b = 0; b < 3; b++) {
      *(lanes *)(to + (9 * b + a) * stride) = y[0][b] + y[1][b];
    }
  }
}

/* The sum over the third direction for d = 0, 1, 2: x[3 q3 + d]. */
LANES_INLINE void sum_third(const lanes x[9], lanes to[9]) {
  values(x, 3, to);
  values(x + 1, 3, to + 3);
  slopes(x + 2, 3, to + 6);
}

/* LANES columns b of the stiffness of a pair, for all a, `stride` doubles apart:
 * K_ab = sum_q,d,e dN_a/dxi_d A_de dN_b/dxi_e */
LANES_INLINE void stiffness_columns(const struct hex27_tables *tables,
                                    const double (*tangent)[HEX27_STRIDE], int block, double *to,
                                    int stride) {
  ALIGNED lanes third[81];
  for (int line = 0; line < 9; line++) {
    lanes x[9];
    for (int k = 0; k < 3; k++) {
      int q = 3 * line + k;
      const double(*n)[HEX27_STRIDE] = tables->by_point[q];
      lanes n0 = *(const lanes *)(n[0] + LANES * block),
            n1 = *(const lanes *)(n[1] + LANES * block),
            n2 = *(const lanes *)(n[2] + LANES * block);
      for (int d = 0; d < 3; d++) {
        x[3 * k + d] =
            tangent[3 * d][q] * n0 + tangent[3 * d + 1][q] * n1 + tangent[3 * d + 2][q] * n2;
      }
    }
    sum_third(x, third + 9 * line);
  }
  sum_rest(third, to, stride);
}

/* Residual and, with the tangent, coupling: to[a][3 m + i]. */
LANES_INLINE void right_columns(const struct element_geometry *geometry, const struct response *r,
                                bool coupling, double to[HEX27_NODES][RIGHT]) {
  ALIGNED double x[9][RIGHT] = {{0}};
  ALIGNED lanes third[RIGHT / LANES][81];
  int halves = coupling ? RIGHT / LANES : (3 + LANES - 1) / LANES;
  for (int line = 0; line < 9; line++) {
    for (int k = 0; k < 3; k++) {
      int q = 3 * line + k;
      for (int n = 0; n < 9; n++) {
        double *row = x[3 * k + n % 3] + n / 3, volume = coupling ? r->volume[n][q] : 0;
        row[0] = r->stress[n][q];
        for (int m = 0; coupling && m < ELEMENT_PRESSURES; m++) {
          row[3 + 3 * m] = geometry->phi[m][q] * volume;
        }
      }
    }
    for (int h = 0; h < halves; h++) {
      lanes part[9];
      for (int n = 0; n < 9; n++) {
        part[n] = *(const lanes *)(x[n] + LANES * h);
      }
      sum_third(part, third[h] + 9 * line);
    }
  }
  for (int h = 0; h < halves; h++) {
    sum_rest(third[h], to[0] + LANES * h, RIGHT);
  }
}

enum { WIDTH = 3 * HEX27_STRIDE + SLACK }; /* of a row: three blocks of padded nodes */

/* Row a of block i of the tangent from its diagonal on, less the condensation of the pressures.
 * Whole vectors are written: what is too much is overwritten by the next block or row. Returns
 * where the next row begins. */
LANES_INLINE double *pack_row(int i, int a, const double *row,
                              double coupling[ELEMENT_PRESSURES][WIDTH],
                              const double scaled[ELEMENT_PRESSURES], double *packed) {
  for (int k = i; k < 3; k++) {
    int first = k == i ? a : 0;
    for (int b = first; b < HEX27_NODES; b += LANES) {
      int at = HEX27_STRIDE * k + b;
      lanes value = *(const lanes *)(row + at);
      for (int m = 0; m < ELEMENT_PRESSURES; m++) {
        value -= scaled[m] * *(const lanes *)(coupling[m] + at);
      }
      *(lanes *)(packed + b - first) = value;
    }
    packed += HEX27_NODES - first;
  }
  return packed;
}

/* One block row i of the condensed tangent K - C^T (dr/dp)^-1 C. */
LANES_INLINE double *pack_block(int i, double (*rows)[WIDTH],
                                double coupling[ELEMENT_PRESSURES][WIDTH],
                                const struct element_internal *internal, double *packed) {
  double tail[TAIL * (TAIL + 1) / 2 + SLACK], *end = packed;
  for (int a = 0; a < HEX27_NODES; a++) {
    double scaled[ELEMENT_PRESSURES] = {0};
    for (int m = 0; m < ELEMENT_PRESSURES; m++) {
      for (int n = 0; n < ELEMENT_PRESSURES; n++) {
        scaled[m] += internal->inverse[m][n] * coupling[n][HEX27_STRIDE * i + a];
      }
    }
    if (i == 2 && a == HEX27_NODES - TAIL) {
      end = packed;
      packed = tail;
    }
    packed = pack_row(i, a, rows[a], coupling, scaled, packed);
  }
  if (i == 2) {
    memcpy(end, tail, TAIL * (TAIL + 1) / 2 * sizeof *tail);
  }
  return packed;
}

LANES_INLINE void pack_tangent(const struct hex27_tables *tables, const struct response *r,
                               double coupling[ELEMENT_PRESSURES][WIDTH],
                               const struct element_internal *internal, double *packed) {
  ALIGNED double rows[HEX27_NODES][WIDTH];
  const double(*tangent)[HEX27_STRIDE] = r->tangent;
  for (int a = 0; a < HEX27_NODES; a++) {
    memset(rows[a] + WIDTH - SLACK, 0, SLACK * sizeof rows[a][0]);
  }
  for (int i = 0; i < 3; i++) {
    for (int k = i; k < 3; k++, tangent += 9) {
      for (int block = 0; block < BLOCKS; block++) {
        stiffness_columns(tables, tangent, block, rows[0] + HEX27_STRIDE * k + LANES * block,
                          WIDTH);
      }
    }
    packed = pack_block(i, rows, coupling, internal, packed);
  }
}

/* Spreads the columns to residual[27 i + a] and to the coupling, padded and not. */
LANES_INLINE void spread(double columns[HEX27_NODES][RIGHT], double residual[ELEMENT_DOFS],
                         double coupling[ELEMENT_PRESSURES][WIDTH],
                         struct element_internal *internal) {
  for (int i = 0; i < 3; i++) {
    for (int a = 0; a < HEX27_NODES; a++) {
      residual[HEX27_NODES * i + a] = columns[a][i];
    }
  }
  for (int m = 0; coupling && m < ELEMENT_PRESSURES; m++) {
    for (int i = 0; i < 3; i++) {
      for (int a = 0; a < HEX27_NODES; a++) {
        double value = columns[a][3 + 3 * m + i];
        internal->coupling[m][HEX27_NODES * i + a] = value;
        coupling[m][HEX27_STRIDE * i + a] = value;
      }
    }
  }
}

LANES_INLINE bool evaluate(const struct element_geometry *geometry,
                           const struct material_spec *material, double bulk_modulus,
                           const struct element_viscosity *viscosity, double u[3][HEX27_STRIDE],
                           const double p[ELEMENT_PRESSURES], double residual[ELEMENT_DOFS],
                           double *packed, struct element_internal *internal) {
  ALIGNED struct response r;
  ALIGNED double columns[HEX27_NODES][RIGHT];
  for (int block = 0; block < BLOCKS; block++) {
    if (!respond(geometry, material, bulk_modulus, viscosity, block, u, p, packed != NULL, &r)) {
      return false;
    }
  }
  right_columns(geometry, &r, packed != NULL, columns);
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    internal->residual[m] = 0;
    for (int q = 0; q < HEX27_POINTS; q++) {
      internal->residual[m] += geometry->phi[m][q] * r.excess[q];
    }
  }
  if (packed) {
    ALIGNED double coupling[ELEMENT_PRESSURES][WIDTH] = {{0}};
    for (int m = 0; m < ELEMENT_PRESSURES; m++) {
      for (int n = 0; n < ELEMENT_PRESSURES; n++) {
        internal->inverse[m][n] = -bulk_modulus * geometry->projection[m][n];
      }
    }
    spread(columns, residual, coupling, internal);
    pack_tangent(geometry->tables, &r, coupling, internal, packed);
  } else {
    spread(columns, residual, NULL, internal);
  }
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    double y = 0;
    for (int n = 0; n < ELEMENT_PRESSURES; n++) {
      y += internal->inverse[m][n] * internal->residual[n];
    }
    for (int d = 0; d < ELEMENT_DOFS; d++) {
      residual[d] -= y * internal->coupling[m][d];
    }
  }
  return true;
}

/* Apart with and without tangent, so that neither carries the other's tests. */
LANES_INLINE bool evaluate_either(const struct element_arguments *a) {
  return a->packed ? evaluate(a->geometry, a->material, a->bulk_modulus, a->viscosity, a->u, a->p,
                              a->residual, a->packed, a->internal)
                   : evaluate(a->geometry, a->material, a->bulk_modulus, a->viscosity, a->u, a->p,
                              a->residual, NULL, a->internal);
}
