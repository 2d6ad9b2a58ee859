/* Fronts and hypervolumes against their definitions, evaluated by brute force. */
#include <math.h>
#include <stdlib.h>

#include "solver/explore/pareto.h"
#include "solver/explore/random.h"
#include "tests/unit/suite.h"

enum { COUNT_MAX = 200 };

static bool beats(const double *a, const double *b, int objectives) {
  bool better = false;
  for (int k = 0; k < objectives; k++) {
    if (a[k] > b[k]) {
      return false;
    }
    better = better || a[k] < b[k];
  }
  return better;
}

/* Coarse values, so that some are equal. */
static void draw(double *y, int count, int objectives, uint64_t seed) {
  uint64_t random = seed;
  for (int i = 0; i < count * objectives; i++) {
    y[i] = (double)random_below(&random, 12);
  }
}

/* Peels fronts off: what nothing that is left dominates is the next. */
START_TEST(fronts_are_peeled_off) {
  static const int objectives[] = {1, 2, 3, 5};
  int m = objectives[_i], front[COUNT_MAX], wanted[COUNT_MAX] = {0}, open = COUNT_MAX;
  double y[5 * COUNT_MAX];
  struct error error;
  draw(y, COUNT_MAX, m, (uint64_t)_i + 3);
  for (int level = 1; open > 0; level++) {
    int found[COUNT_MAX] = {0};
    for (int i = 0; i < COUNT_MAX; i++) {
      found[i] = wanted[i] == 0;
      for (int j = 0; j < COUNT_MAX && found[i]; j++) {
        found[i] = wanted[j] != 0 || !beats(y + j * m, y + i * m, m);
      }
    }
    for (int i = 0; i < COUNT_MAX; i++) {
      if (found[i]) {
        wanted[i] = level;
        open--;
      }
    }
  }
  ck_assert(pareto_fronts(y, COUNT_MAX, m, front, &error) == STATUS_OK);
  for (int i = 0; i < COUNT_MAX; i++) {
    ck_assert_int_eq(front[i], wanted[i]);
  }
}
END_TEST

START_TEST(designs_without_a_value_have_no_front) {
  static const double y[] = {1, 2, NAN, 0, 2, 1, INFINITY, 0, 3, 3};
  int front[5];
  struct error error;
  ck_assert(pareto_fronts(y, 5, 2, front, &error) == STATUS_OK);
  ck_assert(front[0] == 1 && front[1] == 0 && front[2] == 1 && front[3] == 0 && front[4] == 2);
  ck_assert(pareto_fronts(y, 0, 2, front, &error) == STATUS_OK);
}
END_TEST

/* The volume of a union of boxes by inclusion and exclusion of all subsets. */
static double union_of_boxes(const double *y, int count, int m, const double *reference) {
  double volume = 0;
  for (unsigned subset = 1; subset < 1U << count; subset++) {
    double common = __builtin_popcount(subset) % 2 ? 1 : -1;
    for (int k = 0; k < m; k++) {
      double side = INFINITY;
      for (int i = 0; i < count; i++) {
        if (subset >> i & 1) {
          side = fmin(side, reference[k] - y[i * m + k]);
        }
      }
      common *= fmax(side, 0);
    }
    volume += common;
  }
  return volume;
}

START_TEST(hypervolumes_are_those_of_unions_of_boxes) {
  static const double reference[5] = {11, 10, 11, 9, 12};
  double y[5 * 12], volume;
  struct error error;
  for (int m = 1; m <= 5; m++) {
    for (uint64_t seed = 0; seed < 10; seed++) {
      draw(y, 12, m, 100 * seed + (uint64_t)m);
      ck_assert(pareto_hypervolume(y, 12, m, reference, &volume, &error) == STATUS_OK);
      ck_assert_double_eq_tol(volume, union_of_boxes(y, 12, m, reference), 1e-9);
    }
  }
  ck_assert(pareto_hypervolume(y, 0, 3, reference, &volume, &error) == STATUS_OK && volume == 0);
}
END_TEST

/* Points on a plane x + y + z = 1: with more and more of them the volume up to (1, 1, 1) tends to
 * 5/6 from below. Zitzler's (2000) first test function: y = 1 - sqrt(x), up to (1, 1): 2/3. */
START_TEST(dense_fronts_tend_to_their_limits) {
  double plane[3 * 400], curve[2 * 400], volume;
  static const double one[3] = {1, 1, 1};
  struct error error;
  int count = 0, n = 19;
  for (int i = 0; i <= n; i++) {
    for (int j = 0; i + j <= n; j++, count++) {
      plane[3 * count] = (double)i / n;
      plane[3 * count + 1] = (double)j / n;
      plane[3 * count + 2] = (double)(n - i - j) / n;
    }
  }
  ck_assert(pareto_hypervolume(plane, (size_t)count, 3, one, &volume, &error) == STATUS_OK);
  ck_assert_double_lt(volume, 5.0 / 6);
  ck_assert_double_gt(volume, 5.0 / 6 - 2.0 / n);
  for (int i = 0; i < 400; i++) {
    curve[2 * i] = (i + 0.5) / 400;
    curve[2 * i + 1] = 1 - sqrt(curve[2 * i]);
  }
  ck_assert(pareto_hypervolume(curve, 400, 2, one, &volume, &error) == STATUS_OK);
  ck_assert_double_eq_tol(volume, 2.0 / 3, 5e-3);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("explore: Pareto fronts");
  TCase *tcase = tcase_create("all");
  tcase_add_loop_test(tcase, fronts_are_peeled_off, 0, 4);
  tcase_add_test(tcase, designs_without_a_value_have_no_front);
  tcase_add_test(tcase, hypervolumes_are_those_of_unions_of_boxes);
  tcase_add_test(tcase, dense_fronts_tend_to_their_limits);
  tcase_set_timeout(tcase, 300);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
