/* Bodies that fly, spin, fall and jump. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/dynamics_carry.h"
#include "solver/base/vec3.h"
#include "tests/physics/moving.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

static const struct material_spec rubber = {
    .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1e6}, .density_kg_m3 = 1000, .bulk_ratio = 1000};

/* ---- free bodies ---- */

static void box_open(struct moving *b) {
  moving_block(b, (const double[3]){-0.05, -0.1, -0.15}, (const double[3]){0.05, 0.1, 0.15},
               (const int[3]){1, 1, 2});
  moving_open(b, &rubber);
}

/* Momentum and moment of momentum about the origin. */
static void momentum(const struct moving *b, double linear[3], double angular[3]) {
  int nodes = b->mesh.node_count;
  double *p = calloc(3 * (size_t)nodes, sizeof *p);
  ck_assert_ptr_nonnull(p);
  inertia_multiply(b->dynamics->inertia, b->motion.velocity, p);
  memset(linear, 0, 3 * sizeof *linear);
  memset(angular, 0, 3 * sizeof *angular);
  for (int n = 0; n < nodes; n++) {
    double x[3], turn[3];
    for (int i = 0; i < 3; i++) {
      x[i] = b->mesh.x[3 * n + i] + b->state.u[3 * n + i];
      linear[i] += p[3 * n + i];
    }
    vec3_cross(x, p + 3 * n, turn);
    for (int i = 0; i < 3; i++) {
      angular[i] += turn[i];
    }
  }
  free(p);
}

/* Velocities of a rigid motion. */
static void throw(struct moving * b, const double speed[3], const double spin[3]) {
  const struct fe_load none = {0, 0, 0};
  for (int n = 0; n < b->mesh.node_count; n++) {
    double turn[3];
    vec3_cross(spin, b->mesh.x + 3 * n, turn);
    for (int i = 0; i < 3; i++) {
      b->motion.velocity[3 * n + i] = speed[i] + turn[i];
    }
  }
  b->motion.step = 1e-3;
  ck_assert_int_eq(dynamics_balance(b->dynamics, &none, &b->state, &b->motion), STATUS_OK);
}

static double apart(const double a[3], const double b[3]) {
  double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return vec3_norm(d);
}

/* Tumbles for a second, a turn, in steps of 1/count. Lost share of the moment of momentum. */
static double tumble(int count) {
  struct moving b;
  double linear[2][3], angular[2][3];
  box_open(&b);
  throw(&b, (const double[3]){0.3, -0.2, 0.5}, (const double[3]){2, 5, 3});
  momentum(&b, linear[0], angular[0]);
  double before = moving_energy(&b);
  b.dynamics->options.fast = 0.8;
  moving_march(&b, 1.0 / count, count, NULL);
  momentum(&b, linear[1], angular[1]);
  double wandered = apart(linear[1], linear[0]) / vec3_norm(linear[0]);
  double turned = apart(angular[1], angular[0]) / vec3_norm(angular[0]);
  report_value("energy of a tumbling body", "steps of 1/100 s and less", before, moving_energy(&b));
  ck_assert_double_lt(wandered, 1e-10);
  ck_assert_double_lt(fabs(moving_energy(&b) / before - 1), 2e-3);
  moving_close(&b);
  return turned;
}

START_TEST(a_thrown_body_keeps_its_momentum) {
  double lost = tumble(100), less = tumble(200);
  report_value("moment of momentum lost in a turn", "100 steps", 0, lost);
  report_check("order of that", "100 and 200 steps", 2, report_order(lost, less, 2), 0.1);
  ck_assert_double_lt(lost, 2e-3);
}
END_TEST

/* A viscosity whose relaxation time is a second does not slow a spin of 1 rad/s: over a whole turn
 * it dissipates no more than the strains that the spin itself causes. */
START_TEST(viscosity_does_not_damp_a_rotation) {
  struct moving b;
  struct energy energy;
  const struct fe_load none = {0, 0, 0};
  box_open(&b);
  b.dynamics->options.viscosity = 1e6;
  b.dynamics->options.fast = 0.8;
  throw(&b, (const double[3]){0, 0, 0}, (const double[3]){0, 0, 1});
  energy_start(&energy, b.model, &b.state, &none, moving_energy(&b));
  moving_march(&b, 2 * M_PI / 60, 60, &energy);
  report_value("dissipated in a turn, share", "60 steps", 0, energy.damping / energy.start);
  report_value("spin after a turn", "60 steps", energy.start, energy.kinetic);
  ck_assert_double_lt(energy.damping, 1e-4 * energy.start);
  moving_close(&b);
}
END_TEST

START_TEST(a_falling_body_has_the_velocity_g_t) {
  struct moving b;
  struct energy energy;
  const double g[3] = {0, 0, -9.80665};
  const struct fe_load weight = {0, 0, 1};
  double linear[3], angular[3];
  box_open(&b);
  model_add_gravity(b.model, g);
  b.dynamics->options.fast = 0.5;
  b.motion.step = 0.01;
  ck_assert_int_eq(dynamics_balance(b.dynamics, &weight, &b.state, &b.motion), STATUS_OK);
  energy_start(&energy, b.model, &b.state, &weight, 0);
  for (int k = 0; k < 20; k++) {
    ck_assert_int_eq(dynamics_step(b.dynamics, &weight, 0, &b.state, &b.motion, &energy),
                     STATUS_OK);
  }
  momentum(&b, linear, angular);
  report_check("velocity of a falling body", "20 steps", 0.2 * g[2],
               linear[2] / b.dynamics->inertia->total, 1e-8);
  report_check("fallen", "20 steps", 0.5 * g[2] * 0.04, b.state.u[2], 1e-8);
  report_check("kinetic energy over the work of the weight", "20 steps", energy.weight_work,
               energy.kinetic, 1e-8);
  moving_close(&b);
}
END_TEST

/* ---- a clamped shallow arch that snaps through ---- */

static const double rise = 0.01, thickness = 0.003, half_span = 0.5;

static void arch_map(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  double t = s[0], slope = -2 * rise * t / half_span;
  double scale = thickness * (s[2] - 0.5) / sqrt(1 + slope * slope);
  x[0] = t * half_span - (t < 1 ? slope * scale : 0);
  x[1] = 0.01 * half_span * s[1];
  x[2] = rise * (1 - t * t) + scale;
}

static void arch_open(struct moving *b) {
  struct body body = {.blocks = 1, .cells = {12, 1, 1}, .map = arch_map};
  *b = (struct moving){.model = NULL};
  ck_assert_int_eq(body_build(&body, &b->mesh), STATUS_OK);
  b->mesh.wall_thickness = thickness;
  body_hold(&b->mesh, 0, 0, HOLD_X);
  body_hold(&b->mesh, 0, half_span, HOLD_ALL);
  body_hold(&b->mesh, -1, 0, HOLD_Y);
  moving_open(b, &rubber);
  body_add_traction(b->model, 0, 0, (double[3]){0, 0, -0.5 / thickness});
}

/* Follows the path by arc length over both limit points until the load is `beyond` times the upper
 * one; returns that load, and the equilibrium under it. */
static double arch_by_arc_length(struct moving *b, double beyond, double *upper) {
  struct fe_model *m = b->model;
  int n = m->dof_count, iterations, crown = 3 * body_node(&b->mesh, 0, 0, rise) + 2;
  struct fe_load load = {0, 0, 0};
  double *direction = calloc(2 * (size_t)n, sizeof *direction), *last = direction + n;
  b->solver->options.step_tolerance = 1e-10;
  *upper = 0;
  for (int k = 0; k < 300; k++) {
    double size = 0, along = 0;
    ck_assert_int_eq(equilibrium_tangent(b->solver, &load, true, &b->state, direction), STATUS_OK);
    for (int i = 0; i < n; i++) {
      size += direction[i] * direction[i];
      along += direction[i] * last[i];
    }
    double change = (along < 0 ? -1 : 1) * 0.02 * rise * sqrt(n / size);
    for (int i = 0; i < n; i++) {
      last[i] = change * direction[i];
    }
    ck_assert_int_eq(
        equilibrium_follow(b->solver, &load, true, direction, change, &b->state, &iterations),
        STATUS_OK);
    bool over = b->state.u[crown] < -rise;
    *upper = over ? *upper : fmax(*upper, load.dead);
    if (over && load.dead > beyond * *upper) {
      break;
    }
  }
  free(direction);
  load.dead = beyond * *upper;
  ck_assert_int_eq(equilibrium_solve(b->solver, &load, 0, &b->state, &iterations), STATUS_OK);
  ck_assert_int_eq(b->solver->negative_pivots, 0);
  return load.dead;
}

static const double overload = 1.05;

START_TEST(a_snapping_arch_comes_to_the_rest_that_arc_length_finds) {
  struct moving path, b;
  double upper, load = arch_by_arc_length((arch_open(&path), &path), overload, &upper);
  int crown = 3 * body_node(&path.mesh, 0, 0, rise) + 2, iterations;
  arch_open(&b);
  b.solver->options.step_tolerance = 1e-10;
  struct fe_load now = {0, 0, 0.95 * upper};
  ck_assert_int_eq(equilibrium_solve(b.solver, &now, 0, &b.state, &iterations), STATUS_OK);
  ck_assert_double_gt(b.state.u[crown], -rise);

  struct energy energy;
  struct carry_report report;
  struct error error = {0};
  struct carry_options options = carry_defaults(b.dynamics);
  b.dynamics->options.fast = 0.8;
  b.dynamics->options.viscosity = 2e5;
  energy_start(&energy, b.model, &b.state, &now, 0);
  now.dead = load;
  enum status status =
      dynamics_carry(b.dynamics, &options, &now, &b.state, &b.motion, &energy, &report, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  ck_assert(report.rested);
  fprintf(stdout,
          "carried over in %.4g s: %d steps, %d repeated, %d factorisations, peak of the kinetic "
          "energy %.3g J, dissipated %.3g J by damping and %.3g J besides\n",
          report.time, report.steps, report.rejected, report.iterations, report.peak_kinetic,
          report.damping, report.remainder);
  report_check("crown of the arch that snapped, arc length", "12 elements", path.state.u[crown],
               b.state.u[crown], 1e-6);
  /* The work of the load is what is stored and what is dissipated; the steps dissipate little. */
  ck_assert_double_gt(report.damping, 0.9 * (report.damping + report.remainder));
  ck_assert_double_eq_tol(energy.weight_work,
                          energy.strain - energy.start + report.damping + report.remainder,
                          1e-9 * energy.weight_work);
  moving_close(&b);
  moving_close(&path);
}
END_TEST

/* Limits end a carrying, and say so. */
START_TEST(a_carrying_that_does_not_end_is_ended) {
  struct moving b;
  struct carry_report report;
  struct error error = {0};
  arch_open(&b);
  struct carry_options options = carry_defaults(b.dynamics);
  options.steps = 5;
  struct fe_load load = {0, 0, 50};
  enum status status =
      dynamics_carry(b.dynamics, &options, &load, &b.state, &b.motion, NULL, &report, &error);
  ck_assert_int_eq(status, STATUS_DIVERGED);
  ck_assert(!report.rested);
  ck_assert_int_eq(report.steps, 5);
  ck_assert_ptr_nonnull(strstr(error.message, "5 steps"));
  options.wall_s = 1e-9;
  status = dynamics_carry(b.dynamics, &options, &load, &b.state, &b.motion, NULL, &report, &error);
  ck_assert_int_eq(status, STATUS_TIMEOUT);
  ck_assert_int_eq(report.steps, 0);
  moving_close(&b);
}
END_TEST

/* Displacements, velocities and accelerations that were kept bring the motion back to the bit. */
START_TEST(a_motion_that_was_kept_goes_on_the_same) {
  struct moving b;
  struct fe_state state;
  struct motion motion;
  box_open(&b);
  throw(&b, (const double[3]){0, 0, 0}, (const double[3]){0, 2, 3});
  moving_march(&b, 0.01, 3, NULL);
  ck_assert_int_eq(state_create(b.model, &state), STATUS_OK);
  ck_assert_int_eq(motion_create(b.model, &motion), STATUS_OK);
  double ends[2];
  state_copy(b.model, &state, &b.state);
  motion_copy(b.model, &motion, &b.motion);
  for (int k = 0; k < 2; k++) {
    state_copy(b.model, &b.state, &state);
    motion_copy(b.model, &b.motion, &motion);
    b.dynamics->factor_step = 0;
    moving_march(&b, 0.01, 3, NULL);
    ends[k] = b.state.u[0];
  }
  ck_assert(ends[0] == ends[1]);
  motion_release(&motion);
  state_release(&state);
  moving_close(&b);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("motion");
  TCase *tcase = tcase_create("motion");
  tcase_set_timeout(tcase, 300);
  tcase_add_test(tcase, a_thrown_body_keeps_its_momentum);
  tcase_add_test(tcase, viscosity_does_not_damp_a_rotation);
  tcase_add_test(tcase, a_falling_body_has_the_velocity_g_t);
  tcase_add_test(tcase, a_snapping_arch_comes_to_the_rest_that_arc_length_finds);
  tcase_add_test(tcase, a_carrying_that_does_not_end_is_ended);
  tcase_add_test(tcase, a_motion_that_was_kept_goes_on_the_same);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
