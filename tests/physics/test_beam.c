/* Slender cantilevers of nearly incompressible material: locking, and large rotations. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/equilibrium.h"
#include "solver/mesh/grid.h"
#include "tests/physics/body.h"
#include "tests/physics/newton.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

static const struct material_spec rubber = {
    .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 1000};

static double young(const struct material_spec *m) {
  double mu = m->c[0], kappa = mu * m->bulk_ratio;
  return 9 * kappa * mu / (3 * kappa + mu);
}

/* ---- small deflection ---- */

static const double slender_height = 0.05;

struct skew {
  int cells;
  double amount; /* of the planes between elements, of their distance; alternating */
};

/* Length 1, square section of edge 0.05 about the x axis. */
static void beam_map(const void *context, int block, const double s[3], double x[3]) {
  const struct skew *skew = context;
  (void)block;
  double wave = sin(M_PI * skew->cells * s[0] + 0.5 * M_PI) * (s[0] > 0 && s[0] < 1);
  x[1] = slender_height * (s[1] - 0.5);
  x[2] = slender_height * (s[2] - 0.5);
  x[0] = s[0] + skew->amount / skew->cells * wave * (2 * s[2] - 1);
}

/* Tip deflection over that of the Timoshenko beam with Cowper's shear coefficient. The base is
 * held so that the section may contract. */
static double deflection_ratio(struct skew skew) {
  struct body body = {.blocks = 1, .cells = {skew.cells, 1, 1}, .map = beam_map, .context = &skew};
  struct mesh mesh;
  struct fe_state state;
  body_build(&body, &mesh);
  body_hold(&mesh, 0, 0, HOLD_X);
  body_hold(&mesh, 1, 0, HOLD_Y);
  mesh.fixed[3 * body_node(&mesh, 0, 0, 0) + 2] = 1;
  struct fe_model *model = body_model(&mesh, &rubber);
  double area = slender_height * slender_height, inertia = area * area / 12, force = 1e-9;
  body_add_traction(model, 0, 1, (double[3]){0, 0, force / area});
  ck_assert_int_eq(state_create(model, &state), STATUS_OK);
  struct fe_load load = {0, 0, 1};
  ck_assert_int_eq(newton_solve(model, &load, &state, 1e-12, NULL), STATUS_OK);
  double nu = 0.5 * (3 * rubber.bulk_ratio - 2) / (3 * rubber.bulk_ratio + 1);
  double shear = 10 * (1 + nu) / (12 + 11 * nu);
  double beam = force / (3 * young(&rubber) * inertia) + force / (shear * rubber.c[0] * area);
  double ratio = state.u[3 * body_node(&mesh, 1, 0, 0) + 2] / beam;
  state_release(&state);
  model_destroy(model);
  mesh_release(&mesh);
  return ratio;
}

/* Elements two and five times as long as high; with curvatures that are constant per element, 4
 * of them can reach 1 - 1/64 at best. A locking element would stay far below. */
START_TEST(bending_does_not_lock) {
  static const struct {
    const char *mesh;
    struct skew skew;
    double tolerance;
  } cases[] = {{"10 elements", {10, 0}, 5e-3},
               {"4 elements", {4, 0}, 0.02},
               {"10 elements, skewed", {10, 0.25}, 0.04}};
  report_check("cantilever L/h = 20, bulk/shear 1000, tip over Timoshenko", cases[_i].mesh, 1,
               deflection_ratio(cases[_i].skew), cases[_i].tolerance);
}
END_TEST

/* ---- large deflection: the elastica under a dead tip load ---- */

/* Tip of the inextensible elastica of length 1 with EI = 1 under the load p across it:
 * theta'' = -p cos(theta), theta(0) = 0, theta'(1) = 0, by Runge-Kutta and shooting. */
static double shoot(double p, double curvature, double tip[2]) {
  const int steps = 2000;
  double h = 1.0 / steps, y[4] = {0, curvature, 0, 0}; /* theta, theta', x, z */
  for (int k = 0; k < steps; k++) {
    double d[4][4], z[4];
    for (int stage = 0; stage < 4; stage++) {
      static const double at[4] = {0, 0.5, 0.5, 1};
      for (int i = 0; i < 4; i++) {
        z[i] = y[i] + (stage > 0 ? at[stage] * h * d[stage - 1][i] : 0);
      }
      d[stage][0] = z[1];
      d[stage][1] = -p * cos(z[0]);
      d[stage][2] = cos(z[0]);
      d[stage][3] = sin(z[0]);
    }
    for (int i = 0; i < 4; i++) {
      y[i] += h / 6 * (d[0][i] + 2 * d[1][i] + 2 * d[2][i] + d[3][i]);
    }
  }
  tip[0] = y[2];
  tip[1] = y[3];
  return y[1];
}

static void elastica(double p, double tip[2]) {
  double low = 0, high = p; /* the straight beam's curvature is the largest */
  for (int k = 0; k < 60; k++) {
    double middle = 0.5 * (low + high);
    if (shoot(p, middle, tip) > 0) {
      high = middle;
    } else {
      low = middle;
    }
  }
}

static enum cell_kind all_solid(const void *context, const int tag[3]) {
  (void)context;
  (void)tag;
  return CELL_SOLID;
}

static void identity(const void *context, const double grid_point[3], double x[3]) {
  (void)context;
  memcpy(x, grid_point, 3 * sizeof *x);
}

/* Length 1, square section, with axial sections so that the retraction works. */
static void build_strip(double height, int cells, struct mesh *mesh) {
  struct grid grid = {0};
  const double start[3] = {0, -0.5 * height, -0.5 * height},
               end[3] = {1, 0.5 * height, 0.5 * height};
  for (int d = 0; d < 3; d++) {
    ck_assert_int_eq(grid_axis_extend(&grid.axis[d], start[d], 0, 0), STATUS_OK);
    ck_assert_int_eq(grid_axis_extend(&grid.axis[d], end[d], d == 0 ? cells : 1, 0), STATUS_OK);
  }
  ck_assert_int_eq(grid_mesh(&grid, false, all_solid, identity, NULL, mesh, NULL), STATUS_OK);
  grid_release(&grid);
  mesh->wall_thickness = height;
  memset(mesh->node_core, 1, (size_t)mesh->node_count);
  memset(mesh->fixed, 0, 3 * (size_t)mesh->node_count);
  body_hold(mesh, 0, 0, HOLD_X);
  body_hold(mesh, 1, 0, HOLD_Y);
  mesh->fixed[3 * body_node(mesh, 0, 0, 0) + 2] = 1;
}

/* The whole load in one step: the tip turns by up to 82 degrees. */
START_TEST(elastica_in_one_step) {
  static const double loads[] = {1, 4, 10};
  const double p = loads[_i], height = 0.01, area = height * height;
  struct mesh mesh;
  struct fe_model *model;
  struct equilibrium *solver;
  struct fe_state state;
  struct error error = {0};
  build_strip(height, 20, &mesh);
  ck_assert_int_eq(model_create(&mesh, &rubber, false, &model, NULL), STATUS_OK);
  ck_assert_int_eq(equilibrium_create(model, &solver, &error), STATUS_OK);
  ck_assert_int_eq(state_create(model, &state), STATUS_OK);
  double force = p * young(&rubber) * area * area / 12;
  body_add_traction(model, 0, 1, (double[3]){0, 0, force / area});
  solver->options.step_tolerance = 1e-9;
  struct fe_load load = {0, 0, 1};
  int iterations;
  enum status status = equilibrium_solve(solver, &load, 0, &state, &iterations);
  ck_assert_msg(status == STATUS_OK, "load %g: %s", p, status_word(status));
  double tip[2];
  elastica(p, tip);
  int node = body_node(&mesh, 1, 0, 0);
  char what[80], how[60];
  snprintf(how, sizeof how, "20 elements, L/h = 100, one step, %d factorisations", iterations);
  snprintf(what, sizeof what, "elastica, P L2/EI = %g, tip height", p);
  report_check(what, how, tip[1], state.u[3 * node + 2], 3e-3);
  snprintf(what, sizeof what, "elastica, P L2/EI = %g, tip distance", p);
  report_check(what, how, tip[0], 1 + state.u[3 * node], 3e-3);
  state_release(&state);
  equilibrium_destroy(solver);
  model_destroy(model);
  mesh_release(&mesh);
}
END_TEST

/* Bisshopp and Drucker (1945), as printed in textbooks: tip at 0.30172 and 1 - 0.05643 for the
 * load 1, 0.81061 and 1 - 0.55500 for the load 10. */
START_TEST(elastica_is_the_known_one) {
  double tip[2];
  elastica(1, tip);
  ck_assert_double_eq_tol(tip[1], 0.30172, 1e-5);
  ck_assert_double_eq_tol(1 - tip[0], 0.05643, 1e-5);
  elastica(10, tip);
  ck_assert_double_eq_tol(tip[1], 0.81061, 1e-5);
  ck_assert_double_eq_tol(1 - tip[0], 0.55500, 1e-5);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("beams");
  TCase *beam = tcase_create("beams");
  tcase_set_timeout(beam, 60);
  tcase_add_loop_test(beam, bending_does_not_lock, 0, 3);
  tcase_add_test(beam, elastica_is_the_known_one);
  tcase_add_loop_test(beam, elastica_in_one_step, 0, 3);
  suite_add_tcase(suite, beam);
  return suite_run(suite);
}
