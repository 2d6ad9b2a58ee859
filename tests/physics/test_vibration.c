/* Mass, frequencies, damping and the conservation of energy of bodies that vibrate. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/verify/report.h"
#include "solver/verify/strip.h"
#include "solver/verify/timoshenko.h"
#include "tests/physics/moving.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

static const struct material_spec rubber = {
    .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1e6}, .density_kg_m3 = 1000, .bulk_ratio = 1000};
static const double mu = 1e6, density = 1000;

/* E and nu of the material, which is not quite incompressible. */
static double young(void) {
  return 9 * 1000 * mu / (3 * 1000 + 1);
}
static double poisson(void) {
  return (3 * 1000 - 2.0) / (2 * (3 * 1000 + 1.0));
}

static double *vector_of(const struct moving *b) {
  double *v = calloc(3 * (size_t)b->mesh.node_count, sizeof *v);
  ck_assert_ptr_nonnull(v);
  return v;
}

/* ---- mass ---- */

START_TEST(rigid_motions_have_the_mass_and_inertia_of_the_body) {
  struct moving b;
  const double low[3] = {-0.1, -0.2, -0.3}, high[3] = {0.1, 0.2, 0.3};
  moving_block(&b, low, high, (const int[3]){2, 1, 3});
  moving_open(&b, &rubber);
  double mass = density * 0.2 * 0.4 * 0.6, *v = vector_of(&b);
  report_check("mass of a box", "2 x 1 x 3", mass, b.dynamics->inertia->total, 1e-12);
  for (int n = 0; n < b.mesh.node_count; n++) {
    memcpy(v + 3 * n, (double[3]){1, 2, -2}, 3 * sizeof *v);
  }
  report_check("kinetic energy of a translation", "2 x 1 x 3", 0.5 * mass * 9,
               inertia_kinetic(b.dynamics->inertia, v), 1e-12);
  for (int n = 0; n < b.mesh.node_count; n++) { /* 3 rad/s about x */
    const double *x = b.mesh.x + 3 * n;
    memcpy(v + 3 * n, (double[3]){0, -3 * x[2], 3 * x[1]}, 3 * sizeof *v);
  }
  double inertia = mass / 12 * (0.4 * 0.4 + 0.6 * 0.6);
  report_check("kinetic energy of a rotation", "2 x 1 x 3", 0.5 * inertia * 9,
               inertia_kinetic(b.dynamics->inertia, v), 1e-12);
  free(v);
  moving_close(&b);
}
END_TEST

/* ---- frequencies ---- */

/* A quarter of a bar of square section, between its planes of symmetry, fixed at x = 0: f1 =
 * c/(4L), c^2 = E/density, less the inertia of the contracting section (Rayleigh, Theory of Sound,
 * 157). */
START_TEST(first_axial_frequency_of_a_bar) {
  const double length = 1, edge = 0.1;
  struct moving b;
  moving_block(&b, (const double[3]){0, 0, 0}, (const double[3]){length, edge / 2, edge / 2},
               (const int[3]){8, 1, 1});
  body_hold(&b.mesh, 0, 0, HOLD_X);
  body_hold(&b.mesh, 1, 0, HOLD_Y);
  body_hold(&b.mesh, 2, 0, HOLD_Z);
  moving_open(&b, &rubber);
  double *mode = vector_of(&b), turn = poisson() * M_PI / 2 / length;
  double radius2 = edge * edge / 6; /* of gyration about the axis, squared */
  double thin = M_PI / 2 / length * sqrt(young() / density);
  report_check("axial frequency of a bar", "8 elements", thin / sqrt(1 + turn * turn * radius2),
               moving_frequency(&b, mode), 2e-4);
  free(mode);
  moving_close(&b);
}
END_TEST

static void cantilever_open(struct moving *b, double edge, int cells) {
  *b = (struct moving){.model = NULL};
  ck_assert_int_eq(strip_build(edge, cells, false, &b->mesh), STATUS_OK);
  moving_open(b, &rubber);
}

START_TEST(first_bending_frequency_of_a_cantilever) {
  const double edge = 0.1;
  struct moving b;
  cantilever_open(&b, edge, 16);
  struct timoshenko beam = {young(), mu, poisson(), density, edge};
  double *mode = vector_of(&b), exact = timoshenko_frequency(&beam);
  report_value("bending frequency, Euler-Bernoulli", "16 elements", timoshenko_slender(&beam),
               exact);
  report_check("bending frequency, Timoshenko", "16 elements", exact, moving_frequency(&b, mode),
               1e-3);
  free(mode);
  moving_close(&b);
}
END_TEST

/* ---- vibration in time ---- */

/* Starts in the shape at rest with the first mode's velocities, the largest of which is `speed`.
 * Returns the mode's angular frequency. */
static double strike(struct moving *b, double speed) {
  double *mode = vector_of(b), w = moving_frequency(b, mode);
  const struct fe_load none = {0, 0, 0};
  for (int i = 0; i < 3 * b->mesh.node_count; i++) {
    b->motion.velocity[i] = speed * mode[i];
  }
  b->motion.step = 1e-2 / w;
  ck_assert_int_eq(dynamics_balance(b->dynamics, &none, &b->state, &b->motion), STATUS_OK);
  free(mode);
  return w;
}

/* Amplitude and angular frequency of the tip's vibration by a least-squares fit of a damped sine
 * would hide what goes wrong: times of zero crossings and heights of peaks are read off directly.
 */
struct reading {
  double crossing[32], peak[32];
  int crossings, peaks;
};

static void read_tip(struct moving *b, double h, int count, struct reading *r) {
  int tip = 3 * body_node(&b->mesh, 1, 0, 0) + 2;
  double last[2] = {0, b->state.u[tip]};
  *r = (struct reading){.crossings = 0};
  for (int k = 0; k < count; k++) {
    moving_march(b, h, 1, NULL);
    double now = b->state.u[tip], before = last[1], turn = now - 2 * before + last[0];
    if (before * now < 0) {
      r->crossing[r->crossings++] = b->motion.time - h * now / (now - before);
    }
    if (k > 0 && (before - last[0]) * (now - before) < 0) { /* the parabola's vertex */
      double slope = 0.5 * (now - last[0]);
      r->peak[r->peaks++] = before - slope * slope / (2 * turn);
    }
    last[0] = before;
    last[1] = now;
  }
}

/* The period of small vibrations is that of the mode; the trapezoidal rule lengthens it by (w h)^2
 * / 12 and damps nothing. */
START_TEST(small_vibrations_have_the_period_of_the_mode) {
  struct moving b;
  struct reading r;
  cantilever_open(&b, 0.1, 8);
  double w = strike(&b, 1e-3), h = 0.1 / w;
  read_tip(&b, h, 400, &r);
  ck_assert_int_ge(r.crossings, 12);
  double half = (r.crossing[11] - r.crossing[1]) / 10;
  report_check("period of a small vibration", "8 elements, w h = 0.1",
               2 * M_PI / w * (1 + 0.01 / 12), 2 * half, 1e-4);
  report_check("its amplitude after five periods", "8 elements, w h = 0.1", r.peak[0], r.peak[10],
               1e-3);
  moving_close(&b);
}
END_TEST

/* Logarithmic decrement of viscous damping of ratio z = viscosity w / (2 mu): 2 pi z / sqrt(1 -
 * z^2). */
START_TEST(viscous_damping_has_its_decrement) {
  static const double ratio[] = {0.02, 0.1};
  struct moving b;
  struct reading r;
  cantilever_open(&b, 0.1, 8);
  double z = ratio[_i], w = strike(&b, 1e-3), h = 0.1 / w;
  b.dynamics->options.viscosity = 2 * z * mu / w;
  motion_clear(b.model, &b.motion);
  strike(&b, 1e-3);
  read_tip(&b, h, 330, &r);
  ck_assert_int_ge(r.peaks, 9);
  report_check("logarithmic decrement", z < 0.05 ? "damping 2 %" : "damping 10 %",
               2 * M_PI * z / sqrt(1 - z * z), log(r.peak[0] / r.peak[8]) / 4, 0.01);
  moving_close(&b);
}
END_TEST

/* A drag of the momentum damps every motion with the rate drag/2. */
START_TEST(drag_has_its_decrement) {
  struct moving b;
  struct reading r;
  cantilever_open(&b, 0.1, 8);
  double w = strike(&b, 1e-3), h = 0.1 / w, z = 0.05;
  b.dynamics->options.drag = 2 * z * w;
  motion_clear(b.model, &b.motion);
  strike(&b, 1e-3);
  read_tip(&b, h, 330, &r);
  report_check("logarithmic decrement of drag", "damping 5 %", 2 * M_PI * z / sqrt(1 - z * z),
               log(r.peak[0] / r.peak[8]) / 4, 0.01);
  moving_close(&b);
}
END_TEST

/* Tip swings of more than half the length: largest relative change of the energy over two periods,
 * and the swing. */
static double energy_drift(double fast, double viscosity, double wh, struct energy *energy,
                           double *swing) {
  struct moving b;
  cantilever_open(&b, 0.1, 8);
  int tip = 3 * body_node(&b.mesh, 1, 0, 0) + 2;
  b.dynamics->options.fast = fast;
  double slow = strike(&b, 0), w = strike(&b, 0.6 * slow), worst = 0;
  b.dynamics->options.viscosity = viscosity;
  double first = moving_energy(&b);
  const struct fe_load none = {0, 0, 0};
  *swing = 0;
  energy_start(energy, b.model, &b.state, &none, first);
  for (int k = 0; k < (int)(4 * M_PI / wh); k++) {
    moving_march(&b, wh / w, 1, energy);
    worst = fmax(worst, fabs(energy->remainder) / first);
    *swing = fmax(*swing, fabs(b.state.u[tip]));
  }
  ck_assert_double_eq_tol(energy->kinetic + energy->strain, moving_energy(&b), 1e-9 * first);
  moving_close(&b);
  return worst;
}

START_TEST(large_vibrations_keep_their_energy) {
  struct energy energy;
  double swing, drift[2];
  for (int k = 0; k < 2; k++) {
    drift[k] = energy_drift(1, 0, 0.1 / (1 + k), &energy, &swing);
    report_value("energy drift, rho = 1", k ? "w h = 0.05" : "w h = 0.1", 0, drift[k]);
  }
  report_value("swing of the tip over the length", "8 elements", 0.5, swing);
  ck_assert_double_gt(swing, 0.45);
  ck_assert_double_lt(drift[0], 5e-3);
  ck_assert_double_lt(drift[1], 1.5e-3);
  for (int k = 0; k < 2; k++) {
    drift[k] = energy_drift(0.8, 0, 0.1 / (1 + k), &energy, &swing);
    report_value("energy lost, rho = 0.8", k ? "w h = 0.05" : "w h = 0.1", 0, drift[k]);
  }
  ck_assert_double_lt(drift[0], 1e-2);
  ck_assert_double_lt(drift[1], 4e-3);
}
END_TEST

/* With damping the ledger closes: what is lost is what the viscosity dissipates. */
START_TEST(the_ledger_of_a_damped_vibration_closes) {
  struct energy energy;
  double swing, drift = energy_drift(1, 3e4, 0.05, &energy, &swing);
  report_value("dissipated by viscosity, share", "w h = 0.05", 0, energy.damping / energy.start);
  report_value("energy drift with damping", "w h = 0.05", 0, drift);
  ck_assert_double_gt(energy.damping, 0.3 * energy.start);
  ck_assert_double_lt(drift, 5e-3);
}
END_TEST

/* ---- the tangent ---- */

struct trial {
  struct moving b;
  struct fe_state at;
  double *direction, *exact, *forward, *backward; /* dof_count */
};

static void residual_at(struct trial *t, double h, double *residual) {
  const struct fe_load none = {0, 0, 0};
  struct fe_model *m = t->b.model;
  state_copy(m, &t->at, &t->b.state);
  for (int d = 0; d < 3 * m->mesh->node_count; d++) {
    t->at.u[d] += m->equation[d] >= 0 ? h * t->direction[m->equation[d]] : 0;
  }
  ck_assert_int_eq(model_evaluate(m, &t->at, &none, false), STATUS_OK);
  memcpy(residual, m->residual, (size_t)m->dof_count * sizeof *residual);
}

static double tangent_error(void *context, double h) {
  struct trial *t = context;
  residual_at(t, h, t->forward);
  residual_at(t, -h, t->backward);
  return verify_difference_error(t->b.model->dof_count, t->backward, t->forward, h, t->exact);
}

/* Of mass and viscosity, in a deformed state that goes on deforming: differences of the residual.
 */
START_TEST(the_tangent_of_a_step_is_exact) {
  struct trial t;
  unsigned seed = 3;
  const struct fe_load none = {0, 0, 0};
  moving_block(&t.b, (const double[3]){0, 0, 0}, (const double[3]){1, 1, 1},
               (const int[3]){2, 1, 1});
  moving_open(&t.b, &rubber);
  struct fe_model *m = t.b.model;
  struct inertia *inertia = t.b.dynamics->inertia;
  double *now = vector_of(&t.b), *before = vector_of(&t.b),
         *vectors = calloc(4, 1000 * sizeof *now);
  ck_assert(vectors && m->dof_count <= 1000);
  t.direction = vectors;
  t.exact = vectors + 1000;
  t.forward = vectors + 2000;
  t.backward = vectors + 3000;
  for (int d = 0; d < 3 * m->mesh->node_count; d++) {
    now[d] = 0.05 * body_random(&seed);
    before[d] = 0.05 * body_random(&seed);
    t.b.state.u[d] = 0.05 * body_random(&seed);
    inertia->offset[d] = body_random(&seed);
    t.direction[d] = body_random(&seed);
  }
  inertia->stiffness = 1e3;
  inertia_set_viscosity(inertia, m, 2e6, 4.0 / 3, now, -1.0 / 3, before);
  m->inertia = inertia;
  ck_assert_int_eq(state_create(m, &t.at), STATUS_OK);
  ck_assert_int_eq(model_evaluate(m, &t.b.state, &none, true), STATUS_OK);
  model_multiply(m, t.direction, t.exact);
  report_second_order("tangent of a step in time", tangent_error, &t, 0.02, 4, 1e-7);
  m->inertia = NULL;
  state_release(&t.at);
  free(now);
  free(before);
  free(vectors);
  moving_close(&t.b);
}
END_TEST

/* ---- order in time ---- */

/* Place of the tip after a fixed time in steps of that time over `count`. Without damping only
 * small swings are smooth in these steps: large ones make the length ring. */
static void tip_after(double viscosity, double fast, int count, double tip[3]) {
  struct moving b;
  cantilever_open(&b, 0.1, 4);
  double slow = strike(&b, 0);
  b.dynamics->options.viscosity = viscosity;
  b.dynamics->options.fast = fast;
  double w = strike(&b, (viscosity > 0 ? 0.4 : 1e-3) * slow);
  moving_march(&b, 2 / w / count, count, NULL);
  memcpy(tip, b.state.u + 3 * body_node(&b.mesh, 1, 0, 0), 3 * sizeof *tip);
  moving_close(&b);
}

START_TEST(the_method_is_of_second_order) {
  static const double viscosity[] = {0, 2e4}, fast[] = {1, 0.8};
  double finest[3], error[2];
  tip_after(viscosity[_i % 2], fast[_i / 2], 160, finest);
  for (int k = 0; k < 2; k++) {
    double tip[3];
    tip_after(viscosity[_i % 2], fast[_i / 2], 20 << k, tip);
    error[k] = hypot(tip[0] - finest[0], tip[2] - finest[2]);
  }
  /* The reference errs too, by 1/64 and 1/16 of the two errors. */
  double order = report_order(error[0] / (1 - 1.0 / 64), error[1] / (1 - 1.0 / 16), 2);
  report_check("order in time", _i % 2 ? "damped" : "undamped", 2, order, 0.15);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("vibration");
  TCase *tcase = tcase_create("vibration");
  tcase_set_timeout(tcase, 300);
  tcase_add_test(tcase, rigid_motions_have_the_mass_and_inertia_of_the_body);
  tcase_add_test(tcase, first_axial_frequency_of_a_bar);
  tcase_add_test(tcase, first_bending_frequency_of_a_cantilever);
  tcase_add_test(tcase, small_vibrations_have_the_period_of_the_mode);
  tcase_add_loop_test(tcase, viscous_damping_has_its_decrement, 0, 2);
  tcase_add_test(tcase, drag_has_its_decrement);
  tcase_add_test(tcase, large_vibrations_keep_their_energy);
  tcase_add_test(tcase, the_ledger_of_a_damped_vibration_closes);
  tcase_add_test(tcase, the_tangent_of_a_step_is_exact);
  tcase_add_loop_test(tcase, the_method_is_of_second_order, 0, 4);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
