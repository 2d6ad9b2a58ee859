#include "solver/fe/pressure.h"

#include <string.h>
#include "solver/base/vec3.h"

/* Position and tangents at Gauss point q. */
static void face_point(const struct quad9_tables *tables, double x[QUAD9_NODES][3], int q,
                       double position[3], double a[3], double b[3]) {
  for (int i = 0; i < 3; i++) {
    position[i] = a[i] = b[i] = 0;
    for (int m = 0; m < QUAD9_NODES; m++) {
      position[i] += tables->n[q][m] * x[m][i];
      a[i] += tables->dn[q][0][m] * x[m][i];
      b[i] += tables->dn[q][1][m] * x[m][i];
    }
  }
}

double pressure_face(const struct quad9_tables *tables, double x[QUAD9_NODES][3], int side,
                     double force[FACE_DOFS]) {
  double volume = 0;
  memset(force, 0, FACE_DOFS * sizeof *force);
  for (int q = 0; q < QUAD9_POINTS; q++) {
    double position[3], a[3], b[3], normal[3];
    face_point(tables, x, q, position, a, b);
    vec3_cross(a, b, normal);
    double weight = side * tables->weight[q];
    volume -= weight * vec3_dot(position, normal) / 3;
    for (int m = 0; m < QUAD9_NODES; m++) {
      for (int i = 0; i < 3; i++) {
        force[3 * m + i] += weight * tables->n[q][m] * normal[i];
      }
    }
  }
  return volume;
}

void pressure_face_tangent(const struct quad9_tables *tables, double x[QUAD9_NODES][3], int side,
                           double tangent[FACE_DOFS * FACE_DOFS]) {
  memset(tangent, 0, FACE_DOFS * FACE_DOFS * sizeof *tangent);
  for (int q = 0; q < QUAD9_POINTS; q++) {
    double position[3], a[3], b[3];
    face_point(tables, x, q, position, a, b);
    double half = 0.5 * side * tables->weight[q];
    const double *n = tables->n[q], *ns = tables->dn[q][0], *nt = tables->dn[q][1];
    for (int m = 0; m < QUAD9_NODES; m++) {
      for (int k = 0; k < QUAD9_NODES; k++) {
        /* 1/2 ([a]x (N_m N_k,t - N_k N_m,t) - [b]x (N_m N_k,s - N_k N_m,s)) = [v]x */
        double along_a = half * (n[m] * nt[k] - n[k] * nt[m]);
        double along_b = half * (n[m] * ns[k] - n[k] * ns[m]);
        double v[3];
        for (int i = 0; i < 3; i++) {
          v[i] = along_a * a[i] - along_b * b[i];
        }
        double *block = tangent + 3 * m * FACE_DOFS + 3 * k;
        block[1] -= v[2];
        block[2] += v[1];
        block[FACE_DOFS] += v[2];
        block[FACE_DOFS + 2] -= v[0];
        block[2 * FACE_DOFS] -= v[1];
        block[2 * FACE_DOFS + 1] += v[0];
      }
    }
  }
}
