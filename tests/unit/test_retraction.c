/* Corotational retraction: first order, rigid increments, frames. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/fe/retraction.h"
#include "solver/base/vec3.h"
#include "solver/verify/body.h"
#include "tests/physics/pneunet_case.h"
#include "tests/unit/suite.h"
#include "solver/mesh/pneunet.h"

struct setting {
  struct mesh mesh;
  struct retraction *retraction;
  size_t size; /* of u */
  double *u, *increment, *moved;
};

static void setting_open(struct setting *s, bool half) {
  struct job_spec spec;
  case_prototype(&spec, 2);
  case_refine(&spec, 1);
  spec.half_model = half;
  ck_assert_int_eq(pneunet_mesh(&spec, &s->mesh, NULL), STATUS_OK);
  s->retraction = retraction_create(&s->mesh);
  s->size = 3 * (size_t)s->mesh.node_count;
  s->u = calloc(3 * s->size, sizeof *s->u);
  ck_assert(s->retraction && s->u);
  s->increment = s->u + s->size;
  s->moved = s->increment + s->size;
}

static void setting_close(struct setting *s) {
  free(s->u);
  retraction_destroy(s->retraction);
  mesh_release(&s->mesh);
}

/* A bent and twisted body (bent only when half). */
static void bend(struct setting *s) {
  for (int n = 0; n < s->mesh.node_count; n++) {
    const double *x = s->mesh.x + 3 * n;
    double bent[3], turn[9];
    double angle[3] = {s->mesh.half ? 0 : 20 * x[0], 40 * x[0], 0};
    rotation_matrix(angle, turn);
    mat3_apply(turn, (double[3]){0.2 * x[0], x[1], x[2]}, bent);
    for (int i = 0; i < 3; i++) {
      s->u[3 * n + i] = bent[i] + (i == 0 ? x[0] : 0) - x[i];
    }
  }
}

static double node_distance(const struct setting *s, const double *u, int a, int b) {
  double d[3];
  for (int i = 0; i < 3; i++) {
    d[i] = s->mesh.x[3 * a + i] + u[3 * a + i] - s->mesh.x[3 * b + i] - u[3 * b + i];
  }
  return vec3_norm(d);
}

/* ---- tests ---- */

/* |apply(u, h d) - (u + h d)| has to fall with h^2. */
START_TEST(equals_addition_to_first_order) {
  struct setting s;
  setting_open(&s, _i == 1);
  bend(&s);
  double previous = 0;
  for (int k = 0; k < 8; k++) {
    double h = 2e-3 / (1 << k), error = 0;
    unsigned seed = 5;
    for (size_t d = 0; d < s.size; d++) {
      bool held = s.mesh.half && d % 3 == 1 && s.mesh.x[d] == 0;
      double random = body_random(&seed);
      s.increment[d] = held ? 0 : h * (random + 100 * s.mesh.x[d - d % 3]);
    }
    memcpy(s.moved, s.u, s.size * sizeof *s.u);
    retraction_apply(s.retraction, s.moved, s.increment);
    for (size_t d = 0; d < s.size; d++) {
      error = fmax(error, fabs(s.moved[d] - s.u[d] - s.increment[d]));
    }
    if (k > 3) {
      ck_assert_double_gt(previous / error, 3.5);
      ck_assert_double_lt(previous / error, 4.5);
    }
    previous = error;
  }
  setting_close(&s);
}
END_TEST

/* w x (x - c) turns the body as a whole: by a finite rotation, without strain. */
START_TEST(rigid_increment_is_a_rotation) {
  struct setting s;
  setting_open(&s, _i == 1);
  bend(&s);
  const double w[3] = {_i == 1 ? 0 : 0.4, -1.3, _i == 1 ? 0 : 0.8}, c[3] = {0.01, 0, 0.004};
  for (int n = 0; n < s.mesh.node_count; n++) {
    double arm[3];
    for (int i = 0; i < 3; i++) {
      arm[i] = s.mesh.x[3 * n + i] + s.u[3 * n + i] - c[i];
    }
    vec3_cross(w, arm, s.increment + 3 * n);
  }
  memcpy(s.moved, s.u, s.size * sizeof *s.u);
  retraction_apply(s.retraction, s.moved, s.increment);
  double rotation[9];
  rotation_matrix(w, rotation);
  for (int n = 1; n < s.mesh.node_count; n++) {
    double before[3], after[3], turned[3];
    for (int i = 0; i < 3; i++) {
      double x = s.mesh.x[3 * n + i] - s.mesh.x[i];
      before[i] = x + s.u[3 * n + i] - s.u[i];
      after[i] = x + s.moved[3 * n + i] - s.moved[i];
    }
    mat3_apply(rotation, before, turned);
    for (int i = 0; i < 3; i++) {
      ck_assert_double_eq_tol(after[i], turned[i], 1e-14);
    }
    ck_assert_double_eq_tol(node_distance(&s, s.u, n, n / 2), node_distance(&s, s.moved, n, n / 2),
                            1e-14);
  }
  setting_close(&s);
}
END_TEST

START_TEST(zero_increment_changes_nothing) {
  struct setting s;
  setting_open(&s, _i == 1);
  bend(&s);
  memcpy(s.moved, s.u, s.size * sizeof *s.u);
  retraction_apply(s.retraction, s.moved, s.increment);
  for (size_t d = 0; d < s.size; d++) {
    ck_assert_double_eq_tol(s.moved[d], s.u[d], 1e-16);
  }
  setting_close(&s);
}
END_TEST

START_TEST(base_and_plane_of_symmetry_stay) {
  struct setting s;
  unsigned seed = 3;
  setting_open(&s, true);
  bend(&s);
  for (size_t d = 0; d < s.size; d++) {
    double random = 5e-3 * body_random(&seed);
    s.increment[d] = s.mesh.fixed[d] ? 0 : random;
  }
  memcpy(s.moved, s.u, s.size * sizeof *s.u);
  retraction_apply(s.retraction, s.moved, s.increment);
  for (size_t d = 0; d < s.size; d++) {
    if (s.mesh.fixed[d]) {
      ck_assert_double_eq_tol(s.moved[d], s.u[d], 1e-16);
    }
  }
  setting_close(&s);
}
END_TEST

START_TEST(mesh_without_sections_adds) {
  struct setting s;
  unsigned seed = 3;
  setting_open(&s, false);
  retraction_destroy(s.retraction);
  int sections = s.mesh.section_count;
  s.mesh.section_count = 0;
  s.retraction = retraction_create(&s.mesh);
  ck_assert_ptr_nonnull(s.retraction);
  for (size_t d = 0; d < s.size; d++) {
    s.u[d] = body_random(&seed);
    s.increment[d] = body_random(&seed);
    s.moved[d] = s.u[d];
  }
  retraction_apply(s.retraction, s.moved, s.increment);
  for (size_t d = 0; d < s.size; d++) {
    ck_assert_double_eq(s.moved[d], s.u[d] + s.increment[d]);
  }
  s.mesh.section_count = sections;
  setting_close(&s);
  retraction_destroy(NULL);
}
END_TEST

/* The frame of every section of a rigidly turned body is that rotation. */
START_TEST(frame_of_a_turned_body) {
  struct setting s;
  setting_open(&s, _i == 1);
  double rotation[9], frame[9], centre[3];
  const double w[3] = {_i == 1 ? 0 : -0.9, 2.2, _i == 1 ? 0 : 0.5};
  rotation_matrix(w, rotation);
  for (int n = 0; n < s.mesh.node_count; n++) {
    double x[3];
    mat3_apply(rotation, s.mesh.x + 3 * n, x);
    for (int i = 0; i < 3; i++) {
      s.u[3 * n + i] = x[i] - s.mesh.x[3 * n + i];
    }
  }
  for (int k = 0; k < s.mesh.section_count; k++) {
    retraction_frame(s.retraction, s.u, k, frame, centre);
    for (int i = 0; i < 9; i++) {
      ck_assert_double_eq_tol(frame[i], rotation[i], 1e-12);
    }
    /* Halfway up the bottom layer, on the line y = 0 turned. */
    double x[3];
    int node = s.mesh.centreline[k];
    mat3_apply(rotation, (double[3]){s.mesh.x[3 * node], 0, 0.003}, x);
    for (int i = 0; i < 3; i++) {
      ck_assert_double_eq_tol(centre[i], x[i], 1e-14);
    }
  }
  setting_close(&s);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("retraction");
  TCase *retraction = tcase_create("retraction");
  tcase_set_timeout(retraction, 60);
  tcase_add_loop_test(retraction, equals_addition_to_first_order, 0, 2);
  tcase_add_loop_test(retraction, rigid_increment_is_a_rotation, 0, 2);
  tcase_add_loop_test(retraction, zero_increment_changes_nothing, 0, 2);
  tcase_add_test(retraction, base_and_plane_of_symmetry_stay);
  tcase_add_test(retraction, mesh_without_sections_adds);
  tcase_add_loop_test(retraction, frame_of_a_turned_body, 0, 2);
  suite_add_tcase(suite, retraction);
  return suite_run(suite);
}
