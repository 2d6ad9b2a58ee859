/* Surfaces of triangles: as smooth as the shapes they come from, facets when asked for, sign,
 * volumes, skins, and every fault named with its place. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/rigid/shape.h"
#include "solver/rigid/skin.h"
#include "tests/unit/rigid_probe.h"
#include "tests/unit/rigid_triangles.h"
#include "tests/unit/suite.h"

#define MM 1e-3

static struct rigid_shape *surface_of(struct stl stl, double crease) {
  struct rigid_shape *shape = NULL;
  struct error error = {.message = ""};
  enum status status = rigid_shape_create_surface(&stl, MM, crease, &shape, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  stl_release(&stl);
  return shape;
}

/* ---- against the shapes they come from -------------------------------------------------- */

struct difference {
  double distance, normal, curvature; /* largest; mean over the points for the last */
};

/* Differences of a shape and its surface at points up to `depth` from it. */
static struct difference compare(const struct rigid_shape *exact, const struct rigid_shape *surface,
                                 double depth) {
  struct difference most = {0, 0, 0};
  double low[3], high[3];
  unsigned state = 9;
  rigid_shape_bounds(exact, low, high);
  for (int n = 0; n < 4000;) {
    struct rigid_nearest a, b;
    double x[3], curvature = 0;
    for (int i = 0; i < 3; i++) {
      x[i] = probe_random(&state, low[i] - depth, high[i] + depth);
    }
    if (!rigid_shape_nearest(exact, x, depth, &a) || a.distance < -depth) {
      continue;
    }
    n++;
    bool found = rigid_shape_nearest(surface, x, INFINITY, &b);
    for (int i = 0; i < 9 && found; i++) {
      double gap = a.curvature[i / 3][i % 3] - b.curvature[i / 3][i % 3];
      curvature += gap * gap;
    }
    for (int i = 0; i < 3; i++) {
      a.normal[i] -= b.normal[i];
    }
    most.distance = fmax(most.distance, found ? fabs(a.distance - b.distance) : INFINITY);
    most.normal = fmax(most.normal, vec3_norm(a.normal));
    most.curvature += sqrt(curvature) / 4000;
  }
  return most;
}

/* A ball of 40 mm: its facets of 1280 triangles are 0.09 mm off and lean by 5 degrees; the smooth
 * surface through the same corners is 4 um off, and leans by 0.35 degrees. */
START_TEST(a_ball_of_triangles_is_a_ball) {
  struct rigid_shape *ball = NULL;
  ck_assert_int_eq(rigid_shape_create_sphere(40 * MM, &ball, NULL), STATUS_OK);
  struct difference before = {1, 1, 1000};
  for (int level = 2; level <= 4; level++) {
    struct stl stl = triangles_of_ball(40 * MM, level);
    triangles_round(&stl);
    struct rigid_shape *surface = surface_of(stl, RIGID_CREASE);
    struct difference now = compare(ball, surface, 4 * MM);
    struct rigid_mass mass;
    ck_assert(rigid_shape_mass(surface, &mass));
    ck_assert_double_eq_tol(mass.volume / (4 * acos(-1) * 8e-6 / 3), 1, 4e-4 / pow(4, level - 1));
    ck_assert_double_eq_tol(mass.inertia[0] / 1.6e-4, 1, 4e-4 / pow(4, level - 1));
    ck_assert_double_lt(now.distance, before.distance / 3.5);
    ck_assert_double_lt(now.normal, before.normal / 1.8);
    ck_assert_double_lt(now.curvature, before.curvature / 1.2);
    before = now;
    rigid_shape_destroy(surface);
  }
  ck_assert_double_lt(before.distance, 1.2e-6);
  ck_assert_double_lt(before.normal, 0.003);
  ck_assert_double_lt(before.curvature, 0.05 * sqrt(2) / (20 * MM)); /* 5 % of the ball's own */
  rigid_shape_destroy(ball);
}
END_TEST

START_TEST(facets_stay_flat_when_asked_for) {
  struct rigid_shape *ball = NULL;
  ck_assert_int_eq(rigid_shape_create_sphere(40 * MM, &ball, NULL), STATUS_OK);
  struct rigid_shape *surface = surface_of(triangles_of_ball(40 * MM, 3), 0);
  struct difference flat = compare(ball, surface, 4 * MM);
  ck_assert_double_gt(flat.distance, 80e-6);
  ck_assert_double_lt(flat.distance, 100e-6);
  rigid_shape_destroy(surface);
  rigid_shape_destroy(ball);
}
END_TEST

START_TEST(a_sharp_box_of_triangles_is_the_box) {
  struct rigid_shape *box = NULL;
  ck_assert_int_eq(
      rigid_shape_create_box((const double[3]){30 * MM, 40 * MM, 50 * MM}, 0, &box, NULL),
      STATUS_OK);
  struct rigid_shape *surface = surface_of(triangles_of(box, 1e-5), RIGID_CREASE);
  struct difference most = compare(box, surface, 4 * MM);
  ck_assert_double_lt(most.distance, 1e-15);
  ck_assert_double_lt(most.normal, 1e-11);
  ck_assert_double_lt(most.curvature, 1e-7);
  struct rigid_mass a, b;
  ck_assert(rigid_shape_mass(box, &a) && rigid_shape_mass(surface, &b));
  ck_assert_double_eq_tol(b.volume / a.volume, 1, 1e-12);
  for (int i = 0; i < 9; i++) {
    ck_assert_double_eq_tol(b.inertia[i], a.inertia[i], 1e-15);
  }
  probe_turned(surface, 3 * MM, 200);
  rigid_shape_destroy(surface);
  rigid_shape_destroy(box);
}
END_TEST

/* Flat sides next to rounded rims, and creases next to round walls. tolerance: of the skin. */
START_TEST(flat_sides_do_not_bulge) {
  static const struct {
    double tolerance, distance, volume;
  } steps[] = {{50e-6, 25e-6, 1e-3}, {10e-6, 1.2e-6, 2e-5}};
  struct rigid_shape *shapes[3] = {NULL};
  ck_assert_int_eq(rigid_shape_create_box((const double[3]){30 * MM, 40 * MM, 50 * MM}, 5 * MM,
                                          &shapes[0], NULL),
                   STATUS_OK);
  ck_assert_int_eq(rigid_shape_create_cylinder(40 * MM, 60 * MM, 4 * MM, &shapes[1], NULL),
                   STATUS_OK);
  ck_assert_int_eq(rigid_shape_create_frustum(40 * MM, 20 * MM, 60 * MM, 0, &shapes[2], NULL),
                   STATUS_OK);
  for (int k = 0; k < 3; k++) {
    for (int n = 0; n < 2; n++) {
      struct rigid_shape *surface =
          surface_of(triangles_of(shapes[k], steps[n].tolerance), RIGID_CREASE);
      struct difference most = compare(shapes[k], surface, 2 * MM);
      struct rigid_mass a, b;
      ck_assert(rigid_shape_mass(shapes[k], &a) && rigid_shape_mass(surface, &b));
      ck_assert_double_lt(most.distance, steps[n].distance);
      ck_assert_double_eq_tol(b.volume / a.volume, 1, steps[n].volume);
      rigid_shape_destroy(surface);
    }
    rigid_shape_destroy(shapes[k]);
  }
}
END_TEST

START_TEST(normals_and_curvatures_are_derivatives) {
  struct rigid_shape *bottle = NULL;
  static const double profile[][2] = {{0, 0.030},     {0.060, 0.030}, {0.120, 0.030},
                                      {0.150, 0.020}, {0.165, 0.013}, {0.180, 0.013},
                                      {0.200, 0.013}};
  ck_assert_int_eq(
      rigid_shape_create_revolution(profile, 7, RIGID_PROFILE_SMOOTH, 3 * MM, &bottle, NULL),
      STATUS_OK);
  struct rigid_shape *surfaces[] = {surface_of(triangles_of_ball(40 * MM, 3), RIGID_CREASE),
                                    surface_of(triangles_of(bottle, 20e-6), RIGID_CREASE)};
  for (int k = 0; k < 2; k++) {
    probe_derivatives(surfaces[k], 1 * MM, 600, 1e-8, 1e-3);
    probe_turned(surfaces[k], 1 * MM, 100);
    rigid_shape_destroy(surfaces[k]);
  }
  rigid_shape_destroy(bottle);
}
END_TEST

/* Sign and distance against the plain way: all facets one by one, and the winding number. */
START_TEST(sign_and_distance_against_all_triangles) {
  struct rigid_shape *frustum = NULL;
  ck_assert_int_eq(rigid_shape_create_frustum(40 * MM, 12 * MM, 30 * MM, 0, &frustum, NULL),
                   STATUS_OK);
  struct stl stl = triangles_of(frustum, 300e-6);
  struct rigid_shape *surface = NULL;
  ck_assert_int_eq(rigid_shape_create_surface(&stl, MM, 0, &surface, NULL), STATUS_OK);
  unsigned state = 8;
  for (int n = 0; n < 1500; n++) {
    double x[3] = {probe_random(&state, -25, 25), probe_random(&state, -25, 25),
                   probe_random(&state, -20, 20)};
    double turns = 0, y[3] = {x[0] * MM, x[1] * MM, x[2] * MM};
    struct rigid_nearest at;
    for (int t = 0; t < stl.count; t++) {
      /* The solid angle of a triangle (van Oosterom, Strackee 1983). */
      double p[3][3], length[3], cross[3];
      for (int i = 0; i < 9; i++) {
        p[i / 3][i % 3] = stl.corner[9 * t + i] - x[i % 3];
      }
      for (int k = 0; k < 3; k++) {
        length[k] = vec3_norm(p[k]);
      }
      vec3_cross(p[1], p[2], cross);
      turns += 2 * atan2(vec3_dot(p[0], cross),
                         length[0] * length[1] * length[2] + vec3_dot(p[0], p[1]) * length[2] +
                             vec3_dot(p[1], p[2]) * length[0] + vec3_dot(p[2], p[0]) * length[1]);
    }
    ck_assert(rigid_shape_nearest(surface, y, INFINITY, &at));
    ck_assert((at.distance < 0) == (turns > 2 * acos(-1)));
    struct rigid_nearest smooth;
    ck_assert(rigid_shape_nearest(frustum, y, INFINITY, &smooth));
    ck_assert_double_eq_tol(at.distance, smooth.distance, 400e-6);
  }
  stl_release(&stl);
  rigid_shape_destroy(surface);
  rigid_shape_destroy(frustum);
}
END_TEST

START_TEST(beyond_reach_nothing_is_told) {
  struct rigid_shape *surface = surface_of(triangles_of_ball(40 * MM, 3), RIGID_CREASE);
  struct rigid_nearest at;
  ck_assert(!rigid_shape_nearest(surface, (double[3]){0, 0, 30 * MM}, 9.9 * MM, &at));
  ck_assert(rigid_shape_nearest(surface, (double[3]){0, 0, 30 * MM}, 10.1 * MM, &at));
  ck_assert(!rigid_shape_nearest(surface, (double[3]){15 * MM, 15 * MM, 15 * MM}, 5.9 * MM, &at));
  ck_assert(rigid_shape_nearest(surface, (double[3]){1 * MM, 0, 0}, 0, &at));
  ck_assert_double_eq_tol(at.distance, -19 * MM, 1e-4);
  rigid_shape_destroy(surface);
}
END_TEST

/* ---- skins ------------------------------------------------------------------------------ */

START_TEST(skins_are_closed_and_near) {
  static const double profile[][2] = {{0, 0},        {0, 0.020},     {0.004, 0.026},
                                      {0.08, 0.034}, {0.082, 0.032}, {0.08, 0.030},
                                      {0.01, 0.024}, {0.006, 0.018}, {0.006, 0}};
  struct rigid_shape *shapes[4] = {NULL};
  ck_assert_int_eq(rigid_shape_create_sphere(40 * MM, &shapes[0], NULL), STATUS_OK);
  ck_assert_int_eq(rigid_shape_create_box((const double[3]){20 * MM, 20 * MM, 50 * MM}, 10 * MM,
                                          &shapes[1], NULL),
                   STATUS_OK);
  ck_assert_int_eq(rigid_shape_create_cylinder(30 * MM, 20 * MM, 10 * MM, &shapes[2], NULL),
                   STATUS_OK);
  ck_assert_int_eq(rigid_shape_create_revolution(profile, sizeof profile / sizeof *profile,
                                                 RIGID_PROFILE_SMOOTH, 0, &shapes[3], NULL),
                   STATUS_OK);
  for (int k = 0; k < 4; k++) {
    struct rigid_skin skin;
    ck_assert_int_eq(rigid_shape_skin(shapes[k], 50e-6, 0, &skin, NULL), STATUS_OK);
    for (int v = 0; v < skin.vertex_count; v++) {
      struct rigid_nearest at;
      ck_assert(rigid_shape_nearest(shapes[k], skin.vertex + 3 * v, 1, &at));
      ck_assert_double_eq_tol(at.distance, 0, 1e-12);
    }
    for (int t = 0; t < skin.triangle_count; t++) {
      const int *corner = skin.triangle + 3 * t;
      struct rigid_nearest at;
      double x[3] = {0};
      for (int i = 0; i < 9; i++) {
        x[i % 3] += skin.vertex[3 * corner[i / 3] + i % 3] / 3;
      }
      ck_assert(rigid_shape_nearest(shapes[k], x, 1, &at));
      ck_assert_double_eq_tol(at.distance, 0, 100e-6);
    }
    rigid_skin_release(&skin);
    /* Closed, oriented, one body: what a surface is checked for. */
    rigid_shape_destroy(surface_of(triangles_of(shapes[k], 50e-6), RIGID_CREASE));
    rigid_shape_destroy(shapes[k]);
  }
}
END_TEST

START_TEST(a_plane_is_a_square_of_its_extent) {
  struct rigid_shape *plane = NULL;
  struct rigid_skin skin;
  ck_assert_int_eq(rigid_shape_create_plane(&plane, NULL), STATUS_OK);
  ck_assert_int_eq(rigid_shape_skin(plane, 1e-5, 0.2, &skin, NULL), STATUS_OK);
  ck_assert(skin.vertex_count == 4 && skin.triangle_count == 2 && skin.vertex[0] == -0.2);
  rigid_skin_release(&skin);
  rigid_shape_destroy(plane);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("rigid: surfaces of triangles");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, a_ball_of_triangles_is_a_ball);
  tcase_add_test(tcase, facets_stay_flat_when_asked_for);
  tcase_add_test(tcase, a_sharp_box_of_triangles_is_the_box);
  tcase_add_test(tcase, flat_sides_do_not_bulge);
  tcase_add_test(tcase, normals_and_curvatures_are_derivatives);
  tcase_add_test(tcase, sign_and_distance_against_all_triangles);
  tcase_add_test(tcase, beyond_reach_nothing_is_told);
  tcase_add_test(tcase, skins_are_closed_and_near);
  tcase_add_test(tcase, a_plane_is_a_square_of_its_extent);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
