#include "solver/fe/element.h"

#include <cblas.h>
#include <math.h>
#include <string.h>
#include "solver/fe/element_evaluate.h"
#include "solver/fe/lanes.h"

/* Of a symmetric positive definite matrix: Gauss-Jordan needs no pivoting. */
static void invert(double m[ELEMENT_PRESSURES][ELEMENT_PRESSURES],
                   double inverse[ELEMENT_PRESSURES][ELEMENT_PRESSURES]) {
  double a[ELEMENT_PRESSURES][2 * ELEMENT_PRESSURES] = {{0}};
  for (int i = 0; i < ELEMENT_PRESSURES; i++) {
    memcpy(a[i], m[i], sizeof m[i]);
    a[i][ELEMENT_PRESSURES + i] = 1;
  }
  for (int c = 0; c < ELEMENT_PRESSURES; c++) {
    double pivot = 1 / a[c][c];
    for (int j = 0; j < 2 * ELEMENT_PRESSURES; j++) {
      a[c][j] *= pivot;
    }
    for (int i = 0; i < ELEMENT_PRESSURES; i++) {
      double factor = a[i][c];
      for (int j = 0; i != c && j < 2 * ELEMENT_PRESSURES; j++) {
        a[i][j] -= factor * a[c][j];
      }
    }
  }
  for (int i = 0; i < ELEMENT_PRESSURES; i++) {
    memcpy(inverse[i], a[i] + ELEMENT_PRESSURES, sizeof inverse[i]);
  }
}

static void fill_projection(struct element_geometry *geometry) {
  double mass[ELEMENT_PRESSURES][ELEMENT_PRESSURES] = {{0}};
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    for (int n = 0; n < ELEMENT_PRESSURES; n++) {
      for (int q = 0; q < HEX27_POINTS; q++) {
        mass[m][n] += geometry->weight[q] * geometry->phi[m][q] * geometry->phi[n][q];
      }
    }
  }
  invert(mass, geometry->projection);
}

double element_geometry_fill(const struct hex27_tables *tables, double x[HEX27_NODES][3],
                             struct element_geometry *geometry) {
  double centre[3], volume = 0, size;
  for (int i = 0; i < 3; i++) {
    centre[i] = x[13][i]; /* the middle node */
  }
  size = 0;
  for (int a = 0; a < HEX27_NODES; a++) {
    for (int i = 0; i < 3; i++) {
      size = fmax(size, fabs(x[a][i] - centre[i]));
    }
  }
  memset(geometry, 0, sizeof *geometry);
  geometry->tables = tables;
  double n[HEX27_NODES];
  for (int q = 0; q < HEX27_POINTS; q++) {
    struct kinematics map = {0}; /* map.f[3 i + d] = dX_i / dxi_d */
    double position[3] = {0};
    hex27_shape(tables->point[q], n, NULL);
    for (int a = 0; a < HEX27_NODES; a++) {
      for (int i = 0; i < 3; i++) {
        position[i] += n[a] * x[a][i];
        for (int d = 0; d < 3; d++) {
          map.f[3 * i + d] += x[a][i] * tables->dn[q][d][a];
        }
      }
    }
    double determinant = kinematics_complete(&map);
    if (!(determinant > 0)) {
      return 0;
    }
    for (int i = 0; i < 9; i++) { /* the cofactor is the transposed inverse */
      geometry->inverse[i % 3 * 3 + i / 3][q] = map.cofactor[i];
    }
    geometry->weight[q] = determinant * tables->weight[q];
    volume += geometry->weight[q];
    geometry->phi[0][q] = 1;
    for (int i = 0; i < 3; i++) {
      geometry->phi[1 + i][q] = (position[i] - centre[i]) / size;
    }
  }
  fill_projection(geometry);
  return volume;
}

void element_gradient(const struct element_geometry *geometry, int q, double u[3][HEX27_STRIDE],
                      double f[9]) {
  const double(*dn)[HEX27_NODES] = geometry->tables->dn[q];
  for (int i = 0; i < 3; i++) {
    double h[3] = {0};
    for (int d = 0; d < 3; d++) {
      for (int a = 0; a < HEX27_NODES; a++) {
        h[d] += u[i][a] * dn[d][a];
      }
    }
    for (int j = 0; j < 3; j++) {
      f[3 * i + j] = (i == j) + h[0] * geometry->inverse[j][q] +
                     h[1] * geometry->inverse[3 + j][q] + h[2] * geometry->inverse[6 + j][q];
    }
  }
}

bool element_evaluate(const struct element_geometry *geometry, const struct material_spec *material,
                      double bulk_modulus, double u[3][HEX27_STRIDE],
                      const double p[ELEMENT_PRESSURES], double residual[ELEMENT_DOFS],
                      double *packed, struct element_internal *internal) {
  return element_evaluate_damped(geometry, material, bulk_modulus, NULL, u, p, residual, packed,
                                 internal);
}

bool element_evaluate_damped(const struct element_geometry *geometry,
                             const struct material_spec *material, double bulk_modulus,
                             const struct element_viscosity *viscosity, double u[3][HEX27_STRIDE],
                             const double p[ELEMENT_PRESSURES], double residual[ELEMENT_DOFS],
                             double *packed, struct element_internal *internal) {
  struct element_arguments a = {geometry, material, bulk_modulus, viscosity, u,
                                p,        residual, packed,       internal};
  switch (lanes_width()) {
  case 512:
    return element_evaluate_512(&a);
  case 256:
    return element_evaluate_256(&a);
  default:
    return element_evaluate_128(&a);
  }
}

void element_recover(const struct element_internal *internal, const double du[ELEMENT_DOFS],
                     double share, double dp[ELEMENT_PRESSURES]) {
  double r[ELEMENT_PRESSURES];
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    r[m] =
        share * internal->residual[m] + cblas_ddot(ELEMENT_DOFS, internal->coupling[m], 1, du, 1);
  }
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    dp[m] = -cblas_ddot(ELEMENT_PRESSURES, internal->inverse[m], 1, r, 1);
  }
}
