#include "tests/physics/plane_strain.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NODES = 9, DOFS = 18, LOAD_STEPS = 4 };

struct membrane {
  int n, side, dofs; /* elements and nodes an edge */
  double mu, kappa;
  enum volumetric_law law;
  double *x, *u;
  double *matrix; /* dofs x (dofs + 1), the last column is the right-hand side */
};

static const double gauss_point[3] = {-0.774596669241483377, 0, 0.774596669241483377};
static const double gauss_weight[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};

static void lagrange(double t, double value[3], double slope[3]) {
  value[0] = t * (t - 1) / 2;
  value[1] = 1 - t * t;
  value[2] = t * (t + 1) / 2;
  slope[0] = t - 0.5;
  slope[1] = -2 * t;
  slope[2] = t + 0.5;
}

/* First Piola-Kirchhoff stress p and tangent k of F = (a b; c d) in the plane, W = mu/2 (J^(-2/3)
 * (F:F + 1) - 3) + U(J). With C = dJ/dF: p = 2 W1 F + WJ C. */
static void material(const struct membrane *m, const double f[4], double p[4], double k[4][4]) {
  static const double second[4][4] = {{0, 0, 0, 1}, {0, 0, -1, 0}, {0, -1, 0, 0}, {1, 0, 0, 0}};
  double c[4] = {f[3], -f[2], -f[1], f[0]}, j = f[0] * f[3] - f[1] * f[2], i1 = 1;
  for (int i = 0; i < 4; i++) {
    i1 += f[i] * f[i];
  }
  double slope = m->law == LAW_SQUARE ? j - 1 : (j - 1 / j) / 2;
  double curvature = m->law == LAW_SQUARE ? 1 : (1 + 1 / (j * j)) / 2;
  double w1 = m->mu / 2 * pow(j, -2.0 / 3), w1j = -m->mu / 3 * pow(j, -5.0 / 3);
  double wj = w1j * i1 + m->kappa * slope;
  double wjj = 5 * m->mu / 9 * pow(j, -8.0 / 3) * i1 + m->kappa * curvature;
  for (int a = 0; a < 4; a++) {
    p[a] = 2 * w1 * f[a] + wj * c[a];
    for (int b = 0; b < 4; b++) {
      k[a][b] = (a == b ? 2 * w1 : 0) + 2 * w1j * (f[a] * c[b] + c[a] * f[b]) + wjj * c[a] * c[b] +
                wj * second[a][b];
    }
  }
}

/* Gradients of the shape functions with respect to x; returns the weight of the point. */
static double gradients(const struct membrane *m, const int nodes[NODES], int q,
                        double gradient[NODES][2]) {
  double vs[3], ds[3], vt[3], dt[3], map[4] = {0};
  lagrange(gauss_point[q / 3], vs, ds);
  lagrange(gauss_point[q % 3], vt, dt);
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
  return det * gauss_weight[q / 3] * gauss_weight[q % 3];
}

static void add_element(struct membrane *m, const int nodes[NODES]) {
  size_t width = (size_t)m->dofs + 1;
  for (int q = 0; q < 9; q++) {
    double g[NODES][2], f[4] = {1, 0, 0, 1}, p[4], k[4][4];
    double weight = gradients(m, nodes, q, g);
    for (int a = 0; a < NODES; a++) {
      for (int i = 0; i < 4; i++) {
        f[i] += m->u[2 * nodes[a] + i / 2] * g[a][i % 2];
      }
    }
    material(m, f, p, k);
    for (int r = 0; r < DOFS; r++) {
      int a = r / 2, i = r % 2;
      double *row = m->matrix + (size_t)(2 * nodes[a] + i) * width;
      row[m->dofs] -= weight * (p[2 * i] * g[a][0] + p[2 * i + 1] * g[a][1]);
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
  size_t width = (size_t)m->dofs + 1;
  memset(m->matrix, 0, sizeof *m->matrix * (size_t)m->dofs * width);
  for (int e = 0; e < m->n * m->n; e++) {
    int nodes[NODES];
    for (int a = 0; a < NODES; a++) {
      nodes[a] = (2 * (e / m->n) + a / 3) * m->side + 2 * (e % m->n) + a % 3;
    }
    add_element(m, nodes);
  }
  for (int e = 0; e < m->n; e++) {
    static const double simpson[3] = {1.0 / 6, 4.0 / 6, 1.0 / 6};
    for (int a = 0; a < 3; a++) {
      int node = (m->side - 1) * m->side + 2 * e + a;
      m->matrix[(size_t)(2 * node + 1) * width + (size_t)m->dofs] += load * simpson[a] / m->n;
    }
  }
  for (int d = 0; d < 2 * m->side; d++) {
    double *row = m->matrix + (size_t)d * width;
    memset(row, 0, sizeof *row * width);
    row[d] = 1;
  }
}

/* Gaussian elimination within the band, without pivoting: the matrix is close to definite. Adds
 * the solution to u and returns its largest entry. */
static double solve(struct membrane *m) {
  int n = m->dofs, band = 4 * m->side + 6;
  size_t width = (size_t)n + 1;
  for (int c = 0; c < n; c++) {
    const double *pivot = m->matrix + (size_t)c * width;
    int last = c + band < n ? c + band : n;
    for (int r = c + 1; r < last; r++) {
      double *row = m->matrix + (size_t)r * width, factor = row[c] / pivot[c];
      for (int k = c; factor != 0 && k < last; k++) {
        row[k] -= factor * pivot[k];
      }
      row[n] -= factor * pivot[n];
    }
  }
  double most = 0;
  for (int r = n - 1; r >= 0; r--) {
    double *row = m->matrix + (size_t)r * width;
    for (int k = r + 1; k < n && k < r + band; k++) {
      row[n] -= row[k] * m->matrix[(size_t)k * width + (size_t)n];
    }
    row[n] /= row[r];
    m->u[r] += row[n];
    most = fmax(most, fabs(row[n]));
  }
  return most;
}

double plane_strain_cook(int n, double mu, double kappa, enum volumetric_law law) {
  struct membrane m = {.n = n, .side = 2 * n + 1, .mu = mu, .kappa = kappa, .law = law};
  int nodes = m.side * m.side;
  m.dofs = 2 * nodes;
  m.x = calloc((size_t)m.dofs, sizeof *m.x);
  m.u = calloc((size_t)m.dofs, sizeof *m.u);
  m.matrix = calloc((size_t)m.dofs * ((size_t)m.dofs + 1), sizeof *m.matrix);
  ck_assert(m.x && m.u && m.matrix);
  for (int i = 0; i < nodes; i++) {
    double s = i / m.side / (2.0 * n), t = i % m.side / (2.0 * n);
    m.x[2 * i] = 48 * s;
    m.x[2 * i + 1] = 44 * s + t * (44 - 28 * s);
  }
  for (int step = 1; step <= LOAD_STEPS; step++) {
    double correction = 1;
    for (int it = 0; it < 20 && correction > 1e-9; it++) {
      assemble(&m, (double)step / LOAD_STEPS);
      correction = solve(&m);
    }
    ck_assert_double_le(correction, 1e-9);
  }
  double tip = m.u[2 * nodes - 1];
  free(m.x);
  free(m.u);
  free(m.matrix);
  return tip;
}
