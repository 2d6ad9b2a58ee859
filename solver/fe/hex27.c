#include "solver/fe/hex27.h"

#include <math.h>
#include <string.h>

/* Quadratic Lagrange functions on the nodes -1, 0, 1 with derivatives. */
static void lagrange2(double x, double n[3], double d[3]) {
  n[0] = 0.5 * x * (x - 1);
  n[1] = 1 - x * x;
  n[2] = 0.5 * x * (x + 1);
  d[0] = x - 0.5;
  d[1] = -2 * x;
  d[2] = x + 0.5;
}

void hex27_shape(const double xi[3], double n[HEX27_NODES], double dn[3][HEX27_NODES]) {
  double l[3][3], d[3][3];
  for (int k = 0; k < 3; k++) {
    lagrange2(xi[k], l[k], d[k]);
  }
  for (int a = 0; a < HEX27_NODES; a++) {
    int i = a / 9, j = a / 3 % 3, k = a % 3;
    n[a] = l[0][i] * l[1][j] * l[2][k];
    if (dn) {
      dn[0][a] = d[0][i] * l[1][j] * l[2][k];
      dn[1][a] = l[0][i] * d[1][j] * l[2][k];
      dn[2][a] = l[0][i] * l[1][j] * d[2][k];
    }
  }
}

void quad9_shape(double s, double t, double n[QUAD9_NODES], double dn[2][QUAD9_NODES],
                 double d2n[3][QUAD9_NODES]) {
  static const double curvature[3] = {1, -2, 1};
  double ls[3], lt[3], ds[3], dt[3];
  lagrange2(s, ls, ds);
  lagrange2(t, lt, dt);
  for (int a = 0; a < 3; a++) {
    for (int b = 0; b < 3; b++) {
      int m = 3 * a + b;
      n[m] = ls[a] * lt[b];
      dn[0][m] = ds[a] * lt[b];
      dn[1][m] = ls[a] * dt[b];
      if (d2n) {
        d2n[0][m] = curvature[a] * lt[b];
        d2n[1][m] = ls[a] * curvature[b];
        d2n[2][m] = ds[a] * dt[b];
      }
    }
  }
}

static void gauss3(double x[3], double w[3]) {
  x[0] = -sqrt(0.6);
  x[1] = 0;
  x[2] = sqrt(0.6);
  w[0] = w[2] = 5.0 / 9;
  w[1] = 8.0 / 9;
}

void hex27_tables_fill(struct hex27_tables *tables) {
  double x[3], w[3], n[HEX27_NODES];
  gauss3(x, w);
  memset(tables, 0, sizeof *tables);
  for (int q = 0; q < HEX27_POINTS; q++) {
    int i[3] = {q / 9, q / 3 % 3, q % 3};
    tables->weight[q] = w[i[0]] * w[i[1]] * w[i[2]];
    for (int d = 0; d < 3; d++) {
      tables->point[q][d] = x[i[d]];
    }
    hex27_shape(tables->point[q], n, tables->dn[q]);
    for (int m = 0; m < 3 * HEX27_NODES; m++) {
      int d = m / HEX27_NODES, a = m % HEX27_NODES;
      tables->by_point[q][d][a] = tables->by_node[a][d][q] = tables->dn[q][d][a];
    }
  }
}

void quad9_tables_fill(struct quad9_tables *tables) {
  double x[3], w[3];
  gauss3(x, w);
  for (int q = 0; q < QUAD9_POINTS; q++) {
    tables->point[q][0] = x[q / 3];
    tables->point[q][1] = x[q % 3];
    tables->weight[q] = w[q / 3] * w[q % 3];
    quad9_shape(x[q / 3], x[q % 3], tables->n[q], tables->dn[q], NULL);
  }
}
