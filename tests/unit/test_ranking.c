/* Ranking of a study's members: measures of known curves, scores by hand. */
#include <math.h>
#include <stdlib.h>

#include "solver/explore/ranking.h"
#include "tests/unit/suite.h"

enum { POINTS = 241, LENGTH_MM = 120 };

static const double degree = M_PI / 180;

/* A straight body of 120 mm that rises by `tilt`, and the same bent to an arc of `turn` in all. */
static void make_arc(double tilt, double turn, double *rest, double *now) {
  for (int p = 0; p < POINTS; p++) {
    double s = (double)LENGTH_MM * p / (POINTS - 1), t = turn * s / LENGTH_MM;
    double radius = LENGTH_MM / turn;
    double x = radius * sin(t), z = -radius * (1 - cos(t));
    rest[3 * p] = s * cos(tilt);
    rest[3 * p + 1] = now[3 * p + 1] = 0;
    rest[3 * p + 2] = s * sin(tilt);
    now[3 * p] = x * cos(tilt) - z * sin(tilt);
    now[3 * p + 2] = x * sin(tilt) + z * cos(tilt);
  }
}

START_TEST(an_arc_is_measured) {
  static const double station[3] = {0.04, 0.07, 0.1};
  static const double tilts[] = {0, 0.05}, turns[] = {1, 9};
  double rest[3 * POINTS], now[3 * POINTS], turn = turns[_i / 2], tilt = tilts[_i % 2];
  struct ranking_measures measures;
  make_arc(tilt, turn, rest, now);
  ck_assert(ranking_measure(rest, now, POINTS, station, 3, &measures));
  for (int k = 0; k < 3; k++) {
    double s = 1e3 * station[k], angle = turn * s / LENGTH_MM;
    ck_assert_double_eq_tol(measures.bending[k], angle / degree, 2e-2);
    ck_assert_double_eq_tol(measures.slope[k], angle / degree / s, 1e-3);
    double fall = LENGTH_MM / turn * (cos(tilt) * (1 - cos(angle)) - sin(tilt) * sin(angle));
    ck_assert_double_eq_tol(measures.deflection[k], s * sin(tilt) + fall, 1e-2);
  }
}
END_TEST

START_TEST(a_station_beyond_the_end_is_refused) {
  static const double station[1] = {0.121};
  double rest[3 * POINTS], now[3 * POINTS];
  struct ranking_measures measures;
  make_arc(0, 1, rest, now);
  ck_assert(!ranking_measure(rest, now, POINTS, station, 1, &measures));
  ck_assert(!ranking_measure(rest, now, 1, station, 1, &measures));
}
END_TEST

/* Three members, two stations. By hand, extremes over all stations: bending 10 to 50, slope 0.5 to
 * 1.0, deflection 0 to 20. Member 0: (0.4 x 0 + 0.3 x 0 + 0.3 x 0) and (0.4 x 0.5 + 0.3 x 0.4 + 0.3
 * x 0.5), mean 0.235; slopes 0.5, 0.7: variance 0.01. Member 1: 0.4 x 0.25 + 0.3 x 1 + 0.3 x 0.25
 * and 0.4 x 1 + 0.3 x 1 + 0.3 x 1, mean 0.7375; variance 0. Member 2: 0.4 x 0.125 + 0.3 x 0.2 + 0.3
 * x 0.1 and 0.4 x 0.75 + 0.3 x 1 + 0.3 x 0.75, mean 0.4825; slopes 0.6, 1.0: variance 0.04.
 * Variances normalised 0.25, 0, 1. */
static const struct ranking_measures three[3] = {
    {{10, 30}, {0.5, 0.7}, {0, 10}},
    {{20, 50}, {1.0, 1.0}, {5, 20}},
    {{15, 40}, {0.6, 1.0}, {2, 15}},
};
static const struct study_ranking printed = {.asked = true,
                                             .station_count = 2,
                                             .bending = 0.4,
                                             .slope = 0.3,
                                             .deflection = 0.3,
                                             .mean_weight = 0.5};

START_TEST(scores_by_hand) {
  struct ranking_score scores[3];
  ranking_score(&printed, false, three, 3, scores);
  ck_assert_double_eq_tol(scores[0].mean, 0.235, 1e-12);
  ck_assert_double_eq_tol(scores[1].mean, 0.7375, 1e-12);
  ck_assert_double_eq_tol(scores[2].mean, 0.4825, 1e-12);
  ck_assert_double_eq_tol(scores[0].variance, 0.01, 1e-12);
  ck_assert_double_eq_tol(scores[0].normalised_variance, 0.25, 1e-12);
  ck_assert_double_eq_tol(scores[0].final, 0.5 * 0.235 + 0.5 * 0.75, 1e-12);
  ck_assert_double_eq_tol(scores[1].final, 0.5 * 0.7375 + 0.5, 1e-12);
  ck_assert_double_eq_tol(scores[2].final, 0.5 * 0.4825, 1e-12);
  ck_assert_int_eq(scores[0].rank, 2);
  ck_assert_int_eq(scores[1].rank, 1);
  ck_assert_int_eq(scores[2].rank, 3);
}
END_TEST

/* Extremes at each station: member 0 is the least everywhere, member 1 the most. Member 2: bending
 * 0.5 at both, slope 0.2 and 1, deflection 0.4 and 0.5: mean 0.4 x 0.5 + 0.3 x 0.6 + 0.3 x 0.45. */
START_TEST(scores_by_station_by_hand) {
  struct ranking_score scores[3];
  ranking_score(&printed, true, three, 3, scores);
  ck_assert_double_eq_tol(scores[0].mean, 0, 1e-12);
  ck_assert_double_eq_tol(scores[1].mean, 1, 1e-12);
  ck_assert_double_eq_tol(scores[2].mean, 0.515, 1e-12);
  ck_assert_double_eq_tol(scores[2].final, 0.5 * 0.515, 1e-12);
}
END_TEST

START_TEST(equal_members_share_a_rank) {
  struct ranking_measures same[3] = {three[0], three[1], three[1]};
  struct ranking_score scores[3];
  ranking_score(&printed, false, same, 3, scores);
  ck_assert_int_eq(scores[1].rank, 1);
  ck_assert_int_eq(scores[2].rank, 1);
  ck_assert_int_eq(scores[0].rank, 3);
  ranking_score(&printed, false, &same[1], 2, scores);
  ck_assert_double_eq_tol(scores[0].mean, 0.4 * 0.5 + 0.3 * 0.5, 1e-12);
  ck_assert(isfinite(scores[0].final));
}
END_TEST

int main(void) {
  Suite *suite = suite_create("study: ranking");
  TCase *tcase = tcase_create("all");
  tcase_add_loop_test(tcase, an_arc_is_measured, 0, 4);
  tcase_add_test(tcase, a_station_beyond_the_end_is_refused);
  tcase_add_test(tcase, scores_by_hand);
  tcase_add_test(tcase, scores_by_station_by_hand);
  tcase_add_test(tcase, equal_members_share_a_rank);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
