#include "tests/unit/rigid_triangles.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/rigid/skin.h"

struct stl triangles_of(const struct rigid_shape *shape, double tolerance) {
  struct rigid_skin skin;
  ck_assert_int_eq(rigid_shape_skin(shape, tolerance, 0.1, &skin, NULL), STATUS_OK);
  struct stl stl = {skin.triangle_count, malloc(sizeof(double[9]) * (size_t)skin.triangle_count)};
  ck_assert_ptr_nonnull(stl.corner);
  for (int c = 0; c < 3 * skin.triangle_count; c++) {
    for (int i = 0; i < 3; i++) {
      stl.corner[3 * c + i] = 1e3 * skin.vertex[3 * skin.triangle[c] + i];
    }
  }
  rigid_skin_release(&skin);
  return stl;
}

static void middle(const double *a, const double *b, double radius, double *out) {
  double length = 0;
  for (int i = 0; i < 3; i++) {
    out[i] = a[i] + b[i];
    length += out[i] * out[i];
  }
  for (int i = 0; i < 3; i++) {
    out[i] *= radius / sqrt(length);
  }
}

struct stl triangles_of_ball(double diameter, int levels) {
  static const int faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                   {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                   {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                   {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  const double g = (1 + sqrt(5)) / 2, r = 500 * diameter, scale = r / sqrt(1 + g * g);
  const double corner[12][3] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  int count = 20 << 2 * levels, have = 20;
  double(*t)[9] = malloc(sizeof *t * (size_t)count);
  ck_assert_ptr_nonnull(t);
  for (int n = 0; n < 180; n++) {
    t[n / 9][n % 9] = scale * corner[faces[n / 9][n % 9 / 3]][n % 3];
  }
  for (; have < count; have *= 4) {
    for (int n = have - 1; n >= 0; n--) {
      double a[9], m[9];
      memcpy(a, t[n], sizeof a);
      for (int k = 0; k < 3; k++) {
        middle(a + 3 * k, a + 3 * ((k + 1) % 3), r, m + 3 * k);
      }
      memcpy(t[4 * n], m, sizeof m);
      for (int k = 0; k < 3; k++) {
        memcpy(t[4 * n + 1 + k], a + 3 * k, sizeof(double[3]));
        memcpy(t[4 * n + 1 + k] + 3, m + 3 * k, sizeof(double[3]));
        memcpy(t[4 * n + 1 + k] + 6, m + 3 * ((k + 2) % 3), sizeof(double[3]));
      }
    }
  }
  return (struct stl){count, t[0]};
}

void triangles_round(struct stl *stl) {
  for (int n = 0; n < 9 * stl->count; n++) {
    stl->corner[n] = (double)(float)stl->corner[n];
  }
}
