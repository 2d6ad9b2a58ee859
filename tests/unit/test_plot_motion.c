/* Plots of identified models and of cells in motion. */
#include <check.h>
#include <stdbool.h>
#include <stdlib.h>

#include "tests/unit/plot_bistable_samples.h"
#include "tests/unit/plot_pictures.h"
#include "tests/unit/suite.h"

#define BLUE 0, 114, 178
#define ORANGE 213, 94, 0
#define GREEN 0, 158, 115
#define INK 28, 37, 48
#define BLUE_BAND 204, 227, 240

/* Distances of colours: the same, and that of a thin line, which is never of its colour alone. */
enum { SAME = 4, LINE = 40, THIN = 100 };

/* Mean y of the pixels near a colour within a box; NaN when there are none. */
static double mean_in(const struct picture *picture, int left, int right, int top, int bottom,
                      int near, int r, int g, int b) {
  double sum = 0, count = 0;
  for (int y = top; y < bottom; y++) {
    for (int x = left; x < right; x++) {
      const unsigned char *p = picture->rgb + 3 * (y * (int)picture->image.width + x);
      bool same = abs(p[0] - r) < near && abs(p[1] - g) < near && abs(p[2] - b) < near;
      sum += same ? y : 0;
      count += same;
    }
  }
  return sum / count;
}

START_TEST(both_kinds_offer_theirs) {
  char text[300];
  json_t *identified = plot_sample_identify(), *motion = plot_sample_motion(false);
  ck_assert_str_eq(picture_offered("identify", identified, text), "coefficients fitted");
  ck_assert_str_eq(picture_offered("bistable", motion, text), "time phase snap");
  json_object_del(motion, "events");
  ck_assert_str_eq(picture_offered("bistable", motion, text), "time phase");
  ck_assert_str_eq(plot_names("identify")[1], "fitted");
  ck_assert_str_eq(plot_names("bistable")[0], "time");
  json_decref(identified);
  json_decref(motion);
}
END_TEST

START_TEST(every_plot_at_every_size) {
  json_t *identified = plot_sample_identify(), *one = plot_sample_motion(false);
  json_t *two = plot_sample_motion(true);
  picture_at_all_sizes("coefficients", identified, "two-modes");
  picture_at_all_sizes("fitted", identified, "nine-trials");
  picture_at_all_sizes("time", one, "cells");
  picture_at_all_sizes("time", two, "load");
  picture_at_all_sizes("phase", one, "cells");
  picture_at_all_sizes("snap", one, "cells");
  picture_at_all_sizes("snap", two, "load");
  json_decref(identified);
  json_decref(one);
  json_decref(two);
}
END_TEST

/* The stiffness is in the chart at the top left: of the compressed mode it falls, of the stretched
 * one it is below and level. The interval that would squeeze the damping is cut: both modes agree
 * there, and their marks lie in the middle of the chart. */
START_TEST(coefficients_are_where_they_belong) {
  json_t *identified = plot_sample_identify();
  struct picture picture = picture_of("coefficients", identified, NULL);
  double early = mean_in(&picture, 120, 180, 60, 270, SAME, BLUE);
  double late = mean_in(&picture, 300, 370, 60, 270, SAME, BLUE);
  double other = mean_in(&picture, 300, 370, 60, 270, SAME, ORANGE);
  ck_assert_msg(early < late - 20 && late < other - 10, "%g, %g, %g", early, late, other);
  /* the damping at 20 of both: neither at the top nor at the bottom of its chart */
  double damping = mean_in(&picture, 560, 740, 60, 270, SAME, ORANGE);
  ck_assert_msg(damping > 110 && damping < 240, "%g", damping);
  ck_assert_uint_gt(picture_count(&picture, BLUE_BAND), 300);
  size_t whole = picture_count(&picture, ORANGE);
  free(picture.rgb);
  json_t *modes = json_object_get(identified, "modes");
  json_object_del(json_array_get(modes, 1), "points");
  ck_assert_uint_lt(picture_pixels("coefficients", identified, ORANGE) + 500, whole);
  json_decref(identified);
}
END_TEST

/* Without mass and gamma the coefficients are those over the mass. */
START_TEST(coefficients_over_the_mass) {
  json_t *identified = plot_sample_identify(), *mode, *point;
  size_t m, i;
  json_array_foreach(json_object_get(identified, "modes"), m, mode) {
    json_object_del(mode, "polynomials");
    json_array_foreach(json_object_get(mode, "points"), i, point) {
      json_t *value = json_deep_copy(json_object_get(point, "stiffness_N_m"));
      json_object_set_new(point, "stiffness_per_mass_1_s2", value);
      json_object_del(point, "stiffness_N_m");
    }
  }
  struct picture picture = picture_of("coefficients", identified, NULL);
  ck_assert_double_lt(picture_mean_y(&picture, 60, 380, BLUE), 600);
  ck_assert_double_gt(picture_mean_y(&picture, 60, 160, ORANGE),
                      picture_mean_y(&picture, 60, 160, BLUE));
  free(picture.rgb);
  json_decref(identified);
}
END_TEST

/* Of a trial that was used and one that was held out, which was measured 1 mm above its simulation,
 * the residuals of the second are above those of the first, in the chart below at the left. */
START_TEST(residuals_of_trials_held_out) {
  json_t *identified = plot_sample_identify(), *trials = json_object_get(identified, "trials");
  while (json_array_size(trials) > 3) {
    json_array_remove(trials, json_array_size(trials) - 1);
  }
  json_array_remove(trials, 1);
  struct picture picture = picture_of("fitted", identified, NULL);
  double used = mean_in(&picture, 100, 340, 350, 560, THIN, BLUE);
  double held_out = mean_in(&picture, 100, 340, 350, 560, THIN, ORANGE);
  ck_assert_msg(held_out < used - 20, "%g is not above %g", held_out, used);
  free(picture.rgb);
  json_decref(identified);
}
END_TEST

/* The plate goes up at every snap, and so does the third cell at the last. */
START_TEST(the_plate_climbs_by_steps) {
  json_t *motion = plot_sample_motion(false);
  struct picture picture = picture_of("time", motion, NULL);
  /* 4 s on about 75 to 775 pixels; h in the upper third */
  double before[3];
  for (int i = 0; i < 3; i++) {
    before[i] = mean_in(&picture, 270 + 175 * i, 400 + 175 * i, 56, 240, SAME, INK);
  }
  ck_assert_msg(before[0] > before[1] + 10 && before[1] > before[2] + 10, "%g, %g, %g", before[0],
                before[1], before[2]);
  double cell[2] = {mean_in(&picture, 330, 390, 56, 268, LINE, GREEN),
                    mean_in(&picture, 640, 760, 56, 268, LINE, GREEN)};
  ck_assert_msg(cell[1] < cell[0] - 10, "%g is not above %g", cell[1], cell[0]);
  free(picture.rgb);
  ck_assert_uint_gt(picture_pixels("phase", motion, ORANGE), 100);
  json_decref(motion);
}
END_TEST

/* The last of the three is the fastest: the first cell is stretched, and only the third moves. */
START_TEST(the_fastest_snap_is_enlarged) {
  json_t *motion = plot_sample_motion(false);
  struct picture picture = picture_of("snap", motion, NULL);
  double before = mean_in(&picture, 90, 160, 56, 268, LINE, GREEN);
  double after = mean_in(&picture, 600, 740, 56, 268, LINE, GREEN);
  ck_assert_msg(after < before - 20, "%g is not above %g", after, before);
  free(picture.rgb);
  json_decref(motion);
}
END_TEST

START_TEST(motion_without_samples) {
  json_t *empty = json_pack("{s:s}", "kind", "bistable");
  json_t *bare = json_pack("{s:s, s:[{}], s:[{}, n]}", "kind", "identify", "modes", "trials");
  ck_assert_uint_gt(picture_pixels("time", empty, INK), 50);
  ck_assert_uint_gt(picture_pixels("phase", empty, INK), 50);
  ck_assert_uint_gt(picture_pixels("coefficients", bare, INK), 50);
  ck_assert_uint_gt(picture_pixels("fitted", bare, INK), 50);
  json_decref(empty);
  json_decref(bare);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("plots: identification and motion");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 120);
  tcase_add_test(tcase, both_kinds_offer_theirs);
  tcase_add_test(tcase, every_plot_at_every_size);
  tcase_add_test(tcase, coefficients_are_where_they_belong);
  tcase_add_test(tcase, coefficients_over_the_mass);
  tcase_add_test(tcase, residuals_of_trials_held_out);
  tcase_add_test(tcase, the_plate_climbs_by_steps);
  tcase_add_test(tcase, the_fastest_snap_is_enlarged);
  tcase_add_test(tcase, motion_without_samples);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
