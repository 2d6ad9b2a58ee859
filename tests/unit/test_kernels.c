/* The kernels of every instruction set that this processor has, against plain sums. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/fe/element_evaluate.h"
#include "solver/fe/lanes.h"
#include "solver/fe/ldlt_front_internal.h"
#include "solver/verify/materials.h"
#include "tests/unit/suite.h"

enum { SETS = 3 };
static const int width_of[SETS] = {128, 256, 512};

static double uniform(unsigned *seed) {
  *seed = *seed * 1664525u + 1013904223u;
  return (*seed >> 8) / (double)(1u << 23) - 1;
}

/* ---- element ---- */

static const double bulk_modulus = 30;

struct element_case {
  struct hex27_tables tables;
  struct element_geometry geometry;
  double x[HEX27_NODES][3], u[3][HEX27_STRIDE], p[ELEMENT_PRESSURES];
  struct element_viscosity viscosity;
};

static void element_open(struct element_case *c) {
  unsigned seed = 7;
  memset(c, 0, sizeof *c);
  hex27_tables_fill(&c->tables);
  for (int a = 0; a < HEX27_NODES; a++) {
    const int at[3] = {a / 9, a / 3 % 3, a % 3};
    for (int i = 0; i < 3; i++) {
      c->x[a][i] = 0.5 * (1 + i) * at[i] + 0.04 * uniform(&seed);
      c->u[i][a] = 0.2 * uniform(&seed) * at[(i + 1) % 3] * (a % 5 == 0) + 0.1 * at[(i + 2) % 3];
    }
  }
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    c->p[m] = uniform(&seed);
  }
  for (int n = 0; n < 6 * HEX27_POINTS; n++) {
    c->viscosity.history[n / HEX27_POINTS][n % HEX27_POINTS] = uniform(&seed);
  }
  ck_assert_double_gt(element_geometry_fill(&c->tables, c->x, &c->geometry), 0);
}

/* Matrices of the mixed element before condensation, as the potential gives them. */
struct plain {
  double r[ELEMENT_DOFS], k[ELEMENT_DOFS][ELEMENT_DOFS];
  double rp[ELEMENT_PRESSURES], c[ELEMENT_PRESSURES][ELEMENT_DOFS];
};

/* Adds F S and its derivative by F, S = stiffness (F^T F - history). */
static void add_viscous(const struct element_viscosity *viscosity, int q, const double f[9],
                        double stress[9], double tangent[81]) {
  static const int row_of[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
  double s[9];
  for (int n = 0; n < 9; n++) {
    double c = -viscosity->history[row_of[n]][q];
    for (int i = 0; i < 3; i++) {
      c += f[3 * i + n / 3] * f[3 * i + n % 3];
    }
    s[n] = viscosity->stiffness * c;
  }
  for (int n = 0; n < 27; n++) {
    int i = n / 9, j = n / 3 % 3, k = n % 3;
    stress[3 * i + j] += f[3 * i + k] * s[3 * k + j];
    tangent[9 * (3 * i + j) + 3 * i + k] += s[3 * k + j];
    for (int o = 0; o < 9; o++) { /* by F_ol: dC_kj = d_lk F_oj + F_ok d_lj */
      double *to = tangent + 9 * (3 * i + j) + 3 * (o / 3);
      double rate = viscosity->stiffness * f[3 * i + k];
      to[o % 3] += o % 3 == k ? rate * f[3 * (o / 3) + j] : 0;
      to[o % 3] += o % 3 == j ? rate * f[3 * (o / 3) + k] : 0;
    }
  }
}

static void add_point(const struct element_case *c, const struct material_spec *material, int q,
                      struct plain *s) {
  struct kinematics k;
  double stress[9], tangent[81], d[HEX27_NODES][3] = {{0}}, pressure = 0;
  double w = c->geometry.weight[q];
  element_gradient(&c->geometry, q, (double(*)[HEX27_STRIDE])c->u, k.f);
  kinematics_complete(&k);
  hyperelastic_isochoric(material, &k, stress, tangent);
  add_viscous(&c->viscosity, q, k.f, stress, tangent);
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    pressure += c->p[m] * c->geometry.phi[m][q];
  }
  for (int n = 0; n < 9 * HEX27_NODES; n++) {
    int a = n / 9, j = n / 3 % 3, e = n % 3;
    d[a][j] += c->tables.dn[q][e][a] * c->geometry.inverse[3 * e + j][q];
  }
  for (int row = 0; row < ELEMENT_DOFS; row++) {
    int i = row / HEX27_NODES, a = row % HEX27_NODES;
    for (int j = 0; j < 3; j++) {
      double dj = k.j * k.cofactor[3 * i + j];
      s->r[row] += w * (stress[3 * i + j] + pressure * dj) * d[a][j];
      for (int m = 0; m < ELEMENT_PRESSURES; m++) {
        s->c[m][row] += w * c->geometry.phi[m][q] * dj * d[a][j];
      }
      for (int n = 0; n < 3 * ELEMENT_DOFS; n++) {
        int column = n / 3, l = n % 3, o = column / HEX27_NODES, b = column % HEX27_NODES;
        double volumetric = k.cofactor[3 * i + j] * k.cofactor[3 * o + l] -
                            k.cofactor[3 * o + j] * k.cofactor[3 * i + l];
        s->k[row][column] += w *
                             (tangent[9 * (3 * i + j) + 3 * o + l] + pressure * k.j * volumetric) *
                             d[a][j] * d[b][l];
      }
    }
  }
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    s->rp[m] += w * c->geometry.phi[m][q] * (k.j - 1 - pressure / bulk_modulus);
  }
}

static bool evaluate(int set, const struct element_arguments *a) {
  return set == 0   ? element_evaluate_128(a)
         : set == 1 ? element_evaluate_256(a)
                    : element_evaluate_512(a);
}

/* r - C^T M^-1 rp and K - C^T M^-1 C with M^-1 = -kappa (int phi phi)^-1 from `plain`. */
static void compare(const struct plain *s, const struct element_internal *internal,
                    const double *residual, const double *packed) {
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    ck_assert_double_eq_tol(internal->residual[m], s->rp[m], 1e-13);
  }
  for (int row = 0; row < ELEMENT_DOFS; row++) {
    double y[ELEMENT_PRESSURES] = {0}, r = s->r[row];
    for (int m = 0; m < ELEMENT_PRESSURES; m++) {
      ck_assert_double_eq_tol(internal->coupling[m][row], s->c[m][row], 1e-13);
      for (int n = 0; n < ELEMENT_PRESSURES; n++) {
        y[m] += internal->inverse[m][n] * s->c[n][row];
      }
      r -= y[m] * s->rp[m];
    }
    ck_assert_double_eq_tol(residual[row], r, 1e-11);
    for (int column = row; column < ELEMENT_DOFS; column++) {
      double k = s->k[row][column];
      for (int m = 0; m < ELEMENT_PRESSURES; m++) {
        k -= y[m] * s->c[m][column];
      }
      ck_assert_double_eq_tol(*packed++, k, 1e-11);
    }
  }
}

START_TEST(element_is_the_sum_over_its_points) {
  static struct element_case c;
  static struct plain s;
  int set = _i / VERIFY_MATERIALS % SETS;
  bool damped = _i >= SETS * VERIFY_MATERIALS;
  const struct material_spec *material = &verify_materials[_i % VERIFY_MATERIALS];
  if (lanes_width() < width_of[set]) {
    return;
  }
  element_open(&c);
  c.viscosity.stiffness = damped ? 0.3 : 0;
  memset(&s, 0, sizeof s);
  for (int q = 0; q < HEX27_POINTS; q++) {
    add_point(&c, material, q, &s);
  }
  double residual[ELEMENT_DOFS], alone[ELEMENT_DOFS], packed[ELEMENT_PACKED + 1];
  struct element_internal internal;
  struct element_arguments a = {.geometry = &c.geometry,
                                .material = material,
                                .bulk_modulus = bulk_modulus,
                                .viscosity = damped ? &c.viscosity : NULL,
                                .u = c.u,
                                .p = c.p,
                                .residual = residual,
                                .packed = packed,
                                .internal = &internal};
  packed[ELEMENT_PACKED] = 123;
  ck_assert(evaluate(set, &a));
  compare(&s, &internal, residual, packed);
  ck_assert_double_eq(packed[ELEMENT_PACKED], 123);
  a.residual = alone;
  a.packed = NULL;
  ck_assert(evaluate(set, &a));
  for (int d = 0; d < ELEMENT_DOFS; d++) {
    ck_assert_double_eq_tol(alone[d], residual[d], 1e-13);
  }
  c.u[0][13] = 3; /* the middle node far outside */
  ck_assert(!evaluate(set, &a));
}
END_TEST

/* ---- elimination in a front ---- */

static int eliminate(int set, const struct ldlt_dense *front) {
  return set == 0   ? ldlt_front_eliminate_128(front)
         : set == 1 ? ldlt_front_eliminate_256(front)
                    : ldlt_front_eliminate_512(front);
}

/* A symmetric matrix with pivots of both signs on a dominant diagonal, by columns. */
static double *front_matrix(int n) {
  double *a = calloc((size_t)n * (size_t)n, sizeof *a);
  unsigned seed = 5;
  ck_assert_ptr_nonnull(a);
  for (int j = 0; j < n; j++) {
    for (int i = j; i < n; i++) {
      a[j * n + i] = i == j ? (j % 5 == 3 ? -1 : 1) * (double)n : uniform(&seed);
    }
  }
  return a;
}

START_TEST(front_is_eliminated) {
  static const int size[][2] = {{5, 3}, {7, 7}, {40, 17}, {130, 70}, {300, 40}};
  for (int set = 0; set < SETS && width_of[set] <= lanes_width(); set++) {
    int n = size[_i][0], columns = size[_i][1], below = n - columns, negative = 0;
    double *a = front_matrix(n), *l = front_matrix(n);
    double *update = calloc((size_t)below * (size_t)below + 1, sizeof *update);
    double *sign = calloc((size_t)columns, sizeof *sign);
    double *work = calloc(ldlt_front_work(n, columns), sizeof *work);
    ck_assert(update && sign && work);
    struct ldlt_dense front = {n, columns, l, update, false, sign, work};
    int found = eliminate(set, &front);
    for (int j = 0; j < n; j++) {
      negative += j < columns && sign[j] < 0;
      for (int i = j; i < n; i++) {
        double sum = j >= columns ? update[(j - columns) * below + i - columns] : 0;
        for (int k = 0; k < columns && k <= j; k++) {
          sum += sign[k] * l[k * n + i] * l[k * n + j];
        }
        ck_assert_double_eq_tol(sum, j < columns ? a[j * n + i] : 0, 1e-11);
      }
    }
    ck_assert_int_eq(found, negative);
    ck_assert_int_eq(found, (columns + 1) / 5);
    free(a);
    free(l);
    free(update);
    free(sign);
    free(work);
  }
}
END_TEST

/* ---- eigenvalues ---- */

/* Of random tensors, and of those with two or three equal eigenvalues. */
START_TEST(largest_eigenvalue_is_that_of_jacobi) {
  unsigned seed = 11;
  for (int k = 0; k < 2000; k++) {
    double f[9], c[9], value[3], v[9];
    for (int i = 0; i < 9; i++) {
      f[i] = k % 4 == 0 ? (i % 4 == 0) * (1 + (i == 4 * (k % 3)) * uniform(&seed)) : uniform(&seed);
    }
    for (int i = 0; i < 9; i++) {
      c[i] = f[i / 3] * f[i % 3] + f[3 + i / 3] * f[3 + i % 3] + f[6 + i / 3] * f[6 + i % 3];
    }
    symmetric3_eigen(c, value, v);
    ck_assert_double_eq_tol(symmetric3_largest(c), value[0], 1e-8 * value[0]);
  }
  ck_assert_double_eq(symmetric3_largest((double[9]){-2, 0, 0, 0, -2, 0, 0, 0, -2}), -2);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("kernels");
  TCase *element = tcase_create("element"), *front = tcase_create("front");
  TCase *eigen = tcase_create("eigenvalues");
  tcase_add_loop_test(element, element_is_the_sum_over_its_points, 0, 2 * SETS * VERIFY_MATERIALS);
  tcase_add_loop_test(front, front_is_eliminated, 0, 5);
  tcase_add_test(eigen, largest_eigenvalue_is_that_of_jacobi);
  suite_add_tcase(suite, eigen);
  suite_add_tcase(suite, element);
  suite_add_tcase(suite, front);
  return suite_run(suite);
}
