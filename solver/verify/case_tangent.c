/* Tangents of the element and of the pressure load against central differences. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/pressure.h"
#include "solver/verify/cases.h"
#include "solver/verify/materials.h"

/* A hexahedron with every node moved. */
static void crooked_nodes(double x[HEX27_NODES][3], double amplitude, unsigned seed) {
  for (int a = 0; a < HEX27_NODES; a++) {
    int at[3] = {a / 9, a / 3 % 3, a % 3};
    for (int i = 0; i < 3; i++) {
      x[a][i] = 0.5 * at[i] + amplitude * body_random(&seed);
    }
  }
}

/* ---- element ---- */

enum { MIXED = ELEMENT_DOFS + ELEMENT_PRESSURES };

struct element_case {
  struct hex27_tables tables;
  struct element_geometry geometry;
  struct element_internal internal;
  const struct material_spec *material;
  double bulk_modulus;
  double u[3][HEX27_STRIDE], p[ELEMENT_PRESSURES]; /* the state */
  double v[3][HEX27_STRIDE], q[ELEMENT_PRESSURES]; /* the direction */
  double packed[ELEMENT_PACKED];
  double exact[MIXED];
};

/* Both residuals of the mixed element, before the pressures are condensed. */
static void mixed_residual(struct element_case *c, double h, double r[MIXED]) {
  double u[3][HEX27_STRIDE] = {{0}}, p[ELEMENT_PRESSURES], packed[ELEMENT_PACKED];
  struct element_internal at;
  for (int i = 0; i < 3; i++) {
    for (int a = 0; a < HEX27_NODES; a++) {
      u[i][a] = c->u[i][a] + h * c->v[i][a];
    }
  }
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    p[m] = c->p[m] + h * c->q[m];
  }
  element_evaluate(&c->geometry, c->material, c->bulk_modulus, u, p, r, packed, &at);
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    double y = 0;
    for (int n = 0; n < ELEMENT_PRESSURES; n++) {
      y += at.inverse[m][n] * at.residual[n];
    }
    for (int d = 0; d < ELEMENT_DOFS; d++) {
      r[d] += at.coupling[m][d] * y;
    }
    r[ELEMENT_DOFS + m] = at.residual[m];
  }
}

/* y = K v with a packed upper triangle. */
static void multiply_packed(int n, const double *packed, const double *v, double *y) {
  memset(y, 0, sizeof *y * (size_t)n);
  for (int r = 0; r < n; r++) {
    for (int c = r; c < n; c++, packed++) {
      y[r] += *packed * v[c];
      y[c] += c > r ? *packed * v[r] : 0;
    }
  }
}

/* Solves a y = b of order 4 by Gauss-Jordan elimination. */
static void solve4(double a[4][4], const double b[4], double y[4]) {
  memcpy(y, b, 4 * sizeof *y);
  for (int c = 0; c < 4; c++) {
    for (int r = 0; r < 4; r++) {
      double factor = a[r][c] / a[c][c];
      for (int k = 0; r != c && k < 4; k++) {
        a[r][k] -= factor * a[c][k];
      }
      y[r] -= r != c ? factor * y[c] : 0;
    }
  }
  for (int c = 0; c < 4; c++) {
    y[c] /= a[c][c];
  }
}

/* Derivative of the mixed residual along (v, q) from the condensed tangent:
 * r_u' = K_c v + C^T (M^-1 C v + q),  r_p' = C v + M q. */
static void mixed_derivative(struct element_case *c) {
  double v[ELEMENT_DOFS], cv[ELEMENT_PRESSURES] = {0}, mq[ELEMENT_PRESSURES], inverse[4][4];
  for (int d = 0; d < ELEMENT_DOFS; d++) {
    v[d] = c->v[d / HEX27_NODES][d % HEX27_NODES];
    for (int m = 0; m < ELEMENT_PRESSURES; m++) {
      cv[m] += c->internal.coupling[m][d] * v[d];
    }
  }
  multiply_packed(ELEMENT_DOFS, c->packed, v, c->exact);
  memcpy(inverse, c->internal.inverse, sizeof inverse);
  solve4(inverse, c->q, mq);
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    double y = c->q[m];
    for (int n = 0; n < ELEMENT_PRESSURES; n++) {
      y += c->internal.inverse[m][n] * cv[n];
    }
    for (int d = 0; d < ELEMENT_DOFS; d++) {
      c->exact[d] += c->internal.coupling[m][d] * y;
    }
    c->exact[ELEMENT_DOFS + m] = cv[m] + mq[m];
  }
}

/* A large deformation with pressures, and a random direction. */
static bool element_open(struct element_case *c, const struct material_spec *material) {
  double x[HEX27_NODES][3], residual[ELEMENT_DOFS];
  unsigned seed = 21;
  crooked_nodes(x, 0.05, 3);
  memset(c, 0, sizeof *c);
  hex27_tables_fill(&c->tables);
  c->material = material;
  c->bulk_modulus = 50 * material_shear_modulus(material);
  element_geometry_fill(&c->tables, x, &c->geometry);
  for (int d = 0; d < ELEMENT_DOFS; d++) {
    int i = d / HEX27_NODES, a = d % HEX27_NODES;
    c->u[i][a] = 0.3 * x[a][(i + 1) % 3] + 0.2 * x[a][0] * x[a][i] + 0.01 * body_random(&seed);
    c->v[i][a] = body_random(&seed);
  }
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    c->p[m] = 0.3 * body_random(&seed);
    c->q[m] = body_random(&seed);
  }
  bool good = element_evaluate(&c->geometry, material, c->bulk_modulus, c->u, c->p, residual,
                               c->packed, &c->internal);
  mixed_derivative(c);
  return good;
}

/* The worst of all materials. */
static double element_error(void *context, double h) {
  struct element_case *c = context;
  double worst = 0;
  for (int k = 0; k < VERIFY_MATERIALS; k++) {
    double a[MIXED], b[MIXED];
    mixed_residual(&c[k], -h, a);
    mixed_residual(&c[k], h, b);
    worst = fmax(worst, verify_difference_error(MIXED, a, b, h, c[k].exact));
  }
  return worst;
}

enum status case_tangent_element(struct verify_run *run, struct error *error) {
  struct element_case *c = calloc(VERIFY_MATERIALS, sizeof *c);
  enum status status = c ? STATUS_OK : STATUS_NO_MEMORY;
  for (int k = 0; status == STATUS_OK && k < VERIFY_MATERIALS; k++) {
    status = element_open(&c[k], &verify_materials[k]) ? STATUS_OK : STATUS_INVERTED;
  }
  if (status == STATUS_OK) {
    verify_difference(run, element_error, c, 0.01);
  } else {
    verify_failed(status, "the element", error);
  }
  free(c);
  return status;
}

/* ---- follower pressure on a closed surface: the six faces of one hexahedron ---- */

struct pressure_case {
  struct quad9_tables tables;
  double x[HEX27_NODES][3], v[HEX27_NODES][3];
  double force[3 * HEX27_NODES], derivative[3 * HEX27_NODES];
};

/* Volume, force of unit pressure and, unless NULL, its derivative along v, at x + h v. */
static double closed_surface(const struct pressure_case *c, double h, double *force,
                             double *derivative) {
  double volume = 0;
  memset(force, 0, 3 * HEX27_NODES * sizeof *force);
  for (int face = 0; face < 6; face++) {
    int local[QUAD9_NODES], side = face % 2 ? 1 : -1;
    double x[QUAD9_NODES][3], f[FACE_DOFS], k[FACE_DOFS * FACE_DOFS];
    mesh_face_local_nodes(face / 2, side, local);
    for (int m = 0; m < FACE_DOFS; m++) {
      x[m / 3][m % 3] = c->x[local[m / 3]][m % 3] + h * c->v[local[m / 3]][m % 3];
    }
    volume -= pressure_face(&c->tables, x, side, f);
    pressure_face_tangent(&c->tables, x, side, k);
    for (int r = 0; r < FACE_DOFS; r++) {
      int row = 3 * local[r / 3] + r % 3;
      force[row] += f[r];
      for (int s = 0; derivative && s < FACE_DOFS; s++) {
        derivative[row] += k[FACE_DOFS * r + s] * c->v[local[s / 3]][s % 3];
      }
    }
  }
  return volume;
}

/* The force is the gradient of the volume, which is cubic in h. */
static double volume_error(void *context, double h) {
  struct pressure_case *c = context;
  double unused[3 * HEX27_NODES], exact = 0;
  double a = closed_surface(c, -h, unused, NULL), b = closed_surface(c, h, unused, NULL);
  for (int d = 0; d < 3 * HEX27_NODES; d++) {
    exact += c->force[d] * c->v[d / 3][d % 3];
  }
  return verify_difference_error(1, &a, &b, h, &exact);
}

enum status case_tangent_pressure(struct verify_run *run, struct error *error) {
  struct pressure_case c = {.force = {0}};
  double a[3 * HEX27_NODES], b[3 * HEX27_NODES];
  unsigned seed = 31;
  (void)error;
  quad9_tables_fill(&c.tables);
  crooked_nodes(c.x, 0.1, 7);
  for (int d = 0; d < 3 * HEX27_NODES; d++) {
    c.v[d / 3][d % 3] = body_random(&seed);
  }
  closed_surface(&c, 0, c.force, c.derivative);
  verify_difference(run, volume_error, &c, 0.1);
  /* The force is quadratic in h: its central difference is the load stiffness but for round-off. */
  closed_surface(&c, -0.1, a, NULL);
  closed_surface(&c, 0.1, b, NULL);
  verify_metric(run, "load_stiffness_error_percent",
                100 * verify_difference_error(3 * HEX27_NODES, a, b, 0.1, c.derivative));
  return STATUS_OK;
}
