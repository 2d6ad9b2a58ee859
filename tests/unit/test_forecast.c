/* What is expected of a design from those before it: the weights against what they are to
 * reproduce, and the points that designs are. */
#include <math.h>
#include <string.h>

#include "solver/fe/forecast.h"
#include "tests/unit/suite.h"

enum { KNOWN = 24, FIRST = 3, SECOND = 41 };

/* A sequence of even spread in the square (Roberts 2018), in units as different as mm and Pa. */
static void place_of(int index, double point[DESIGN_NUMBERS]) {
  memset(point, 0, sizeof *point * DESIGN_NUMBERS);
  point[FIRST] = 0.002 + 0.001 * fmod(0.5 + 0.7548776662 * index, 1);
  point[SECOND] = 3e5 + 2e5 * fmod(0.5 + 0.5698402910 * index, 1);
  point[0] = 118; /* in which they do not differ */
}

/* A smooth function of the two coordinates. */
static double truth(const double *point) {
  double x = 1e3 * point[FIRST] - 2, y = 5e-6 * point[SECOND] - 1.5;
  return exp(0.8 * x) * (1 + 0.5 * y * y) + 0.3 * x * y;
}

static double mixed(const double *known, const double *weight, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++) {
    sum += weight[i] * truth(known + i * DESIGN_NUMBERS);
  }
  return sum;
}

static double sum_of(const double *weight, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++) {
    sum += weight[i];
  }
  return sum;
}

START_TEST(one_design_tells_what_it_is_itself) {
  double known[DESIGN_NUMBERS], place[DESIGN_NUMBERS], weight[1];
  place_of(0, known);
  place_of(1, place);
  ck_assert_int_eq(forecast_weights(known, 1, place, weight), STATUS_OK);
  ck_assert_double_eq_tol(weight[0], 1, 1e-12);
}
END_TEST

/* The error falls as designs become known, far below that of the nearest one. */
START_TEST(several_tell_more_than_the_nearest) {
  double known[KNOWN * DESIGN_NUMBERS], place[DESIGN_NUMBERS], weight[KNOWN], worst[KNOWN + 1];
  for (int i = 0; i < KNOWN; i++) {
    place_of(i, known + i * DESIGN_NUMBERS);
  }
  for (int count = 1; count <= KNOWN; count++) {
    worst[count] = 0;
    for (int k = 0; k < 50; k++) {
      place_of(1000 + k, place);
      ck_assert_int_eq(forecast_weights(known, count, place, weight), STATUS_OK);
      ck_assert_double_eq_tol(sum_of(weight, count), 1, 1e-6);
      worst[count] = fmax(worst[count], fabs(mixed(known, weight, count) - truth(place)));
    }
  }
  ck_assert_double_lt(worst[6], 0.5 * worst[1]);
  ck_assert_double_lt(worst[12], 0.05 * worst[1]);
  ck_assert_double_lt(worst[KNOWN], 0.03 * worst[1]);
}
END_TEST

/* But for the part of the nugget, which keeps 24 points of a smooth function apart. */
START_TEST(a_design_that_is_known_tells_itself) {
  double known[KNOWN * DESIGN_NUMBERS], weight[KNOWN];
  for (int i = 0; i < KNOWN; i++) {
    place_of(i, known + i * DESIGN_NUMBERS);
  }
  for (int i = 0; i < KNOWN; i++) {
    const double *place = known + i * DESIGN_NUMBERS;
    ck_assert_int_eq(forecast_weights(known, KNOWN, place, weight), STATUS_OK);
    ck_assert_double_eq_tol(mixed(known, weight, KNOWN), truth(place), 2e-3);
  }
}
END_TEST

START_TEST(equal_designs_share_their_weight) {
  double known[4 * DESIGN_NUMBERS], place[DESIGN_NUMBERS], weight[4];
  for (int i = 0; i < 4; i++) {
    place_of(i / 2, known + i * DESIGN_NUMBERS);
  }
  place_of(2, place);
  ck_assert_int_eq(forecast_weights(known, 4, place, weight), STATUS_OK);
  ck_assert_double_eq_tol(sum_of(weight, 4), 1, 1e-6);
  ck_assert_double_eq_tol(weight[0], weight[1], 1e-6);
  ck_assert_double_eq_tol(weight[2], weight[3], 1e-6);
}
END_TEST

/* Where a job differs, its point does, and equal jobs are one point. */
START_TEST(designs_are_points) {
  static const char *const changes[][2] = {{"/actuator/gap_wall", "\"2.1 mm\""},
                                           {"/actuator/taper/left", "\"1.5 deg\""},
                                           {"/load/pressure/to", "\"61 kPa\""},
                                           {"/material", "\"dragon-skin-20\""}};
  double point[DESIGN_NUMBERS], other[DESIGN_NUMBERS];
  struct job_spec spec;
  suite_must_read(NULL, NULL, &spec);
  design_numbers(&spec, point);
  design_numbers(&spec, other);
  ck_assert(memcmp(point, other, sizeof point) == 0);
  job_spec_release(&spec);
  for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
    suite_must_read(changes[i][0], changes[i][1], &spec);
    design_numbers(&spec, other);
    ck_assert(memcmp(point, other, sizeof point) != 0);
    for (int d = 0; d < DESIGN_NUMBERS; d++) {
      ck_assert(isfinite(other[d]));
    }
    job_spec_release(&spec);
  }
}
END_TEST

int main(void) {
  Suite *suite = suite_create("fe: what is expected of a design");
  TCase *tcase = tcase_create("all");
  tcase_add_unchecked_fixture(tcase, suite_share_reader, suite_drop_reader);
  tcase_add_test(tcase, one_design_tells_what_it_is_itself);
  tcase_add_test(tcase, several_tell_more_than_the_nearest);
  tcase_add_test(tcase, a_design_that_is_known_tells_itself);
  tcase_add_test(tcase, equal_designs_share_their_weight);
  tcase_add_test(tcase, designs_are_points);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
