/* What the distance from rigid objects costs: CPU time of a query for every kind of shape, and for
 * balls of ever more triangles, by the distance from the surface.
 *   bench_rigid [--json FILE]
 * Points in random order, as the faces of an actuator are not, and along lines around the ball, as
 * those of a face are. The shortest of three runs counts. */
#include <getopt.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/clock.h"
#include "solver/rigid/skin.h"
#include "solver/rigid/stl.h"
#include "tests/bench/bench.h"

enum { POINTS = 20000, REPETITIONS = 3 };

static const double depth = 1e-3; /* m, of points about shapes */

static double uniform(unsigned *state) {
  *state = *state * 1664525u + 1013904223u;
  return (*state >> 8) / 16777216.0;
}

/* Microseconds of CPU for a query, the least of some runs over all points. */
static double query_time(const struct rigid_shape *shape, double (*x)[3], int rounds) {
  double best = INFINITY;
  for (int k = 0; k < REPETITIONS; k++) {
    double start = clock_cpu_s();
    for (int n = 0; n < rounds * POINTS; n++) {
      struct rigid_nearest nearest;
      if (!rigid_shape_nearest(shape, x[n % POINTS], INFINITY, &nearest)) {
        return NAN;
      }
    }
    best = fmin(best, 1e6 * (clock_cpu_s() - start) / rounds / POINTS);
  }
  return best;
}

static void points_about(const struct rigid_shape *shape, double (*x)[3]) {
  double low[3], high[3];
  unsigned state = 1;
  rigid_shape_bounds(shape, low, high);
  for (int n = 0; n < POINTS;) {
    struct rigid_nearest nearest;
    for (int i = 0; i < 3; i++) {
      double from = fmax(low[i], -0.1) - depth, to = fmin(high[i], 0.1) + depth;
      x[n][i] = from + (to - from) * uniform(&state);
    }
    n += rigid_shape_nearest(shape, x[n], depth, &nearest) && nearest.distance > -depth;
  }
}

/* Points at one distance from a ball: anywhere, or one after the other along a spiral. */
static void points_off_ball(double radius, bool ordered, double (*x)[3]) {
  unsigned state = 1;
  for (int n = 0; n < POINTS; n++) {
    double z = ordered ? 1.8 * n / POINTS - 0.9 : 1.8 * uniform(&state) - 0.9;
    double angle = ordered ? 0.05 * n : 6.28 * uniform(&state), across = sqrt(1 - z * z);
    x[n][0] = radius * across * cos(angle);
    x[n][1] = radius * across * sin(angle);
    x[n][2] = radius * z;
  }
}

static struct rigid_shape *named_shape(const char *name) {
  static const double bottle[][2] = {{0, 0.030},     {0.060, 0.030}, {0.120, 0.030}, {0.150, 0.020},
                                     {0.165, 0.013}, {0.180, 0.013}, {0.200, 0.013}};
  struct rigid_shape *shape = NULL;
  switch (name[0]) {
  case 'p':
    rigid_shape_create_plane(&shape, NULL);
    break;
  case 's':
    rigid_shape_create_sphere(0.04, &shape, NULL);
    break;
  case 'c':
    rigid_shape_create_cylinder(0.04, 0.06, 0.004, &shape, NULL);
    break;
  case 'f':
    rigid_shape_create_frustum(0.04, 0.02, 0.06, 0.002, &shape, NULL);
    break;
  case 'b':
    rigid_shape_create_box((const double[3]){0.03, 0.04, 0.05}, 0.004, &shape, NULL);
    break;
  default:
    rigid_shape_create_revolution(bottle, 7, RIGID_PROFILE_SMOOTH, 0.003, &shape, NULL);
  }
  return shape;
}

static bool bench_shapes(double (*x)[3], json_t *rows) {
  static const char *const names[] = {"plane",   "sphere", "cylinder",
                                      "frustum", "box",    "revolution"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    struct rigid_shape *shape = named_shape(names[i]);
    if (!shape) {
      return false;
    }
    points_about(shape, x);
    double time = query_time(shape, x, 20);
    printf("%-12s %7.3f us a query\n", names[i], time);
    json_array_append_new(rows, json_pack("{s:s, s:f}", "shape", names[i], "query_us", time));
    rigid_shape_destroy(shape);
  }
  return true;
}

/* The triangles of a ball whose chords leave it by `tolerance`, in m. */
static struct stl ball_triangles(double tolerance) {
  struct rigid_shape *ball = named_shape("sphere");
  struct rigid_skin skin = {0};
  struct stl stl = {0};
  if (ball && rigid_shape_skin(ball, tolerance, 0, &skin, NULL) == STATUS_OK) {
    stl.corner = malloc(sizeof(double[9]) * (size_t)skin.triangle_count);
    stl.count = stl.corner ? skin.triangle_count : 0;
  }
  for (int c = 0; c < 3 * stl.count; c++) {
    memcpy(stl.corner + 3 * c, skin.vertex + 3 * skin.triangle[c], sizeof(double[3]));
  }
  rigid_skin_release(&skin);
  rigid_shape_destroy(ball);
  return stl;
}

static bool bench_surface(double tolerance, double (*x)[3], json_t *rows) {
  static const double off[] = {0.05e-3, 0.2e-3, 1e-3, -1e-3, 4e-3};
  struct stl stl = ball_triangles(tolerance);
  struct rigid_shape *surface = NULL;
  double start = clock_cpu_s();
  if (rigid_shape_create_surface(&stl, 1, RIGID_CREASE, &surface, NULL) != STATUS_OK) {
    stl_release(&stl);
    return false;
  }
  double creation = clock_cpu_s() - start;
  printf("%d triangles, made in %.3f s\n", stl.count, creation);
  for (size_t i = 0; i < sizeof off / sizeof *off; i++) {
    points_off_ball(0.02 + off[i], false, x);
    double random = query_time(surface, x, 1);
    points_off_ball(0.02 + off[i], true, x);
    double ordered = query_time(surface, x, 1);
    printf("  %+6.2f mm off: %7.2f us a query in random order, %7.2f us along lines\n",
           1e3 * off[i], random, ordered);
    json_array_append_new(rows, json_pack("{s:i, s:f, s:f, s:f, s:f}", "triangles", stl.count,
                                          "creation_s", creation, "off_mm", 1e3 * off[i],
                                          "random_us", random, "ordered_us", ordered));
  }
  stl_release(&stl);
  rigid_shape_destroy(surface);
  return true;
}

int main(int argc, char **argv) {
  static const struct option options[] = {{"json", required_argument, NULL, 'j'}, {0}};
  static double x[POINTS][3];
  static const double tolerances[] = {20e-6, 2e-6, 0.5e-6};
  const char *path = NULL;
  for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
    if (option != 'j') {
      return EXIT_FAILURE;
    }
    path = optarg;
  }
  json_t *shapes = json_array(), *surfaces = json_array();
  bool fine = bench_shapes(x, shapes);
  for (size_t i = 0; i < sizeof tolerances / sizeof *tolerances && fine; i++) {
    fine = bench_surface(tolerances[i], x, surfaces);
  }
  json_t *document = json_pack("{s:o, s:o, s:o}", "machine", bench_machine(bench_dgemm_rate()),
                               "shapes", shapes, "surfaces", surfaces);
  fine = fine && document && (!path || bench_write_json(path, document));
  json_decref(document);
  return fine ? EXIT_SUCCESS : EXIT_FAILURE;
}
