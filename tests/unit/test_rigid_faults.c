/* Surfaces of triangles that are no body: the fault is named, with its place in the file's unit. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/rigid/shape.h"
#include "tests/unit/rigid_triangles.h"
#include "tests/unit/suite.h"

#define MM 1e-3

/* The cube of 10 mm with a corner in the origin, 12 triangles: faces -z, +z, -y, +y, -x, +x. */
static const double cube[12][9] = {
    {0, 0, 0, 0, 10, 0, 10, 10, 0},    {0, 0, 0, 10, 10, 0, 10, 0, 0},
    {0, 0, 10, 10, 0, 10, 10, 10, 10}, {0, 0, 10, 10, 10, 10, 0, 10, 10},
    {0, 0, 0, 10, 0, 0, 10, 0, 10},    {0, 0, 0, 10, 0, 10, 0, 0, 10},
    {0, 10, 0, 0, 10, 10, 10, 10, 10}, {0, 10, 0, 10, 10, 10, 10, 10, 0},
    {0, 0, 0, 0, 0, 10, 0, 10, 10},    {0, 0, 0, 0, 10, 10, 0, 10, 0},
    {10, 0, 0, 10, 10, 0, 10, 10, 10}, {10, 0, 0, 10, 10, 10, 10, 0, 10}};

/* The cube with room for more triangles. */
struct draft {
  int count;
  double corner[40][9];
};

static struct draft draft_cube(void) {
  struct draft draft = {.count = 12};
  memcpy(draft.corner, cube, sizeof cube);
  return draft;
}

/* Another cube, shifted. */
static void add_cube(struct draft *draft, double x, double y, double z) {
  const double shift[3] = {x, y, z};
  for (int n = 0; n < 108; n++) {
    draft->corner[draft->count + n / 9][n % 9] = cube[n / 9][n % 9] + shift[n % 3];
  }
  draft->count += 12;
}

static void turn_over(double corner[9]) {
  for (int i = 0; i < 3; i++) {
    double swap = corner[i];
    corner[i] = corner[3 + i];
    corner[3 + i] = swap;
  }
}

static enum status make(const struct draft *draft, double unit, struct rigid_shape **shape,
                        struct error *error) {
  struct stl stl = {draft->count, (double *)draft->corner};
  return rigid_shape_create_surface(&stl, unit, RIGID_CREASE, shape, error);
}

static void check_fault(const struct draft *draft, const char *phrase) {
  struct rigid_shape *shape = NULL;
  struct error error = {.message = ""};
  ck_assert_int_eq(make(draft, MM, &shape, &error), STATUS_INVALID);
  ck_assert_ptr_null(shape);
  ck_assert_str_eq(error.pointer, "/stl");
  ck_assert_msg(strstr(error.message, phrase) != NULL, "%s", error.message);
}

START_TEST(the_cube_is_sound) {
  struct draft draft = draft_cube();
  struct rigid_shape *shape = NULL;
  struct rigid_mass mass;
  ck_assert_int_eq(make(&draft, MM, &shape, NULL), STATUS_OK);
  ck_assert(rigid_shape_mass(shape, &mass));
  ck_assert_double_eq_tol(mass.volume, 1e-6, 1e-18);
  ck_assert_double_eq_tol(mass.centroid[0], 5 * MM, 1e-15);
  ck_assert_double_eq_tol(mass.inertia[4], 1e-4 / 6, 1e-16);
  rigid_shape_destroy(shape);
}
END_TEST

START_TEST(a_missing_triangle_leaves_it_open) {
  struct draft draft = draft_cube();
  memcpy(draft.corner[3], draft.corner[11], sizeof draft.corner[3]);
  draft.count = 11;
  check_fault(&draft, "the surface is open: the edge from (");
  check_fault(&draft, "and so are 2 more edges");
  check_fault(&draft, "10)");
}
END_TEST

START_TEST(one_triangle_turned_over) {
  struct draft draft = draft_cube();
  turn_over(draft.corner[4]);
  check_fault(&draft, "the surface is not oriented: the edge from (");
  check_fault(&draft, "runs the same way in its neighbour");
}
END_TEST

START_TEST(everything_turned_over) {
  struct draft draft = draft_cube();
  for (int t = 0; t < draft.count; t++) {
    turn_over(draft.corner[t]);
  }
  check_fault(&draft, "inside out: it encloses a volume of -1000");
}
END_TEST

START_TEST(an_edge_of_more_than_two_triangles) {
  struct draft draft = draft_cube();
  add_cube(&draft, 10, 10, 0);
  check_fault(&draft, "belongs to more than two triangles");
  check_fault(&draft, "(10, 10, 0)");
}
END_TEST

START_TEST(parts_that_touch_in_a_point) {
  struct draft draft = draft_cube();
  add_cube(&draft, 10, 10, 10);
  check_fault(&draft, "touch in the point (10, 10, 10) alone");
}
END_TEST

START_TEST(several_shells) {
  struct draft draft = draft_cube();
  add_cube(&draft, 20, 0, 0);
  check_fault(&draft, "several shells: 12 of its 24 triangles hang together, and triangle 13 at "
                      "(20, 0, 0) is of another one");
}
END_TEST

START_TEST(triangles_without_area) {
  struct draft draft = draft_cube();
  /* On an edge: its corners differ, but are on a line. */
  static const double line[9] = {0, 0, 0, 5, 0, 0, 10, 0, 0};
  memcpy(draft.corner[draft.count++], line, sizeof line);
  check_fault(&draft,
              "triangle 13 of the surface has no area: (0, 0, 0), (5, 0, 0) and (10, 0, 0)");
  /* Two equal corners: left out, and nothing is missing. */
  draft = draft_cube();
  static const double point[9] = {0, 0, 0, 0, 0, 0, 10, 0, 0};
  memcpy(draft.corner[draft.count++], point, sizeof point);
  struct rigid_shape *shape = NULL;
  ck_assert_int_eq(make(&draft, MM, &shape, NULL), STATUS_OK);
  rigid_shape_destroy(shape);
  draft.count = 2;
  check_fault(&draft, "has 2 triangles");
}
END_TEST

/* A spike out of the bottom goes through the top and out. */
START_TEST(a_surface_through_itself) {
  struct draft draft = draft_cube();
  static const double foot[4][3] = {{0, 0, 0}, {0, 10, 0}, {10, 10, 0}, {10, 0, 0}};
  for (int k = 0; k < 4; k++) {
    double *corner = draft.corner[k < 2 ? k : draft.count++];
    memcpy(corner, foot[k], sizeof foot[k]);
    memcpy(corner + 3, foot[(k + 1) % 4], sizeof foot[k]);
    corner[6] = 6;
    corner[7] = 5;
    corner[8] = 15;
  }
  check_fault(&draft, "passes through itself: the edge from (");
  check_fault(&draft, "goes through triangle");
}
END_TEST

START_TEST(corners_are_welded) {
  struct draft draft = draft_cube();
  for (int n = 0; n < 108; n++) {
    draft.corner[n / 9][n % 9] += 4e-6 * ((n * 7919) % 5 - 2);
  }
  struct rigid_shape *shape = NULL;
  ck_assert_int_eq(make(&draft, MM, &shape, NULL), STATUS_OK);
  rigid_shape_destroy(shape);
  draft.corner[5][3] += 0.1;
  check_fault(&draft, "open");
}
END_TEST

START_TEST(units_that_cannot_be) {
  struct draft draft = draft_cube();
  struct rigid_shape *shape = NULL;
  struct error error = {.message = ""};
  ck_assert_int_eq(make(&draft, 1e-6, &shape, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/unit");
  ck_assert_ptr_nonnull(strstr(error.message, "0.01 mm long"));
  ck_assert_int_eq(make(&draft, 1.1, &shape, &error), STATUS_INVALID);
  ck_assert_ptr_nonnull(strstr(error.message, "11000 mm"));
  ck_assert_int_eq(make(&draft, NAN, &shape, &error), STATUS_INVALID);
  ck_assert_int_eq(make(&draft, 0, &shape, &error), STATUS_INVALID);
  struct stl stl = {draft.count, draft.corner[0]};
  ck_assert_int_eq(rigid_shape_create_surface(&stl, MM, -1, &shape, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/crease");
  /* Coordinates at the end of single precision overflow nothing. */
  for (int n = 0; n < 108; n++) {
    draft.corner[n / 9][n % 9] = 3e38 * (draft.corner[n / 9][n % 9] - 5) / 5;
  }
  ck_assert_int_eq(make(&draft, MM, &shape, &error), STATUS_INVALID);
  ck_assert_ptr_null(shape);
}
END_TEST

/* Whatever triangles: a shape that answers, or a sentence. */
START_TEST(random_triangles_end_well) {
  struct draft draft;
  unsigned state = 1;
  for (int n = 0; n < 400; n++) {
    draft = draft_cube();
    for (int changes = 0; changes <= n % 3; changes++) {
      state = state * 1664525u + 1013904223u;
      double *number = &draft.corner[state >> 8 & 7][state >> 16 & 7];
      *number = (double)(state >> 24) / 16;
    }
    struct rigid_shape *shape = NULL;
    struct error error = {.message = ""};
    enum status status = make(&draft, MM, &shape, &error);
    ck_assert(status == STATUS_OK || (status == STATUS_INVALID && error.message[0]));
    rigid_shape_destroy(shape);
  }
}
END_TEST

int main(void) {
  Suite *suite = suite_create("rigid: faults of surfaces");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, the_cube_is_sound);
  tcase_add_test(tcase, a_missing_triangle_leaves_it_open);
  tcase_add_test(tcase, one_triangle_turned_over);
  tcase_add_test(tcase, everything_turned_over);
  tcase_add_test(tcase, an_edge_of_more_than_two_triangles);
  tcase_add_test(tcase, parts_that_touch_in_a_point);
  tcase_add_test(tcase, several_shells);
  tcase_add_test(tcase, triangles_without_area);
  tcase_add_test(tcase, a_surface_through_itself);
  tcase_add_test(tcase, corners_are_welded);
  tcase_add_test(tcase, units_that_cannot_be);
  tcase_add_test(tcase, random_triangles_end_well);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
