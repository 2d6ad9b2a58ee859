/* Rigid planes: the load that goes through them, and what stays in front of them. */
#include <cblas.h>
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/vec3.h"
#include "solver/verify/body.h"
#include "solver/verify/report.h"
#include "tests/physics/forces.h"
#include "tests/physics/pneunet_case.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

/* ---- a block that nothing but a plane holds up ---- */

static void unit_cube(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  memcpy(x, s, 3 * sizeof *x);
}

struct block {
  struct mesh mesh;
  struct fe_model *model;
  struct equilibrium *solver;
  struct fe_state state;
};

static const struct material_spec rubber = {
    .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 100};

/* A cube of 2 x 2 x 2 elements that slides in two planes of symmetry and, unless `scale` is 0,
 * lies on the rigid plane x[axis] = 0, whose normal is given with the length `scale`. */
static void block_open(struct block *b, int axis, double scale) {
  const struct body body = {.blocks = 1, .cells = {2, 2, 2}, .map = unit_cube};
  const double origin[3] = {0, 0, 0};
  double normal[3] = {0, 0, 0};
  struct error error = {0};
  normal[axis] = scale;
  openblas_set_num_threads(1);
  *b = (struct block){.model = NULL};
  ck_assert_int_eq(body_build(&body, &b->mesh), STATUS_OK);
  body_hold(&b->mesh, (axis + 1) % 3, 0, 1 << (axis + 1) % 3);
  body_hold(&b->mesh, (axis + 2) % 3, 0, 1 << (axis + 2) % 3);
  ck_assert_int_eq(model_create(&b->mesh, &rubber, false, &b->model, &error), STATUS_OK);
  if (scale > 0) {
    enum status status = model_add_plane(b->model, origin, normal, &error);
    ck_assert_msg(status == STATUS_OK, "%s", error.message);
  }
  ck_assert_int_eq(equilibrium_create(b->model, &b->solver, &error), STATUS_OK);
  ck_assert_int_eq(state_create(b->model, &b->state), STATUS_OK);
}

static void block_close(struct block *b) {
  state_release(&b->state);
  equilibrium_destroy(b->solver);
  model_destroy(b->model);
  mesh_release(&b->mesh);
}

/* Multipliers of the plane on the faces that lie on it: all equal to p. */
static void check_even_pressure(const struct block *b, int axis, double p) {
  const struct contact *c = &b->model->contact;
  int closed = 0;
  for (int i = 0; i < QUAD9_POINTS * c->face_count; i++) {
    const struct mesh_face *face = &c->face[i / QUAD9_POINTS].face;
    double lambda = b->state.lambda[QUAD9_POINTS * c->face_count + i];
    if (face->axis == axis && face->side < 0) {
      ck_assert_double_eq_tol(lambda, p, 1e-6 * p);
      closed++;
    } else {
      ck_assert_double_eq(lambda, 0);
    }
  }
  ck_assert_int_eq(closed, 4 * QUAD9_POINTS);
}

/* The whole load arrives as an even pressure, and the block shortens evenly. */
START_TEST(block_rests_on_a_plane) {
  static const double scales[3] = {1, 250, 1e-3};
  const double p = 0.3;
  int axis = _i, iterations;
  struct block b;
  block_open(&b, axis, scales[_i]);
  double traction[3] = {0, 0, 0};
  traction[axis] = -p;
  body_add_traction(b.model, axis, 1, traction);
  b.solver->options.traction_tolerance = 1e-8;
  b.solver->options.step_tolerance = 1e-10;
  struct fe_load load = {0, 0, 1};
  /* Stiff enough that the first guess does not take the points above the edges with it. */
  b.model->contact.stiffness *= 20;
  ck_assert_int_eq(equilibrium_solve(b.solver, &load, 0, &b.state, &iterations), STATUS_OK);
  struct contact_summary summary = contact_summarise(&b.model->contact);
  for (int i = 0; i < 3; i++) {
    ck_assert_double_eq_tol(summary.plane_force[0][i], i == axis ? p : 0, 1e-6 * p);
  }
  ck_assert_double_lt(summary.penetration, 1e-6);
  check_even_pressure(&b, axis, p);
  /* Incompressible: p = 1 / l^2 - l per reference area. */
  double l = 0.9;
  for (int k = 0; k < 20; k++) {
    l += (1 / (l * l) - l - p) / (2 / (l * l * l) + 1);
  }
  for (int n = 0; n < b.mesh.node_count; n++) {
    double x = b.mesh.x[3 * n + axis];
    ck_assert_double_eq_tol(b.state.u[3 * n + axis], (l - 1) * x, 2e-3);
  }
  block_close(&b);
}
END_TEST

/* ---- tangent ---- */

/* The same body in the same state with a plane and without one: what differs is the plane's. */
struct plane_tangent {
  struct block with, without;
  double *u, *v, *exact, *low, *high; /* dof_count or node_count x 3 */
};

/* Residual of the plane alone at u + h v. */
static void plane_residual(struct plane_tangent *t, double h, double *residual) {
  struct fe_load none = {0};
  struct block *both[2] = {&t->with, &t->without};
  int unknowns = t->with.model->dof_count;
  memset(residual, 0, sizeof *residual * (size_t)unknowns);
  for (int k = 0; k < 2; k++) {
    for (int d = 0; d < 3 * both[k]->mesh.node_count; d++) {
      both[k]->state.u[d] = t->u[d] + h * t->v[d];
    }
    ck_assert_int_eq(model_evaluate(both[k]->model, &both[k]->state, &none, false), STATUS_OK);
    for (int i = 0; i < unknowns; i++) {
      residual[i] += (k == 0 ? 1 : -1) * both[k]->model->residual[i];
    }
  }
}

static void plane_stiffness(struct plane_tangent *t) {
  struct fe_load none = {0};
  struct block *both[2] = {&t->with, &t->without};
  int unknowns = t->with.model->dof_count;
  double *x = calloc(2 * (size_t)unknowns, sizeof *x), *y = x + unknowns;
  ck_assert_ptr_nonnull(x);
  for (int d = 0; d < 3 * t->with.mesh.node_count; d++) {
    int equation = t->with.model->equation[d];
    if (equation >= 0) {
      x[equation] = t->v[d];
    }
  }
  for (int k = 0; k < 2; k++) {
    ck_assert_int_eq(model_evaluate(both[k]->model, &both[k]->state, &none, true), STATUS_OK);
    model_multiply(both[k]->model, x, y);
    for (int i = 0; i < unknowns; i++) {
      t->exact[i] += (k == 0 ? 1 : -1) * y[i];
    }
  }
  free(x);
}

static double plane_error(void *context, double h) {
  struct plane_tangent *t = context;
  plane_residual(t, -h, t->low);
  plane_residual(t, h, t->high);
  return verify_difference_error(t->with.model->dof_count, t->low, t->high, h, t->exact);
}

/* Mean gap and multiplier. The law is made of parabolas and lines, whose central differences are
 * exact while the step stays within one of them; across their joints they are off by order 1, with
 * a factor that falls with the step. */
static const struct regime {
  const char *name;
  double gap, lambda, rough, floor;
} regimes[] = {{"plane, pressed in", -0.05, 0, 1e-3, 1e-8},
               {"plane, smoothed", 0, 0, 1e-3, 1e-8},
               {"plane, multiplier", 0.02, 0.1, 1e-3, 1e-8},
               {"plane, multiplier, smoothed", 0.085, 0.1, 1e-3, 1e-8},
               {"plane, all parts of the law", 0, 0, 0.03, 1e-5}};
enum { REGIMES = sizeof regimes / sizeof *regimes };

START_TEST(tangent_of_a_plane) {
  const struct regime *regime = &regimes[_i];
  struct plane_tangent t;
  unsigned seed = 23;
  block_open(&t.with, 2, 1);
  block_open(&t.without, 2, 0);
  size_t size = 3 * (size_t)t.with.mesh.node_count;
  double *room = calloc(5 * size, sizeof *room);
  ck_assert_ptr_nonnull(room);
  t.u = room;
  t.v = room + size;
  t.exact = room + 2 * size;
  t.low = room + 3 * size;
  t.high = room + 4 * size;
  for (size_t d = 0; d < size; d++) {
    t.u[d] = regime->rough * body_random(&seed) + (d % 3 == 2 ? regime->gap : 0);
    t.v[d] = body_random(&seed);
  }
  for (int i = 0; i < t.with.model->contact.point_count; i++) {
    t.with.model->contact.point[i].lambda = regime->lambda;
  }
  plane_residual(&t, 0, t.low);
  plane_stiffness(&t);
  ck_assert_int_gt(contact_summarise(&t.with.model->contact).active, 0);
  double error = plane_error(&t, 1e-5);
  report_value(regime->name, "central difference", 0, error);
  ck_assert_double_lt(error, regime->floor);
  free(room);
  block_close(&t.with);
  block_close(&t.without);
}
END_TEST

/* ---- a pneu-net against planes ---- */

static void plane_spec(struct job_spec *spec, int planes, const double point[3],
                       const double normal[3]) {
  case_prototype(spec, 4);
  spec->mesh = (struct mesh_spec){1, 1, 1, 1, 1, 1, 1, 1};
  spec->load = (struct load_spec){.pressure_to = 25e3, .steps = 2};
  spec->plane_count = planes;
  memcpy(spec->plane[0].point, point, sizeof spec->plane[0].point);
  memcpy(spec->plane[0].normal, normal, sizeof spec->plane[0].normal);
}

/* Height of the lowest node above the plane of the spec, m. */
static double lowest_node(const struct pneunet_case *c) {
  const struct plane_spec *plane = &c->spec.plane[0];
  double lowest = INFINITY, length = vec3_norm(plane->normal);
  for (int n = 0; n < c->mesh.node_count; n++) {
    double x[3];
    for (int i = 0; i < 3; i++) {
      x[i] = c->mesh.x[3 * n + i] + c->state.u[3 * n + i] - plane->point[i];
    }
    lowest = fmin(lowest, vec3_dot(x, plane->normal) / length);
  }
  return lowest;
}

static const struct {
  const char *name;
  double point[3], normal[3];
} planes[] = {{"below", {0, 0, -0.002}, {0, 0, 1}},
              {"below, tilted", {0.038, 0, -0.003}, {-0.3, 0, 1}},
              {"below, tilted, normal x 100", {0.038, 0, -0.003}, {-30, 0, 100}},
              {"in front", {0.0385, 0, 0}, {-1, 0, 0}}};
enum { PLANE_CASES = sizeof planes / sizeof *planes };

/* The base bears exactly what the plane pushes, and nothing without a plane. */
START_TEST(base_bears_what_the_plane_pushes) {
  double angle[2], wall = 0.002;
  for (int k = 0; k < 2; k++) {
    struct job_spec spec;
    struct pneunet_case c;
    plane_spec(&spec, k, planes[_i].point, planes[_i].normal);
    case_open(&c, &spec);
    c.solver->options.step_tolerance *= 1e-3;
    case_follow(&c);
    angle[k] = c.angle[2];
    struct forces base = forces_at_base(c.model, &c.state, spec.load.pressure_to);
    struct contact_summary summary = contact_summarise(&c.model->contact);
    for (int i = 0; i < 3; i += 2) { /* of a half model only these are forces of the whole */
      double plane = k == 1 ? summary.plane_force[0][i] : 0;
      ck_assert_double_eq_tol(base.force[i], -plane, 1e-6 * base.size);
    }
    if (k == 1) {
      double force = vec3_norm(summary.plane_force[0]);
      printf("plane %s: %.4f N, nodes of the base %.4f N\n", planes[_i].name, force, base.size);
      ck_assert_double_gt(force, 1e-3 * base.size);
      ck_assert_double_eq_tol(base.force[0], -summary.plane_force[0][0], 1e-4 * force);
      ck_assert_double_eq_tol(base.force[2], -summary.plane_force[0][2], 1e-4 * force);
      report_value(planes[_i].name, "lowest node, walls", 0, fmin(0, lowest_node(&c)) / wall);
      ck_assert_double_lt(summary.penetration, 5e-3 * wall);
      ck_assert_double_gt(summary.min_plane_gap, -5e-3 * wall);
      ck_assert_double_gt(lowest_node(&c), -0.1 * wall);
    }
    case_close(&c);
  }
  ck_assert_double_lt(angle[1], 0.9 * angle[0]);
}
END_TEST

START_TEST(normal_may_have_any_length) {
  double angle[2];
  for (int k = 0; k < 2; k++) {
    struct job_spec spec;
    plane_spec(&spec, 1, planes[1 + k].point, planes[1 + k].normal);
    angle[k] = case_angle_of(&spec);
  }
  ck_assert_double_eq_tol(angle[0], angle[1], 1e-6 * angle[0]);
}
END_TEST

START_TEST(far_plane_changes_nothing) {
  const double point[3] = {0, 0, -0.2}, normal[3] = {0, 0, 1};
  double angle[2];
  for (int k = 0; k < 2; k++) {
    struct job_spec spec;
    plane_spec(&spec, k, point, normal);
    angle[k] = case_angle_of(&spec);
  }
  ck_assert_double_eq_tol(angle[1], angle[0], 1e-9 * angle[0]);
}
END_TEST

/* A half model feels half of the force. */
START_TEST(full_model_feels_twice_the_force) {
  double force[2], angle[2];
  for (int full = 0; full < 2; full++) {
    struct job_spec spec;
    struct pneunet_case c;
    plane_spec(&spec, 1, planes[0].point, planes[0].normal);
    spec.half_model = !full;
    case_open(&c, &spec);
    c.solver->options.step_tolerance *= 1e-3;
    c.solver->options.traction_tolerance *= 1e-3;
    case_follow(&c);
    angle[full] = c.angle[2];
    force[full] = contact_summarise(&c.model->contact).plane_force[0][2];
    case_close(&c);
  }
  report_check("plane below, full against half model, N", "coarse", 2 * force[0], force[1], 1e-5);
  ck_assert_double_eq_tol(angle[0], angle[1], 1e-5 * angle[0]);
}
END_TEST

/* ---- planes that are refused ---- */

START_TEST(plane_through_the_body_is_refused) {
  static const double point[3][3] = {{0, 0, 0.001}, {0.02, 0, 0}, {0, 0, -0.001}};
  static const double normal[3][3] = {{0, 0, 2}, {-1, 0, 0}, {0, 0, -1}};
  for (int k = 0; k < 3; k++) {
    struct job_spec spec;
    struct pneunet_case c;
    struct error error = {0};
    plane_spec(&spec, 0, point[k], normal[k]);
    case_open(&c, &spec);
    ck_assert_int_eq(model_add_plane(c.model, point[k], normal[k], &error), STATUS_GEOMETRY);
    ck_assert_int_eq(error.status, STATUS_GEOMETRY);
    ck_assert_ptr_nonnull(strstr(error.message, "behind"));
    ck_assert_ptr_nonnull(strstr(error.message, "mm"));
    ck_assert_int_eq(c.model->contact.plane_count, 0);
    case_close(&c);
  }
}
END_TEST

/* A plane that the body only touches is in order; there is room for CONTACT_PLANES of them. */
START_TEST(planes_are_limited) {
  static const double point[3] = {0, 0, 0}, normal[3] = {0, 0, 1};
  struct block b;
  struct error error = {0};
  block_open(&b, 2, 1);
  for (int k = 1; k < CONTACT_PLANES; k++) {
    ck_assert_int_eq(model_add_plane(b.model, point, normal, &error), STATUS_OK);
  }
  ck_assert_int_eq(model_add_plane(b.model, point, normal, &error), STATUS_TOO_LARGE);
  ck_assert_int_eq(b.model->contact.plane_count, CONTACT_PLANES);
  block_close(&b);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("contact_planes");
  TCase *tests = tcase_create("contact_planes");
  tcase_set_timeout(tests, 100);
  tcase_add_loop_test(tests, block_rests_on_a_plane, 0, 3);
  tcase_add_loop_test(tests, tangent_of_a_plane, 0, REGIMES);
  tcase_add_loop_test(tests, base_bears_what_the_plane_pushes, 0, PLANE_CASES);
  tcase_add_test(tests, normal_may_have_any_length);
  tcase_add_test(tests, far_plane_changes_nothing);
  tcase_add_test(tests, full_model_feels_twice_the_force);
  tcase_add_test(tests, plane_through_the_body_is_refused);
  tcase_add_test(tests, planes_are_limited);
  suite_add_tcase(suite, tests);
  return suite_run(suite);
}
