/* Shape functions, quadrature and face numbering of the 27-node hexahedron. */
#include <math.h>
#include <string.h>

#include "solver/fe/hex27.h"
#include "tests/unit/suite.h"

static const double points[][3] = {
    {0, 0, 0}, {0.3, -0.7, 0.9}, {-1, 1, -0.2}, {1, 1, 1}, {-0.774, 0.11, -0.5}};
enum { POINTS = sizeof points / sizeof *points };

static void node_point(int a, double xi[3]) {
  xi[0] = a / 9 - 1;
  xi[1] = a / 3 % 3 - 1;
  xi[2] = a % 3 - 1;
}

START_TEST(functions_are_one_at_their_node) {
  double xi[3], n[HEX27_NODES], n9[QUAD9_NODES], dn9[2][QUAD9_NODES];
  for (int a = 0; a < HEX27_NODES; a++) {
    node_point(a, xi);
    hex27_shape(xi, n, NULL);
    for (int b = 0; b < HEX27_NODES; b++) {
      ck_assert_double_eq_tol(n[b], a == b, 1e-15);
    }
  }
  for (int a = 0; a < QUAD9_NODES; a++) {
    quad9_shape(a / 3 - 1, a % 3 - 1, n9, dn9, NULL);
    for (int b = 0; b < QUAD9_NODES; b++) {
      ck_assert_double_eq_tol(n9[b], a == b, 1e-15);
    }
  }
}
END_TEST

/* A polynomial of degree two in every coordinate. */
static double polynomial(const double x[3]) {
  return 1 + x[0] - 2 * x[1] * x[2] + x[0] * x[0] * x[1] + 3 * x[2] * x[2] +
         x[0] * x[0] * x[1] * x[1] * x[2] * x[2];
}

START_TEST(quadratic_polynomials_are_interpolated_exactly) {
  const double *x = points[_i];
  double n[HEX27_NODES], dn[3][HEX27_NODES], value = 0, slope[3] = {0};
  hex27_shape(x, n, dn);
  for (int a = 0; a < HEX27_NODES; a++) {
    double at[3];
    node_point(a, at);
    value += n[a] * polynomial(at);
    for (int d = 0; d < 3; d++) {
      slope[d] += dn[d][a] * polynomial(at);
    }
  }
  ck_assert_double_eq_tol(value, polynomial(x), 1e-14);
  double q = x[0] * x[1] * x[2];
  ck_assert_double_eq_tol(slope[0], 1 + 2 * x[0] * x[1] + 2 * q * x[1] * x[2], 1e-13);
  ck_assert_double_eq_tol(slope[1], -2 * x[2] + x[0] * x[0] + 2 * q * x[0] * x[2], 1e-13);
  ck_assert_double_eq_tol(slope[2], -2 * x[1] + 6 * x[2] + 2 * q * x[0] * x[1], 1e-13);
}
END_TEST

/* f = s^2 t + 2 s t^2 + s^2 t^2 on the face. */
START_TEST(second_derivatives_on_the_face) {
  double s = points[_i][0], t = points[_i][1];
  double n[QUAD9_NODES], dn[2][QUAD9_NODES], d2n[3][QUAD9_NODES], sum[6] = {0};
  quad9_shape(s, t, n, dn, d2n);
  for (int a = 0; a < QUAD9_NODES; a++) {
    double x = a / 3 - 1, y = a % 3 - 1, f = x * x * y + 2 * x * y * y + x * x * y * y;
    double part[6] = {n[a], dn[0][a], dn[1][a], d2n[0][a], d2n[1][a], d2n[2][a]};
    for (int k = 0; k < 6; k++) {
      sum[k] += part[k] * f;
    }
  }
  ck_assert_double_eq_tol(sum[0], s * s * t + 2 * s * t * t + s * s * t * t, 1e-14);
  ck_assert_double_eq_tol(sum[1], 2 * s * t + 2 * t * t + 2 * s * t * t, 1e-14);
  ck_assert_double_eq_tol(sum[2], s * s + 4 * s * t + 2 * s * s * t, 1e-14);
  ck_assert_double_eq_tol(sum[3], 2 * t + 2 * t * t, 1e-14);
  ck_assert_double_eq_tol(sum[4], 4 * s + 2 * s * s, 1e-14);
  ck_assert_double_eq_tol(sum[5], 2 * s + 4 * t + 4 * s * t, 1e-14);
}
END_TEST

/* Three Gauss points integrate x^i y^j z^k exactly up to degree five. */
START_TEST(quadrature_is_exact_to_degree_five) {
  struct hex27_tables tables;
  struct quad9_tables face;
  hex27_tables_fill(&tables);
  quad9_tables_fill(&face);
  for (int i = 0; i < 6; i++) {
    for (int j = 0; j < 6; j++) {
      double exact = (i % 2 ? 0 : 2.0 / (i + 1)) * (j % 2 ? 0 : 2.0 / (j + 1)), sum = 0, flat = 0;
      for (int q = 0; q < HEX27_POINTS; q++) {
        const double *x = tables.point[q];
        sum += tables.weight[q] * pow(x[0], i) * pow(x[1], j) * pow(x[2], 4);
      }
      for (int q = 0; q < QUAD9_POINTS; q++) {
        flat += face.weight[q] * pow(face.point[q][0], i) * pow(face.point[q][1], j);
      }
      ck_assert_double_eq_tol(sum, exact * 2 / 5, 1e-14);
      ck_assert_double_eq_tol(flat, exact, 1e-14);
    }
  }
}
END_TEST

START_TEST(tables_hold_the_functions_at_the_points) {
  struct hex27_tables tables;
  struct quad9_tables face;
  hex27_tables_fill(&tables);
  quad9_tables_fill(&face);
  for (int q = 0; q < HEX27_POINTS; q++) {
    double n[HEX27_NODES], dn[3][HEX27_NODES];
    hex27_shape(tables.point[q], n, dn);
    ck_assert_mem_eq(dn, tables.dn[q], sizeof dn);
  }
  for (int q = 0; q < QUAD9_POINTS; q++) {
    double n[QUAD9_NODES], dn[2][QUAD9_NODES];
    quad9_shape(face.point[q][0], face.point[q][1], n, dn, NULL);
    ck_assert_mem_eq(n, face.n[q], sizeof n);
    ck_assert_mem_eq(dn, face.dn[q], sizeof dn);
  }
}
END_TEST

/* On each face the first parent coordinate of the face, the second, and the outward normal have
 * to form a right-handed system times the side: the pressure relies on that. */
START_TEST(faces_are_numbered_consistently) {
  for (int axis = 0; axis < 3; axis++) {
    for (int side = -1; side <= 1; side += 2) {
      int nodes[QUAD9_NODES];
      mesh_face_local_nodes(axis, side, nodes);
      for (int m = 0; m < QUAD9_NODES; m++) {
        double xi[3];
        node_point(nodes[m], xi);
        ck_assert_double_eq(xi[axis], side);
        ck_assert_double_eq(xi[(axis + 1) % 3], m / 3 - 1);
        ck_assert_double_eq(xi[(axis + 2) % 3], m % 3 - 1);
      }
    }
  }
}
END_TEST

int main(void) {
  Suite *suite = suite_create("hex27");
  TCase *hex27 = tcase_create("hex27");
  tcase_add_test(hex27, functions_are_one_at_their_node);
  tcase_add_loop_test(hex27, quadratic_polynomials_are_interpolated_exactly, 0, POINTS);
  tcase_add_loop_test(hex27, second_derivatives_on_the_face, 0, POINTS);
  tcase_add_test(hex27, quadrature_is_exact_to_degree_five);
  tcase_add_test(hex27, tables_hold_the_functions_at_the_points);
  tcase_add_test(hex27, faces_are_numbered_consistently);
  suite_add_tcase(suite, hex27);
  return suite_run(suite);
}
