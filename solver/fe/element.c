#include "solver/fe/element.h"

#include <cblas.h>
#include <math.h>
#include <string.h>

static const double j_minimum = 0.02;

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
    for (int a = 0; a < HEX27_NODES; a++) {
      for (int i = 0; i < 3; i++) { /* the cofactor is the transposed inverse */
        geometry->gradient[q][i][a] = tables->dn[q][0][a] * map.cofactor[3 * i] +
                                      tables->dn[q][1][a] * map.cofactor[3 * i + 1] +
                                      tables->dn[q][2][a] * map.cofactor[3 * i + 2];
      }
    }
    geometry->weight[q] = determinant * tables->weight[q];
    volume += geometry->weight[q];
    geometry->phi[q][0] = 1;
    for (int i = 0; i < 3; i++) {
      geometry->phi[q][1 + i] = (position[i] - centre[i]) / size;
    }
  }
  return volume;
}

static double dot(const double *restrict a, const double *restrict b) {
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (int i = 0; i < HEX27_STRIDE; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

void element_gradient(const struct element_geometry *geometry, int q, double u[3][HEX27_STRIDE],
                      double f[9]) {
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      f[3 * i + j] = (i == j) + dot(u[i], geometry->gradient[q][j]);
    }
  }
}

/* Residual and pressure rows of one Gauss point. */
struct point_state {
  struct kinematics k;
  double stress[9];   /* weighted total first Piola-Kirchhoff stress */
  double tangent[81]; /* weighted */
};

/* out[a] += b[0] D[0][a] + b[1] D[1][a] + b[2] D[2][a] */
static void add_rows(const double b[3], const double d[3][HEX27_STRIDE], double *restrict out) {
#pragma omp simd
  for (int a = 0; a < HEX27_NODES; a++) {
    out[a] += b[0] * d[0][a] + b[1] * d[1][a] + b[2] * d[2][a];
  }
}

/* Total stress P = P_iso + p J F^-T and tangent A = A_iso + p J (G_iJ G_kL - G_kJ G_iL). */
static void total_response(const struct material_spec *material, double p, double weight,
                           bool tangent, struct point_state *s) {
  const double *g = s->k.cofactor;
  hyperelastic_isochoric(material, &s->k, s->stress, tangent ? s->tangent : NULL);
  double pj = p * s->k.j;
  for (int i = 0; i < 9; i++) {
    s->stress[i] = weight * (s->stress[i] + pj * g[i]);
  }
  for (int r = 0; tangent && r < 9; r++) {
    int i = r / 3, j = r % 3;
    for (int c = 0; c < 9; c++) {
      int k = c / 3, l = c % 3;
      s->tangent[9 * r + c] =
          weight * (s->tangent[9 * r + c] + pj * (g[r] * g[c] - g[3 * k + j] * g[3 * i + l]));
    }
  }
}

/* Rows 3 q + J of work->transformed[i], columns 27 k + b, k >= i: A_iJkL D_bL. */
static void transform_tangent(const double tangent[81], const double d[3][HEX27_STRIDE], int q,
                              struct element_work *work) {
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      double *row = work->transformed[i][3 * q + j];
      const double *a = tangent + 9 * (3 * i + j);
      for (int k = i; k < 3; k++) {
        double *restrict out = row + HEX27_NODES * k;
#pragma omp simd
        for (int b = 0; b < HEX27_NODES; b++) {
          out[b] = a[3 * k] * d[0][b] + a[3 * k + 1] * d[1][b] + a[3 * k + 2] * d[2][b];
        }
      }
    }
  }
}

static void invert_pressure_block(double m[ELEMENT_PRESSURES][ELEMENT_PRESSURES],
                                  double inverse[ELEMENT_PRESSURES][ELEMENT_PRESSURES]) {
  /* -m is symmetric positive definite: Gauss-Jordan needs no pivoting. */
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

/* K_iakb = sum_q,J D_aJ T_iJ,kb for k >= i, then packed with the condensation of the pressures
 * K - C^T (dr/dp)^-1 C. */
static void assemble_packed(const struct element_geometry *geometry,
                            const struct element_internal *internal, struct element_work *work,
                            double *packed) {
  const int rows = 3 * HEX27_POINTS, width = 3 * HEX27_NODES;
  for (int i = 0; i < 3; i++) {
    int first = HEX27_NODES * i;
    cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, HEX27_NODES, width - first, rows, 1,
                &geometry->gradient[0][0][0], HEX27_STRIDE, &work->transformed[i][0][first], width,
                0, &work->stiffness[i][0][first], width);
  }
  double scaled[ELEMENT_PRESSURES][ELEMENT_DOFS];
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    for (int c = 0; c < ELEMENT_DOFS; c++) {
      scaled[m][c] = internal->inverse[m][0] * internal->coupling[0][c] +
                     internal->inverse[m][1] * internal->coupling[1][c] +
                     internal->inverse[m][2] * internal->coupling[2][c] +
                     internal->inverse[m][3] * internal->coupling[3][c];
    }
  }
  for (int r = 0; r < ELEMENT_DOFS; r++) {
    const double *restrict k = work->stiffness[r / HEX27_NODES][r % HEX27_NODES];
    double s0 = scaled[0][r], s1 = scaled[1][r], s2 = scaled[2][r], s3 = scaled[3][r];
    const double(*restrict c)[ELEMENT_DOFS] = internal->coupling;
    double *restrict out = packed - r;
    for (int col = r; col < ELEMENT_DOFS; col++) {
      out[col] = k[col] - s0 * c[0][col] - s1 * c[1][col] - s2 * c[2][col] - s3 * c[3][col];
    }
    packed += ELEMENT_DOFS - r;
  }
}

bool element_evaluate(const struct element_geometry *geometry, const struct material_spec *material,
                      double bulk_modulus, double u[3][HEX27_STRIDE],
                      const double p[ELEMENT_PRESSURES], struct element_work *work,
                      double residual[ELEMENT_DOFS], double *packed,
                      struct element_internal *internal) {
  double pressure_block[ELEMENT_PRESSURES][ELEMENT_PRESSURES] = {{0}};
  memset(residual, 0, ELEMENT_DOFS * sizeof *residual);
  memset(internal->residual, 0, sizeof internal->residual);
  if (packed) {
    memset(internal->coupling, 0, sizeof internal->coupling);
  }
  for (int q = 0; q < HEX27_POINTS; q++) {
    const double(*d)[HEX27_STRIDE] = geometry->gradient[q];
    const double *phi = geometry->phi[q];
    struct point_state s;
    element_gradient(geometry, q, u, s.k.f);
    if (!(kinematics_complete(&s.k) > j_minimum)) {
      return false;
    }
    double pressure = cblas_ddot(ELEMENT_PRESSURES, phi, 1, p, 1);
    total_response(material, pressure, geometry->weight[q], packed != NULL, &s);
    for (int i = 0; i < 3; i++) {
      add_rows(s.stress + 3 * i, d, residual + HEX27_NODES * i);
    }
    double excess = geometry->weight[q] * (s.k.j - 1 - pressure / bulk_modulus);
    for (int m = 0; m < ELEMENT_PRESSURES; m++) {
      internal->residual[m] += phi[m] * excess;
    }
    if (!packed) {
      continue;
    }
    for (int m = 0; m < ELEMENT_PRESSURES; m++) {
      double scale = geometry->weight[q] * phi[m];
      for (int i = 0; i < 3; i++) {
        double b[3];
        for (int j = 0; j < 3; j++) {
          b[j] = scale * s.k.j * s.k.cofactor[3 * i + j];
        }
        add_rows(b, d, internal->coupling[m] + HEX27_NODES * i);
      }
      for (int n = 0; n < ELEMENT_PRESSURES; n++) {
        pressure_block[m][n] -= scale * phi[n] / bulk_modulus;
      }
    }
    transform_tangent(s.tangent, d, q, work);
  }
  if (packed) {
    invert_pressure_block(pressure_block, internal->inverse);
    assemble_packed(geometry, internal, work, packed);
  }
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    double y = cblas_ddot(ELEMENT_PRESSURES, internal->inverse[m], 1, internal->residual, 1);
    cblas_daxpy(ELEMENT_DOFS, -y, internal->coupling[m], 1, residual, 1);
  }
  return true;
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
