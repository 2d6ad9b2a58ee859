/* Pneu-nets as a whole: the reference body, symmetry, signs, refinement, contact. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "tests/physics/pneunet_case.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

/* A coarse body for questions that do not depend on the mesh. */
static void coarse_spec(struct job_spec *spec, int chambers, double pressure, int steps) {
  case_prototype(spec, chambers);
  case_refine(spec, 1);
  spec->load = (struct load_spec){.pressure_to = pressure, .steps = steps};
}

/* ---- the reference body: 12 chambers, 50 kPa ---- */

START_TEST(reference_body) {
  static const struct {
    bool contact;
    double angle, tolerance;
    int factorizations;
  } expected[] = {{false, 64.4, 0.01, 45}, {true, 137, 0.03, 45}};
  struct job_spec spec;
  struct pneunet_case c;
  case_prototype(&spec, 12);
  spec.contact = expected[_i].contact;
  case_open(&c, &spec);
  case_follow(&c);
  char mesh[60];
  snprintf(mesh, sizeof mesh, "%d elements, %d factorisations", c.mesh.element_count,
           c.factorizations);
  report_check(_i ? "12 chambers, contact, 50 kPa, degrees" : "12 chambers, 50 kPa, degrees", mesh,
               expected[_i].angle, c.angle[10], expected[_i].tolerance);
  ck_assert_int_eq(c.records, 11);
  ck_assert_double_eq(c.angle[0], 0);
  for (int k = 1; k < c.records; k++) {
    ck_assert_double_eq_tol(c.pressure[k], 5e3 * k, 1e-9);
    ck_assert_double_gt(c.angle[k], c.angle[k - 1]);
  }
  ck_assert_int_le(c.factorizations, expected[_i].factorizations);
  if (_i == 1) {
    report_value("12 chambers, contact, penetration over wall", mesh, 0,
                 fmax(0, -c.gap[10] / c.mesh.wall_thickness));
    ck_assert_double_lt(c.gap[10], 1e-4);
    ck_assert_double_gt(c.gap[10], -0.02 * c.mesh.wall_thickness);
  }
  case_close(&c);
}
END_TEST

/* ---- what has to hold on any mesh ---- */

START_TEST(no_load_no_motion) {
  struct job_spec spec;
  struct pneunet_case c;
  int iterations;
  coarse_spec(&spec, 2, 10e3, 1);
  spec.contact = true;
  case_open(&c, &spec);
  struct fe_load none = {0};
  ck_assert_int_eq(equilibrium_solve(c.solver, &none, 0, &c.state, &iterations), STATUS_OK);
  for (int d = 0; d < 3 * c.mesh.node_count; d++) {
    ck_assert_double_eq_tol(c.state.u[d], 0, 1e-15);
  }
  case_close(&c);
}
END_TEST

/* A full model has to find what its half finds, and to stay in its plane. */
START_TEST(full_model_equals_half_model) {
  struct job_spec spec;
  struct pneunet_case c;
  coarse_spec(&spec, 3, 15e3, 1);
  double angle[2];
  for (int full = 0; full < 2; full++) {
    spec.half_model = !full;
    case_open(&c, &spec);
    c.solver->options.step_tolerance *= 1e-3;
    case_follow(&c);
    angle[full] = c.angle[1];
    for (int s = 0; s < c.mesh.section_count; s++) {
      ck_assert_double_eq_tol(c.state.u[3 * c.mesh.centreline[s] + 1], 0, 1e-10);
    }
    case_close(&c);
  }
  report_check("3 chambers, full against half model, degrees", "coarse", angle[0], angle[1], 1e-9);
}
END_TEST

/* Turn of the tip section about z, by least squares over its bottom layer. */
static double sideways_turn(const struct pneunet_case *c) {
  double moment = 0, inertia = 0;
  for (int n = 0; n < c->mesh.node_count; n++) {
    if (c->mesh.node_core[n] && c->mesh.node_section[n] == c->mesh.section_count - 1) {
      double y = c->mesh.x[3 * n + 1];
      moment += c->state.u[3 * n] * y;
      inertia += y * y;
    }
  }
  return moment / inertia;
}

/* Unequal sides turn the body sideways, a mirrored body the other way by the same amount. */
START_TEST(unequal_tapers_turn_sideways) {
  double turn[2], angle[2];
  for (int k = 0; k < 2; k++) {
    struct job_spec spec;
    struct pneunet_case c;
    coarse_spec(&spec, 3, 10e3, 1);
    spec.half_model = false;
    spec.pneunet.taper_left = k == 0 ? 0.1 : 0;
    spec.pneunet.taper_right = k == 0 ? 0 : 0.1;
    case_open(&c, &spec);
    c.solver->options.step_tolerance *= 1e-3;
    case_follow(&c);
    turn[k] = sideways_turn(&c);
    angle[k] = c.angle[1];
    case_close(&c);
  }
  ck_assert_double_gt(fabs(turn[0]), 1e-5);
  ck_assert_double_eq_tol(turn[0], -turn[1], 1e-8 * fabs(turn[0]));
  ck_assert_double_eq_tol(angle[0], angle[1], 1e-10 * angle[0]);
}
END_TEST

/* Weight alone: downwards it bends the body as pressure does, upwards the other way, and
 * sideways it moves the tip sideways. */
START_TEST(gravity_pulls_where_it_points) {
  static const double direction[3][3] = {{0, 0, -9.81}, {0, 0, 9.81}, {0, 9.81, 0}};
  double angle[3], tip[3][3];
  for (int k = 0; k < 3; k++) {
    struct job_spec spec;
    struct pneunet_case c;
    coarse_spec(&spec, 4, 1, 1); /* 1 Pa */
    spec.half_model = false;
    memcpy(spec.load.gravity, direction[k], sizeof direction[k]);
    case_open(&c, &spec);
    case_follow(&c);
    angle[k] = c.angle[1];
    memcpy(tip[k], c.state.u + 3 * c.mesh.centreline[c.mesh.section_count - 1], sizeof tip[k]);
    case_close(&c);
  }
  ck_assert_double_gt(angle[0], 0.1);
  ck_assert_double_lt(tip[0][2], -1e-5);
  ck_assert_double_lt(angle[1], -0.1);
  ck_assert_double_gt(tip[1][2], 1e-5);
  ck_assert_double_eq_tol(angle[0], -angle[1], 0.05 * angle[0]);
  ck_assert_double_gt(tip[2][1], 1e-6);
  ck_assert_double_lt(fabs(angle[2]), 0.02 * angle[0]);
}
END_TEST

/* The weight of the body arrives at the base: the reaction of the held nodes. */
START_TEST(dead_load_is_the_weight) {
  struct job_spec spec;
  struct pneunet_case c;
  coarse_spec(&spec, 3, 10e3, 1);
  spec.load.gravity[2] = -10;
  case_open(&c, &spec);
  double sum[3] = {0};
  for (int d = 0; d < 3 * c.mesh.node_count; d++) {
    sum[d % 3] += c.model->dead_load[d];
  }
  /* Half of (box - gaps - cavities), by hand, at 1080 kg/m3 and 10 m/s2. */
  double slope = 2 * tan(2 * M_PI / 180) / 30, volume = 28 * 30 * 20 * (1 - slope * 14);
  for (int k = 0; k < 3; k++) {
    volume -= 4 * 26 * 12.5 * (1 - slope * (10 * k + 4));
    volume -= k < 2 ? 2 * 30 * 14 * (1 - slope * (10 * k + 9)) : 0;
  }
  ck_assert_double_eq_tol(sum[2] / (-0.5e-9 * volume * 1080 * 10), 1, 1e-12);
  ck_assert_double_eq_tol(sum[0], 0, 1e-15);
  case_close(&c);
}
END_TEST

/* Angle under a force on the tip's bottom edge, without pressure. */
static double passive_angle(const struct job_spec *spec) {
  struct pneunet_case c;
  int iterations;
  case_open(&c, spec);
  c.model->dead_load[3 * c.mesh.centreline[c.mesh.section_count - 1] + 2] = -1e-3; /* N */
  struct fe_load load = {0, 0, 1};
  ck_assert_int_eq(equilibrium_solve(c.solver, &load, 0, &c.state, &iterations), STATUS_OK);
  double angle = case_angle(&c.mesh, c.state.u);
  case_close(&c);
  return angle;
}

/* Bodies of one length: walls between the chambers resist bending most, detached chambers
 * least. A small pressure bends all of them towards the bottom layer. */
START_TEST(configurations_differ_as_expected) {
  for (int channel = 0; channel < 2; channel++) {
    double angle[3];
    for (int k = 0; k < 3; k++) {
      struct job_spec spec;
      coarse_spec(&spec, 3, 3e3, 1);
      spec.pneunet.runs[0].config = (enum chamber_config)k;
      spec.pneunet.has_channel = channel;
      if (k == CHAMBER_A) { /* four walls of 2 mm instead of six and two gaps */
        spec.pneunet.cavity_length = (0.028 - 0.008) / 3;
      }
      double bend = case_angle_of(&spec);
      angle[k] = passive_angle(&spec);
      printf("configuration %c%s: %.3f degrees at 3 kPa, %.4f under 2 mN\n", 'A' + k,
             channel ? " with channel" : "", bend, angle[k]);
      ck_assert_double_gt(bend, 0.05);
      ck_assert_double_lt(bend, 5);
    }
    ck_assert_double_gt(angle[0], 0);
    ck_assert_double_gt(angle[1], angle[0]);
    ck_assert_double_gt(angle[2], angle[1]);
  }
}
END_TEST

/* ---- loads beyond what the body can carry ---- */

static enum status keep_pressure(void *context, const struct path_point *point) {
  double *highest = context;
  *highest = fmax(*highest, point->pressure); /* the path may be followed down from there */
  return STATUS_OK;
}

/* The path has to end with a reason at the body's own limit, however far it was to go, and leave
 * the last converged state. */
START_TEST(path_ends_at_the_limit_of_the_body) {
  static const double target[2] = {150e3, 400e3};
  double reached[2] = {0, 0};
  for (int k = 0; k < 2; k++) {
    struct job_spec spec;
    struct pneunet_case c;
    struct error error = {0};
    coarse_spec(&spec, 3, target[k], 1);
    spec.contact = true;
    case_open(&c, &spec);
    struct path_options options = {
        .pressure_to = target[k], .steps = 1, .visit = keep_pressure, .context = &reached[k]};
    enum status status = path_follow(c.solver, &options, &c.state, &error);
    ck_assert_int_ne(status, STATUS_OK);
    ck_assert_int_eq(error.status, status);
    ck_assert_ptr_nonnull(strstr(error.message, "kPa"));
    double angle = case_angle(&c.mesh, c.state.u);
    ck_assert_double_gt(angle, 10);
    ck_assert_double_lt(angle, 360);
    struct fe_load load = {reached[k], reached[k], 0};
    int iterations;
    ck_assert_int_eq(equilibrium_solve(c.solver, &load, reached[k], &c.state, &iterations),
                     STATUS_OK);
    ck_assert_double_eq_tol(case_angle(&c.mesh, c.state.u), angle, 0.01 * angle);
    case_close(&c);
  }
  printf("limit of 3 chambers: %.1f and %.1f kPa\n", 1e-3 * reached[0], 1e-3 * reached[1]);
  ck_assert_double_eq_tol(reached[0], reached[1], 0.05 * reached[1]);
}
END_TEST

/* ---- refinement ---- */

/* Order q from the angles on meshes 1, 2, 3 (element size h = 1/n): (a1 - a2) / (a2 - a3) =
 * (1 - 2^-q) / (2^-q - 3^-q), by bisection. */
static double order_of(const double a[3]) {
  double ratio = (a[0] - a[1]) / (a[1] - a[2]), low = 0.1, high = 12;
  for (int k = 0; k < 60; k++) {
    double q = 0.5 * (low + high);
    if ((1 - pow(2, -q)) / (pow(2, -q) - pow(3, -q)) < ratio) {
      low = q;
    } else {
      high = q;
    }
  }
  return low;
}

START_TEST(angle_converges) {
  double angle[3];
  int meshes = SANITIZED ? 2 : 3;
  for (int n = 1; n <= meshes; n++) {
    struct job_spec spec;
    coarse_spec(&spec, 3, 20e3, 1);
    case_refine(&spec, n);
    angle[n - 1] = case_angle_of(&spec);
  }
  if (meshes == 2) { /* the coarsest mesh is 8 % low */
    ck_assert_double_eq_tol(angle[1] / angle[0], 1, 0.25);
    return;
  }
  double order = order_of(angle), factor = pow(3, -order) / (pow(2, -order) - pow(3, -order));
  double limit = angle[2] + (angle[2] - angle[1]) * factor;
  printf("order %.2f, Richardson value %.5f degrees\n", order, limit);
  for (int n = 1; n <= 3; n++) {
    char mesh[40];
    snprintf(mesh, sizeof mesh, "%d a wall", n);
    report_value("3 chambers, 20 kPa, against the Richardson value, degrees", mesh, limit,
                 angle[n - 1]);
  }
  /* Less than the element's own order: the inner corners of the cavities are singular. */
  ck_assert_double_gt(order, 1);
  ck_assert_double_eq_tol(angle[2], limit, 0.02 * limit);
  for (int tier = ACCURACY_FAST; tier <= ACCURACY_FINE; tier++) {
    static const char *const name[] = {"fast", "standard", "fine"};
    struct job_spec spec;
    case_prototype(&spec, 3);
    spec.accuracy = (enum accuracy)tier;
    spec.mesh = (struct mesh_spec){0};
    spec.load = (struct load_spec){.pressure_to = 20e3, .steps = 1};
    report_check("3 chambers, 20 kPa, tier against the Richardson value, degrees", name[tier],
                 limit, case_angle_of(&spec), 0.05);
  }
}
END_TEST

/* ---- contact ---- */

/* The multipliers remove the penetration whatever the stiffness. */
START_TEST(angle_does_not_depend_on_contact_stiffness) {
  static const double factor[3] = {1, 0.5, 3};
  double angle[3];
  for (int k = 0; k < 3; k++) {
    struct job_spec spec;
    struct pneunet_case c;
    coarse_spec(&spec, 3, 40e3, 4);
    spec.contact = true;
    spec.mesh.gap_wall = 2;
    case_open(&c, &spec);
    c.model->contact.stiffness *= factor[k];
    case_follow(&c);
    angle[k] = c.angle[4];
    ck_assert_int_gt(contact_summarise(&c.model->contact).active, 0);
    ck_assert_double_gt(c.gap[4], -0.02 * c.mesh.wall_thickness);
    case_close(&c);
  }
  report_check("3 chambers, contact, half the stiffness, degrees", "coarse", angle[0], angle[1],
               1e-3);
  report_check("3 chambers, contact, three times the stiffness, degrees", "coarse", angle[0],
               angle[2], 1e-3);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("bending");
  TCase *bending = tcase_create("bending");
  tcase_set_timeout(bending, 300);
  tcase_add_loop_test(bending, reference_body, 0, 2);
  tcase_add_test(bending, no_load_no_motion);
  tcase_add_test(bending, full_model_equals_half_model);
  tcase_add_test(bending, unequal_tapers_turn_sideways);
  tcase_add_test(bending, gravity_pulls_where_it_points);
  tcase_add_test(bending, dead_load_is_the_weight);
  tcase_add_test(bending, configurations_differ_as_expected);
  tcase_add_test(bending, path_ends_at_the_limit_of_the_body);
  tcase_add_test(bending, angle_converges);
  tcase_add_test(bending, angle_does_not_depend_on_contact_stiffness);
  suite_add_tcase(suite, bending);
  return suite_run(suite);
}
