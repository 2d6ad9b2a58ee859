/* Patch test: a distorted mesh reproduces every homogeneous deformation. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/vec3.h"
#include "tests/physics/body.h"
#include "tests/physics/newton.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

static const struct material_spec materials[] = {
    {.model = MATERIAL_NEO_HOOKE,
     .terms = 1,
     .c = {0.4e6},
     .bulk_ratio = 1000,
     .name = "neo-Hooke"},
    {.model = MATERIAL_YEOH,
     .terms = 3,
     .c = {0.25e6, -0.05e6, 0.005e6},
     .bulk_ratio = 1000,
     .name = "Yeoh"},
    {.model = MATERIAL_MOONEY_RIVLIN,
     .terms = 2,
     .c = {0.293e6, 0.177e6},
     .bulk_ratio = 1000,
     .name = "Mooney-Rivlin"},
    {.model = MATERIAL_OGDEN,
     .terms = 3,
     .c = {0.63e6, 0.0012e6, -0.01e6},
     .alpha = {1.3, 5, -2},
     .bulk_ratio = 1000,
     .name = "Ogden"},
};
enum { MATERIALS = sizeof materials / sizeof *materials };

/* Deformation gradients: small, finite stretch with shear, finite with a large rotation. */
static const double deformations[][9] = {
    {1 + 1e-4, 2e-4, -1e-4, 0, 1 - 2e-4, 3e-4, 1e-4, 0, 1 + 2e-4},
    {1.4, 0.5, 0.1, -0.2, 0.9, 0.3, 0.1, -0.1, 0.7},
    {0.1, -1.3, 0.2, 0.9, 0.2, -0.1, 0.3, 0.1, 0.9},
};
static const char *const deformation_names[] = {"strain 1e-4", "stretch and shear",
                                                "with a large rotation"};
enum { DEFORMATIONS = sizeof deformations / sizeof *deformations };

/* Every node but those of the flat sides is moved, middle nodes too. */
static void distorted(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  unsigned seed = (unsigned)(1 + lrint(1000 * s[0]) * 7919 + lrint(1000 * s[1]) * 104729 +
                             lrint(1000 * s[2]) * 1299709);
  for (int i = 0; i < 5; i++) {
    body_random(&seed);
  }
  for (int d = 0; d < 3; d++) {
    bool inside = s[d] > 0 && s[d] < 1;
    x[d] = s[d] * (d == 0 ? 3 : 2) + (inside ? 0.06 * body_random(&seed) : 0);
  }
}

static void build(struct mesh *mesh) {
  struct body body = {.blocks = 1, .cells = {3, 2, 2}, .map = distorted};
  body_build(&body, mesh);
}

/* Exact state of the deformation gradient f. */
static void set_homogeneous(const struct fe_model *m, const double f[9], struct fe_state *state) {
  struct kinematics k;
  memcpy(k.f, f, sizeof k.f);
  kinematics_complete(&k);
  for (int n = 0; n < m->mesh->node_count; n++) {
    double x[3];
    mat3_apply(f, m->mesh->x + 3 * n, x);
    for (int i = 0; i < 3; i++) {
      state->u[3 * n + i] = x[i] - m->mesh->x[3 * n + i];
    }
  }
  for (int e = 0; e < m->mesh->element_count; e++) {
    state->p[ELEMENT_PRESSURES * e] = m->bulk_modulus * (k.j - 1);
  }
}

/* Largest entry of the residual and of any element's share of it. */
static void residual_size(struct fe_model *m, const struct fe_state *state, double *residual,
                          double *scale) {
  struct fe_load none = {0};
  ck_assert_int_eq(model_evaluate(m, state, &none, true), STATUS_OK);
  *residual = *scale = 0;
  for (int i = 0; i < m->dof_count; i++) {
    *residual = fmax(*residual, fabs(m->residual[i]));
  }
  for (int e = 0; e < m->mesh->element_count; e++) {
    double u[3][HEX27_STRIDE], r[ELEMENT_DOFS];
    model_gather(m, state->u, e, u);
    element_evaluate(&m->geometry[e], &m->material, m->bulk_modulus, u,
                     state->p + ELEMENT_PRESSURES * e, m->work, r, NULL, &m->internal[e]);
    for (int i = 0; i < ELEMENT_DOFS; i++) {
      *scale = fmax(*scale, fabs(r[i]));
    }
  }
}

static void solve_patch(const struct mesh *mesh, const struct material_spec *material,
                        const double f[9], const char *deformation) {
  struct fe_model *m = body_model(mesh, material);
  char what[80];
  struct fe_state exact, state;
  ck_assert_int_eq(state_create(m, &exact), STATUS_OK);
  ck_assert_int_eq(state_create(m, &state), STATUS_OK);
  set_homogeneous(m, f, &exact);
  double residual, scale, size = 0, error = 0;
  residual_size(m, &exact, &residual, &scale);
  ck_assert_msg(residual < 1e-10 * scale, "%s: residual %.2e of %.2e", material->name, residual,
                scale);
  /* From a disturbed interior the solution has to come back. */
  state_copy(m, &state, &exact);
  unsigned seed = 5;
  for (int d = 0; d < 3 * mesh->node_count; d++) {
    size = fmax(size, fabs(exact.u[d]));
  }
  for (int d = 0; d < 3 * mesh->node_count; d++) {
    state.u[d] += mesh->fixed[d] ? 0 : 0.03 * fmin(size, 1) * body_random(&seed);
  }
  memset(state.p, 0, sizeof *state.p * ELEMENT_PRESSURES * (size_t)mesh->element_count);
  struct fe_load none = {0};
  enum status status = newton_solve(m, &none, &state, 1e-12, NULL);
  ck_assert_msg(status == STATUS_OK, "%s: %s", material->name, status_word(status));
  for (int d = 0; d < 3 * mesh->node_count; d++) {
    error = fmax(error, fabs(state.u[d] - exact.u[d]));
  }
  ck_assert_msg(error < 1e-10 * size, "%s: error %.2e of %.2e", material->name, error, size);
  snprintf(what, sizeof what, "patch test, %s, %s", material->name, deformation);
  report_value(what, "3 x 2 x 2, distorted", 0, error / size);
  state_release(&state);
  state_release(&exact);
  model_destroy(m);
}

START_TEST(homogeneous_deformation_is_reproduced) {
  struct mesh mesh;
  build(&mesh);
  unsigned char *boundary = malloc((size_t)mesh.node_count);
  ck_assert_ptr_nonnull(boundary);
  body_mark_boundary(&mesh, boundary);
  int interior = 0;
  for (int n = 0; n < mesh.node_count; n++) {
    memset(mesh.fixed + 3 * n, boundary[n], 3);
    interior += !boundary[n];
  }
  free(boundary);
  ck_assert_int_eq(interior, 5 * 3 * 3);
  solve_patch(&mesh, &materials[_i / DEFORMATIONS], deformations[_i % DEFORMATIONS],
              deformation_names[_i % DEFORMATIONS]);
  mesh_release(&mesh);
}
END_TEST

START_TEST(rigid_motion_leaves_no_residual) {
  struct mesh mesh;
  build(&mesh);
  struct fe_model *m = body_model(&mesh, &materials[_i]);
  struct fe_state state;
  ck_assert_int_eq(state_create(m, &state), STATUS_OK);
  double r[9], residual, scale;
  rotation_matrix((double[3]){1.9, -0.8, 1.1}, r);
  set_homogeneous(m, r, &state);
  for (int n = 0; n < mesh.node_count; n++) {
    state.u[3 * n] += 17;
  }
  memset(state.p, 0, sizeof *state.p * ELEMENT_PRESSURES * (size_t)mesh.element_count);
  residual_size(m, &state, &residual, &scale);
  double stiffness = 0; /* force of a unit displacement */
  for (int i = 0; i < ELEMENT_PACKED; i++) {
    stiffness = fmax(stiffness, fabs(m->element_value[i]));
  }
  ck_assert_msg(residual < 1e-12 * stiffness, "residual %.2e, stiffness %.2e", residual, stiffness);
  state_release(&state);
  model_destroy(m);
  mesh_release(&mesh);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("patch test");
  TCase *patch = tcase_create("patch");
  tcase_set_timeout(patch, 60);
  tcase_add_loop_test(patch, homogeneous_deformation_is_reproduced, 0, MATERIALS * DEFORMATIONS);
  tcase_add_loop_test(patch, rigid_motion_leaves_no_residual, 0, MATERIALS);
  suite_add_tcase(suite, patch);
  return suite_run(suite);
}
