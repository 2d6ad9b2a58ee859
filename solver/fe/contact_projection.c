#include "solver/fe/contact_projection.h"

#include <math.h>
#include <string.h>
#include "solver/base/vec3.h"

static void evaluate(double master[QUAD9_NODES][3], const double slave[3], const double xi[2],
                     struct projection *p) {
  double d2n[3][QUAD9_NODES];
  quad9_shape(xi[0], xi[1], p->n, p->dn, d2n);
  memset(p->tangent, 0, sizeof p->tangent);
  memset(p->curvature, 0, sizeof p->curvature);
  memcpy(p->distance, slave, sizeof p->distance);
  for (int m = 0; m < QUAD9_NODES; m++) {
    for (int i = 0; i < 3; i++) {
      double x = master[m][i];
      p->distance[i] -= p->n[m] * x;
      p->tangent[0][i] += p->dn[0][m] * x;
      p->tangent[1][i] += p->dn[1][m] * x;
      p->curvature[0][i] += d2n[0][m] * x;
      p->curvature[1][i] += d2n[1][m] * x;
      p->curvature[2][i] += d2n[2][m] * x;
    }
  }
  const double *a = p->tangent[0], *b = p->tangent[1], *d = p->distance;
  p->c11 = vec3_dot(a, a) - vec3_dot(d, p->curvature[0]);
  p->c22 = vec3_dot(b, b) - vec3_dot(d, p->curvature[1]);
  p->c12 = vec3_dot(a, b) - vec3_dot(d, p->curvature[2]);
}

bool projection_find(double master[QUAD9_NODES][3], const double slave[3], double xi[2],
                     struct projection *p) {
  for (int iteration = 0; iteration < 12; iteration++) {
    evaluate(master, slave, xi, p);
    double determinant = p->c11 * p->c22 - p->c12 * p->c12;
    if (!(determinant > 0)) {
      return false;
    }
    double r1 = vec3_dot(p->distance, p->tangent[0]), r2 = vec3_dot(p->distance, p->tangent[1]);
    double d1 = (p->c22 * r1 - p->c12 * r2) / determinant;
    double d2 = (p->c11 * r2 - p->c12 * r1) / determinant;
    if (fabs(d1) + fabs(d2) < 1e-12) {
      return true;
    }
    xi[0] = fmax(-2, fmin(2, xi[0] + d1));
    xi[1] = fmax(-2, fmin(2, xi[1] + d2));
  }
  return false;
}

double projection_gap(const struct projection *p, int side, double normal[3]) {
  vec3_cross(p->tangent[0], p->tangent[1], normal);
  double length = vec3_norm(normal) * side;
  for (int i = 0; i < 3; i++) {
    normal[i] /= length;
  }
  return vec3_dot(p->distance, normal);
}
