/* Contact: tangent against differences, balance of forces, transmission of a uniform pressure. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/equilibrium.h"
#include "solver/fe/vec3.h"
#include "tests/physics/body.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

/* ---- one pair of faces ---- */

struct pair_case {
  struct mesh mesh;
  struct quad9_tables tables;
  struct contact contact;
  double x[CONTACT_NODES][3], v[CONTACT_DOFS];
  double exact[CONTACT_DOFS];
};

/* Two cubes of edge 1 that look at each other along x. */
static void two_cubes(const void *context, int block, const double s[3], double x[3]) {
  const double *gap = context;
  memcpy(x, s, 3 * sizeof *x);
  x[0] += block * (1 + *gap);
}

static void build_blocks(int cells, double gap, struct mesh *mesh) {
  struct body body = {.blocks = 2, .cells = {1, cells, cells}, .map = two_cubes, .context = &gap};
  body_build(&body, mesh);
  int pairs = cells * cells;
  mesh->facing = calloc((size_t)pairs, sizeof *mesh->facing);
  ck_assert_ptr_nonnull(mesh->facing);
  mesh->facing_count = pairs;
  mesh->gap_width = 0.1;
  for (int p = 0; p < pairs; p++) {
    mesh->facing[p].slave = (struct mesh_face){p, 0, 1, FACE_OUTER};
    mesh->facing[p].master = (struct mesh_face){pairs + p, 0, -1, FACE_OUTER};
  }
}

/* Faces `gap` apart; the master is curved and tilted by `crooked`, the slave follows it. */
static void open_pair(struct pair_case *c, double gap, double crooked) {
  build_blocks(1, 0.1, &c->mesh);
  quad9_tables_fill(&c->tables);
  ck_assert_int_eq(contact_init(&c->contact, &c->mesh, &c->tables, NULL), STATUS_OK);
  c->contact.stiffness = 10;
  c->contact.smoothing = 0.05;
  int nodes[CONTACT_NODES];
  unsigned seed = 17;
  contact_nodes(&c->contact, 0, nodes);
  for (int a = 0; a < CONTACT_NODES; a++) {
    memcpy(c->x[a], c->mesh.x + 3 * nodes[a], sizeof c->x[a]);
    double y = c->x[a][1], z = c->x[a][2];
    c->x[a][0] = 1 + crooked * (2 * y - z + 3 * y * y - 2 * y * z + 2 * z * z);
    c->x[a][0] += a < QUAD9_NODES ? 0.1 * crooked * body_random(&seed) : gap;
    c->x[a][1] += 0.3 * crooked * body_random(&seed);
    c->x[a][2] += 0.3 * crooked * body_random(&seed);
  }
  for (int d = 0; d < CONTACT_DOFS; d++) {
    c->v[d] = body_random(&seed);
  }
}

static void close_pair(struct pair_case *c) {
  contact_release(&c->contact);
  mesh_release(&c->mesh);
}

static void residual_at(struct pair_case *c, double h, double r[CONTACT_DOFS]) {
  double x[CONTACT_NODES][3];
  for (int d = 0; d < CONTACT_DOFS; d++) {
    x[d / 3][d % 3] = c->x[d / 3][d % 3] + h * c->v[d];
  }
  ck_assert(contact_evaluate(&c->contact, 0, x, r, NULL));
}

static double pair_error(void *context, double h) {
  struct pair_case *c = context;
  double a[CONTACT_DOFS], b[CONTACT_DOFS], error = 0, size = 0;
  residual_at(c, -h, a);
  residual_at(c, h, b);
  for (int d = 0; d < CONTACT_DOFS; d++) {
    double e = (b[d] - a[d]) / (2 * h) - c->exact[d];
    error += e * e;
    size += c->exact[d] * c->exact[d];
  }
  return sqrt(error / size);
}

/* Tangent times v, and the range of the law's argument g - lambda/eps over the points. */
static void tangent_at(struct pair_case *c, double *low, double *high) {
  double r[CONTACT_DOFS];
  double *packed = malloc(sizeof *packed * CONTACT_PACKED);
  ck_assert_ptr_nonnull(packed);
  ck_assert(contact_evaluate(&c->contact, 0, c->x, r, packed));
  memset(c->exact, 0, sizeof c->exact);
  const double *value = packed;
  for (int i = 0; i < CONTACT_DOFS; i++) {
    for (int j = i; j < CONTACT_DOFS; j++, value++) {
      c->exact[i] += *value * c->v[j];
      c->exact[j] += j > i ? *value * c->v[i] : 0;
    }
  }
  free(packed);
  *low = INFINITY;
  *high = -INFINITY;
  for (int q = 0; q < QUAD9_POINTS; q++) {
    const struct contact_point *point = &c->contact.point[q];
    ck_assert(point->valid);
    double argument = point->gap - point->lambda / c->contact.stiffness;
    *low = fmin(*low, argument);
    *high = fmax(*high, argument);
  }
}

/* gap, multiplier, range of the law's argument in units of the smoothing, smallest error. */
static const struct regime {
  const char *name;
  double gap, lambda, crooked, low, high, floor;
} regimes[] = {
    {"contact, penetrating", -0.12, 0, 0.05, -INFINITY, -1, 1e-7},
    {"contact, smoothed", 0.01, 0, 0.05, -1, 1, 1e-7},
    {"contact, multiplier across a gap", 0.08, 3, 0.05, -INFINITY, -1, 1e-7},
    {"contact, multiplier, smoothed", 0.11, 1, 0.05, -1, 1, 1e-7},
    {"contact, flat faces", -0.12, 0, 0, -INFINITY, -1, 1e-7},
    {"contact, multiplier on touching faces", 1e-5, 3, 0.02, -INFINITY, -1, 1e-7},
    {"contact, multiplier on closed faces", 1e-10, 3, 0, -INFINITY, -1, 1e-7},
    {"contact, multiplier, hardly penetrating", -1e-9, 3, 0, -INFINITY, -1, 1e-7},
};
enum { REGIMES = sizeof regimes / sizeof *regimes };

START_TEST(tangent_of_a_pair) {
  const struct regime *regime = &regimes[_i];
  struct pair_case c;
  double low, high;
  open_pair(&c, regime->gap, regime->crooked);
  for (int q = 0; q < QUAD9_POINTS; q++) {
    c.contact.point[q].lambda = regime->lambda;
  }
  tangent_at(&c, &low, &high);
  ck_assert_double_gt(low, regime->low * c.contact.smoothing);
  ck_assert_double_lt(high, regime->high * c.contact.smoothing);
  report_second_order(regime->name, pair_error, &c, 2e-3, 3, regime->floor);
  close_pair(&c);
}
END_TEST

START_TEST(forces_of_a_pair_balance) {
  struct pair_case c;
  double r[CONTACT_DOFS], force[3] = {0}, moment[3] = {0}, turn[3], size = 0;
  open_pair(&c, -0.12, 0.05);
  residual_at(&c, 0, r);
  for (int a = 0; a < CONTACT_NODES; a++) {
    vec3_cross(c.x[a], r + 3 * a, turn);
    for (int i = 0; i < 3; i++) {
      force[i] += r[3 * a + i];
      moment[i] += turn[i];
      size += fabs(r[3 * a + i]);
    }
  }
  ck_assert_double_lt(vec3_norm(force), 1e-14 * size);
  ck_assert_double_lt(vec3_norm(moment), 1e-12 * size);
  close_pair(&c);
}
END_TEST

START_TEST(open_faces_carry_nothing) {
  struct pair_case c;
  double r[CONTACT_DOFS];
  open_pair(&c, 0.06, 0);
  ck_assert(!contact_evaluate(&c.contact, 0, c.x, r, NULL));
  ck_assert_double_eq_tol(contact_summarise(&c.contact).min_gap, 0.06, 1e-14);
  ck_assert_int_eq(contact_summarise(&c.contact).active, 0);
  close_pair(&c);
}
END_TEST

/* ---- two blocks pressed together ---- */

static const struct material_spec rubber = {
    .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 50};

/* A uniform traction on the far end of the second block has to arrive unchanged at every point
 * of contact. The blocks slide on three planes of symmetry. */
START_TEST(uniform_pressure_is_transmitted) {
  const double traction = 0.3, gap = 1e-6; /* nodes of touching blocks would be joined */
  struct mesh mesh;
  struct fe_model *model;
  struct equilibrium *solver;
  struct fe_state state;
  build_blocks(2, gap, &mesh);
  body_hold(&mesh, 0, 0, HOLD_X);
  body_hold(&mesh, 1, 0, HOLD_Y);
  body_hold(&mesh, 2, 0, HOLD_Z);
  ck_assert_int_eq(model_create(&mesh, &rubber, true, &model, NULL), STATUS_OK);
  ck_assert_int_eq(equilibrium_create(model, &solver, NULL), STATUS_OK);
  ck_assert_int_eq(state_create(model, &state), STATUS_OK);
  body_add_traction(model, 0, 2 + gap, (double[3]){-traction, 0, 0});
  solver->options.traction_tolerance = 1e-8;
  solver->options.step_tolerance = 1e-9;
  struct fe_load load = {0, 0, 1};
  int iterations;
  ck_assert_int_eq(equilibrium_solve(solver, &load, 0, &state, &iterations), STATUS_OK);
  double worst = 0;
  for (int i = 0; i < 4 * QUAD9_POINTS; i++) {
    worst = fmax(worst, fabs(model->contact.point[i].lambda / traction - 1));
  }
  report_value("contact patch test, pressure", "2 x (1 x 2 x 2)", 0, worst);
  ck_assert_double_lt(worst, 1e-6);
  state_release(&state);
  equilibrium_destroy(solver);
  model_destroy(model);
  mesh_release(&mesh);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("contact");
  TCase *contact = tcase_create("contact");
  tcase_set_timeout(contact, 60);
  tcase_add_loop_test(contact, tangent_of_a_pair, 0, REGIMES);
  tcase_add_test(contact, forces_of_a_pair_balance);
  tcase_add_test(contact, open_faces_carry_nothing);
  tcase_add_test(contact, uniform_pressure_is_transmitted);
  suite_add_tcase(suite, contact);
  return suite_run(suite);
}
