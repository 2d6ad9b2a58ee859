/* Rigid objects that are free to move: alone, and on a body. */
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
    .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1e5}, .density_kg_m3 = 1000, .bulk_ratio = 1000};
static const struct fe_load unloaded = {0, 0, 0};
static const double gravity = 9.80665;

/* ---- an object on a block with a hollow top ---- */

static const double half = 0.018, depth = 0.012, hollow = 0.011; /* m */

/* Centre of the top in the origin; the hollow is that of a sphere. context: only y > 0. */
static void bowl(const void *context, int block, const double s[3], double x[3]) {
  const bool *cut = context;
  (void)block;
  x[0] = half * (2 * s[0] - 1);
  x[1] = half * (*cut ? s[1] : 2 * s[1] - 1);
  double r2 = fmin(x[0] * x[0] + x[1] * x[1], 0.6 * hollow * hollow);
  double top = hollow - sqrt(hollow * hollow - r2);
  x[2] = -depth * (1 - s[2]) + top * s[2];
}

struct scene {
  struct moving b;
  struct rigid_shape *shape;
  struct free_object *object;
  int index;
};

static void scene_open_cut(struct scene *s, bool cut, struct rigid_shape *shape, double friction,
                           double mass, const double place[3]) {
  bool near = place[2] < 2 * hollow; /* nothing happens to a body far away */
  struct body body = {.blocks = 1,
                      .cells = {near ? 6 : 1,
                                !near ? 1
                                : cut ? 3
                                      : 6,
                                near ? 2 : 1},
                      .map = bowl,
                      .context = &cut};
  struct error error = {0};
  struct rigid_pose pose = rigid_pose_identity();
  *s = (struct scene){.shape = shape};
  ck_assert_int_eq(body_build(&body, &s->b.mesh), STATUS_OK);
  s->b.mesh.wall_thickness = depth;
  s->b.mesh.half = cut;
  if (cut) {
    body_hold(&s->b.mesh, 1, 0, HOLD_Y);
  }
  body_hold(&s->b.mesh, 2, -depth, HOLD_ALL);
  moving_open_with(&s->b, &rubber, shape, friction, &s->index);
  memcpy(pose.place, place, sizeof pose.place);
  model_place_obstacle(s->b.model, s->index, &pose);
  enum status status = free_object_create(s->b.solver, s->index, mass, &s->object, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  s->b.dynamics->object = s->object;
  s->b.dynamics->options.fast = 0.8;
  s->object->gravity[2] = -gravity;
  s->b.solver->options.step_tolerance = 1e-9;
}

static void scene_open(struct scene *s, struct rigid_shape *shape, double friction, double mass,
                       const double place[3]) {
  scene_open_cut(s, false, shape, friction, mass, place);
}

static void scene_close(struct scene *s) {
  free_object_destroy(s->b.solver, s->object);
  moving_close(&s->b);
  rigid_shape_destroy(s->shape);
}

static struct rigid_shape *ball(double diameter) {
  struct rigid_shape *shape;
  ck_assert_int_eq(rigid_shape_create_sphere(diameter, &shape, NULL), STATUS_OK);
  return shape;
}

/* ---- derivatives ---- */

/* Force and moment about the centroid after a small motion of the object or of the body. */
static void moved_resultant(struct scene *s, const double motion[6], const double *du, double h,
                            double resultant[6]) {
  struct fe_model *m = s->b.model;
  struct fe_state moved;
  struct rigid_pose before = m->obstacle[s->index]->pose, pose = before;
  double shift[3], turn[3];
  for (int i = 0; i < 3; i++) {
    shift[i] = h * motion[i];
    turn[i] = h * motion[3 + i];
  }
  rigid_pose_move(&pose, shift, turn);
  model_place_obstacle(m, s->index, &pose);
  ck_assert_int_eq(state_create(m, &moved), STATUS_OK);
  state_copy(m, &moved, &s->b.state);
  for (int d = 0; du && d < 3 * m->mesh->node_count; d++) {
    moved.u[d] += m->equation[d] >= 0 ? h * du[m->equation[d]] : 0;
  }
  ck_assert_int_eq(model_evaluate(m, &moved, &unloaded, false), STATUS_OK);
  free_object_resultant(s->object, resultant);
  model_place_obstacle(m, s->index, &before);
  state_release(&moved);
}

/* Largest error of the differences, relative to the largest derivative of its kind. */
static double difference_error(struct scene *s, const double motion[6], const double *du,
                               const double exact[6]) {
  const double h = 1e-7;
  double plus[6], minus[6], worst = 0, size[2] = {0, 0};
  moved_resultant(s, motion, du, h, plus);
  moved_resultant(s, motion, du, -h, minus);
  for (int i = 0; i < 6; i++) {
    size[i / 3] = fmax(size[i / 3], fabs(exact[i]));
  }
  for (int i = 0; i < 6; i++) {
    worst = fmax(worst, fabs((plus[i] - minus[i]) / (2 * h) - exact[i]) / size[i / 3]);
  }
  return worst;
}

/* A box, so that turns matter, whose edges are in the hollow. */
START_TEST(the_coupling_is_that_of_differences) {
  struct rigid_shape *shape;
  struct scene s;
  const double size[3] = {0.016, 0.014, 0.02};
  unsigned seed = 4;
  ck_assert_int_eq(rigid_shape_create_box(size, 0.006, &shape, NULL), STATUS_OK);
  scene_open(&s, shape, 0.5, 0.05, (const double[3]){1.3e-3, -2.2e-3, 0.0108});
  struct fe_model *m = s.b.model;
  ck_assert_int_eq(model_evaluate(m, &s.b.state, &unloaded, true), STATUS_OK);
  ck_assert_int_eq(model_factor(m), 0);
  s.b.solver->guest->factored(s.b.solver->guest->context);
  const struct obstacle_coupling *c = &s.object->coupling;
  size_t count = (size_t)m->dof_count;
  double *du = calloc(count, sizeof *du), worst = 0, exact[6];
  ck_assert_ptr_nonnull(du);
  ck_assert_double_gt(model_obstacle_state(m, s.index).touching, 5);
  for (int j = 0; j < 6; j++) {
    double motion[6] = {0};
    motion[j] = 1;
    for (int i = 0; i < 6; i++) {
      exact[i] = c->own[6 * i + j];
    }
    worst = fmax(worst, difference_error(&s, motion, NULL, exact));
  }
  report_value("resultants by motions of the object", "differences", 0, worst);
  ck_assert_double_lt(worst, 1e-5);
  for (size_t d = 0; d < count; d++) {
    du[d] = body_random(&seed);
  }
  for (size_t i = 0; i < 6; i++) {
    exact[i] = 0;
    for (size_t d = 0; d < count; d++) {
      exact[i] += c->by_u[i * count + d] * du[d];
    }
  }
  worst = difference_error(&s, (const double[6]){0}, du, exact);
  report_value("resultants by displacements of the body", "differences", 0, worst);
  ck_assert_double_lt(worst, 1e-5);
  free(du);
  scene_close(&s);
}
END_TEST

static void check_weight(const struct scene *s, const char *how, double tolerance) {
  struct obstacle_state state = model_obstacle_state(s->b.model, s->index);
  report_check("contact force over the weight", how, 1,
               state.force[2] / (s->object->mass * gravity), tolerance);
  ck_assert_double_lt(hypot(state.force[0], state.force[1]), 1e-3 * state.force[2]);
}

/* The equilibrium of a ball that is put into the hollow a little too deep and off its middle. */
START_TEST(a_ball_at_rest_is_carried_by_the_contact) {
  struct scene s;
  int iterations;
  scene_open(&s, ball(0.02), _i == 0 ? 0 : 0.5, 0.05, (const double[3]){2e-4, -1e-4, 9.7e-3});
  enum status status = equilibrium_solve(s.b.solver, &unloaded, 0, &s.b.state, &iterations);
  ck_assert_msg(status == STATUS_OK, "%s", status_sentence(status));
  printf("%d factorisations\n", iterations);
  check_weight(&s, _i == 0 ? "at rest, no friction" : "at rest, friction 0.5", 1e-5);
  ck_assert_double_lt(free_object_unbalanced(s.object), 1e-3 * s.object->mass * gravity);
  double centre[3];
  free_object_centroid(s.object, centre);
  if (_i == 0) { /* without friction it lies in the middle */
    ck_assert_double_lt(hypot(centre[0], centre[1]), 5e-6);
  }
  scene_close(&s);
}
END_TEST

/* Half a model and half a ball rest as the whole ones do. */
START_TEST(half_a_model_gives_the_same_rest) {
  double centre[2][3];
  for (int cut = 0; cut < 2; cut++) {
    struct scene s;
    int iterations;
    scene_open_cut(&s, cut == 1, ball(0.02), 0.5, 0.05, (const double[3]){2e-4, 0, 9.7e-3});
    s.b.solver->options.force_tolerance = 1e-5;
    ck_assert_int_eq(equilibrium_solve(s.b.solver, &unloaded, 0, &s.b.state, &iterations),
                     STATUS_OK);
    report_check("mass that rests", cut ? "half a model" : "whole model", cut ? 0.025 : 0.05,
                 s.object->mass, 1e-12);
    free_object_centroid(s.object, centre[cut]);
    scene_close(&s);
  }
  ck_assert_double_eq(centre[1][1], 0);
  for (int i = 0; i < 3; i++) {
    ck_assert_double_eq_tol(centre[0][i], centre[1][i], 1e-6);
  }
}
END_TEST

/* Work that goes into the gaps: a contact that settles at another overlap than in the step before
 * takes or gives its force times the difference. */
struct gap_work {
  const struct scene *scene;
  double pressure[2000], gap[2000];
  double farthest; /* gap of a point that is out of reach, m */
  double work;
};

static enum status add_gap_work(void *context, const struct motion *motion,
                                const struct fe_state *state, const struct fe_load *load) {
  struct gap_work *w = context;
  const struct fe_model *m = w->scene->b.model;
  (void)motion;
  (void)state;
  (void)load;
  ck_assert_int_le(QUAD9_POINTS * m->contact.face_count, 2000);
  for (int i = 0; i < QUAD9_POINTS * m->contact.face_count; i++) {
    const struct obstacle_point *p = &m->obstacle[w->scene->index]->point[i];
    double mean = 0.5 * (p->pressure + w->pressure[i]);
    w->work -= mean > 0 ? p->area * mean * (p->gap - w->gap[i]) : 0;
    w->pressure[i] = p->pressure;
    w->gap[i] = isfinite(p->gap) ? p->gap : w->farthest;
  }
  return STATUS_OK;
}

/* A ball falls and comes to rest: what its weight has done is stored or dissipated. */
START_TEST(a_falling_ball_comes_to_rest_on_the_body) {
  struct scene s;
  struct energy energy;
  struct carry_report report;
  struct error error = {0};
  struct fe_load load = unloaded;
  struct gap_work gaps = {.scene = &s, .farthest = 1e-3};
  for (int i = 0; i < 2000; i++) {
    gaps.gap[i] = gaps.farthest;
  }
  scene_open(&s, ball(0.02), 0.5, 0.05, (const double[3]){0, 0, 0.0115});
  s.b.dynamics->options.viscosity = 400;
  s.b.dynamics->options.tolerance = 2e-6;
  struct carry_options options = carry_defaults(s.b.dynamics);
  options.drive = (struct dynamics_drive){NULL, add_gap_work, &gaps};
  energy_start(&energy, s.b.model, &s.b.state, &load, 0);
  ck_assert_int_eq(dynamics_balance(s.b.dynamics, &load, &s.b.state, &s.b.motion), STATUS_OK);
  enum status status = dynamics_carry(s.b.dynamics, &options, &load, &s.b.state, &s.b.motion,
                                      &energy, &report, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  ck_assert(report.rested);
  check_weight(&s, "after a fall", 5e-4);
  double centre[3];
  free_object_centroid(s.object, centre);
  report_check("work of the weight over that of its way", "after a fall", 1,
               energy.weight_work / (s.object->mass * gravity * (0.0115 - centre[2])), 1e-9);
  printf("%.4g s, %d steps, %d repeated, %d factorisations: weight %.4g J, strain %.3g J, damping "
         "%.4g J, friction %.3g J, gaps %.3g J, besides %.3g J\n",
         report.time, report.steps, report.rejected, report.iterations, energy.weight_work,
         energy.strain, energy.damping, energy.friction, gaps.work, energy.remainder - gaps.work);
  ck_assert_double_lt(fabs(energy.remainder - gaps.work), 0.05 * energy.weight_work);
  scene_close(&s);
}
END_TEST

/* A ball that hangs in the air has no equilibrium. */
START_TEST(an_object_without_support_has_no_equilibrium) {
  struct scene s;
  int iterations;
  scene_open(&s, ball(0.02), 0.5, 0.05, (const double[3]){0, 0, 0.015});
  enum status status = equilibrium_solve(s.b.solver, &unloaded, 0, &s.b.state, &iterations);
  ck_assert_int_eq(status, STATUS_DIVERGED);
  scene_close(&s);
}
END_TEST

/* ---- an object in the air ---- */

/* A box that is thrown with a spin about its middle axis, which is unstable; away from the body. */
static void throw_box(int count, double *momentum_lost, double *energy_lost, double fallen[2]) {
  struct rigid_shape *shape;
  struct scene s;
  const double size[3] = {0.02, 0.03, 0.05};
  double linear[3], before[3], after[3];
  ck_assert_int_eq(rigid_shape_create_box(size, 0.002, &shape, NULL), STATUS_OK);
  scene_open(&s, shape, 0.5, 0.03, (const double[3]){0, 0, 1});
  struct object_motion *o = &s.b.motion.object;
  memcpy(o->velocity, (double[3]){1, 0, 0}, sizeof o->velocity);
  memcpy(o->spin, (double[3]){0.3, 8, 0.2}, sizeof o->spin);
  s.b.motion.step = 1.0 / count;
  ck_assert_int_eq(dynamics_balance(s.b.dynamics, &unloaded, &s.b.state, &s.b.motion), STATUS_OK);
  free_motion_momentum(s.object, o, linear, before);
  double energy = free_motion_kinetic(s.object, o);
  moving_march(&s.b, 1.0 / count, count, NULL);
  free_motion_momentum(s.object, o, linear, after);
  double change[3] = {after[0] - before[0], after[1] - before[1], after[2] - before[2]};
  double centre[3];
  free_object_centroid(s.object, centre);
  double weight = s.object->mass * gravity;
  *momentum_lost = vec3_norm(change) / vec3_norm(before);
  *energy_lost = fabs(free_motion_kinetic(s.object, o) - weight * (1 - centre[2]) - energy) /
                 (energy - 0.5 * s.object->mass);
  fallen[0] = 1 - centre[2];
  fallen[1] = o->velocity[2];
  scene_close(&s);
}

START_TEST(a_tumbling_box_keeps_its_moment_of_momentum) {
  double momentum[2], energy[2], fallen[2];
  for (int k = 0; k < 2; k++) {
    throw_box(100 << k, &momentum[k], &energy[k], fallen);
    report_value("moment of momentum lost", k == 0 ? "100 steps" : "200 steps", 0, momentum[k]);
    report_value("energy of rotation lost", k == 0 ? "100 steps" : "200 steps", 0, energy[k]);
  }
  report_check("fallen in a second", "200 steps", 0.5 * gravity, fallen[0], 1e-8);
  report_check("velocity after a second", "200 steps", -gravity, fallen[1], 1e-8);
  ck_assert_double_lt(momentum[0], 1e-2);
  ck_assert_double_gt(report_order(momentum[0], momentum[1], 2), 1.8);
}
END_TEST

START_TEST(masses_are_checked) {
  struct scene s;
  struct free_object *other;
  struct error error = {0};
  scene_open(&s, ball(0.02), 0.5, 0.05, (const double[3]){0, 0, 1});
  ck_assert_int_eq(free_object_create(s.b.solver, s.index, 0.05, &other, &error), STATUS_CONFLICT);
  static const double bad[] = {0, -1, INFINITY, NAN};
  for (int k = 0; k < 4; k++) {
    ck_assert_int_eq(free_object_create(s.b.solver, s.index, bad[k], &other, &error),
                     STATUS_INVALID);
    ck_assert_ptr_nonnull(strstr(error.message, "50 g"));
  }
  scene_close(&s);
}
END_TEST

/* Stiffnesses of which the answer is known: springs along the axes; one that pushes on; two motions
 * of which neither is resisted alone, but one gains force by the other; the same across the plane
 * of symmetry of half an object, which cannot move so. */
START_TEST(stable_is_what_no_push_drives_away) {
  struct free_object o = {.size = 0.02};
  for (int i = 0; i < 6; i++) {
    o.tangent[7 * i] = i < 3 ? 100 : 0.01;
  }
  ck_assert(free_object_stable(&o));
  o.tangent[0] = 0;
  ck_assert(free_object_stable(&o)); /* nothing resists that, and nothing drives it */
  o.tangent[0] = -1;
  ck_assert(!free_object_stable(&o));
  o.tangent[0] = o.tangent[7] = 0;
  o.tangent[1] = o.tangent[6] = 50;
  ck_assert(!free_object_stable(&o));
  o.half = true;
  ck_assert(free_object_stable(&o));
}
END_TEST

int main(void) {
  Suite *suite = suite_create("free object");
  const struct {
    const char *name;
    const TTest *test;
    int count;
  } cases[] = {{"coupling", the_coupling_is_that_of_differences, 1},
               {"rest", a_ball_at_rest_is_carried_by_the_contact, 2},
               {"half", half_a_model_gives_the_same_rest, 1},
               {"fall", a_falling_ball_comes_to_rest_on_the_body, 1},
               {"support", an_object_without_support_has_no_equilibrium, 1},
               {"air", a_tumbling_box_keeps_its_moment_of_momentum, 1},
               {"stable", stable_is_what_no_push_drives_away, 1},
               {"mass", masses_are_checked, 1}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    TCase *tcase = tcase_create(cases[k].name);
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, cases[k].test, 0, cases[k].count);
    suite_add_tcase(suite, tcase);
  }
  return suite_run(suite);
}
