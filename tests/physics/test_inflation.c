/* Thick cylinder and sphere under inner pressure, A = 1, B = 2: pressure against inner stretch.
 *
 * The cavity's volume is prescribed and the pressure found, so that the flat part and the limit
 * point of the curve are no obstacle; the inner stretch is that of the volume. The incompressible
 * solution is p = integral over the stretch l, from the outer to the inner one, of
 * W'(l) / (l^n - 1), n = 2 for the cylinder and 3 for the sphere, W'(l) of the homogeneous
 * deformation with hoop stretch l. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include "tests/physics/body.h"
#include "tests/physics/newton.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

static const double inner = 1, outer = 2;

/* A quarter of a cylinder of height 1 (one block), or an octant of a sphere (three blocks). */
struct shape {
  const char *name;
  int power; /* 2 cylinder, 3 sphere */
  int blocks;
  double volume_scale; /* model_volume leaves out the planes z = 0, 1 of the cylinder */
};
static const struct shape cylinder = {"cylinder", 2, 1, 1.5};
static const struct shape sphere = {"sphere", 3, 3, 1};

static void cylinder_map(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  double r = inner * pow(outer / inner, s[0]), angle = 0.5 * M_PI * s[1];
  x[0] = s[1] < 1 ? r * cos(angle) : 0;
  x[1] = r * sin(angle);
  x[2] = s[2];
}

/* The faces x = 1, y = 1, z = 1 of the unit cube, blown up to the sphere. */
static void sphere_map(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  double r = inner * pow(outer / inner, s[0]);
  double y = tan(0.25 * M_PI * s[1]), z = tan(0.25 * M_PI * s[2]);
  double scale = r / sqrt(1 + y * y + z * z);
  x[block] = scale;
  x[(block + 1) % 3] = scale * y;
  x[(block + 2) % 3] = scale * z;
}

struct inflation {
  const struct shape *shape;
  struct mesh mesh;
  struct fe_model *model;
  struct fe_state state;
  double volume, pressure;
};

static void inflation_open(struct inflation *c, const struct shape *shape,
                           const struct material_spec *material, int radial, int around) {
  struct body body = {.blocks = shape->blocks,
                      .cells = {radial, around, shape->power == 3 ? around : 1},
                      .cavity = true,
                      .map = shape->power == 3 ? sphere_map : cylinder_map};
  body_build(&body, &c->mesh);
  body_hold(&c->mesh, 0, 0, HOLD_X);
  body_hold(&c->mesh, 1, 0, HOLD_Y);
  body_hold(&c->mesh, shape->power == 3 ? 2 : -1, 0, HOLD_Z);
  c->shape = shape;
  c->model = body_model(&c->mesh, material);
  ck_assert_int_eq(state_create(c->model, &c->state), STATUS_OK);
  c->volume = shape->volume_scale * model_volume(c->model, &c->state, NULL);
  c->pressure = 0;
}

static void inflation_close(struct inflation *c) {
  state_release(&c->state);
  model_destroy(c->model);
  mesh_release(&c->mesh);
}

/* Brings the inner stretch to `stretch` in a step; returns the pressure. */
static double inflate(struct inflation *c, double stretch) {
  double target = c->volume * pow(stretch, c->shape->power);
  enum status status =
      newton_inflate(c->model, target, c->shape->volume_scale, &c->state, &c->pressure, 1e-10);
  ck_assert_msg(status == STATUS_OK, "%s at stretch %g: %s", c->shape->name, stretch,
                status_word(status));
  return c->pressure;
}

/* Inflates in steps of at most 0.1. */
static double inflate_from(struct inflation *c, double from, double to) {
  int steps = (int)ceil((to - from) / 0.1 - 1e-9);
  for (int k = 1; k <= steps; k++) {
    inflate(c, from + (to - from) * k / steps);
  }
  return c->pressure;
}

static double outer_stretch(const struct shape *shape, double stretch) {
  double ratio = pow(inner / outer, shape->power);
  return pow((pow(stretch, shape->power) - 1) * ratio + 1, 1.0 / shape->power);
}

/* ---- closed forms and quadrature ---- */

static double neo_hooke(const struct shape *shape, double a) {
  double b = outer_stretch(shape, a);
  return shape->power == 2 ? log(a / b) + (1 / (b * b) - 1 / (a * a)) / 2
                           : 2 / b + 1 / (2 * pow(b, 4)) - 2 / a - 1 / (2 * pow(a, 4));
}

/* dW/dl of the Yeoh material over l^n - 1. */
static double integrand(const struct shape *shape, const struct material_spec *m, double l) {
  double i1 = shape->power == 2 ? l * l + 1 / (l * l) + 1 : 2 * l * l + pow(l, -4);
  double slope = shape->power == 2 ? 2 * l - 2 * pow(l, -3) : 4 * l - 4 * pow(l, -5);
  double x = i1 - 3;
  double w1 = m->c[0] + x * (2 * m->c[1] + 3 * m->c[2] * x);
  return w1 * slope / (pow(l, shape->power) - 1);
}

static double gauss3(const struct shape *shape, const struct material_spec *m, double a, double b) {
  double middle = 0.5 * (a + b), half = 0.5 * (b - a), d = sqrt(0.6) * half;
  return half / 9 *
         (5 * integrand(shape, m, middle - d) + 8 * integrand(shape, m, middle) +
          5 * integrand(shape, m, middle + d));
}

/* Adaptive quadrature: halves until three Gauss points agree with six. */
static double integrate(const struct shape *shape, const struct material_spec *m, double a,
                        double b, double tolerance) {
  double middle = 0.5 * (a + b), whole = gauss3(shape, m, a, b);
  double parts = gauss3(shape, m, a, middle) + gauss3(shape, m, middle, b);
  if (fabs(whole - parts) < tolerance) {
    return parts;
  }
  return integrate(shape, m, a, middle, tolerance) + integrate(shape, m, middle, b, tolerance);
}

static double quadrature(const struct shape *shape, const struct material_spec *m, double a) {
  return integrate(shape, m, outer_stretch(shape, a), a, 1e-12 * m->c[0]);
}

/* ---- tests ---- */

static const struct material_spec hooke = {
    .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 1e6};

struct row {
  const struct shape *shape;
  double p[4]; /* p/mu at the stretches below */
};
static const double stretches[4] = {1.1, 1.25, 1.5, 2.0};
static const struct row table[] = {
    {&cylinder, {0.131562, 0.275712, 0.428228, 0.574054}},
    {&sphere, {0.287155, 0.551869, 0.755433, 0.806927}},
};

START_TEST(neo_hooke_table) {
  const struct row *row = &table[_i];
  struct inflation c;
  inflation_open(&c, row->shape, &hooke, 3, 3);
  double at = 1;
  for (int k = 0; k < 4; k++) {
    char what[80];
    double p = inflate_from(&c, at, stretches[k]);
    at = stretches[k];
    snprintf(what, sizeof what, "neo-Hooke %s, p/mu at stretch %.2f", row->shape->name, at);
    ck_assert_double_eq_tol(neo_hooke(row->shape, at), row->p[k], 1e-6);
    report_check(what, row->shape == &sphere ? "3 x (3 x 3 x 3)" : "3 x 3", row->p[k], p, 1e-3);
  }
  inflation_close(&c);
}
END_TEST

/* Refinement in all directions: the pressure is a functional of the energy, order 2 p = 4. */
START_TEST(neo_hooke_order) {
  const struct shape *shape = table[_i].shape;
  const int meshes[] = {1, 2, 4};
  double error[3];
  for (int k = 0; k < 3; k++) {
    struct inflation c;
    char mesh[40], what[80];
    inflation_open(&c, shape, &hooke, meshes[k], meshes[k]);
    double p = inflate_from(&c, 1, 1.5), exact = neo_hooke(shape, 1.5);
    error[k] = p / exact - 1;
    snprintf(mesh, sizeof mesh, "%d through the wall", meshes[k]);
    snprintf(what, sizeof what, "neo-Hooke %s, refinement", shape->name);
    report_value(what, mesh, exact, p);
    inflation_close(&c);
  }
  double order = report_order(error[1], error[2], 2);
  printf("%s: observed order %.2f, %.2f\n", shape->name, report_order(error[0], error[1], 2),
         order);
  ck_assert_double_gt(order, 3.5);
}
END_TEST

/* Elastosil M4601; and a softening law, which passes a limit point. */
static const struct material_spec yeoh[] = {
    {.model = MATERIAL_YEOH, .terms = 2, .c = {0.11, 0.02}, .bulk_ratio = 1e6, .name = "Yeoh 2"},
    {.model = MATERIAL_YEOH,
     .terms = 3,
     .c = {0.25, -0.05, 0.005},
     .bulk_ratio = 1e6,
     .name = "Yeoh 3"},
};

START_TEST(yeoh_curve) {
  const struct shape *shape = table[_i / 2].shape;
  const struct material_spec *material = &yeoh[_i % 2];
  struct inflation c;
  inflation_open(&c, shape, material, 4, 3);
  double worst = 0, highest = 0, last = 0, exact = 0;
  bool limit_point = false;
  for (double a = 1.1; a < 2.05; a += 0.1) {
    last = inflate(&c, a);
    exact = quadrature(shape, material, a);
    worst = fmax(worst, fabs(last / exact - 1));
    highest = fmax(highest, exact);
    limit_point = limit_point || exact < highest;
  }
  char what[120];
  snprintf(what, sizeof what, "%s %s, p at stretch 2 (worst of the curve %.1e%s)", material->name,
           shape->name, worst, limit_point ? ", past a limit point" : "");
  report_check(what, shape == &sphere ? "3 x (4 x 3 x 3)" : "4 x 3", exact, last, 1e-3);
  ck_assert_double_lt(worst, 1e-3);
  ck_assert_int_eq(limit_point, _i % 2 == 1);
  inflation_close(&c);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("inflation");
  TCase *inflation = tcase_create("inflation");
  tcase_set_timeout(inflation, 200);
  tcase_add_loop_test(inflation, neo_hooke_table, 0, 2);
  tcase_add_loop_test(inflation, neo_hooke_order, 0, 2);
  tcase_add_loop_test(inflation, yeoh_curve, 0, 4);
  suite_add_tcase(suite, inflation);
  return suite_run(suite);
}
