/* Contact with rigid objects: tangent against differences in every regime, balance of forces. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/obstacle_internal.h"
#include "solver/base/vec3.h"
#include "solver/verify/body.h"
#include "solver/verify/report.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

enum { FACE_DOFS = 3 * QUAD9_NODES };

static void unit_cube(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  memcpy(x, s, 3 * sizeof *x);
}

/* A cube of one element and a sphere of radius 0.8, turned about its place, under one of its faces.
 */
struct contact_case {
  struct mesh mesh;
  struct fe_model *model;
  struct rigid_shape *sphere;
  struct rigid_pose pose;
  struct obstacle *object;
  int face;
  int nodes[QUAD9_NODES];
  double x[QUAD9_NODES][3]; /* of the face, crooked */
  double v[FACE_DOFS + 6];  /* a direction: of the nodes, and of the object's motion */
  double exact[FACE_DOFS];  /* the tangent along it */
  double resultant[6];      /* its derivative along it */
};

/* What the points remember, and how the sphere lies: `depth` below its top is the face. */
static const struct regime {
  const char *name;
  double depth, friction, pressure, slip; /* slip: of the points from their stick points */
  int slipping;                           /* points; -1: some */
} regimes[] = {
    {"object, frictionless, penetrating", 0.05, 0, 0, 0, 0},
    {"object, frictionless, multiplier across a gap", -0.02, 0, 3, 0, 0},
    {"object, sticking", 0.05, 0.8, 2, 0.02, 0},
    {"object, slipping", 0.05, 0.1, 2, 0.6, 9},
    {"object, slipping across a gap", -0.02, 0.1, 3, 0.6, 9},
    {"object, some points slip", 0.05, 0.125, 2, 0.2, -1},
};
enum { REGIMES = sizeof regimes / sizeof *regimes };

static const struct material_spec rubber = {
    .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 100};

/* The face z = 0 of the cube. */
static int bottom_face(const struct fe_model *m) {
  for (int f = 0; f < m->contact.face_count; f++) {
    int nodes[QUAD9_NODES];
    bool bottom = true;
    mesh_face_nodes(m->mesh, &m->contact.face[f].face, nodes);
    for (int a = 0; a < QUAD9_NODES; a++) {
      bottom = bottom && m->mesh->x[3 * nodes[a] + 2] == 0;
    }
    if (bottom) {
      return f;
    }
  }
  return -1;
}

/* Stick points `slip` away from the points in varying directions; tau well inside the disc. */
static void remember(struct contact_case *c, const struct regime *regime, unsigned *seed) {
  for (int q = 0; q < QUAD9_POINTS; q++) {
    struct obstacle_point *point = &c->object->point[QUAD9_POINTS * c->face + q];
    struct obstacle_memory *memory = &point->memory;
    double out[3], along[3], place[3] = {0}, random[3];
    memory->pressure = regime->pressure * (1 + 0.3 * body_random(seed));
    memory->held = regime->slip > 0;
    for (int a = 0; a < QUAD9_NODES; a++) {
      for (int i = 0; i < 3; i++) {
        place[i] += c->model->quad9.n[q][a] * c->x[a][i];
      }
    }
    rigid_pose_inward(&c->pose, place, place);
    for (int i = 0; i < 3; i++) {
      out[i] = place[i] / vec3_norm(place);
      random[i] = body_random(seed);
    }
    vec3_cross(out, random, along);
    for (int i = 0; i < 3; i++) {
      memory->normal[i] = out[i];
      memory->anchor[i] = place[i] - (regime->slip + 0.2 * regime->slip * body_random(seed)) *
                                         along[i] / vec3_norm(along);
      memory->traction[i] = 0.1 * along[i];
    }
  }
}

static void case_open(struct contact_case *c, const struct regime *regime) {
  const struct body body = {.blocks = 1, .cells = {1, 1, 1}, .map = unit_cube};
  struct error error = {0};
  unsigned seed = 11;
  int index;
  *c = (struct contact_case){.model = NULL};
  ck_assert_int_eq(body_build(&body, &c->mesh), STATUS_OK);
  ck_assert_int_eq(model_create(&c->mesh, &rubber, false, &c->model, &error), STATUS_OK);
  ck_assert_int_eq(rigid_shape_create_sphere(1.6, &c->sphere, &error), STATUS_OK);
  ck_assert_int_eq(model_add_obstacle(c->model, c->sphere, regime->friction, &index, &error),
                   STATUS_OK);
  c->object = c->model->obstacle[index];
  c->object->stiffness = 20; /* above pressure times curvature, so that all of it is there */
  c->face = bottom_face(c->model);
  ck_assert_int_ge(c->face, 0);
  mesh_face_nodes(&c->mesh, &c->model->contact.face[c->face].face, c->nodes);
  const double place[3] = {0.5, 0.45, -0.8 + regime->depth}, axis[3] = {1, 2, -1};
  c->pose = rigid_pose_turned(place, axis, 0.7);
  for (int a = 0; a < QUAD9_NODES; a++) {
    memcpy(c->x[a], c->mesh.x + 3 * c->nodes[a], sizeof c->x[a]);
    double x = c->x[a][0] - 0.5, y = c->x[a][1] - 0.5;
    c->x[a][2] = -0.55 * (x * x + y * y) + 0.01 * body_random(&seed);
  }
  for (int d = 0; d < FACE_DOFS + 6; d++) {
    c->v[d] = body_random(&seed);
  }
  remember(c, regime, &seed);
  model_place_obstacle(c->model, index, &c->pose);
}

static void case_close(struct contact_case *c) {
  model_destroy(c->model);
  rigid_shape_destroy(c->sphere);
  mesh_release(&c->mesh);
}

/* Residual r, and the tangent unless NULL, of the face moved by h v, and the object with `motion`
 * not 0. */
static void evaluate(struct contact_case *c, double h, bool motion, double r[FACE_DOFS],
                     double (*stiffness)[FACE_DOFS]) {
  double x[QUAD9_NODES][3], shift[3], turn[3];
  for (int d = 0; d < FACE_DOFS; d++) {
    x[d / 3][d % 3] = c->x[d / 3][d % 3] + h * c->v[d];
  }
  for (int i = 0; i < 3 && motion; i++) {
    shift[i] = h * c->v[FACE_DOFS + i];
    turn[i] = h * c->v[FACE_DOFS + 3 + i];
  }
  c->object->pose = c->pose;
  if (motion) {
    rigid_pose_move(&c->object->pose, shift, turn);
  }
  c->object->near[c->face] = 1;
  ck_assert(obstacle_face_evaluate(c->object, &c->model->quad9,
                                   &c->object->point[QUAD9_POINTS * c->face], x, r, stiffness));
}

static double face_error(void *contact_case, double h) {
  struct contact_case *c = contact_case;
  double a[FACE_DOFS], b[FACE_DOFS];
  evaluate(c, -h, false, a, NULL);
  evaluate(c, h, false, b, NULL);
  return verify_difference_error(FACE_DOFS, a, b, h, c->exact);
}

static int slipping_points(const struct contact_case *c) {
  int count = 0;
  for (int q = 0; q < QUAD9_POINTS; q++) {
    count += c->object->point[QUAD9_POINTS * c->face + q].slips;
  }
  return count;
}

START_TEST(tangent_of_a_face) {
  const struct regime *regime = &regimes[_i];
  struct contact_case c;
  double r[FACE_DOFS], stiffness[FACE_DOFS][FACE_DOFS];
  case_open(&c, regime);
  evaluate(&c, 0, false, r, stiffness);
  int slipping = slipping_points(&c);
  ck_assert(regime->slipping < 0 ? slipping > 0 && slipping < QUAD9_POINTS
                                 : slipping == regime->slipping);
  for (int i = 0; i < FACE_DOFS; i++) {
    for (int j = i; j < FACE_DOFS; j++) {
      c.exact[i] += stiffness[i][j] * c.v[j];
      c.exact[j] += j > i ? stiffness[i][j] * c.v[i] : 0;
    }
  }
  report_second_order(regime->name, face_error, &c, 1e-3, 3, 1e-7);
  case_close(&c);
}
END_TEST

/* Force and moment about the place, on the object. */
static void resultant(const struct contact_case *c, double out[6]) {
  struct obstacle_state state = model_obstacle_state(c->model, 0);
  memcpy(out, state.force, sizeof state.force);
  memcpy(out + 3, state.moment, sizeof state.moment);
}

static double moving_error(void *contact_case, double h) {
  struct contact_case *c = contact_case;
  double a[FACE_DOFS], b[FACE_DOFS];
  evaluate(c, -h, true, a, NULL);
  evaluate(c, h, true, b, NULL);
  return verify_difference_error(FACE_DOFS, a, b, h, c->exact);
}

static double resultant_error(void *contact_case, double h) {
  struct contact_case *c = contact_case;
  double r[FACE_DOFS], a[6], b[6];
  evaluate(c, -h, true, r, NULL);
  resultant(c, a);
  evaluate(c, h, true, r, NULL);
  resultant(c, b);
  return verify_difference_error(6, a, b, h, c->resultant);
}

/* Derivatives for an object that moves together with the face's nodes. */
START_TEST(coupling_with_a_moving_object) {
  const struct regime *regime = &regimes[_i];
  struct contact_case c;
  struct obstacle_coupling coupling;
  double r[FACE_DOFS], stiffness[FACE_DOFS][FACE_DOFS], now[6];
  case_open(&c, regime);
  size_t count = (size_t)c.model->dof_count;
  coupling.by_motion = calloc(6 * count, sizeof *coupling.by_motion);
  coupling.by_u = calloc(6 * count, sizeof *coupling.by_u);
  ck_assert(coupling.by_motion && coupling.by_u);
  evaluate(&c, 0, false, r, stiffness);
  model_obstacle_coupling(c.model, 0, &coupling);
  resultant(&c, now);
  for (int i = 0; i < 6; i++) {
    ck_assert_double_eq_tol(coupling.resultant[i], now[i], 1e-13);
    for (int j = 0; j < 6; j++) {
      c.resultant[i] += coupling.own[6 * i + j] * c.v[FACE_DOFS + j];
    }
  }
  for (int d = 0; d < FACE_DOFS; d++) {
    size_t equation = (size_t)c.model->equation[3 * c.nodes[d / 3] + d % 3];
    for (int e = 0; e < FACE_DOFS; e++) {
      c.exact[d] += (e < d ? stiffness[e][d] : stiffness[d][e]) * c.v[e];
    }
    for (size_t j = 0; j < 6; j++) {
      c.exact[d] += coupling.by_motion[j * count + equation] * c.v[FACE_DOFS + j];
      c.resultant[j] += coupling.by_u[j * count + equation] * c.v[d];
    }
  }
  report_second_order(regime->name, moving_error, &c, 1e-3, 3, 1e-7);
  report_second_order(regime->name, resultant_error, &c, 1e-3, 3, 1e-7);
  free(coupling.by_motion);
  free(coupling.by_u);
  case_close(&c);
}
END_TEST

/* What the nodes of the body feel is what the object feels, the other way. */
START_TEST(forces_balance_to_round_off) {
  struct contact_case c;
  double r[FACE_DOFS], sum[6] = {0}, on_object[6], size = 0;
  case_open(&c, &regimes[_i]);
  evaluate(&c, 0, false, r, NULL);
  resultant(&c, on_object);
  for (int a = 0; a < QUAD9_NODES; a++) {
    double arm[3], moment[3];
    for (int i = 0; i < 3; i++) {
      arm[i] = c.x[a][i] - c.pose.place[i];
    }
    vec3_cross(arm, r + 3 * a, moment);
    for (int i = 0; i < 3; i++) {
      sum[i] += r[3 * a + i];
      sum[3 + i] += moment[i];
      size += fabs(r[3 * a + i]);
    }
  }
  for (int i = 0; i < 6; i++) {
    ck_assert_double_eq_tol(sum[i], on_object[i], 1e-14 * size);
  }
  case_close(&c);
}
END_TEST

START_TEST(faults_are_refused) {
  struct contact_case c;
  struct error error = {0};
  int index;
  case_open(&c, &regimes[0]);
  ck_assert_int_eq(model_add_obstacle(c.model, c.sphere, -0.1, &index, &error), STATUS_INVALID);
  ck_assert_ptr_nonnull(strstr(error.message, "-0.1"));
  ck_assert_int_eq(model_add_obstacle(c.model, c.sphere, NAN, &index, &error), STATUS_INVALID);
  while (c.model->obstacle_count < MODEL_OBSTACLES) {
    ck_assert_int_eq(model_add_obstacle(c.model, c.sphere, 0.1, &index, &error), STATUS_OK);
  }
  ck_assert_int_eq(model_add_obstacle(c.model, c.sphere, 0.1, &index, &error), STATUS_TOO_LARGE);
  case_close(&c);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("obstacle");
  TCase *obstacle = tcase_create("obstacle");
  tcase_set_timeout(obstacle, 60);
  tcase_add_loop_test(obstacle, tangent_of_a_face, 0, REGIMES);
  tcase_add_loop_test(obstacle, coupling_with_a_moving_object, 0, REGIMES);
  tcase_add_loop_test(obstacle, forces_balance_to_round_off, 0, REGIMES);
  tcase_add_test(obstacle, faults_are_refused);
  suite_add_tcase(suite, obstacle);
  return suite_run(suite);
}
