/* The laws in terms of the invariants, for one point or for LANES of them: define REAL (double or
 * lanes) and LAW(name) before including this. F and G = F^-T are 3 x 3 row-major; tangents hold the
 * block rows i <= k of d2W/dF_iJ dF_kL, index 9 pair + 3 J + L with the pairs 00 01 02 11 12 22. */
#include <string.h>
#include "solver/fe/lanes.h"

struct LAW(point) {
  REAL f[9], g[9];
  REAL j, root; /* det F, J^(-1/3) */
};

/* Fills G and J from F. */
LANES_INLINE void LAW(invert)(struct LAW(point) * x) {
  const REAL *f = x->f;
  REAL *g = x->g;
  g[0] = f[4] * f[8] - f[5] * f[7];
  g[1] = f[5] * f[6] - f[3] * f[8];
  g[2] = f[3] * f[7] - f[4] * f[6];
  g[3] = f[2] * f[7] - f[1] * f[8];
  g[4] = f[0] * f[8] - f[2] * f[6];
  g[5] = f[1] * f[6] - f[0] * f[7];
  g[6] = f[1] * f[5] - f[2] * f[4];
  g[7] = f[2] * f[3] - f[0] * f[5];
  g[8] = f[0] * f[4] - f[1] * f[3];
  x->j = f[0] * g[0] + f[1] * g[1] + f[2] * g[2];
  REAL inverse = 1.0 / x->j;
  for (int i = 0; i < 9; i++) {
    g[i] *= inverse;
  }
}

/* Energy, stress and, unless NULL, tangent of c1 x + c2 x^2 + c3 x^3, x = I1b - 3, with
 * I1b = J^(-2/3) F:F, s = dI1b/dF and H = d2 I1b/dF2:
 *   s = 2 c F - 2/3 I1b G,   c = J^(-2/3)
 *   H = 2 c d_ik d_JL - 4/3 c F_iJ G_kL - 2/3 G_iJ s_kL + 2/3 I1b G_kJ G_iL */
LANES_INLINE void LAW(first_invariant)(const double c[3], const struct LAW(point) * x, REAL *energy,
                                       REAL stress[9], REAL *tangent) {
  const REAL *f = x->f, *g = x->g;
  REAL a = x->root * x->root, i1 = f[0] * f[0], s[9];
  for (int i = 1; i < 9; i++) {
    i1 += f[i] * f[i];
  }
  i1 *= a;
  REAL e = i1 - 3.0, w1 = c[0] + e * (2 * c[1] + 3 * c[2] * e), w2 = 2 * c[1] + 6 * c[2] * e;
  REAL h = 2.0 / 3 * w1, h1 = h * i1, ha = 2 * h * a, diagonal = 2 * w1 * a;
  *energy = e * (c[0] + e * (c[1] + e * c[2]));
  for (int i = 0; i < 9; i++) {
    s[i] = 2 * a * f[i] - 2.0 / 3 * i1 * g[i];
    stress[i] = w1 * s[i];
  }
  for (int i = 0; tangent && i < 3; i++) {
    for (int k = i; k < 3; k++) {
      for (int j = 0; j < 3; j++) {
        REAL fs = w2 * s[3 * i + j] - h * g[3 * i + j], fg = ha * f[3 * i + j];
        REAL gg = h1 * g[3 * k + j];
        for (int l = 0; l < 3; l++) {
          tangent[3 * j + l] = fs * s[3 * k + l] - fg * g[3 * k + l] + gg * g[3 * i + l];
        }
        if (i == k) {
          tangent[4 * j] += diagonal;
        }
      }
      tangent += 9;
    }
  }
}

/* C = F^T F, B = F F^T, F C and tr C. */
struct LAW(products) {
  REAL c[9], b[9], fc[9], trace;
};

LANES_INLINE void LAW(multiply)(const REAL f[9], struct LAW(products) * p) {
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      p->c[3 * i + j] = f[i] * f[j] + f[3 + i] * f[3 + j] + f[6 + i] * f[6 + j];
      p->b[3 * i + j] =
          f[3 * i] * f[3 * j] + f[3 * i + 1] * f[3 * j + 1] + f[3 * i + 2] * f[3 * j + 2];
    }
  }
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      p->fc[3 * i + j] =
          f[3 * i] * p->c[j] + f[3 * i + 1] * p->c[3 + j] + f[3 * i + 2] * p->c[6 + j];
    }
  }
  p->trace = p->c[0] + p->c[4] + p->c[8];
}

/* Adds those of w (I2b - 3), I2b = J^(-4/3) I2, I2 = (I1^2 - tr C^2)/2:
 *   M = dI2/dF = 2 (I1 F - F C),   s = a M - 4/3 I2b G,   a = J^(-4/3)
 *   d2 I2/dF2 = 4 F F + 2 I1 d_ik d_JL - 2 (d_ik C_LJ + F_iL F_kJ + B_ik d_JL) */
LANES_INLINE void LAW(second_invariant)(double w, const struct LAW(point) * x, REAL *energy,
                                        REAL stress[9], REAL *tangent) {
  const REAL *f = x->f, *g = x->g;
  struct LAW(products) p;
  LAW(multiply)(f, &p);
  REAL a = x->root * x->root * x->root * x->root, i2 = p.trace * p.trace, m[9];
  for (int i = 0; i < 9; i++) {
    i2 -= p.c[i] * p.c[i];
  }
  i2 *= 0.5 * a;
  *energy += w * (i2 - 3.0);
  for (int i = 0; i < 9; i++) {
    m[i] = 2 * a * (p.trace * f[i] - p.fc[i]);
    stress[i] += w * (m[i] - 4.0 / 3 * i2 * g[i]);
  }
  REAL wa = w * a, wi = 4.0 / 3 * w * i2;
  for (int i = 0; tangent && i < 3; i++) {
    for (int k = i; k < 3; k++, tangent += 9) {
      for (int j = 0; j < 3; j++) {
        REAL ff = 4 * wa * f[3 * i + j], fk = 2 * wa * f[3 * k + j], gk = wi * g[3 * k + j];
        REAL mg = 4.0 / 3 * (wi * g[3 * i + j] - w * m[3 * i + j]);
        REAL gm = 4.0 / 3 * w * g[3 * i + j];
        for (int l = 0; l < 3; l++) {
          tangent[3 * j + l] += ff * f[3 * k + l] - fk * f[3 * i + l] + mg * g[3 * k + l] -
                                gm * m[3 * k + l] + gk * g[3 * i + l];
          if (i == k) {
            tangent[3 * j + l] -= 2 * wa * p.c[3 * l + j];
          }
        }
        tangent[4 * j] -= 2 * wa * p.b[3 * i + k];
        if (i == k) {
          tangent[4 * j] += 2 * wa * p.trace;
        }
      }
    }
  }
}

/* Any law but that of Ogden. */
LANES_INLINE void LAW(isochoric)(const struct material_spec *material, const struct LAW(point) * x,
                                 REAL *energy, REAL stress[9], REAL *tangent) {
  double c[3] = {0};
  switch (material->model) {
  case MATERIAL_NEO_HOOKE:
    c[0] = 0.5 * material->c[0];
    break;
  case MATERIAL_MOONEY_RIVLIN:
    c[0] = material->c[0];
    break;
  default:
    memcpy(c, material->c, sizeof *c * (size_t)material->terms);
  }
  LAW(first_invariant)(c, x, energy, stress, tangent);
  if (material->model == MATERIAL_MOONEY_RIVLIN) {
    LAW(second_invariant)(material->c[1], x, energy, stress, tangent);
  }
}
