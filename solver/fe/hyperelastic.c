#include "solver/fe/hyperelastic.h"

#include <math.h>
#include <string.h>

#define REAL double
#define LAW(name) scalar_##name
#include "solver/fe/hyperelastic_law.h"

double kinematics_complete(struct kinematics *k) {
  struct scalar_point x;
  memcpy(x.f, k->f, sizeof x.f);
  scalar_invert(&x);
  memcpy(k->cofactor, x.g, sizeof x.g);
  k->j = x.j;
  return k->j;
}

double symmetric3_largest(const double c[9]) {
  double mean = (c[0] + c[4] + c[8]) / 3, a = c[0] - mean, b = c[4] - mean, d = c[8] - mean;
  double off = c[1] * c[1] + c[2] * c[2] + c[5] * c[5];
  double spread = sqrt((a * a + b * b + d * d + 2 * off) / 6);
  double det =
      a * (b * d - c[5] * c[5]) - c[1] * (c[1] * d - c[5] * c[2]) + c[2] * (c[1] * c[5] - b * c[2]);
  double cosine = spread > 0 ? 0.5 * det / (spread * spread * spread) : 1;
  return mean + 2 * spread * cos(acos(fmax(-1, fmin(1, cosine))) / 3);
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

/* All of the tangent from its block rows i <= k. */
static void expand_tangent(const double *pair, double tangent[81]) {
  for (int i = 0; i < 3; i++) {
    for (int k = i; k < 3; k++, pair += 9) {
      for (int j = 0; j < 3; j++) {
        for (int l = 0; l < 3; l++) {
          tangent[9 * (3 * i + j) + 3 * k + l] = pair[3 * j + l];
          tangent[9 * (3 * k + l) + 3 * i + j] = pair[3 * j + l];
        }
      }
    }
  }
}

double hyperelastic_isochoric(const struct material_spec *material, const struct kinematics *k,
                              double stress[9], double *tangent) {
  if (material->model == MATERIAL_OGDEN) {
    return ogden_law(material, k, stress, tangent);
  }
  struct scalar_point x = {.j = k->j, .root = 1 / cbrt(k->j)};
  double energy, pair[54];
  memcpy(x.f, k->f, sizeof x.f);
  memcpy(x.g, k->cofactor, sizeof x.g);
  if (tangent) {
    scalar_isochoric(material, &x, &energy, stress, pair);
    expand_tangent(pair, tangent);
  } else {
    scalar_isochoric(material, &x, &energy, stress, NULL);
  }
  return energy;
}
