/* Stresses, tangents and load stiffness against central differences. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/pressure.h"
#include "solver/fe/vec3.h"
#include "tests/physics/body.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

static const struct material_spec materials[] = {
    {.model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {0.4}, .bulk_ratio = 50, .name = "neo-Hooke"},
    {.model = MATERIAL_YEOH,
     .terms = 3,
     .c = {0.25, -0.05, 0.005},
     .bulk_ratio = 50,
     .name = "Yeoh"},
    {.model = MATERIAL_MOONEY_RIVLIN,
     .terms = 2,
     .c = {0.293, 0.177},
     .bulk_ratio = 50,
     .name = "Mooney-Rivlin"},
    {.model = MATERIAL_OGDEN,
     .terms = 3,
     .c = {0.63, 0.0012, -0.01},
     .alpha = {1.3, 5, -2},
     .bulk_ratio = 50,
     .name = "Ogden"},
};
enum { MATERIALS = sizeof materials / sizeof *materials };

static double norm(int n, const double *a) {
  double sum = 0;
  for (int i = 0; i < n; i++) {
    sum += a[i] * a[i];
  }
  return sqrt(sum);
}

/* |(b - a) / 2h - exact| / |exact| */
static double difference_error(int n, const double *a, const double *b, double h,
                               const double *exact) {
  double sum = 0;
  for (int i = 0; i < n; i++) {
    double d = (b[i] - a[i]) / (2 * h) - exact[i];
    sum += d * d;
  }
  return sqrt(sum) / norm(n, exact);
}

/* ---- material ---- */

struct material_case {
  const struct material_spec *material;
  double f[9], direction[9], stress[9], tangent[81];
};

static double material_at(const struct material_case *c, double h, double stress[9]) {
  struct kinematics k;
  for (int i = 0; i < 9; i++) {
    k.f[i] = c->f[i] + h * c->direction[i];
  }
  kinematics_complete(&k);
  return hyperelastic_isochoric(c->material, &k, stress, NULL);
}

static double stress_error(void *context, double h) {
  struct material_case *c = context;
  double unused[9], exact = 0;
  double a = material_at(c, -h, unused), b = material_at(c, h, unused);
  for (int i = 0; i < 9; i++) {
    exact += c->stress[i] * c->direction[i];
  }
  return difference_error(1, &a, &b, h, &exact);
}

static double tangent_error(void *context, double h) {
  struct material_case *c = context;
  double a[9], b[9], exact[9] = {0};
  material_at(c, -h, a);
  material_at(c, h, b);
  for (int i = 0; i < 81; i++) {
    exact[i / 9] += c->tangent[i] * c->direction[i % 9];
  }
  return difference_error(9, a, b, h, exact);
}

static void prepare_material(struct material_case *c, int index, const double f[9]) {
  unsigned seed = 11;
  c->material = &materials[index];
  memcpy(c->f, f, sizeof c->f);
  for (int i = 0; i < 9; i++) {
    c->direction[i] = body_random(&seed);
  }
  struct kinematics k;
  memcpy(k.f, f, sizeof k.f);
  kinematics_complete(&k);
  hyperelastic_isochoric(c->material, &k, c->stress, c->tangent);
}

START_TEST(stress_and_tangent_of_the_material) {
  static const double f[9] = {1.5, 0.4, -0.2, 0.3, 0.8, 0.25, -0.1, 0.35, 1.1};
  struct material_case c;
  char stress_name[100], tangent_name[100];
  prepare_material(&c, _i, f);
  snprintf(stress_name, sizeof stress_name, "stress from energy, %s", c.material->name);
  snprintf(tangent_name, sizeof tangent_name, "tangent from stress, %s", c.material->name);
  report_second_order(stress_name, stress_error, &c, 0.05, 4, 1e-8);
  report_second_order(tangent_name, tangent_error, &c, 0.05, 4, 1e-9);
  for (int i = 0; i < 81; i++) {
    ck_assert_double_eq_tol(c.tangent[i], c.tangent[i % 9 * 9 + i / 9], 1e-13);
  }
}
END_TEST

/* Equal principal stretches are a special case of laws in principal axes. */
START_TEST(tangent_at_equal_stretches) {
  static const double f[][9] = {
      {1, 0, 0, 0, 1, 0, 0, 0, 1}, {1.3, 0, 0, 0, 1.3, 0, 0, 0, 0.6}, {0, -2, 0, 2, 0, 0, 0, 0, 2}};
  for (int k = 0; k < 3; k++) {
    struct material_case c;
    prepare_material(&c, _i, f[k]);
    ck_assert_double_lt(tangent_error(&c, 1e-5), 1e-8);
  }
}
END_TEST

/* ---- element ---- */

struct element_case {
  struct element_geometry geometry;
  struct element_work work;
  struct element_internal internal;
  const struct material_spec *material;
  double bulk_modulus;
  double u[3][HEX27_STRIDE], p[ELEMENT_PRESSURES];
  double v[3][HEX27_STRIDE], q[ELEMENT_PRESSURES];
  double packed[ELEMENT_PACKED];
  double exact[ELEMENT_DOFS + ELEMENT_PRESSURES];
};

/* Both residuals of the mixed element, before the pressures are condensed. */
static void mixed_residual(struct element_case *c, double h,
                           double r[ELEMENT_DOFS + ELEMENT_PRESSURES]) {
  double u[3][HEX27_STRIDE] = {{0}}, p[ELEMENT_PRESSURES], packed[ELEMENT_PACKED];
  struct element_internal at;
  for (int i = 0; i < 3 * HEX27_STRIDE; i++) {
    u[i / HEX27_STRIDE][i % HEX27_STRIDE] =
        c->u[i / HEX27_STRIDE][i % HEX27_STRIDE] + h * c->v[i / HEX27_STRIDE][i % HEX27_STRIDE];
  }
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    p[m] = c->p[m] + h * c->q[m];
  }
  ck_assert(
      element_evaluate(&c->geometry, c->material, c->bulk_modulus, u, p, &c->work, r, packed, &at));
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

static double element_error(void *context, double h) {
  double a[ELEMENT_DOFS + ELEMENT_PRESSURES], b[ELEMENT_DOFS + ELEMENT_PRESSURES];
  mixed_residual(context, -h, a);
  mixed_residual(context, h, b);
  return difference_error(ELEMENT_DOFS + ELEMENT_PRESSURES, a, b, h,
                          ((struct element_case *)context)->exact);
}

/* A hexahedron with every node moved. */
static void crooked_nodes(double x[HEX27_NODES][3], double amplitude, unsigned seed) {
  for (int a = 0; a < HEX27_NODES; a++) {
    int at[3] = {a / 9, a / 3 % 3, a % 3};
    for (int i = 0; i < 3; i++) {
      x[a][i] = 0.5 * at[i] + amplitude * body_random(&seed);
    }
  }
}

START_TEST(tangent_of_the_element) {
  static struct element_case c;
  struct hex27_tables tables;
  double x[HEX27_NODES][3], residual[ELEMENT_DOFS];
  unsigned seed = 21;
  hex27_tables_fill(&tables);
  crooked_nodes(x, 0.05, 3);
  memset(&c, 0, sizeof c);
  c.material = &materials[_i];
  c.bulk_modulus = c.material->bulk_ratio * material_shear_modulus(c.material);
  ck_assert_double_gt(element_geometry_fill(&tables, x, &c.geometry), 0);
  for (int d = 0; d < ELEMENT_DOFS; d++) {
    int i = d / HEX27_NODES, a = d % HEX27_NODES;
    c.u[i][a] = 0.3 * x[a][(i + 1) % 3] + 0.2 * x[a][0] * x[a][i] + 0.01 * body_random(&seed);
    c.v[i][a] = body_random(&seed);
  }
  for (int m = 0; m < ELEMENT_PRESSURES; m++) {
    c.p[m] = 0.3 * body_random(&seed);
    c.q[m] = body_random(&seed);
  }
  ck_assert(element_evaluate(&c.geometry, c.material, c.bulk_modulus, c.u, c.p, &c.work, residual,
                             c.packed, &c.internal));
  mixed_derivative(&c);
  char what[100];
  snprintf(what, sizeof what, "element tangent, %s", c.material->name);
  report_second_order(what, element_error, &c, 0.01, 4, 1e-8);
}
END_TEST

/* ---- follower pressure on a closed surface: the six faces of one hexahedron ---- */

struct pressure_case {
  struct quad9_tables tables;
  double x[HEX27_NODES][3], v[HEX27_NODES][3];
  double force[3 * HEX27_NODES], derivative[3 * HEX27_NODES];
};

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

static double load_stiffness_error(void *context, double h) {
  struct pressure_case *c = context;
  double a[3 * HEX27_NODES], b[3 * HEX27_NODES];
  closed_surface(c, -h, a, NULL);
  closed_surface(c, h, b, NULL);
  return difference_error(3 * HEX27_NODES, a, b, h, c->derivative);
}

static double volume_gradient_error(void *context, double h) {
  struct pressure_case *c = context;
  double unused[3 * HEX27_NODES], exact = 0;
  double a = closed_surface(c, -h, unused, NULL), b = closed_surface(c, h, unused, NULL);
  for (int d = 0; d < 3 * HEX27_NODES; d++) {
    exact += c->force[d] * c->v[d / 3][d % 3];
  }
  return difference_error(1, &a, &b, h, &exact);
}

/* The force is quadratic in the nodes, so that a central difference of it is exact, and the
 * volume is cubic. */
START_TEST(load_stiffness_of_a_closed_surface) {
  struct pressure_case c = {.force = {0}};
  unsigned seed = 31;
  quad9_tables_fill(&c.tables);
  crooked_nodes(c.x, 0.1, 7);
  for (int d = 0; d < 3 * HEX27_NODES; d++) {
    c.v[d / 3][d % 3] = body_random(&seed);
  }
  closed_surface(&c, 0, c.force, c.derivative);
  ck_assert_double_lt(load_stiffness_error(&c, 0.1), 1e-13);
  ck_assert_double_lt(load_stiffness_error(&c, 1e-3), 1e-11);
  report_second_order("volume gradient", volume_gradient_error, &c, 0.1, 4, 1e-10);
  double sum[3] = {0}, moment[3] = {0}, turn[3];
  for (int a = 0; a < HEX27_NODES; a++) {
    vec3_cross(c.x[a], c.force + 3 * a, turn);
    for (int i = 0; i < 3; i++) {
      sum[i] += c.force[3 * a + i];
      moment[i] += turn[i];
    }
  }
  ck_assert_double_lt(vec3_norm(sum), 1e-14);
  ck_assert_double_lt(vec3_norm(moment), 1e-14);
}
END_TEST

START_TEST(volume_of_a_box) {
  struct pressure_case c = {.force = {0}};
  double force[3 * HEX27_NODES];
  quad9_tables_fill(&c.tables);
  crooked_nodes(c.x, 0, 1);
  for (int a = 0; a < HEX27_NODES; a++) {
    c.x[a][0] = 5 + 2 * c.x[a][0] + 0.3 * c.x[a][1];
    c.x[a][1] = -3 + 0.5 * c.x[a][1];
  }
  ck_assert_double_eq_tol(closed_surface(&c, 0, force, NULL), 1, 1e-14);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("tangents");
  TCase *tangent = tcase_create("tangents");
  tcase_set_timeout(tangent, 60);
  tcase_add_loop_test(tangent, stress_and_tangent_of_the_material, 0, MATERIALS);
  tcase_add_loop_test(tangent, tangent_at_equal_stretches, 0, MATERIALS);
  tcase_add_loop_test(tangent, tangent_of_the_element, 0, MATERIALS);
  tcase_add_test(tangent, load_stiffness_of_a_closed_surface);
  tcase_add_test(tangent, volume_of_a_box);
  suite_add_tcase(suite, tangent);
  return suite_run(suite);
}
