/* Steps of a body against rigid objects that move: what sticks stays, a step that is taken back
 * leaves no trace, the penalties do not matter, objects and self-contact together. */
#include <cblas.h>
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/verify/contact_pair.h"
#include "solver/verify/slider.h"
#include "tests/physics/forces.h"
#include "tests/unit/suite.h"

static const double none[3] = {0};
static const struct material_spec rubber = {
    .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 5};

/* A block of 0.3 x 1 x 1 held at x = 0, and objects at its other sides. */
struct rig {
  struct verify_run run;
  struct verify_body body;
  struct rigid_shape *shape;
  struct slider slider;
  struct error error;
};

static void block_map(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  memcpy(x, s, 3 * sizeof *x);
  x[0] *= 0.3;
}

static void rig_mesh(struct rig *rig) {
  const struct body body = {.blocks = 1, .cells = {2, 3, 3}, .map = block_map};
  openblas_set_num_threads(1);
  *rig = (struct rig){.shape = NULL};
  ck_assert_int_eq(body_build(&body, &rig->body.mesh), STATUS_OK);
  rig->body.mesh.wall_thickness = 0.3;
  body_hold(&rig->body.mesh, 0, 0, HOLD_ALL);
}

/* The body's model, and `shape`, which becomes the rig's, at `pose`. */
static void rig_open(struct rig *rig, bool contact, struct rigid_shape *shape,
                     const struct rigid_pose *pose, double friction) {
  rig->shape = shape;
  ck_assert_int_eq(verify_body_open(&rig->body, &rubber, contact, &rig->error), STATUS_OK);
  ck_assert_int_eq(
      slider_open(&rig->slider, &rig->body, shape, pose, friction, &rig->run, &rig->error),
      STATUS_OK);
}

static void rig_close(struct rig *rig) {
  slider_close(&rig->slider);
  verify_body_close(&rig->run, &rig->body);
  rigid_shape_destroy(rig->shape);
}

static void rig_move(struct rig *rig, double x, double y, double z, int steps) {
  enum status status = slider_move(&rig->slider, (double[3]){x, y, z}, none, steps, &rig->error);
  ck_assert_msg(status == STATUS_OK, "%s", rig->error.message);
}

/* A plane that faces the block's free side, pressed on it by `way`. */
static void pressed_open(struct rig *rig, double friction, double way, double eps_factor,
                         double tangential_factor) {
  struct rigid_shape *plane;
  const double place[3] = {0.3, 0, 0}, axis[3] = {-1, 0, 0};
  struct rigid_pose pose = rigid_pose_upright(place, axis);
  rig_mesh(rig);
  ck_assert_int_eq(rigid_shape_create_plane(&plane, &rig->error), STATUS_OK);
  rig_open(rig, false, plane, &pose, friction);
  struct obstacle *o = rig->body.model->obstacle[0];
  o->stiffness *= eps_factor;
  o->tangential *= tangential_factor;
  rig->slider.solver->options.force_tolerance = 1e-7;
  rig_move(rig, -way, 0, 0, 1);
}

static double friction_ratio(const struct rig *rig) {
  const double *force = rig->slider.now.force;
  return hypot(force[1], force[2]) / fabs(force[0]);
}

/* Below the limit nothing slips and nothing creeps; beyond it the force is mu N. */
START_TEST(sticks_up_to_the_limit) {
  const double friction = 0.5;
  struct rig rig;
  pressed_open(&rig, friction, 0.01, 1, 1);
  rig_move(&rig, 0, 0.002, 0, 1);
  const struct obstacle_state held = rig.slider.now;
  ck_assert_double_eq(held.slip_share, 0);
  ck_assert_double_gt(friction_ratio(&rig), 0.02);
  ck_assert_double_lt(friction_ratio(&rig), friction);
  for (int k = 0; k < 10; k++) {
    rig_move(&rig, 0, 0, 0, 1);
  }
  for (int i = 0; i < 3; i++) {
    ck_assert_double_eq_tol(rig.slider.now.force[i], held.force[i], 1e-6 * held.normal_force);
  }
  ck_assert_double_eq(rig.slider.now.friction_total, 0);
  for (int k = 0; k < 8; k++) {
    rig_move(&rig, 0, 0.02, 0.01, 1);
    ck_assert_double_lt(friction_ratio(&rig), friction * (1 + 1e-6));
  }
  ck_assert_double_eq_tol(rig.slider.now.slip_share, 1, 1e-12);
  ck_assert_double_eq_tol(friction_ratio(&rig), friction, 1e-5 * friction);
  /* The friction on the object is against its motion. */
  ck_assert_double_lt(rig.slider.now.force[1], 0);
  ck_assert_double_gt(rig.slider.now.friction_work, 0);
  rig_close(&rig);
}
END_TEST

/* A body that partly slips, with both penalties a third and three times of what they are. */
START_TEST(penalties_do_not_matter) {
  static const double factor[][2] = {
      {1, 1}, {3, 3}, {1.0 / 3, 1.0 / 3}, {3, 1.0 / 3}, {1.0 / 3, 3}};
  double first[3] = {0};
  for (size_t k = 0; k < sizeof factor / sizeof *factor; k++) {
    struct rig rig;
    pressed_open(&rig, 0.4, 0.015, factor[k][0], factor[k][1]);
    rig_move(&rig, 0, 0.02, 0, 4);
    rig_move(&rig, 0, 0, 0.01, 2);
    const struct obstacle_state *now = &rig.slider.now;
    ck_assert_double_gt(now->slip_share, 0.05);
    for (int i = 0; i < 3; i++) {
      first[i] = k == 0 ? now->force[i] : first[i];
      ck_assert_double_eq_tol(now->force[i], first[i], 5e-3 * fabs(first[0]));
    }
    rig_close(&rig);
  }
}
END_TEST

/* A step that fails half-way and is taken back, then another: as if it had not been. */
START_TEST(step_taken_back_leaves_no_trace) {
  struct rig rig[2];
  for (int k = 0; k < 2; k++) {
    pressed_open(&rig[k], 0.4, 0.015, 1, 1);
    rig_move(&rig[k], 0, 0.01, 0, 2);
    if (k == 1) {
      struct rigid_pose far = rig[k].slider.pose;
      far.place[0] -= 0.08;
      far.place[2] += 0.2;
      rig[k].slider.solver->options.max_iterations = 2;
      ck_assert_int_ne(slider_step(&rig[k].slider, &far), STATUS_OK);
      rig[k].slider.solver->options.max_iterations = 30;
    }
    rig_move(&rig[k], 0, 0.005, 0.005, 2);
  }
  const struct fe_model *m = rig[0].body.model;
  const struct fe_state *a = &rig[0].body.state, *b = &rig[1].body.state;
  ck_assert_mem_eq(a->u, b->u, 3 * sizeof *a->u * (size_t)m->mesh->node_count);
  for (int i = 0; i < QUAD9_POINTS * m->contact.face_count; i++) {
    ck_assert_double_eq(a->memory[i].pressure, b->memory[i].pressure);
    for (int d = 0; d < 3; d++) {
      ck_assert_double_eq(a->memory[i].traction[d], b->memory[i].traction[d]);
      ck_assert_double_eq(a->memory[i].anchor[d], b->memory[i].anchor[d]);
    }
  }
  ck_assert_double_eq(rig[0].slider.now.friction_total, rig[1].slider.now.friction_total);
  ck_assert_double_eq(rig[0].slider.now.motion_total, rig[1].slider.now.motion_total);
  rig_close(&rig[0]);
  rig_close(&rig[1]);
}
END_TEST

/* The first components of the force that the support has to add, against that of the objects. */
static void check_support(const struct rig *rig, int components) {
  struct fe_model *m = rig->body.model;
  struct forces base = forces_at_base(m, &rig->body.state, 0);
  double sum[3] = {base.force[0], base.force[1], base.force[2]};
  for (int k = 0; k < m->obstacle_count; k++) {
    struct obstacle_state state = model_obstacle_state(m, k);
    for (int i = 0; i < 3; i++) {
      sum[i] -= state.force[i];
    }
  }
  for (int i = 0; i < components; i++) {
    ck_assert_double_eq_tol(sum[i], 0, 2e-4 * base.size + 1e-6);
  }
}

/* A plane on the free side, and a sphere pressed into another side. */
START_TEST(two_objects) {
  struct rigid_shape *sphere;
  struct rig rig;
  int second;
  const double place[3] = {0.3, 0, 0}, axis[3] = {-1, 0, 0};
  struct rigid_pose pose = rigid_pose_upright(place, axis), ball = rigid_pose_identity();
  struct rigid_shape *plane;
  rig_mesh(&rig);
  ck_assert_int_eq(rigid_shape_create_plane(&plane, &rig.error), STATUS_OK);
  ck_assert_int_eq(rigid_shape_create_sphere(0.6, &sphere, &rig.error), STATUS_OK);
  rig.shape = plane;
  ck_assert_int_eq(verify_body_open(&rig.body, &rubber, false, &rig.error), STATUS_OK);
  ck_assert_int_eq(model_add_obstacle(rig.body.model, sphere, 0.3, &second, &rig.error), STATUS_OK);
  ck_assert_int_eq(slider_open(&rig.slider, &rig.body, plane, &pose, 0.5, &rig.run, &rig.error),
                   STATUS_OK);
  rig.slider.solver->options.force_tolerance = 1e-6;
  ball.place[0] = 0.24; /* clear of the faces that end on the support */
  ball.place[1] = 0.5;
  ball.place[2] = 1.3 - 0.008;
  model_place_obstacle(rig.body.model, second, &ball);
  rig_move(&rig, -0.01, 0, 0, 1);
  rig_move(&rig, 0, 0.02, 0, 2);
  struct obstacle_state state = model_obstacle_state(rig.body.model, second);
  ck_assert_double_gt(state.force[2], 0);
  ck_assert_int_gt(state.touching, 0);
  ck_assert_double_gt(rig.slider.now.force[0], 0);
  ck_assert_double_lt(rig.slider.now.force[1], 0);
  check_support(&rig, 3);
  rig_close(&rig);
  rigid_shape_destroy(sphere);
}
END_TEST

/* Two cubes that a plane presses on each other: all three forces are one. */
START_TEST(object_and_self_contact) {
  const double gap = 1e-3, place[3] = {2 + gap, 0, 0}, axis[3] = {-1, 0, 0};
  struct rigid_pose pose = rigid_pose_upright(place, axis);
  struct rigid_shape *plane;
  struct rig rig = {.shape = NULL};
  openblas_set_num_threads(1);
  ck_assert_int_eq(contact_blocks_build(2, gap, &rig.body.mesh), STATUS_OK);
  body_hold(&rig.body.mesh, 0, 0, HOLD_ALL);
  body_hold(&rig.body.mesh, 1, 0, HOLD_Y);
  body_hold(&rig.body.mesh, 2, 0, HOLD_Z);
  ck_assert_int_eq(rigid_shape_create_plane(&plane, &rig.error), STATUS_OK);
  rig_open(&rig, true, plane, &pose, 0.4);
  rig.slider.solver->options.traction_tolerance = 1e-6;
  rig.slider.solver->options.force_tolerance = 1e-6;
  rig_move(&rig, -0.05, 0, 0, 4);
  struct contact_summary between = contact_summarise(&rig.body.model->contact);
  double force = rig.slider.now.force[0];
  ck_assert_double_gt(force, 0.02);
  ck_assert_double_eq_tol(between.force, force, 1e-3 * force);
  check_support(&rig, 1);
  rig_close(&rig);
}
END_TEST

/* A drum with a rounded rim is pulled out sideways under the block: its edge passes along below the
 * block until nothing touches any more. */
START_TEST(slides_off_a_rim) {
  const double place[3] = {0.3 + 0.5, 0.1, 0.5}, axis[3] = {-1, 0, 0};
  struct rigid_pose pose = rigid_pose_upright(place, axis);
  struct rigid_shape *drum;
  struct rig rig;
  rig_mesh(&rig);
  ck_assert_int_eq(rigid_shape_create_cylinder(1.5, 1, 0.05, &drum, &rig.error), STATUS_OK);
  rig_open(&rig, false, drum, &pose, 0.4);
  rig_move(&rig, -0.01, 0, 0, 1);
  double area = rig.slider.now.area, total = 0;
  ck_assert_double_gt(area, 0.5);
  for (int k = 0; k < 20; k++) {
    rig_move(&rig, 0, 0.1, 0, 1);
    ck_assert_double_ge(rig.slider.now.friction_work, 0);
    total += rig.slider.now.friction_work;
    check_support(&rig, 3);
  }
  ck_assert_int_eq(rig.slider.now.touching, 0);
  ck_assert_double_gt(total, 0);
  ck_assert_double_eq_tol(rig.slider.now.motion_total, total, 0.1 * total);
  ck_assert_int_lt(rig.slider.steps, 60);
  rig_close(&rig);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("steps against objects");
  TCase *steps = tcase_create("steps");
  tcase_set_timeout(steps, 120);
  tcase_add_test(steps, sticks_up_to_the_limit);
  tcase_add_test(steps, penalties_do_not_matter);
  tcase_add_test(steps, step_taken_back_leaves_no_trace);
  tcase_add_test(steps, two_objects);
  tcase_add_test(steps, object_and_self_contact);
  tcase_add_test(steps, slides_off_a_rim);
  suite_add_tcase(suite, steps);
  return suite_run(suite);
}
