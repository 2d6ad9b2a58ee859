/* Stresses and tangents of the materials against central differences; bodies at rest. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "solver/fe/pressure.h"
#include "solver/base/vec3.h"
#include "solver/verify/report.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

static const struct material_spec materials[] = {
    {.model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {0.4}, .bulk_ratio = 50, .name = "neo-Hooke"},
    {.model = MATERIAL_YEOH,
     .terms = 3,
     .c = {0.25, -0.05, 0.005},
     .bulk_ratio = 50,
     .name = "Yeoh"},
    {.model = MATERIAL_MOONEY_RIVLIN,
     .terms = 2,
     .c = {0.293, 0.177},
     .bulk_ratio = 50,
     .name = "Mooney-Rivlin"},
    {.model = MATERIAL_OGDEN,
     .terms = 3,
     .c = {0.63, 0.0012, -0.01},
     .alpha = {1.3, 5, -2},
     .bulk_ratio = 50,
     .name = "Ogden"},
};
enum { MATERIALS = sizeof materials / sizeof *materials };

/* ---- material ---- */

struct material_case {
  const struct material_spec *material;
  double f[9], direction[9], stress[9], tangent[81];
};

static double material_at(const struct material_case *c, double h, double stress[9]) {
  struct kinematics k;
  for (int i = 0; i < 9; i++) {
    k.f[i] = c->f[i] + h * c->direction[i];
  }
  kinematics_complete(&k);
  return hyperelastic_isochoric(c->material, &k, stress, NULL);
}

static double stress_error(void *context, double h) {
  struct material_case *c = context;
  double unused[9], exact = 0;
  double a = material_at(c, -h, unused), b = material_at(c, h, unused);
  for (int i = 0; i < 9; i++) {
    exact += c->stress[i] * c->direction[i];
  }
  return verify_difference_error(1, &a, &b, h, &exact);
}

static double tangent_error(void *context, double h) {
  struct material_case *c = context;
  double a[9], b[9], exact[9] = {0};
  material_at(c, -h, a);
  material_at(c, h, b);
  for (int i = 0; i < 81; i++) {
    exact[i / 9] += c->tangent[i] * c->direction[i % 9];
  }
  return verify_difference_error(9, a, b, h, exact);
}

static void prepare_material(struct material_case *c, int index, const double f[9]) {
  unsigned seed = 11;
  c->material = &materials[index];
  memcpy(c->f, f, sizeof c->f);
  for (int i = 0; i < 9; i++) {
    c->direction[i] = body_random(&seed);
  }
  struct kinematics k;
  memcpy(k.f, f, sizeof k.f);
  kinematics_complete(&k);
  hyperelastic_isochoric(c->material, &k, c->stress, c->tangent);
}

START_TEST(stress_and_tangent_of_the_material) {
  static const double f[9] = {1.5, 0.4, -0.2, 0.3, 0.8, 0.25, -0.1, 0.35, 1.1};
  struct material_case c;
  char stress_name[100], tangent_name[100];
  prepare_material(&c, _i, f);
  snprintf(stress_name, sizeof stress_name, "stress from energy, %s", c.material->name);
  snprintf(tangent_name, sizeof tangent_name, "tangent from stress, %s", c.material->name);
  report_second_order(stress_name, stress_error, &c, 0.05, 4, 1e-8);
  report_second_order(tangent_name, tangent_error, &c, 0.05, 4, 1e-9);
  for (int i = 0; i < 81; i++) {
    ck_assert_double_eq_tol(c.tangent[i], c.tangent[i % 9 * 9 + i / 9], 1e-13);
  }
}
END_TEST

/* Equal principal stretches are a special case of laws in principal axes. */
START_TEST(tangent_at_equal_stretches) {
  static const double f[][9] = {
      {1, 0, 0, 0, 1, 0, 0, 0, 1}, {1.3, 0, 0, 0, 1.3, 0, 0, 0, 0.6}, {0, -2, 0, 2, 0, 0, 0, 0, 2}};
  for (int k = 0; k < 3; k++) {
    struct material_case c;
    prepare_material(&c, _i, f[k]);
    ck_assert_double_lt(tangent_error(&c, 1e-5), 1e-8);
  }
}
END_TEST

/* ---- element and pressure load ---- */

/* A brick of 2 x 0.5 x 2 with a slanted side. */
static void brick(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  x[0] = 5 + 2 * s[0] + 0.3 * s[1];
  x[1] = -3 + 0.5 * s[1];
  x[2] = 2 * s[2];
}

START_TEST(rigid_motion_leaves_no_residual) {
  struct body body = {.blocks = 1, .cells = {1, 1, 1}, .map = brick};
  struct verify_run run = {.refinement = 1};
  struct verify_body b = {.model = NULL};
  struct fe_load none = {0};
  double r[9], x[3], residual = 0, stiffness = 0; /* force, and that of a unit displacement */
  ck_assert_int_eq(body_build(&body, &b.mesh), STATUS_OK);
  ck_assert_int_eq(verify_body_open(&b, &materials[_i], false, NULL), STATUS_OK);
  rotation_matrix((double[3]){1.9, -0.8, 1.1}, r);
  for (int n = 0; n < b.mesh.node_count; n++) {
    mat3_apply(r, b.mesh.x + 3 * n, x);
    for (int i = 0; i < 3; i++) {
      b.state.u[3 * n + i] = x[i] - b.mesh.x[3 * n + i] + (i == 0 ? 17 : 0);
    }
  }
  ck_assert_int_eq(model_evaluate(b.model, &b.state, &none, true), STATUS_OK);
  for (int i = 0; i < b.model->dof_count; i++) {
    residual = fmax(residual, fabs(b.model->residual[i]));
  }
  for (int i = 0; i < ELEMENT_PACKED; i++) {
    stiffness = fmax(stiffness, fabs(b.model->element_value[i]));
  }
  ck_assert_msg(residual < 1e-12 * stiffness, "residual %.2e, stiffness %.2e", residual, stiffness);
  verify_body_close(&run, &b);
}
END_TEST

START_TEST(volume_of_a_box) {
  struct body body = {.blocks = 1, .cells = {1, 1, 1}, .map = brick};
  struct quad9_tables tables;
  struct mesh mesh;
  double volume = 0;
  quad9_tables_fill(&tables);
  ck_assert_int_eq(body_build(&body, &mesh), STATUS_OK);
  ck_assert_int_eq(mesh.face_count, 6);
  for (int f = 0; f < 6; f++) {
    int nodes[QUAD9_NODES];
    double x[QUAD9_NODES][3], force[FACE_DOFS];
    mesh_face_nodes(&mesh, &mesh.faces[f], nodes);
    for (int a = 0; a < QUAD9_NODES; a++) {
      memcpy(x[a], mesh.x + 3 * nodes[a], sizeof x[a]);
    }
    volume -= pressure_face(&tables, x, mesh.faces[f].side, force);
  }
  ck_assert_double_eq_tol(volume, 2, 1e-14);
  mesh_release(&mesh);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("tangents");
  TCase *tangent = tcase_create("tangents");
  tcase_set_timeout(tangent, 60);
  tcase_add_loop_test(tangent, stress_and_tangent_of_the_material, 0, MATERIALS);
  tcase_add_loop_test(tangent, tangent_at_equal_stretches, 0, MATERIALS);
  tcase_add_loop_test(tangent, rigid_motion_leaves_no_residual, 0, MATERIALS);
  tcase_add_test(tangent, volume_of_a_box);
  suite_add_tcase(suite, tangent);
  return suite_run(suite);
}
