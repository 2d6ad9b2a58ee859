/* Rigid shapes of formulas: distances against closed forms, normals and curvatures against
 * differences, volumes and inertia against closed forms, and sizes that are refused. */
#include <math.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/rigid/shape.h"
#include "tests/unit/rigid_probe.h"
#include "tests/unit/suite.h"

#define MM 1e-3

static struct rigid_shape *made(enum status status, struct rigid_shape *shape) {
  ck_assert_int_eq(status, STATUS_OK);
  return shape;
}

static struct rigid_shape *sphere(double diameter) {
  struct rigid_shape *shape = NULL;
  enum status status = rigid_shape_create_sphere(diameter, &shape, NULL);
  return made(status, shape);
}

static struct rigid_shape *cylinder(double diameter, double length, double rim) {
  struct rigid_shape *shape = NULL;
  enum status status = rigid_shape_create_cylinder(diameter, length, rim, &shape, NULL);
  return made(status, shape);
}

static struct rigid_shape *frustum(double base, double tip, double length, double rim) {
  struct rigid_shape *shape = NULL;
  enum status status = rigid_shape_create_frustum(base, tip, length, rim, &shape, NULL);
  return made(status, shape);
}

static struct rigid_shape *box(double x, double y, double z, double edge) {
  struct rigid_shape *shape = NULL;
  enum status status = rigid_shape_create_box((const double[3]){x, y, z}, edge, &shape, NULL);
  return made(status, shape);
}

/* ---- distances -------------------------------------------------------------------------- */

static double distance_at(const struct rigid_shape *shape, double x, double y, double z) {
  struct rigid_nearest nearest;
  ck_assert(rigid_shape_nearest(shape, (const double[3]){x, y, z}, INFINITY, &nearest));
  return nearest.distance;
}

/* Distance to a convex region of the half plane around a core rectangle, by Quilez' formula. */
static double rounded(double beyond_a, double beyond_b, double radius) {
  return hypot(fmax(beyond_a, 0), fmax(beyond_b, 0)) + fmin(fmax(beyond_a, beyond_b), 0) - radius;
}

START_TEST(distances_of_spheres_and_planes) {
  struct rigid_shape *ball = sphere(40 * MM), *plane = NULL;
  ck_assert_int_eq(rigid_shape_create_plane(&plane, NULL), STATUS_OK);
  unsigned state = 1;
  for (int i = 0; i < 1000; i++) {
    double x = probe_random(&state, -0.05, 0.05), y = probe_random(&state, -0.05, 0.05),
           z = probe_random(&state, -0.05, 0.05);
    ck_assert_double_eq_tol(distance_at(ball, x, y, z), sqrt(x * x + y * y + z * z) - 20 * MM,
                            1e-16);
    ck_assert_double_eq(distance_at(plane, x, y, z), z);
  }
  ck_assert_double_eq_tol(distance_at(ball, 0, 0, 0), -20 * MM, 1e-17);
  rigid_shape_destroy(ball);
  rigid_shape_destroy(plane);
}
END_TEST

START_TEST(distances_of_cylinders) {
  static const double rims[] = {0, 1 * MM, 5 * MM, 12 * MM};
  for (int k = 0; k < 4; k++) {
    struct rigid_shape *shape = cylinder(24 * MM, 50 * MM, rims[k]);
    unsigned state = 2;
    for (int i = 0; i < 2000; i++) {
      double x = probe_random(&state, -0.03, 0.03), y = probe_random(&state, -0.03, 0.03),
             z = probe_random(&state, -0.04, 0.04);
      double wanted =
          rounded(hypot(x, y) - (12 * MM - rims[k]), fabs(z) - (25 * MM - rims[k]), rims[k]);
      ck_assert_double_eq_tol(distance_at(shape, x, y, z), wanted, 1e-15);
    }
    rigid_shape_destroy(shape);
  }
}
END_TEST

START_TEST(distances_of_boxes) {
  static const double edges[] = {0, 2 * MM, 5 * MM};
  for (int k = 0; k < 3; k++) {
    struct rigid_shape *shape = box(10 * MM, 30 * MM, 20 * MM, edges[k]);
    unsigned state = 2;
    for (int i = 0; i < 2000; i++) {
      double x = probe_random(&state, -0.02, 0.02), y = probe_random(&state, -0.03, 0.03),
             z = probe_random(&state, -0.02, 0.02);
      double a = fabs(x) - (5 * MM - edges[k]), b = fabs(y) - (15 * MM - edges[k]),
             c = fabs(z) - (10 * MM - edges[k]);
      double wanted = hypot(hypot(fmax(a, 0), fmax(b, 0)), fmax(c, 0)) +
                      fmin(fmax(a, fmax(b, c)), 0) - edges[k];
      ck_assert_double_eq_tol(distance_at(shape, x, y, z), wanted, 1e-15);
    }
    rigid_shape_destroy(shape);
  }
}
END_TEST

/* A frustum has three sides in the half plane; the distance to each is that of a segment. */
static double to_segment(const double q[2], const double a[2], const double b[2]) {
  double ab[2] = {b[0] - a[0], b[1] - a[1]}, aq[2] = {q[0] - a[0], q[1] - a[1]};
  double s = (ab[0] * aq[0] + ab[1] * aq[1]) / (ab[0] * ab[0] + ab[1] * ab[1]);
  s = fmin(fmax(s, 0), 1);
  return hypot(aq[0] - s * ab[0], aq[1] - s * ab[1]);
}

START_TEST(distances_of_frusta) {
  static const double base[2][2] = {{-0.02, 0}, {-0.02, 0.015}}, side[2] = {0.02, 0.006},
                      tip[2] = {0.02, 0};
  struct rigid_shape *shape = frustum(30 * MM, 12 * MM, 40 * MM, 0);
  unsigned state = 4;
  for (int i = 0; i < 2000; i++) {
    double x = probe_random(&state, -0.03, 0.03), y = probe_random(&state, -0.03, 0.03),
           z = probe_random(&state, -0.04, 0.04);
    double q[2] = {z, hypot(x, y)};
    double wanted = fmin(to_segment(q, base[0], base[1]),
                         fmin(to_segment(q, base[1], side), to_segment(q, side, tip)));
    bool inside = fabs(z) < 0.02 && q[1] < 0.0105 - 0.225 * z;
    ck_assert_double_eq_tol(distance_at(shape, x, y, z), inside ? -wanted : wanted, 1e-15);
  }
  rigid_shape_destroy(shape);
  /* Rounded by r it is the frustum that is smaller by r all around, and r around it. */
  struct rigid_shape *round = frustum(30 * MM, 12 * MM, 40 * MM, 2 * MM);
  ck_assert_double_eq_tol(distance_at(round, 0, 0, 30 * MM), 10 * MM, 1e-15);
  ck_assert_double_eq_tol(
      distance_at(round, 10.5 * MM + 0.04 * cos(atan(0.225)), 0, 0.04 * sin(atan(0.225))), 0.04,
      1e-15);
  ck_assert_double_gt(distance_at(round, 15 * MM, 0, -20 * MM), 0.1 * MM);
  rigid_shape_destroy(round);
}
END_TEST

START_TEST(beyond_reach_nothing_is_told) {
  struct rigid_shape *shapes[] = {sphere(40 * MM), cylinder(40 * MM, 40 * MM, 1 * MM),
                                  box(40 * MM, 40 * MM, 40 * MM, 1 * MM)};
  for (int i = 0; i < 3; i++) {
    struct rigid_nearest nearest;
    ck_assert(rigid_shape_nearest(shapes[i], (double[3]){0, 29 * MM, 0}, 9.1 * MM, &nearest));
    ck_assert(!rigid_shape_nearest(shapes[i], (double[3]){0, 29 * MM, 0}, 8.9 * MM, &nearest));
    ck_assert(rigid_shape_nearest(shapes[i], (double[3]){0, 1 * MM, 0}, 1 * MM, &nearest));
    ck_assert_double_eq_tol(nearest.distance, -19 * MM, 1e-15);
    rigid_shape_destroy(shapes[i]);
  }
}
END_TEST

/* ---- derivatives ------------------------------------------------------------------------ */

START_TEST(normals_and_curvatures_are_derivatives) {
  struct rigid_shape *shapes[] = {
      sphere(40 * MM),
      cylinder(24 * MM, 50 * MM, 4 * MM),
      cylinder(24 * MM, 50 * MM, 12 * MM),
      frustum(30 * MM, 12 * MM, 40 * MM, 4 * MM),
      frustum(10 * MM, 30 * MM, 20 * MM, 3 * MM),
      box(20 * MM, 30 * MM, 25 * MM, 4 * MM),
      box(20 * MM, 20 * MM, 20 * MM, 10 * MM),
  };
  for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
    probe_derivatives(shapes[i], 2.5 * MM, 1000, 1e-8, 1e-5);
    probe_turned(shapes[i], 2.5 * MM, 200);
    rigid_shape_destroy(shapes[i]);
  }
}
END_TEST

/* On the axis the directions around and along the meridian are equal by symmetry. */
START_TEST(the_axis_is_no_exception) {
  struct rigid_shape *ball = sphere(40 * MM), *capsule = cylinder(20 * MM, 60 * MM, 10 * MM);
  struct rigid_shape *shapes[2] = {ball, capsule};
  const double radius[2] = {20 * MM, 10 * MM}, top[2] = {20 * MM, 30 * MM};
  for (int k = 0; k < 2; k++) {
    for (int i = 0; i < 3; i++) {
      double off[3] = {0, 1e-14, 1e-9};
      struct rigid_nearest at;
      ck_assert(rigid_shape_nearest(shapes[k], (double[3]){off[i], 0, top[k] + 1 * MM}, 1, &at));
      ck_assert_double_eq_tol(at.distance, 1 * MM, 1e-15);
      ck_assert_double_eq_tol(at.normal[2], 1, 1e-12);
      ck_assert_double_eq_tol(at.curvature[0][0], 1 / (radius[k] + 1 * MM), 1e-5);
      ck_assert_double_eq_tol(at.curvature[1][1], 1 / (radius[k] + 1 * MM), 1e-5);
      ck_assert_double_eq_tol(at.curvature[2][2], 0, 1e-5);
    }
    rigid_shape_destroy(shapes[k]);
  }
}
END_TEST

/* ---- volumes ---------------------------------------------------------------------------- */

static void check_mass(struct rigid_shape *shape, double volume, double middle, double across,
                       double along, double tolerance) {
  struct rigid_mass mass;
  ck_assert(rigid_shape_mass(shape, &mass));
  ck_assert_double_eq_tol(mass.volume, volume, tolerance * volume);
  ck_assert_double_eq_tol(mass.centroid[2], middle, tolerance * 0.1);
  ck_assert_double_eq_tol(mass.inertia[0], across, tolerance * across);
  ck_assert_double_eq_tol(mass.inertia[4], across, tolerance * across);
  ck_assert_double_eq_tol(mass.inertia[8], along, tolerance * along);
  for (int i = 0; i < 9; i++) {
    ck_assert(i % 4 == 0 || mass.inertia[i] == 0);
  }
  rigid_shape_destroy(shape);
}

START_TEST(volumes_and_inertia) {
  const double pi = acos(-1), r = 20 * MM, h = 30 * MM;
  check_mass(sphere(2 * r), 4 * pi * r * r * r / 3, 0, 0.4 * r * r, 0.4 * r * r, 1e-13);
  check_mass(cylinder(2 * r, h, 0), pi * r * r * h, 0, (3 * r * r + h * h) / 12, r * r / 2, 1e-13);
  check_mass(box(2 * r, 2 * r, h, 0), 4 * r * r * h, 0, (4 * r * r + h * h) / 12, 8 * r * r / 12,
             1e-13);
  check_mass(box(2 * r, 2 * r, 2 * r, r), 4 * pi * r * r * r / 3, 0, 0.4 * r * r, 0.4 * r * r,
             1e-13);
  /* A cone cut off, by the difference of two cones: centroid from its base. */
  const double a = 30 * MM, b = 10 * MM;
  double centroid = h * (a * a + 2 * a * b + 3 * b * b) / (4 * (a * a + a * b + b * b));
  double along = 0.3 * (pow(a, 5) - pow(b, 5)) / (pow(a, 3) - pow(b, 3));
  struct rigid_mass mass;
  struct rigid_shape *cone = frustum(2 * a, 2 * b, h, 0);
  ck_assert(rigid_shape_mass(cone, &mass));
  ck_assert_double_eq_tol(mass.volume, pi * h * (a * a + a * b + b * b) / 3, 1e-18);
  ck_assert_double_eq_tol(mass.centroid[2], centroid - h / 2, 1e-15);
  ck_assert_double_eq_tol(mass.inertia[8], along, 1e-16);
  rigid_shape_destroy(cone);
  /* A capsule: a cylinder and two halves of a ball, each with its centroid 3 r / 8 from its plane.
   */
  double ball = 4 * pi * r * r * r / 3, middle = pi * r * r * h, reach = h / 2 + 3 * r / 8;
  double own = 0.4 * r * r - 9 * r * r / 64;
  check_mass(cylinder(2 * r, h + 2 * r, r), ball + middle, 0,
             (middle * (3 * r * r + h * h) / 12 + ball * (own + reach * reach)) / (ball + middle),
             (middle * r * r / 2 + ball * 0.4 * r * r) / (ball + middle), 1e-13);
}
END_TEST

/* Volume and moments by counting cells whose middle is inside, which is good to some 1e-3. */
START_TEST(moments_against_counting_cells) {
  enum { CELLS = 80 };
  struct rigid_shape *shapes[] = {box(20 * MM, 30 * MM, 24 * MM, 6 * MM),
                                  cylinder(30 * MM, 28 * MM, 6 * MM),
                                  frustum(30 * MM, 12 * MM, 30 * MM, 4 * MM)};
  for (int k = 0; k < 3; k++) {
    double low[3], high[3], cell = 1, sum[4] = {0};
    struct rigid_mass mass;
    rigid_shape_bounds(shapes[k], low, high);
    ck_assert(rigid_shape_mass(shapes[k], &mass));
    for (int n = 0; n < CELLS * CELLS * CELLS; n++) {
      double x[3] = {(n % CELLS + 0.5) / CELLS, (n / CELLS % CELLS + 0.5) / CELLS,
                     (n / CELLS / CELLS + 0.5) / CELLS};
      struct rigid_nearest nearest;
      for (int i = 0; i < 3; i++) {
        x[i] = low[i] + (high[i] - low[i]) * x[i];
      }
      if (rigid_shape_nearest(shapes[k], x, 0, &nearest)) {
        double z = x[2] - mass.centroid[2];
        sum[0] += 1;
        sum[1] += z;
        sum[2] += x[1] * x[1] + z * z;
        sum[3] += x[0] * x[0] + x[1] * x[1];
      }
    }
    for (int i = 0; i < 3; i++) {
      cell *= (high[i] - low[i]) / CELLS;
    }
    ck_assert_double_eq_tol(sum[0] * cell / mass.volume, 1, 2e-3);
    ck_assert_double_eq_tol(sum[1] / sum[0], 0, 1e-5);
    ck_assert_double_eq_tol(sum[2] / sum[0] / mass.inertia[0], 1, 2e-3);
    ck_assert_double_eq_tol(sum[3] / sum[0] / mass.inertia[8], 1, 2e-3);
    rigid_shape_destroy(shapes[k]);
  }
}
END_TEST

START_TEST(a_plane_has_no_volume) {
  struct rigid_shape *plane = NULL;
  struct rigid_mass mass;
  double low[3], high[3];
  ck_assert_int_eq(rigid_shape_create_plane(&plane, NULL), STATUS_OK);
  ck_assert(!rigid_shape_mass(plane, &mass));
  rigid_shape_bounds(plane, low, high);
  ck_assert(isinf(low[0]) && isinf(high[1]) && isinf(low[2]) && high[2] == 0);
  rigid_shape_destroy(plane);
}
END_TEST

START_TEST(bounds_hold_the_shape_closely) {
  struct rigid_shape *shape = frustum(30 * MM, 12 * MM, 40 * MM, 3 * MM);
  double low[3], high[3];
  rigid_shape_bounds(shape, low, high);
  ck_assert_double_eq_tol(low[2], -20 * MM, 1e-15);
  ck_assert_double_eq_tol(high[2], 20 * MM, 1e-15);
  /* The rounding of the base is widest somewhat above it, and less wide than the sharp edge. */
  ck_assert_double_eq_tol(distance_at(shape, high[0] + 5 * MM, 0, -17 * MM), 5 * MM, 1e-15);
  ck_assert(high[0] < 15 * MM && low[1] == -high[1]);
  rigid_shape_destroy(shape);
}
END_TEST

/* ---- refusals --------------------------------------------------------------------------- */

static void check_refused(enum status status, struct rigid_shape *shape, const struct error *error,
                          const char *pointer, const char *phrase) {
  ck_assert_int_eq(status, STATUS_INVALID);
  ck_assert_ptr_null(shape);
  ck_assert_str_eq(error->pointer, pointer);
  ck_assert_msg(strstr(error->message, phrase) != NULL, "%s", error->message);
}

START_TEST(sizes_that_cannot_be) {
  struct rigid_shape *shape = NULL;
  struct error e;
  enum status status = rigid_shape_create_sphere(-40 * MM, &shape, &e);
  check_refused(status, shape, &e, "/diameter", "-40 mm");
  status = rigid_shape_create_sphere(NAN, &shape, &e);
  check_refused(status, shape, &e, "/diameter", "nan");
  status = rigid_shape_create_sphere(INFINITY, &shape, &e);
  check_refused(status, shape, &e, "/diameter", "inf");
  status = rigid_shape_create_cylinder(40 * MM, 0, 0, &shape, &e);
  check_refused(status, shape, &e, "/length", "0 mm");
  status = rigid_shape_create_cylinder(40 * MM, 30 * MM, 16 * MM, &shape, &e);
  check_refused(status, shape, &e, "/rim", "16 mm: from 0 (sharp) to 15 mm");
  status = rigid_shape_create_cylinder(40 * MM, 30 * MM, -1 * MM, &shape, &e);
  check_refused(status, shape, &e, "/rim", "-1 mm");
  status = rigid_shape_create_frustum(40 * MM, 20 * 1e3, 30 * MM, 0, &shape, &e);
  check_refused(status, shape, &e, "/tip_diameter", "to 10 m");
  status = rigid_shape_create_frustum(40 * MM, 2 * MM, 30 * MM, 5 * MM, &shape, &e);
  check_refused(status, shape, &e, "/rim", "frustum is rounded by 5 mm");
  status = rigid_shape_create_box((double[3]){10 * MM, 1e-9, 1}, 0, &shape, &e);
  check_refused(status, shape, &e, "/size/1", "along y");
  status = rigid_shape_create_box((double[3]){10 * MM, 20 * MM, 1}, 6 * MM, &shape, &e);
  check_refused(status, shape, &e, "/edge", "to 5 mm");
}
END_TEST

int main(void) {
  Suite *suite = suite_create("rigid: shapes");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, distances_of_spheres_and_planes);
  tcase_add_test(tcase, distances_of_cylinders);
  tcase_add_test(tcase, distances_of_boxes);
  tcase_add_test(tcase, distances_of_frusta);
  tcase_add_test(tcase, beyond_reach_nothing_is_told);
  tcase_add_test(tcase, normals_and_curvatures_are_derivatives);
  tcase_add_test(tcase, the_axis_is_no_exception);
  tcase_add_test(tcase, volumes_and_inertia);
  tcase_add_test(tcase, moments_against_counting_cells);
  tcase_add_test(tcase, a_plane_has_no_volume);
  tcase_add_test(tcase, bounds_hold_the_shape_closely);
  tcase_add_test(tcase, sizes_that_cannot_be);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
