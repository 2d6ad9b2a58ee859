/* Bodies of revolution by profiles: curves that pass through their points without waves, edges,
 * derivatives, volumes, and profiles that are refused. */
#include <math.h>
#include <string.h>

#include "solver/rigid/profile.h"
#include "solver/rigid/shape.h"
#include "tests/unit/rigid_probe.h"
#include "tests/unit/suite.h"

#define MM 1e-3
#define COUNT(list) ((int)(sizeof(list) / sizeof *(list)))

/* A bottle with a straight body, a shoulder and a neck. */
static const double bottle[][2] = {{0, 0.030},     {0.060, 0.030}, {0.120, 0.030}, {0.150, 0.020},
                                   {0.165, 0.013}, {0.180, 0.013}, {0.200, 0.013}};
/* A vase on a foot, with a belly and a lip. */
static const double vase[][2] = {{0, 0.025},     {0.020, 0.032}, {0.060, 0.045},
                                 {0.110, 0.030}, {0.140, 0.022}, {0.170, 0.030}};
/* A cup with its inside: out along the bottom, up the wall, round the lip, down to the axis. */
static const double cup[][2] = {{0, 0},         {0, 0.020},       {0.004, 0.026}, {0.010, 0.028},
                                {0.090, 0.038}, {0.0915, 0.0375}, {0.092, 0.036}, {0.0915, 0.0345},
                                {0.090, 0.034}, {0.012, 0.024},   {0.008, 0.022}, {0.006, 0.018},
                                {0.006, 0}};
/* A spool: flange, hub, flange. */
static const double spool[][2] = {{-0.030, 0.050}, {-0.024, 0.050}, {-0.024, 0.025},
                                  {0.024, 0.025},  {0.024, 0.050},  {0.030, 0.050}};
/* Level, then a rise of 76 degrees, then level. */
static const double step[][2] = {{0, 0.010}, {0.020, 0.010}, {0.025, 0.030}, {0.045, 0.030}};

static struct rigid_shape *revolved(const double (*point)[2], int count, enum rigid_profile form,
                                    double edge) {
  struct rigid_shape *shape = NULL;
  struct error error = {.message = ""};
  enum status status = rigid_shape_create_revolution(point, count, form, edge, &shape, &error);
  ck_assert_msg(status == STATUS_OK, "%s %s", error.pointer, error.message);
  return shape;
}

static const struct {
  const double (*point)[2];
  int count;
  enum rigid_profile form;
  double edge;
} bodies[] = {
    {bottle, COUNT(bottle), RIGID_PROFILE_SMOOTH, 3 * MM},
    {vase, COUNT(vase), RIGID_PROFILE_SMOOTH, 2 * MM},
    {cup, COUNT(cup), RIGID_PROFILE_SMOOTH, 0},
    {spool, COUNT(spool), RIGID_PROFILE_STRAIGHT, 2 * MM},
    {step, COUNT(step), RIGID_PROFILE_SMOOTH, 1 * MM},
    {spool, COUNT(spool), RIGID_PROFILE_STRAIGHT, 0},
};

START_TEST(smooth_curves_pass_through_their_points_without_waves) {
  struct meridian_piece piece[MERIDIAN_PIECES];
  for (int k = 0; k < COUNT(bodies); k++) {
    int pieces = 0, at = 0;
    if (bodies[k].form == RIGID_PROFILE_STRAIGHT) {
      continue;
    }
    ck_assert_int_eq(profile_curve(bodies[k].point, bodies[k].count, 0, 1, piece, &pieces, NULL),
                     STATUS_OK);
    for (int i = 0; i < pieces; i++) {
      /* Each piece begins at the end of the one before, in its direction. */
      double point[2], end[2] = {0, 1}, tangent[2];
      if (i > 0) {
        meridian_piece_point(&piece[i - 1], piece[i - 1].length, point, end);
        ck_assert_double_eq_tol(point[0], piece[i].start[0], 1e-12);
        ck_assert_double_eq_tol(point[1], piece[i].start[1], 1e-12);
        ck_assert_double_eq_tol(end[0] * piece[i].tangent[1], end[1] * piece[i].tangent[0], 1e-9);
      }
      for (int n = 0; n <= 20; n++) {
        meridian_piece_point(&piece[i], piece[i].length * n / 20, point, tangent);
        for (int c = 0; c < 2; c++) {
          double a = bodies[k].point[at][c], b = bodies[k].point[at + 1][c];
          ck_assert_double_ge(point[c], fmin(a, b) - 1e-12);
          ck_assert_double_le(point[c], fmax(a, b) + 1e-12);
        }
      }
      const double *next = bodies[k].point[at + 1];
      at += hypot(piece[i].end[0] - next[0], piece[i].end[1] - next[1]) < 1e-12;
    }
    ck_assert_int_eq(at, bodies[k].count - 1);
  }
}
END_TEST

START_TEST(points_of_a_circle_give_the_circle) {
  static const double degrees[] = {0, 20, 50, 75, 90, 100, 130, 160, 180};
  double point[COUNT(degrees)][2];
  for (int i = 0; i < COUNT(degrees); i++) {
    double angle = degrees[i] * acos(-1) / 180;
    point[i][0] = -0.03 * cos(angle);
    point[i][1] = i == 0 || i == COUNT(degrees) - 1 ? 0 : 0.03 * sin(angle);
  }
  struct rigid_shape *shape =
      revolved((const double(*)[2])point, COUNT(degrees), RIGID_PROFILE_SMOOTH, 0);
  struct rigid_mass mass;
  ck_assert(rigid_shape_mass(shape, &mass));
  ck_assert_double_eq_tol(mass.volume, 4 * acos(-1) * 27e-6 / 3, 1e-15);
  unsigned state = 5;
  for (int i = 0; i < 500; i++) {
    double x[3], square = 0;
    struct rigid_nearest at;
    for (int c = 0; c < 3; c++) {
      x[c] = probe_random(&state, -0.04, 0.04);
      square += x[c] * x[c];
    }
    ck_assert(rigid_shape_nearest(shape, x, INFINITY, &at));
    ck_assert_double_eq_tol(at.distance, sqrt(square) - 0.03, 1e-14);
  }
  rigid_shape_destroy(shape);
}
END_TEST

/* Points of the same outline in the other order make the same body. */
START_TEST(the_order_of_the_points_does_not_matter) {
  double point[COUNT(vase)][2];
  for (int i = 0; i < COUNT(vase); i++) {
    memcpy(point[i], vase[COUNT(vase) - 1 - i], sizeof *point);
  }
  struct rigid_shape *a = revolved(vase, COUNT(vase), RIGID_PROFILE_SMOOTH, 2 * MM);
  struct rigid_shape *b =
      revolved((const double(*)[2])point, COUNT(vase), RIGID_PROFILE_SMOOTH, 2 * MM);
  struct rigid_mass one, other;
  ck_assert(rigid_shape_mass(a, &one) && rigid_shape_mass(b, &other));
  ck_assert_double_eq_tol(one.volume, other.volume, 1e-15);
  ck_assert_double_eq_tol(one.inertia[0], other.inertia[0], 1e-15);
  rigid_shape_destroy(a);
  rigid_shape_destroy(b);
}
END_TEST

/* Whether the half plane's point is below the outline, by counting crossings of a ray. */
static bool below(double (*p)[2], int count, const double q[2]) {
  bool inside = false;
  for (int i = 0; i < count; i++) {
    const double *a = p[i], *b = p[(i + 1) % count];
    if ((a[1] > q[1]) != (b[1] > q[1]) &&
        q[0] < a[0] + (q[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) {
      inside = !inside;
    }
  }
  return inside;
}

START_TEST(distances_are_those_to_many_points_of_the_outline) {
  enum { PARTS = 400 };
  static double outline[20 * PARTS][2];
  struct meridian_piece piece[MERIDIAN_PIECES];
  for (int k = 0; k < COUNT(bodies); k++) {
    int pieces = 0, points = 0;
    struct rigid_shape *shape =
        revolved(bodies[k].point, bodies[k].count, bodies[k].form, bodies[k].edge);
    ck_assert_int_eq(profile_pieces(bodies[k].point, bodies[k].count, bodies[k].form,
                                    bodies[k].edge, piece, &pieces, NULL),
                     STATUS_OK);
    for (int i = 0; i < pieces; i++) {
      for (int n = 0; n < PARTS && points < COUNT(outline); n += 1 + pieces / 20) {
        meridian_piece_point(&piece[i], piece[i].length * n / PARTS, outline[points++], NULL);
      }
    }
    unsigned state = 6;
    for (int i = 0; i < 400; i++) {
      double low[3], high[3], x[3], best = INFINITY;
      rigid_shape_bounds(shape, low, high);
      for (int c = 0; c < 3; c++) {
        x[c] = probe_random(&state, low[c] - 10 * MM, high[c] + 10 * MM);
      }
      double q[2] = {x[2], hypot(x[0], x[1])};
      for (int n = 0; n < points; n++) {
        best = fmin(best, hypot(outline[n][0] - q[0], outline[n][1] - q[1]));
      }
      struct rigid_nearest at;
      ck_assert(rigid_shape_nearest(shape, x, INFINITY, &at));
      ck_assert_double_eq_tol(fabs(at.distance), best, 0.2 * MM);
      ck_assert(best < 0.2 * MM || (at.distance < 0) == below(outline, points, q));
    }
    rigid_shape_destroy(shape);
  }
}
END_TEST

START_TEST(normals_and_curvatures_are_derivatives) {
  for (int k = 0; k < COUNT(bodies) - 1; k++) {
    struct rigid_shape *shape =
        revolved(bodies[k].point, bodies[k].count, bodies[k].form, bodies[k].edge);
    probe_derivatives(shape, 0.4 * MM, 1000, 1e-8, 1e-4);
    probe_turned(shape, 0.4 * MM, 100);
    rigid_shape_destroy(shape);
  }
}
END_TEST

START_TEST(volumes_of_profiles) {
  const double pi = acos(-1);
  struct rigid_mass mass;
  /* Three cylinders. */
  struct rigid_shape *sharp = revolved(spool, COUNT(spool), RIGID_PROFILE_STRAIGHT, 0);
  ck_assert(rigid_shape_mass(sharp, &mass));
  double flange = pi * 2.5e-3 * 6 * MM, hub = pi * 6.25e-4 * 48 * MM;
  ck_assert_double_eq_tol(mass.volume, 2 * flange + hub, 1e-16);
  ck_assert_double_eq_tol(mass.centroid[2], 0, 1e-16);
  ck_assert_double_eq_tol(mass.inertia[8],
                          (2 * flange * 1.25e-3 + hub * 3.125e-4) / (2 * flange + hub), 1e-15);
  rigid_shape_destroy(sharp);
  /* An edge rounded by e takes away, or adds in a hollow, (1 - pi/4) e^2 times the way of the
   * centroid of this spandrel, which is 0.2234 e off the sharp edge (Pappus, Guldin). */
  struct rigid_shape *round = revolved(spool, COUNT(spool), RIGID_PROFILE_STRAIGHT, 2 * MM);
  struct rigid_mass less;
  ck_assert(rigid_shape_mass(round, &less));
  double area = (1 - pi / 4) * 4e-6, off = (10 - 3 * pi) / (12 - 3 * pi) * 2 * MM;
  double change = 2 * pi * area * (-4 * (50 * MM - off) + 2 * (25 * MM + off));
  ck_assert_double_eq_tol(less.volume - mass.volume, change, 1e-16);
  rigid_shape_destroy(round);
  /* The bottle's outside is wider than its straight lines, and no wider than a cylinder. */
  struct rigid_shape *full = revolved(bottle, COUNT(bottle), RIGID_PROFILE_SMOOTH, 0);
  double low[3], high[3];
  rigid_shape_bounds(full, low, high);
  ck_assert_double_eq_tol(high[0], 30 * MM, 1e-15);
  ck_assert_double_eq(low[2], 0);
  ck_assert_double_eq(high[2], 200 * MM);
  rigid_shape_destroy(full);
}
END_TEST

START_TEST(a_cup_is_hollow) {
  struct rigid_shape *shape = revolved(cup, COUNT(cup), RIGID_PROFILE_SMOOTH, 0);
  struct rigid_nearest at;
  ck_assert(rigid_shape_nearest(shape, (double[3]){0, 0, 50 * MM}, INFINITY, &at));
  ck_assert_double_gt(at.distance, 20 * MM);
  ck_assert(rigid_shape_nearest(shape, (double[3]){0, 0, 4 * MM}, INFINITY, &at));
  ck_assert_double_eq_tol(at.distance, -2 * MM, 1e-12);
  ck_assert_double_eq_tol(at.normal[2], 1, 1e-12);
  rigid_shape_destroy(shape);
}
END_TEST

/* ---- refusals --------------------------------------------------------------------------- */

static void check_refused(const double (*point)[2], int count, enum rigid_profile form, double edge,
                          const char *pointer, const char *phrase) {
  struct rigid_shape *shape = NULL;
  struct error error = {.message = ""};
  ck_assert_int_eq(rigid_shape_create_revolution(point, count, form, edge, &shape, &error),
                   STATUS_INVALID);
  ck_assert_ptr_null(shape);
  ck_assert_msg(strcmp(error.pointer, pointer) == 0 && strstr(error.message, phrase), "%s: %s",
                error.pointer, error.message);
}

START_TEST(profiles_that_cannot_be) {
  static const double negative[][2] = {{0, 0.01}, {0.01, -0.01}, {0.02, 0.01}};
  static const double touching[][2] = {{0, 0.01}, {0.01, 0}, {0.02, 0.01}};
  static const double twice[][2] = {{0, 0.01}, {0.01, 0.01}, {0.01, 0.01}};
  static const double flat[][2] = {{0, 0.01}, {0, 0.02}};
  static const double turning[][2] = {{0, 0.01}, {0.02, 0.01}, {0.02, 0.03}};
  static const double backwards[][2] = {{0.02, 0.03}, {0.02, 0.01}, {0, 0.01}};
  static const double knot[][2] = {{0, 0.01}, {0.03, 0.03}, {0.03, 0.01}, {0, 0.03}, {-0.01, 0.03}};
  static const double infinite[][2] = {{0, 0.01}, {NAN, 0.01}};
  static double many[RIGID_PROFILE_POINTS + 1][2];
  const enum rigid_profile smooth = RIGID_PROFILE_SMOOTH, straight = RIGID_PROFILE_STRAIGHT;
  check_refused(negative, 3, smooth, 0, "/profile/1", "-10 mm");
  check_refused(touching, 3, straight, 0, "/profile/1", "above 0 between the ends");
  check_refused(twice, 3, smooth, 0, "/profile/2", "the one before again");
  check_refused(flat, 2, straight, 0, "/profile", "encloses nothing");
  check_refused(turning, 3, smooth, 0, "/profile/1", "turns by 90 degrees");
  check_refused(backwards, 3, smooth, 0, "/profile/1", "turns by 90 degrees");
  check_refused(knot, 5, straight, 0, "/profile", "crosses itself");
  check_refused(infinite, 2, smooth, 0, "/profile/1", "nan");
  check_refused(bottle, 1, smooth, 0, "/profile", "1 points");
  check_refused((const double(*)[2])many, RIGID_PROFILE_POINTS + 1, smooth, 0, "/profile",
                "from 2 to 200");
  check_refused(bottle, COUNT(bottle), smooth, -1 * MM, "/rim", "-1 mm");
  check_refused(bottle, COUNT(bottle), smooth, 14 * MM, "/rim", "has no room");
  check_refused(spool, COUNT(spool), straight, 4 * MM, "/rim", "has no room");
}
END_TEST

/* Whatever the points: a body of finite volume, or a sentence. */
START_TEST(random_profiles_end_well) {
  unsigned state = 11;
  int made = 0;
  for (int n = 0; n < 3000; n++) {
    double point[12][2];
    int count = 2 + (int)probe_random(&state, 0, 10.99);
    for (int i = 0; i < count; i++) {
      point[i][0] = 0.01 * i + probe_random(&state, 0, n % 2 ? 0.009 : 0.03);
      point[i][1] = probe_random(&state, 0.005, n % 3 ? 0.01 : 0.05);
    }
    point[0][1] *= n % 4 > 0;
    struct rigid_shape *shape = NULL;
    struct rigid_mass mass;
    enum rigid_profile form = n % 5 ? RIGID_PROFILE_SMOOTH : RIGID_PROFILE_STRAIGHT;
    if (rigid_shape_create_revolution((const double(*)[2])point, count, form, 0.5e-3, &shape,
                                      NULL) != STATUS_OK) {
      ck_assert_ptr_null(shape);
      continue;
    }
    made++;
    ck_assert(rigid_shape_mass(shape, &mass));
    ck_assert(mass.volume > 0 && mass.volume < 0.01);
    double low[3], high[3];
    rigid_shape_bounds(shape, low, high);
    ck_assert(high[0] < 0.06 && low[2] > -0.01 && high[2] < 0.16);
    rigid_shape_destroy(shape);
  }
  ck_assert_int_gt(made, 1000);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("rigid: profiles");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, smooth_curves_pass_through_their_points_without_waves);
  tcase_add_test(tcase, points_of_a_circle_give_the_circle);
  tcase_add_test(tcase, the_order_of_the_points_does_not_matter);
  tcase_add_test(tcase, distances_are_those_to_many_points_of_the_outline);
  tcase_add_test(tcase, normals_and_curvatures_are_derivatives);
  tcase_add_test(tcase, volumes_of_profiles);
  tcase_add_test(tcase, a_cup_is_hollow);
  tcase_add_test(tcase, profiles_that_cannot_be);
  tcase_add_test(tcase, random_profiles_end_well);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
