/* Buckling of rings and cylinders by the second variation in circumferential harmonics. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "solver/axi/harmonic.h"
#include "tests/physics/axi_block.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

static struct error failure;

static void must(enum status status) {
  ck_assert_msg(status == STATUS_OK, "%s", failure.message);
}

/* Lowest pressure at which the form of n is no longer positive; base(mesh, pressure, u) fills the
 * state. Bisection on the inertia between 0 and `above`. */
static double critical(const struct axi_mesh *mesh, enum harmonic_plate plate, int n, double above,
                       void (*base)(const struct axi_mesh *mesh, double pressure, double *u)) {
  struct harmonic *harmonic;
  double *u = calloc(2 * (size_t)mesh->node_count, sizeof *u), below = 0;
  int count;
  must(harmonic_create(mesh, plate, &harmonic, &failure));
  struct harmonic_state state = {.u = u};
  for (int k = 0; k < 24; k++) {
    state.pressure = 0.5 * (below + above);
    base(mesh, state.pressure, u);
    must(harmonic_negative(harmonic, &state, n, n, &count, &failure));
    *(count > 0 ? &above : &below) = state.pressure;
  }
  harmonic_destroy(harmonic);
  free(u);
  return above;
}

/* Lame's tube under external pressure, small strains: u_r = A r + B/r, and the axial strain c of
 * a tube that is free to lengthen. */
static void lame(const struct axi_mesh *mesh, double pressure, bool lengthens, double *u) {
  double mu = mesh->region[0].c[0], kappa = mu * mesh->region[0].bulk_ratio;
  double lambda = kappa - 2 * mu / 3, inner = mesh->position[0];
  double outer = mesh->position[2 * mesh->node_count - 2], share = inner * inner / outer / outer;
  /* s_r = 2 (lambda + mu) A + lambda c - 2 mu B / r^2, s_z = (lambda + 2 mu) c + 2 lambda A */
  double ratio = lengthens ? -2 * lambda / (lambda + 2 * mu) : 0; /* c/A */
  double sum = 2 * (lambda + mu) + lambda * ratio;
  double a = -pressure / (sum * (1 - share)), b = sum * a * inner * inner / (2 * mu);
  for (int n = 0; n < mesh->node_count; n++) {
    double r = mesh->position[2 * n];
    u[2 * n] = a * r + b / r;
    u[2 * n + 1] = ratio * a * mesh->position[2 * n + 1];
  }
}

static void long_tube(const struct axi_mesh *mesh, double pressure, double *u) {
  lame(mesh, pressure, false, u);
}

static void free_tube(const struct axi_mesh *mesh, double pressure, double *u) {
  lame(mesh, pressure, true, u);
}

/* Ring of a long tube, R = 1, external pressure that follows (Bresse 1866; Levy 1884). Its axial
 * motion is held, or tied to a copy ahead in an endless row. */
START_TEST(long_tube_under_pressure) {
  static const int wave[] = {2, 3, 5};
  double thickness = 0.01, modulus = 1, poisson = 0.3;
  struct block block = {{1 - thickness / 2, 1 + thickness / 2}, {0, 0.05}, 2, 1, false};
  struct axi_mesh mesh;
  bool tied = _i / 3;
  int n = wave[_i % 3];
  block_mesh(&block, &mesh);
  mesh.region[0] = block_elastic(modulus, poisson);
  for (int node = 0; node < mesh.node_count; node++) {
    if (!tied) {
      mesh.hold[2 * node + 1] = AXI_FIXED;
    } else if (node >= mesh.node_count - 5) {
      mesh.hold[2 * node] = AXI_TIED;
      mesh.hold[2 * node + 1] = AXI_AHEAD;
      mesh.master[node] = node - mesh.node_count + 5;
    }
  }
  double wanted = (n * n - 1) * modulus / (1 - poisson * poisson) * pow(thickness, 3) / 12;
  char what[60];
  snprintf(what, sizeof what, "long tube%s, external pressure, n = %d", tied ? ", endless" : "", n);
  report_check(what, "R/t 100", wanted, critical(&mesh, HARMONIC_GUIDED, n, 3 * wanted, long_tube),
               2e-4);
  axi_mesh_release(&mesh);
}
END_TEST

/* The mode of the ring does not stretch its middle line: u_r + n u_t = 0. Its stiffness is what the
 * form gives, 0 at the critical pressure, below 0 above. A spring on the gap of touching points
 * adds half its stiffness times the gap's square. */
START_TEST(mode_of_a_ring) {
  struct block block = {{0.99, 1.01}, {0, 0.05}, 2, 1, false};
  struct axi_mesh mesh;
  struct harmonic *harmonic;
  struct harmonic_touch spring = {1, {2}, {{1, 0}}, 1};
  double u[30], mode[45], stiffness[3], value;
  double buckling = 3 * pow(0.02, 3) / 12 / (1 - 0.09);
  block_mesh(&block, &mesh);
  mesh.region[0] = block_elastic(1, 0.3);
  for (int node = 0; node < mesh.node_count; node++) {
    mesh.hold[2 * node + 1] = AXI_FIXED;
  }
  must(harmonic_create(&mesh, HARMONIC_GUIDED, &harmonic, &failure));
  struct harmonic_state state = {.u = u};
  for (int k = 0; k < 3; k++) { /* below the critical pressure, above it, and propped */
    int count[2];
    state.pressure = (k == 0 ? 0.5 : 1.5) * buckling;
    state.touch = &spring;
    state.touch_count = k == 2;
    lame(&mesh, state.pressure, false, u);
    must(harmonic_negative(harmonic, &state, 2, 3, count, &failure));
    ck_assert_int_eq(count[0], k == 1);
    ck_assert_int_eq(count[1], 0);
    must(harmonic_mode(harmonic, &state, 2, mode, &stiffness[k], &failure));
    must(harmonic_quadratic(harmonic, &state, 2, mode, &value, &failure));
    ck_assert_double_eq_tol(value, stiffness[k], 1e-5 * fabs(value));
    if (k < 2) {
      ck_assert_double_eq_tol(mode[3 * 7 + 2], -0.5 * mode[3 * 7], 1e-3);
    }
  }
  report_check("stiffness of the ring at 3/2 and 1/2 of buckling", "R/t 50", -1,
               stiffness[1] / stiffness[0], 0.01);
  ck_assert_double_gt(stiffness[2], 0);
  harmonic_destroy(harmonic);
  axi_mesh_release(&mesh);
}
END_TEST

/* Determinant of Fluegge's equations of buckling (1932; 1973, section 8.2) of a simply supported
 * cylinder, R = 1, under lateral pressure, q = p (1 - nu^2) / (E t), l = pi/L, for
 * u = A cos l x cos n t, v = B sin l x sin n t, w = C sin l x cos n t. */
static double fluegge_determinant(double t, double l, double nu, double n, double q) {
  double k = t * t / 12, l2 = l * l, n2 = n * n;
  double a11 = l2 + (1 - nu) / 2 * (1 + k) * n2 - q * n2;
  double a12 = -(1 + nu) / 2 * l * n;
  double a13 = -(nu + q) * l - k * (l * l2 - (1 - nu) / 2 * l * n2);
  double a22 = n2 + (1 - nu) / 2 * (1 + 3 * k) * l2 - q * n2;
  double a23 = (1 - q) * n + (3 - nu) / 2 * k * l2 * n;
  double a33 = 1 + k * ((l2 + n2) * (l2 + n2) - 2 * n2 + 1) - q * n2;
  return a11 * (a22 * a33 - a23 * a23) - a12 * (a12 * a33 - a23 * a13) +
         a13 * (a12 * a23 - a22 * a13);
}

/* Least critical pressure over the modulus, by bisection up to `above`. */
static double fluegge(double t, double length, double nu, int n, double above) {
  double low = 0, high = above * (1 - nu * nu) / t;
  for (int k = 0; k < 60; k++) {
    double q = 0.5 * (low + high);
    *(fluegge_determinant(t, M_PI / length, nu, n, q) > 0 ? &low : &high) = q;
  }
  return low * t / (1 - nu * nu);
}

/* Supports of the middle line of both ends: u_r = u_t = 0. */
static void support_ends(struct axi_mesh *mesh, int columns) {
  mesh->hold[2 * columns] = AXI_FIXED;
  mesh->hold[2 * (mesh->node_count - 1 - columns)] = AXI_FIXED;
}

START_TEST(cylinder_under_pressure) {
  static const struct {
    double t, length;
    int n;
  } cases[] = {{0.01, 1, 6}, {0.01, 1, 8}, {0.01, 2, 5}, {0.02, 4, 3}};
  double t = cases[_i].t, length = cases[_i].length, poisson = 0.3;
  struct block block = {{1 - t / 2, 1 + t / 2}, {0, length}, 1, 24, false};
  struct axi_mesh mesh;
  block_mesh(&block, &mesh);
  mesh.region[0] = block_elastic(1, poisson);
  support_ends(&mesh, 1);
  double wanted = fluegge(t, length, poisson, cases[_i].n, 1e-4);
  char what[80];
  snprintf(what, sizeof what, "supported cylinder, R/t %.0f, L/R %g, n = %d", 1 / t, length,
           cases[_i].n);
  report_check(what, "1 x 24", wanted,
               critical(&mesh, HARMONIC_GUIDED, cases[_i].n, 2 * wanted, free_tube), 0.01);
  axi_mesh_release(&mesh);
}
END_TEST

/* A cylinder compressed along its axis: sigma = E (l^2/s^2 + t^2 s^2 / (12 (1 - nu^2) l^2)) with
 * l = m pi / L, s = l^2 + n^2, least over m (Lorenz 1908, Timoshenko 1910; R = 1). `pressure`
 * stands for the stress over the modulus. */
static void compressed(const struct axi_mesh *mesh, double stress, double *u) {
  for (int n = 0; n < mesh->node_count; n++) {
    u[2 * n] = 0.3 * stress * mesh->position[2 * n];
    u[2 * n + 1] = -stress * mesh->position[2 * n + 1];
  }
}

START_TEST(cylinder_under_axial_force) {
  static const int wave[] = {0, 4, 7};
  double t = 0.005, length = 0.8, poisson = 0.3, wanted = 1;
  struct block block = {{1 - t / 2, 1 + t / 2}, {0, length}, 1, 40, false};
  struct axi_mesh mesh;
  int n = wave[_i];
  block_mesh(&block, &mesh);
  mesh.inner_count = 0;
  mesh.region[0] = block_elastic(1, poisson);
  support_ends(&mesh, 1);
  mesh.hold[2 * 1 + 1] = n == 0 ? AXI_FIXED : AXI_FREE;
  for (int m = 1; m < 40; m++) {
    double l = m * M_PI / length, s = l * l + n * n;
    wanted = fmin(wanted, l * l / (s * s) + t * t * s * s / (12 * (1 - poisson * poisson) * l * l));
  }
  char what[80];
  snprintf(what, sizeof what, "compressed cylinder, R/t 200, n = %d", n);
  report_check(what, "1 x 40", wanted, critical(&mesh, HARMONIC_GUIDED, n, 2 * wanted, compressed),
               0.01);
  axi_mesh_release(&mesh);
}
END_TEST

/* A slender tube between plates that cannot tilt, as a column: Euler (1744) with the shear of a
 * thin tube, whose area counts half (Engesser 1891), sigma = s / (1 + 2 s / G), s = c pi^2 E R^2 /
 * (2 L^2); c = 4 where the upper plate is guided, 1 where it may sway. */
START_TEST(column) {
  double t = 0.1, length = 100, poisson = 0.3, c = _i ? 1 : 4;
  struct block block = {{1 - t / 2, 1 + t / 2}, {0, length}, 1, 80, false};
  struct axi_mesh mesh;
  block_mesh(&block, &mesh);
  mesh.inner_count = 0;
  mesh.region[0] = block_elastic(1, poisson);
  for (int i = 0; i < 3; i++) {
    int low = 2 * i, high = 2 * (mesh.node_count - 1 - i);
    mesh.hold[low] = mesh.hold[low + 1] = mesh.hold[high] = AXI_FIXED;
    mesh.hold[high + 1] = AXI_PLATE;
  }
  double euler = c * pow(M_PI / length, 2) / 2 * (1 + t * t / 4);
  double wanted = euler / (1 + 4 * (1 + poisson) * euler);
  report_check(_i ? "column, plate sways" : "column, plate guided", "1 x 80", wanted,
               critical(&mesh, _i ? HARMONIC_SWAYING : HARMONIC_GUIDED, 1, 2 * wanted, compressed),
               0.015);
  axi_mesh_release(&mesh);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("buckling");
  TCase *buckling = tcase_create("buckling");
  tcase_add_loop_test(buckling, long_tube_under_pressure, 0, 6);
  tcase_add_test(buckling, mode_of_a_ring);
  tcase_add_loop_test(buckling, cylinder_under_pressure, 0, 4);
  tcase_add_loop_test(buckling, cylinder_under_axial_force, 0, 3);
  tcase_add_loop_test(buckling, column, 0, 2);
  tcase_set_timeout(buckling, 60);
  suite_add_tcase(suite, buckling);
  return suite_run(suite);
}
