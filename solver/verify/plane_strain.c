#include "solver/verify/plane_strain.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { NODES = 9, DOFS = 18, LOAD_STEPS = 10 };

struct membrane {
  int n, side, dofs; /* elements and nodes an edge */
  double mu, kappa;
  enum volumetric_law law;
  int band; /* nonzero entries of a row lie less than this far from the diagonal */
  double *x, *u;
  double *matrix; /* dofs x 2 band, see row_of */
  double *right;  /* right-hand side */
};

/* Row r of the matrix, to be indexed by columns r - band < c < r + band. */
static double *row_of(const struct membrane *m, int r) {
  return m->matrix + (ptrdiff_t)r * 2 * m->band + m->band - r;
}

/* Quadrature: nine points for the isochoric part; four for the volumetric part, so that the
 * elements do not lock. */
struct rule {
  int side;
  double point[3], weight[3];
  bool volumetric;
};
static const struct rule rules[2] = {
    {3, {-0.774596669241483377, 0, 0.774596669241483377}, {5.0 / 9, 8.0 / 9, 5.0 / 9}, false},
    {2, {-0.577350269189625765, 0.577350269189625765}, {1, 1}, true}};

static void lagrange(double t, double value[3], double slope[3]) {
  value[0] = t * (t - 1) / 2;
  value[1] = 1 - t * t;
  value[2] = t * (t + 1) / 2;
  slope[0] = t - 0.5;
  slope[1] = -2 * t;
  slope[2] = t + 0.5;
}

/* First Piola-Kirchhoff stress p and tangent k of F = (a b; c d) in the plane, of
 * mu/2 (J^(-2/3) (F:F + 1) - 3) or of U(J). With C = dJ/dF: p = 2 W1 F + WJ C. */
static void material(const struct membrane *m, bool volumetric, const double f[4], double p[4],
                     double k[4][4]) {
  static const double second[4][4] = {{0, 0, 0, 1}, {0, 0, -1, 0}, {0, -1, 0, 0}, {1, 0, 0, 0}};
  double c[4] = {f[3], -f[2], -f[1], f[0]}, j = f[0] * f[3] - f[1] * f[2], i1 = 1;
  for (int i = 0; i < 4; i++) {
    i1 += f[i] * f[i];
  }
  double slope = m->law == LAW_SQUARE ? j - 1 : (j - 1 / j) / 2;
  double curvature = m->law == LAW_SQUARE ? 1 : (1 + 1 / (j * j)) / 2;
  double mu = volumetric ? 0 : m->mu, kappa = volumetric ? m->kappa : 0;
  double w1 = mu / 2 * pow(j, -2.0 / 3), w1j = -mu / 3 * pow(j, -5.0 / 3);
  double wj = w1j * i1 + kappa * slope;
  double wjj = 5 * mu / 9 * pow(j, -8.0 / 3) * i1 + kappa * curvature;
  for (int a = 0; a < 4; a++) {
    p[a] = 2 * w1 * f[a] + wj * c[a];
    for (int b = 0; b < 4; b++) {
      k[a][b] = (a == b ? 2 * w1 : 0) + 2 * w1j * (f[a] * c[b] + c[a] * f[b]) + wjj * c[a] * c[b] +
                wj * second[a][b];
    }
  }
}

/* Gradients of the shape functions with respect to x; returns the weight of the point. */
static double gradients(const struct membrane *m, const int nodes[NODES], const struct rule *rule,
                        int q, double gradient[NODES][2]) {
  double vs[3], ds[3], vt[3], dt[3], map[4] = {0};
  lagrange(rule->point[q / rule->side], vs, ds);
  lagrange(rule->point[q % rule->side], vt, dt);
  for (int a = 0; a < NODES; a++) {
    double s = ds[a / 3] * vt[a % 3], t = vs[a / 3] * dt[a % 3];
    for (int i = 0; i < 2; i++) {
      map[2 * i] += m->x[2 * nodes[a] + i] * s;
      map[2 * i + 1] += m->x[2 * nodes[a] + i] * t;
    }
  }
  double det = map[0] * map[3] - map[1] * map[2];
  for (int a = 0; a < NODES; a++) {
    double s = ds[a / 3] * vt[a % 3], t = vs[a / 3] * dt[a % 3];
    gradient[a][0] = (s * map[3] - t * map[2]) / det;
    gradient[a][1] = (t * map[0] - s * map[1]) / det;
  }
  return det * rule->weight[q / rule->side] * rule->weight[q % rule->side];
}

static void add_element(struct membrane *m, const int nodes[NODES], const struct rule *rule) {
  for (int q = 0; q < rule->side * rule->side; q++) {
    double g[NODES][2], f[4] = {1, 0, 0, 1}, p[4], k[4][4];
    double weight = gradients(m, nodes, rule, q, g);
    for (int a = 0; a < NODES; a++) {
      for (int i = 0; i < 4; i++) {
        f[i] += m->u[2 * nodes[a] + i / 2] * g[a][i % 2];
      }
    }
    material(m, rule->volumetric, f, p, k);
    for (int r = 0; r < DOFS; r++) {
      int a = r / 2, i = r % 2;
      double *row = row_of(m, 2 * nodes[a] + i);
      m->right[2 * nodes[a] + i] -= weight * (p[2 * i] * g[a][0] + p[2 * i + 1] * g[a][1]);
      for (int c = 0; c < DOFS; c++) {
        int b = c / 2, j = c % 2;
        row[2 * nodes[b] + j] +=
            weight *
            (g[a][0] * (k[2 * i][2 * j] * g[b][0] + k[2 * i][2 * j + 1] * g[b][1]) +
             g[a][1] * (k[2 * i + 1][2 * j] * g[b][0] + k[2 * i + 1][2 * j + 1] * g[b][1]));
      }
    }
  }
}

/* Tangent and residual; the shear load of 1 N on the right edge by Simpson's rule, exact for
 * these shape functions; clamped rows become those of the unit matrix. */
static void assemble(struct membrane *m, double load) {
  memset(m->matrix, 0, sizeof *m->matrix * (size_t)m->dofs * 2 * (size_t)m->band);
  memset(m->right, 0, sizeof *m->right * (size_t)m->dofs);
  for (int e = 0; e < m->n * m->n; e++) {
    int nodes[NODES];
    for (int a = 0; a < NODES; a++) {
      nodes[a] = (2 * (e / m->n) + a / 3) * m->side + 2 * (e % m->n) + a % 3;
    }
    add_element(m, nodes, &rules[0]);
    add_element(m, nodes, &rules[1]);
  }
  for (int e = 0; e < m->n; e++) {
    static const double simpson[3] = {1.0 / 6, 4.0 / 6, 1.0 / 6};
    for (int a = 0; a < 3; a++) {
      int node = (m->side - 1) * m->side + 2 * e + a;
      m->right[2 * node + 1] += load * simpson[a] / m->n;
    }
  }
  for (int d = 0; d < 2 * m->side; d++) {
    memset(m->matrix + (ptrdiff_t)d * 2 * m->band, 0, sizeof *m->matrix * 2 * (size_t)m->band);
    row_of(m, d)[d] = 1;
    m->right[d] = 0;
  }
}

/* Gaussian elimination within the band, without pivoting: the matrix is close to definite. Adds
 * the solution to u and returns its largest entry. */
static double solve(struct membrane *m) {
  int n = m->dofs;
  for (int c = 0; c < n; c++) {
    const double *pivot = row_of(m, c);
    int last = c + m->band < n ? c + m->band : n;
    for (int r = c + 1; r < last; r++) {
      double *row = row_of(m, r), factor = row[c] / pivot[c];
      for (int k = c; factor != 0 && k < last; k++) {
        row[k] -= factor * pivot[k];
      }
      m->right[r] -= factor * m->right[c];
    }
  }
  double most = 0;
  for (int r = n - 1; r >= 0; r--) {
    const double *row = row_of(m, r);
    for (int k = r + 1; k < n && k < r + m->band; k++) {
      m->right[r] -= row[k] * m->right[k];
    }
    m->right[r] /= row[r];
    m->u[r] += m->right[r];
    most = fmax(most, fabs(m->right[r]));
  }
  return most;
}

/* Solves in load steps. False when an iteration does not converge. */
static bool follow(struct membrane *m) {
  for (int step = 1; step <= LOAD_STEPS; step++) {
    double correction = 1;
    for (int it = 0; it < 20 && correction > 1e-9; it++) {
      assemble(m, (double)step / LOAD_STEPS);
      correction = solve(m);
    }
    if (!(correction <= 1e-9)) {
      return false;
    }
  }
  return true;
}

double plane_strain_cook(int n, double mu, double kappa, enum volumetric_law law) {
  struct membrane m = {.n = n, .side = 2 * n + 1, .mu = mu, .kappa = kappa, .law = law};
  int nodes = m.side * m.side;
  m.dofs = 2 * nodes;
  m.band = 4 * m.side + 6;
  m.x = calloc((size_t)m.dofs, sizeof *m.x);
  m.u = calloc((size_t)m.dofs, sizeof *m.u);
  m.right = calloc((size_t)m.dofs, sizeof *m.right);
  m.matrix = calloc((size_t)m.dofs * 2 * (size_t)m.band, sizeof *m.matrix);
  double tip = NAN;
  if (m.x && m.u && m.right && m.matrix) {
    for (int i = 0; i < nodes; i++) {
      double s = i / m.side / (2.0 * n), t = i % m.side / (2.0 * n);
      m.x[2 * i] = 48 * s;
      m.x[2 * i + 1] = 44 * s + t * (44 - 28 * s);
    }
    tip = follow(&m) ? m.u[2 * nodes - 1] : NAN;
  }
  free(m.x);
  free(m.u);
  free(m.right);
  free(m.matrix);
  return tip;
}
