/* Bodies with two oblique rows: homogeneous deformation of the sheared mesh, mirror images, the
 * limit of an ordinary pneu-net, what twists and what does not, contact between oblique walls. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/vec3.h"
#include "solver/job/parameter.h"
#include "solver/mesh/actuator.h"
#include "solver/mesh/grid.h"
#include "solver/post/result_sensitivity.h"
#include "solver/post/sample.h"
#include "tests/physics/oblique_case.h"
#include "tests/physics/pneunet_case.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

static const double degree = M_PI / 180;

/* Under an isochoric homogeneous deformation no inner node carries a force: the patch test of the
 * mesh, whose elements are skewed, kinked in the middle and wedges in the solid ends. */
START_TEST(homogeneous_deformation_is_in_equilibrium) {
  static const double f[9] = {1.25, 0.3, -0.1, 0, 0.8, 0.2, 0, 0, 1}; /* det 1 */
  static const double angles[] = {0, 15, 45, 75};
  struct job_spec spec;
  struct solve s = {.model = NULL};
  oblique_prototype(&spec, angles[_i], 3);
  spec.oblique.has_channel = _i % 2 == 0;
  spec.load.steps = 1;
  ck_assert_int_eq(actuator_mesh(&spec, &s.mesh, NULL), STATUS_OK);
  ck_assert_int_eq(solve_prepare(&spec, &s, NULL), STATUS_OK);
  unsigned char *boundary = calloc((size_t)s.mesh.node_count, 1);
  ck_assert_ptr_nonnull(boundary);
  for (int n = 0; n < s.mesh.node_count; n++) {
    const double *x = s.mesh.x + 3 * n;
    mat3_apply(f, x, s.state.u + 3 * n);
    for (int i = 0; i < 3; i++) {
      s.state.u[3 * n + i] -= x[i];
    }
  }
  for (int k = 0; k < s.mesh.face_count; k++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(&s.mesh, &s.mesh.faces[k], nodes);
    for (int m = 0; m < QUAD9_NODES; m++) {
      boundary[nodes[m]] = 1;
    }
  }
  struct fe_load none = {0};
  double inner = 0, outer = 0;
  ck_assert_int_eq(model_evaluate(s.model, &s.state, &none, false), STATUS_OK);
  for (int d = 0; d < s.model->dof_count; d++) {
    double *most = boundary[s.model->node_of[d]] ? &outer : &inner;
    *most = fmax(*most, fabs(s.model->residual[d]));
  }
  ck_assert_double_gt(outer, 0);
  ck_assert_double_lt(inner, 1e-11 * outer);
  free(boundary);
  solve_release(&s);
}
END_TEST

/* At 0 degrees, without a wall between the rows and with ends that add nothing, it is a pneu-net
 * with chambers of configuration B. */
START_TEST(straight_rows_are_a_pneunet) {
  struct job_spec spec, plain;
  struct solve oblique;
  struct pneunet_case c;
  oblique_prototype(&spec, 0, 3);
  struct oblique_spec *p = &spec.oblique;
  p->centre_wall = 0;
  p->length += 2 * (1e-6 - p->end);
  p->end = 1e-6;
  spec.half_model = true;
  oblique_follow(&spec, &oblique);
  case_prototype(&plain, 3);
  plain.mesh = spec.mesh;
  plain.material = spec.material;
  plain.load = spec.load;
  struct pneunet_spec *q = &plain.pneunet;
  q->length = p->length - 2 * p->end;
  q->width = p->width;
  q->height_base = q->height_tip = p->height;
  q->cavity_length = p->cavity;
  q->chamber_gap = p->chamber_gap;
  q->gap_wall = p->gap_wall;
  q->side_wall = p->side_wall;
  q->top_wall = p->top_wall;
  q->bottom_layer = p->bottom_layer;
  q->taper_left = q->taper_right = 0;
  q->has_channel = false;
  case_open(&c, &plain);
  case_follow(&c);
  struct sample a = {0}, b = {0};
  ck_assert_int_eq(sample_measure(oblique.model, &oblique.state, &a), STATUS_OK);
  ck_assert_int_eq(sample_measure(c.model, &c.state, &b), STATUS_OK);
  report_check("straight rows, deflection against a pneu-net, mm", "coarse", 1e3 * b.tip_deflection,
               1e3 * a.tip_deflection, 1e-3);
  report_check("straight rows, cavities against a pneu-net, mm3", "coarse", 1e9 * b.cavity_volume,
               1e9 * a.cavity_volume, 1e-4);
  case_close(&c);
  solve_release(&oblique);
}
END_TEST

/* The row that is under pressure decides to which side the body goes, and nothing else. */
START_TEST(exchanged_pressures_give_the_mirror_image) {
  struct job_spec spec;
  struct solve s[2];
  struct sample sample[2] = {{0}};
  oblique_prototype(&spec, 45, 2);
  spec.contact = true;
  for (int k = 0; k < 2; k++) {
    spec.load.cavity_share[k] = 1;
    spec.load.cavity_share[1 - k] = 0.25;
    oblique_follow(&spec, &s[k]);
    ck_assert_int_eq(sample_measure(s[k].model, &s[k].state, &sample[k]), STATUS_OK);
  }
  const struct mesh *mesh = &s[0].mesh;
  double most = 0, difference = 0;
  for (int n = 0; n < mesh->node_count; n += 5) {
    const double *x = mesh->x + 3 * n, *u = s[0].state.u + 3 * n;
    int twin = grid_find_node(mesh, (double[3]){x[0], -x[1], x[2]}, mesh->node_section[n]);
    const double *v = s[1].state.u + 3 * twin;
    for (int i = 0; i < 3; i++) {
      most = fmax(most, fabs(u[i]));
      difference = fmax(difference, fabs(u[i] - (i == 1 ? -v[i] : v[i])));
    }
  }
  ck_assert_double_lt(difference, 1e-9 * most);
  ck_assert_double_gt(fabs(sample[0].spatial.twist), 1e-3);
  ck_assert_double_eq_tol(sample[0].spatial.twist, -sample[1].spatial.twist, 1e-10);
  ck_assert_double_eq_tol(sample[0].spatial.bending, sample[1].spatial.bending, 1e-10);
  solve_release(&s[0]);
  solve_release(&s[1]);
}
END_TEST

/* Equal pressures: no twist to round-off in the whole model, which bends as its half. */
START_TEST(equal_pressures_do_not_twist) {
  struct job_spec spec;
  struct solve whole, half;
  struct sample a = {0}, b = {0};
  oblique_prototype(&spec, 45, 2);
  spec.contact = true;
  spec.load.gravity[0] = 9.80665;
  oblique_follow(&spec, &whole);
  spec.half_model = true;
  oblique_follow(&spec, &half);
  ck_assert_int_eq(sample_measure(whole.model, &whole.state, &a), STATUS_OK);
  ck_assert_int_eq(sample_measure(half.model, &half.state, &b), STATUS_OK);
  ck_assert_double_gt(a.spatial.bending, 1 * degree);
  ck_assert_double_eq_tol(a.spatial.twist, 0, 1e-10);
  ck_assert_double_eq_tol(a.spatial.side_bending, 0, 1e-10);
  ck_assert_double_eq_tol(a.shape.tip[1], 0, 1e-12);
  ck_assert_double_eq_tol(a.spatial.bending, b.spatial.bending, 1e-9);
  ck_assert_double_eq_tol(a.cavity_volume / b.cavity_volume, 1, 1e-9);
  solve_release(&whole);
  solve_release(&half);
}
END_TEST

/* Straight chambers under one row's pressure bend the body sideways without twist worth the name;
 * the oblique ones twist it. */
START_TEST(oblique_walls_turn_bending_into_twist) {
  struct job_spec spec;
  double share[2];
  for (int k = 0; k < 2; k++) {
    struct solve s;
    struct sample a = {0};
    oblique_prototype(&spec, k == 0 ? 0 : 45, 3);
    spec.load.cavity_share[1] = 0;
    spec.load.steps = 1;
    oblique_follow(&spec, &s);
    ck_assert_int_eq(sample_measure(s.model, &s.state, &a), STATUS_OK);
    share[k] = fabs(a.spatial.twist) / hypot(a.spatial.bending, a.spatial.side_bending);
    solve_release(&s);
  }
  ck_assert_double_gt(share[1], 0.3);
  ck_assert_double_gt(share[1], 3 * share[0]);
}
END_TEST

/* The derivative of the tip to the shear modulus, of a body whose rows have unequal pressures,
 * against differences; what the samples of a twisted body mean otherwise is left out. */
START_TEST(derivatives_know_the_pressures_of_the_rows) {
  struct job_spec spec;
  struct solve s[3];
  const double modulus[3] = {0.4e6, 0.4e6 - 200, 0.4e6 + 200};
  double tip[3];
  for (int k = 0; k < 3; k++) {
    oblique_prototype(&spec, 45, 2);
    spec.load.cavity_share[1] = 0.25;
    spec.load.steps = 1;
    spec.material.c[0] = modulus[k];
    oblique_follow(&spec, &s[k]);
    int node = s[k].mesh.centreline[s[k].mesh.section_count - 1];
    tip[k] = 1e3 * s[k].state.u[3 * node + 1];
  }
  spec.material.c[0] = modulus[0];
  spec.sensitivity.count = parameter_list(&spec, spec.sensitivity.parameter);
  struct result_sensitivity *r = NULL;
  struct path_point point = {
      .pressure = spec.load.pressure_to, .recorded = true, .state = &s[0].state};
  ck_assert_int_eq(result_sensitivity_create(&spec, s[0].model, &r, NULL), STATUS_OK);
  ck_assert_int_eq(result_sensitivity_add(r, &point), STATUS_OK);
  json_t *block = result_sensitivity_block(r);
  json_t *first = json_array_get(json_object_get(block, "parameters"), 0);
  ck_assert_str_eq(json_string_value(json_object_get(first, "parameter")), "/material/mu");
  json_t *sample = json_array_get(json_object_get(first, "samples"), 0);
  report_check("twisted rows, d tip_y / d mu, mm/MPa", "coarse", (tip[2] - tip[1]) / 400e-6,
               json_number_value(json_object_get(sample, "tip_y_mm")), 2e-4);
  ck_assert_ptr_null(json_object_get(sample, "bending_angle_deg"));
  ck_assert_ptr_null(json_object_get(sample, "cavity_volume_mm3"));
  json_decref(block);
  result_sensitivity_destroy(r);
  for (int k = 0; k < 3; k++) {
    solve_release(&s[k]);
  }
}
END_TEST

/* Neighbours whose oblique walls have met push on each other and do not pass through. */
START_TEST(oblique_walls_touch) {
  struct job_spec spec;
  struct solve s;
  struct sample a = {0};
  oblique_prototype(&spec, 45, 3);
  spec.oblique.chamber_gap = 0.0004;
  oblique_turn(&spec.oblique, 45);
  spec.contact = true;
  spec.half_model = true;
  spec.load.pressure_to = 40e3;
  oblique_follow(&spec, &s);
  ck_assert_int_eq(sample_measure(s.model, &s.state, &a), STATUS_OK);
  ck_assert_double_gt(a.contact_force, 0.1);
  ck_assert_double_gt(a.min_gap, -0.02 * spec.oblique.chamber_gap);
  solve_release(&s);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("oblique rows");
  TCase *tcase = tcase_create("oblique rows");
  tcase_set_timeout(tcase, 120);
  tcase_add_loop_test(tcase, homogeneous_deformation_is_in_equilibrium, 0, 4);
  tcase_add_test(tcase, straight_rows_are_a_pneunet);
  tcase_add_test(tcase, exchanged_pressures_give_the_mirror_image);
  tcase_add_test(tcase, equal_pressures_do_not_twist);
  tcase_add_test(tcase, oblique_walls_turn_bending_into_twist);
  tcase_add_test(tcase, derivatives_know_the_pressures_of_the_rows);
  tcase_add_test(tcase, oblique_walls_touch);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
