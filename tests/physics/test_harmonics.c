/* Second variation in circumferential harmonics: against differences of the energy in three
 * dimensions, rigid motions, and buckling of rings and cylinders. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/axi/element.h"
#include "solver/axi/harmonic.h"
#include "solver/axi/model.h"
#include "solver/fe/hyperelastic.h"
#include "tests/physics/axi_block.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

static struct error failure;

static void must(enum status status) {
  ck_assert_msg(status == STATUS_OK, "%s", failure.message);
}

/* ---- the energy in three dimensions ---- */

enum { AROUND = 48 };

struct trial {
  struct axi_mesh mesh;
  struct harmonic *harmonic;
  struct harmonic_state state;
  double *u, *v; /* node_count x 2 and x 3 */
  int n;
  double form; /* v K v */
};

/* Displacements of a node at an angle: (u_r, u_t, u_z) and their derivatives by the angle. */
static void displaced(const struct trial *t, double step, int node, double angle, double d[3],
                      double turn[3]) {
  const double *v = t->v + 3 * node, *u = t->u + 2 * node;
  double c = step * cos(t->n * angle), s = step * sin(t->n * angle);
  d[0] = u[0] + v[0] * c;
  d[1] = v[2] * s;
  d[2] = u[1] + v[1] * c;
  turn[0] = -t->n * v[0] * s;
  turn[1] = t->n * v[2] * c;
  turn[2] = -t->n * v[1] * s;
}

/* Elastic energy of an element at one angle, as if the whole ring were like that. */
static double slice_energy(const struct trial *t, int element, double step, double angle) {
  const struct axi_element *e = &t->mesh.element[element];
  const struct material_spec *material = &t->mesh.region[0];
  const struct axi_bulk bulk = axi_bulk_parts(material);
  struct axi_geometry g;
  double x[AXI_NODES][2], energy = 0, moment[3] = {0};
  for (int a = 0; a < AXI_NODES; a++) {
    memcpy(x[a], t->mesh.position + 2 * e->node[a], sizeof x[a]);
  }
  ck_assert(axi_geometry_init(x, &g));
  for (int q = 0; q < AXI_POINTS; q++) {
    const struct axi_point *p = &g.point[q];
    struct kinematics k = {.f = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    double stress[9];
    for (int a = 0; a < AXI_NODES; a++) {
      double d[3], turn[3], hoop = p->n[a] / p->radius;
      displaced(t, step, e->node[a], angle, d, turn);
      for (int i = 0; i < 3; i++) {
        k.f[3 * i] += d[i] * p->dr[a];
        k.f[3 * i + 2] += d[i] * p->dz[a];
        k.f[3 * i + 1] += turn[i] * hoop;
      }
      k.f[1] -= d[1] * hoop;
      k.f[4] += d[0] * hoop;
    }
    ck_assert_double_gt(kinematics_complete(&k), 0);
    energy += p->weight * hyperelastic_isochoric(material, &k, stress, NULL);
    energy += 0.5 * p->weight * bulk.local * (k.j - 1) * (k.j - 1);
    for (int i = 0; i < 3; i++) {
      moment[i] += p->weight * p->psi[i] * (k.j - 1);
    }
  }
  for (int i = 0; i < 9; i++) {
    energy += 0.5 * bulk.projected * moment[i / 3] * g.inverse[i] * moment[i % 3];
  }
  return energy;
}

/* Volume on the right of an edge at one angle, as if all around were like that: the flux of a third
 * of the position through the surface, of which the closed contour makes a volume. */
static double slice_volume(const struct trial *t, int edge, double step, double angle) {
  static const double at[4] = {-0.861136311594052575, -0.339981043584856265, 0.339981043584856265,
                               0.861136311594052575};
  static const double weight[4] = {0.347854845137453857, 0.652145154862546143, 0.652145154862546143,
                                   0.347854845137453857};
  double volume = 0;
  for (int q = 0; q < 4; q++) {
    double s = at[q], value[3] = {0.5 * s * (s - 1), 0.5 * s * (s + 1), 1 - s * s};
    double slope[3] = {s - 0.5, s + 0.5, -2 * s}, x[3] = {0}, ds[3] = {0}, dt[3] = {0};
    for (int a = 0; a < AXI_EDGE_NODES; a++) {
      int node = t->mesh.inner[edge].node[a];
      double d[3], turn[3];
      displaced(t, step, node, angle, d, turn);
      d[0] += t->mesh.position[2 * node];
      d[2] += t->mesh.position[2 * node + 1];
      for (int i = 0; i < 3; i++) {
        x[i] += value[a] * d[i];
        ds[i] += slope[a] * d[i];
        dt[i] += value[a] * turn[i];
      }
      dt[0] -= value[a] * d[1];
      dt[1] += value[a] * d[0];
    }
    volume += 2 * M_PI * weight[q] / 3 *
              (x[0] * (ds[1] * dt[2] - ds[2] * dt[1]) + x[1] * (ds[2] * dt[0] - ds[0] * dt[2]) +
               x[2] * (ds[0] * dt[1] - ds[1] * dt[0]));
  }
  return volume;
}

static double potential(const struct trial *t, double step) {
  double sum = 0;
  for (int k = 0; k < AROUND; k++) {
    double angle = 2 * M_PI * k / AROUND;
    for (int e = 0; e < t->mesh.element_count; e++) {
      sum += slice_energy(t, e, step, angle);
    }
    for (int e = 0; e < t->mesh.inner_count; e++) {
      sum -= t->state.pressure * slice_volume(t, e, step, angle);
    }
  }
  return sum / AROUND;
}

static double difference_error(void *context, double step) {
  struct trial *t = context;
  double second = (potential(t, step) - 2 * potential(t, 0) + potential(t, -step)) / (step * step);
  return fabs(second / t->form - 1);
}

/* A hollow ring in a state without symmetry, disturbed likewise. */
static void trial_open(struct trial *t, double strain) {
  static const struct block block = {{0.5, 2}, {-0.4, 1.1}, 3, 3, true};
  memset(t, 0, sizeof *t);
  block_mesh(&block, &t->mesh);
  t->mesh.region[0] = block_elastic(1, 0.49);
  t->u = calloc(2 * (size_t)t->mesh.node_count, sizeof *t->u);
  t->v = calloc(3 * (size_t)t->mesh.node_count, sizeof *t->v);
  ck_assert(t->u && t->v);
  for (int i = 0; i < 2 * t->mesh.node_count; i++) {
    const double *x = t->mesh.position + i / 2 * 2;
    t->u[i] = strain * (i % 2 ? sin(2 * x[0]) * (1 + x[1]) : x[0] * cos(x[1] + 0.3 * x[0]));
  }
  for (int i = 0; i < 3 * t->mesh.node_count; i++) {
    const double *x = t->mesh.position + i / 3 * 2;
    t->v[i] = sin(1.7 * x[0] + (i % 3) - x[1]) + 0.3 * (i % 3) * x[1] * x[1];
  }
  t->state = (struct harmonic_state){.u = t->u, .pressure = 0.05};
  must(harmonic_create(&t->mesh, HARMONIC_GUIDED, &t->harmonic, &failure));
}

static void trial_close(struct trial *t) {
  harmonic_destroy(t->harmonic);
  axi_mesh_release(&t->mesh);
  free(t->u);
  free(t->v);
}

START_TEST(energy_in_three_dimensions) {
  static const int wave[] = {0, 1, 2, 5};
  static const double pressure[] = {0, 0.05, 10};
  struct trial t;
  trial_open(&t, 0.1);
  t.n = wave[_i % 4];
  t.state.pressure = pressure[_i / 4];
  for (int node = 0; node < t.mesh.node_count; node++) {
    t.v[3 * node + 2] *= t.n > 0;
  }
  must(harmonic_quadratic(t.harmonic, &t.state, t.n, t.v, &t.form, &failure));
  char what[80];
  snprintf(what, sizeof what, "second variation, n = %d, p/E = %g", t.n, t.state.pressure);
  report_second_order(what, difference_error, &t, 0.02, 3, 1e-4);
  trial_close(&t);
}
END_TEST

/* Whatever the state, shifts change nothing; turning does not where there is neither stress nor
 * pressure. */
START_TEST(rigid_motion) {
  static const double still[2] = {0};
  struct trial t;
  trial_open(&t, _i == 2 ? 0 : 0.1);
  double scale, value;
  t.n = _i > 0;
  t.state.pressure = _i == 2 ? 0 : 0.05;
  must(harmonic_quadratic(t.harmonic, &t.state, t.n, t.v, &scale, &failure));
  for (int node = 0; node < t.mesh.node_count; node++) {
    const double *x = t.mesh.position + 2 * node, *u = _i == 2 ? still : t.u + 2 * node;
    double r = x[0] + u[0], z = x[1] + u[1], turned[3] = {z, -r, -z};
    static const double shifted[2][3] = {{0, 1, 0}, {1, 0, -1}};
    memcpy(t.v + 3 * node, _i == 2 ? turned : shifted[_i], sizeof turned);
  }
  must(harmonic_quadratic(t.harmonic, &t.state, t.n, t.v, &value, &failure));
  report_value(_i == 0   ? "rigid shift, n = 0"
               : _i == 1 ? "rigid shift, n = 1"
                         : "rigid turn, n = 1",
               "against any motion", 0, value / scale);
  ck_assert_double_lt(fabs(value), 1e-13 * fabs(scale));
  trial_close(&t);
}
END_TEST

/* In equilibrium under pressure turning changes nothing either, and the form of n = 0 has the
 * inertia of the axisymmetric tangent. */
START_TEST(turned_in_equilibrium) {
  struct trial t;
  struct axi_model *model;
  struct axi_state state;
  double scale, value;
  int count;
  trial_open(&t, 0);
  t.mesh.hold[1] = AXI_FIXED;
  must(axi_model_create(&t.mesh, NULL, &model, &failure));
  must(axi_state_create(model, &state, &failure));
  struct continuation_options options = axi_defaults(model);
  struct axi_load load = {.pressure = 0.02};
  must(axi_equilibrium(model, &load, false, &options, &state, NULL, &failure));
  t.state = (struct harmonic_state){.u = state.u, .pressure = load.pressure};
  must(harmonic_quadratic(t.harmonic, &t.state, 1, t.v, &scale, &failure));
  for (int node = 0; node < t.mesh.node_count; node++) {
    double r = t.mesh.position[2 * node] + state.u[2 * node];
    double z = t.mesh.position[2 * node + 1] + state.u[2 * node + 1];
    memcpy(t.v + 3 * node, (double[]){z, -r, -z}, 3 * sizeof z);
  }
  must(harmonic_quadratic(t.harmonic, &t.state, 1, t.v, &value, &failure));
  report_value("rigid turn under pressure, n = 1", "against any motion", 0, value / scale);
  ck_assert_double_lt(fabs(value), 1e-10 * fabs(scale));
  must(harmonic_negative(t.harmonic, &t.state, 0, 0, &count, &failure));
  ck_assert_int_eq(count, state.negative_free);
  axi_state_destroy(&state);
  axi_model_destroy(model);
  trial_close(&t);
}
END_TEST

/* ---- buckling ---- */

/* Lowest pressure at which the form of n is no longer positive; base(mesh, pressure, u) fills the
 * state. Bisection on the inertia between 0 and `above`. */
static double critical(const struct axi_mesh *mesh, int n, double above,
                       void (*base)(const struct axi_mesh *mesh, double pressure, double *u)) {
  struct harmonic *harmonic;
  double *u = calloc(2 * (size_t)mesh->node_count, sizeof *u), below = 0;
  int count;
  must(harmonic_create(mesh, HARMONIC_GUIDED, &harmonic, &failure));
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
  report_check(what, "R/t 100", wanted, critical(&mesh, n, 3 * wanted, long_tube), 2e-4);
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
  report_check(what, "1 x 24", wanted, critical(&mesh, cases[_i].n, 2 * wanted, free_tube), 0.01);
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
  report_check(what, "1 x 40", wanted, critical(&mesh, n, 2 * wanted, compressed), 0.01);
  axi_mesh_release(&mesh);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("harmonics");
  TCase *variation = tcase_create("variation");
  tcase_add_loop_test(variation, energy_in_three_dimensions, 0, 12);
  tcase_add_loop_test(variation, rigid_motion, 0, 3);
  tcase_add_test(variation, turned_in_equilibrium);
  suite_add_tcase(suite, variation);
  TCase *buckling = tcase_create("buckling");
  tcase_add_loop_test(buckling, long_tube_under_pressure, 0, 6);
  tcase_add_test(buckling, mode_of_a_ring);
  tcase_add_loop_test(buckling, cylinder_under_pressure, 0, 4);
  tcase_add_loop_test(buckling, cylinder_under_axial_force, 0, 3);
  suite_add_tcase(suite, buckling);
  return suite_run(suite);
}
