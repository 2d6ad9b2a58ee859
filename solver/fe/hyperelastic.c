#include "solver/fe/hyperelastic.h"

#include <math.h>
#include <string.h>

double kinematics_complete(struct kinematics *k) {
  const double *f = k->f;
  double *g = k->cofactor;
  g[0] = f[4] * f[8] - f[5] * f[7];
  g[1] = f[5] * f[6] - f[3] * f[8];
  g[2] = f[3] * f[7] - f[4] * f[6];
  g[3] = f[2] * f[7] - f[1] * f[8];
  g[4] = f[0] * f[8] - f[2] * f[6];
  g[5] = f[1] * f[6] - f[0] * f[7];
  g[6] = f[1] * f[5] - f[2] * f[4];
  g[7] = f[2] * f[3] - f[0] * f[5];
  g[8] = f[0] * f[4] - f[1] * f[3];
  k->j = f[0] * g[0] + f[1] * g[1] + f[2] * g[2];
  for (int i = 0; i < 9; i++) {
    g[i] /= k->j;
  }
  return k->j;
}

/* Adds w1 H + w2 s (x) s, with s = dI1b/dF and H = d2 I1b/dF2, I1b = J^(-2/3) F:F:
 *   s = 2 c F - 2/3 I1b G,   G = F^-T, c = J^(-2/3)
 *   H = 2 c d_ik d_JL - 4/3 c F_iJ G_kL - 2/3 G_iJ s_kL + 2/3 I1b G_kJ G_iL */
static void add_first_invariant(double w1, double w2, double c, double i1, const double *f,
                                const double *g, const double s[9], double *tangent) {
  double h = w1 * 2 / 3 * i1;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      double *row = tangent + 9 * (3 * i + j);
      double fs = w2 * s[3 * i + j] - w1 * 2 / 3 * g[3 * i + j];
      double fg = w1 * 4 / 3 * c * f[3 * i + j];
      for (int k = 0; k < 3; k++) {
        for (int l = 0; l < 3; l++) {
          row[3 * k + l] += fs * s[3 * k + l] - fg * g[3 * k + l] + h * g[3 * k + j] * g[3 * i + l];
        }
      }
      row[3 * i + j] += w1 * 2 * c;
    }
  }
}

static double invariant_law(const struct kinematics *k, const double *coefficient, int terms,
                            double stress[9], double *tangent) {
  double c = 1 / cbrt(k->j * k->j), i1 = 0;
  for (int i = 0; i < 9; i++) {
    i1 += k->f[i] * k->f[i];
  }
  i1 *= c;
  double x = i1 - 3, c1 = coefficient[0], c2 = terms > 1 ? coefficient[1] : 0,
         c3 = terms > 2 ? coefficient[2] : 0;
  double w1 = c1 + x * (2 * c2 + 3 * c3 * x), w2 = 2 * c2 + 6 * c3 * x;
  double s[9];
  for (int i = 0; i < 9; i++) {
    s[i] = 2 * c * k->f[i] - 2.0 / 3 * i1 * k->cofactor[i];
    stress[i] = w1 * s[i];
  }
  if (tangent) {
    memset(tangent, 0, 81 * sizeof *tangent);
    add_first_invariant(w1, w2, c, i1, k->f, k->cofactor, s, tangent);
  }
  return x * (c1 + x * (c2 + x * c3));
}

/* Adds stress and tangent of w (I2b - 3), I2b = J^(-4/3) I2, I2 = (I1^2 - tr C^2)/2:
 *   M = dI2/dF = 2 (I1 F - F C),   s = a M - 4/3 I2b G,   a = J^(-4/3)
 *   d2 I2/dF2 = 4 F F + 2 I1 d_ik d_JL - 2 (d_ik C_LJ + F_iL F_kJ + B_ik d_JL) */
static double add_second_invariant(double w, const struct kinematics *k, double stress[9],
                                   double *tangent) {
  const double *f = k->f, *g = k->cofactor;
  double cg[9], b[9], fc[9], i1 = 0, cc = 0;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      cg[3 * i + j] = b[3 * i + j] = 0;
      for (int m = 0; m < 3; m++) {
        cg[3 * i + j] += f[3 * m + i] * f[3 * m + j];
        b[3 * i + j] += f[3 * i + m] * f[3 * j + m];
      }
    }
    i1 += cg[4 * i];
  }
  for (int i = 0; i < 9; i++) {
    cc += cg[i] * cg[i];
    fc[i] = 0;
    for (int m = 0; m < 3; m++) {
      fc[i] += f[i / 3 * 3 + m] * cg[3 * m + i % 3];
    }
  }
  double c = 1 / cbrt(k->j * k->j), a = c * c, i2 = a * 0.5 * (i1 * i1 - cc);
  double m[9];
  for (int i = 0; i < 9; i++) {
    m[i] = a * 2 * (i1 * f[i] - fc[i]);
    stress[i] += w * (m[i] - 4.0 / 3 * i2 * g[i]);
  }
  for (int p = 0; tangent && p < 9; p++) {
    int i = p / 3, j = p % 3;
    for (int q = 0; q < 9; q++) {
      int n = q / 3, l = q % 3;
      double second = 4 * f[p] * f[q] - 2 * f[3 * i + l] * f[3 * n + j];
      second += i == n ? -2 * cg[3 * l + j] : 0;
      second += j == l ? -2 * b[3 * i + n] : 0;
      second += p == q ? 2 * i1 : 0;
      tangent[9 * p + q] +=
          w * (a * second - 4.0 / 3 * (m[p] * g[q] + g[p] * m[q]) + 16.0 / 9 * i2 * g[p] * g[q] +
               4.0 / 3 * i2 * g[3 * n + j] * g[3 * i + l]);
    }
  }
  return w * (i2 - 3);
}

void symmetric3_eigen(const double c[9], double value[3], double v[9]) {
  double a[9];
  memcpy(a, c, sizeof a);
  memcpy(v, (double[9]){1, 0, 0, 0, 1, 0, 0, 0, 1}, 9 * sizeof *v);
  for (int sweep = 0; sweep < 30; sweep++) {
    double off = a[1] * a[1] + a[2] * a[2] + a[5] * a[5];
    if (off <= 1e-34 * (a[0] * a[0] + a[4] * a[4] + a[8] * a[8])) {
      break;
    }
    for (int p = 0; p < 2; p++) {
      for (int q = p + 1; q < 3; q++) {
        if (a[3 * p + q] == 0) {
          continue;
        }
        double theta = (a[4 * q] - a[4 * p]) / (2 * a[3 * p + q]);
        double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(1 + theta * theta));
        double cs = 1 / sqrt(1 + t * t), sn = t * cs;
        for (int i = 0; i < 3; i++) {
          double x = a[3 * i + p], y = a[3 * i + q];
          a[3 * i + p] = cs * x - sn * y;
          a[3 * i + q] = sn * x + cs * y;
        }
        for (int i = 0; i < 3; i++) {
          double x = a[3 * p + i], y = a[3 * q + i];
          a[3 * p + i] = cs * x - sn * y;
          a[3 * q + i] = sn * x + cs * y;
          x = v[3 * i + p], y = v[3 * i + q];
          v[3 * i + p] = cs * x - sn * y;
          v[3 * i + q] = sn * x + cs * y;
        }
      }
    }
  }
  for (int i = 0; i < 3; i++) {
    value[i] = a[4 * i];
  }
  for (int i = 0; i < 2; i++) {
    int largest = i;
    for (int j = i + 1; j < 3; j++) {
      largest = value[j] > value[largest] ? j : largest;
    }
    double t = value[i];
    value[i] = value[largest];
    value[largest] = t;
    for (int r = 0; r < 3 && largest != i; r++) {
      t = v[3 * r + i];
      v[3 * r + i] = v[3 * r + largest];
      v[3 * r + largest] = t;
    }
  }
}

/* Principal second Piola-Kirchhoff stresses s[a] and their derivatives
 * d[a][b] = (1/l_b) ds_a/dl_b (Holzapfel 2000, section 6.6). Returns the energy density. */
static double ogden_principal(const struct material_spec *material, const double l2[3], double j,
                              double s[3], double d[3][3]) {
  double beta[3] = {0}, gamma[3][3] = {{0}}, energy = 0, c = 1 / cbrt(j);
  for (int p = 0; p < material->terms; p++) {
    double mu = material->c[p], alpha = material->alpha[p], x[3], sum = 0;
    for (int a = 0; a < 3; a++) {
      x[a] = pow(c * sqrt(l2[a]), alpha);
      sum += x[a];
    }
    energy += mu / alpha * (sum - 3);
    for (int a = 0; a < 3; a++) {
      beta[a] += mu * (x[a] - sum / 3);
      for (int b = 0; b < 3; b++) {
        gamma[a][b] += mu * alpha * ((a == b ? x[a] : 0) - (x[a] + x[b]) / 3 + sum / 9);
      }
    }
  }
  for (int a = 0; a < 3; a++) {
    s[a] = beta[a] / l2[a];
    for (int b = 0; b < 3; b++) {
      d[a][b] = (gamma[a][b] - (a == b ? 2 * beta[a] : 0)) / (l2[a] * l2[b]);
    }
  }
  return energy;
}

static double ogden_law(const struct material_spec *material, const struct kinematics *k,
                        double stress[9], double *tangent) {
  const double *f = k->f;
  double c[9], l2[3], v[9], s[3], d[3][3], fv[9];
  for (int i = 0; i < 9; i++) {
    c[i] = 0;
    for (int m = 0; m < 3; m++) {
      c[i] += f[3 * m + i / 3] * f[3 * m + i % 3];
    }
  }
  symmetric3_eigen(c, l2, v);
  double energy = ogden_principal(material, l2, k->j, s, d);
  for (int i = 0; i < 9; i++) { /* columns F v_a */
    fv[i] = 0;
    for (int m = 0; m < 3; m++) {
      fv[i] += f[i / 3 * 3 + m] * v[3 * m + i % 3];
    }
  }
  double second[9] = {0};
  for (int i = 0; i < 9; i++) {
    stress[i] = 0;
    for (int a = 0; a < 3; a++) {
      stress[i] += s[a] * fv[i / 3 * 3 + a] * v[i % 3 * 3 + a];
      second[i] += s[a] * v[i / 3 * 3 + a] * v[i % 3 * 3 + a];
    }
  }
  if (!tangent) {
    return energy;
  }
  memset(tangent, 0, 81 * sizeof *tangent);
  for (int a = 0; a < 3; a++) {
    for (int b = 0; b < 3; b++) {
      bool near = fabs(l2[a] - l2[b]) < 1e-6 * (l2[a] + l2[b]);
      double shear = near ? 0.5 * (d[b][b] - d[a][b]) : (s[b] - s[a]) / (l2[b] - l2[a]);
      for (int p = 0; p < 9; p++) {
        int i = p / 3, j = p % 3;
        double normal = d[a][b] * fv[3 * i + a] * v[3 * j + a];
        double cross = a != b ? shear * fv[3 * i + a] * v[3 * j + b] : 0;
        for (int q = 0; q < 9; q++) {
          int n = q / 3, l = q % 3;
          tangent[9 * p + q] +=
              normal * fv[3 * n + b] * v[3 * l + b] +
              cross * (fv[3 * n + a] * v[3 * l + b] + fv[3 * n + b] * v[3 * l + a]);
        }
      }
    }
  }
  for (int p = 0; p < 9; p++) {
    for (int l = 0; l < 3; l++) {
      tangent[9 * p + p / 3 * 3 + l] += second[3 * (p % 3) + l];
    }
  }
  return energy;
}

double hyperelastic_isochoric(const struct material_spec *material, const struct kinematics *k,
                              double stress[9], double *tangent) {
  switch (material->model) {
  case MATERIAL_OGDEN:
    return ogden_law(material, k, stress, tangent);
  case MATERIAL_NEO_HOOKE: {
    double half = 0.5 * material->c[0];
    return invariant_law(k, &half, 1, stress, tangent);
  }
  case MATERIAL_MOONEY_RIVLIN: {
    double energy = invariant_law(k, material->c, 1, stress, tangent);
    return energy + add_second_invariant(material->c[1], k, stress, tangent);
  }
  case MATERIAL_YEOH:
    break;
  }
  return invariant_law(k, material->c, material->terms, stress, tangent);
}
