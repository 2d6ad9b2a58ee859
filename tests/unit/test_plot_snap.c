/* Plots of bistable actuators: paths, shapes, held forces, harmonics, and several in one. */
#include <check.h>
#include <math.h>
#include <stdlib.h>

#include "tests/unit/plot_bistable_samples.h"
#include "tests/unit/plot_pictures.h"
#include "tests/unit/suite.h"

/* Colours of series, and of what lies in the meridian. */
#define BLUE 0, 114, 178
#define ORANGE 213, 94, 0
#define GREEN 0, 158, 115
#define PINK 204, 121, 167
#define SILICONE 158, 199, 224

START_TEST(a_snap_offers_what_it_has) {
  char text[300];
  json_t *snap = plot_sample_snap(35);
  ck_assert_str_eq(picture_offered("snap", snap, text), "snap-path shapes held stability");
  json_object_del(snap, "shapes");
  json_object_del(snap, "held");
  json_object_set_new(snap, "harmonics", json_array());
  ck_assert_str_eq(picture_offered("snap", snap, text), "snap-path");
  ck_assert_int_eq(picture_refuse_one("shapes", snap, NULL), STATUS_NOT_FOUND);
  ck_assert_int_eq(picture_refuse_one("held", snap, NULL), STATUS_NOT_FOUND);
  ck_assert_int_eq(picture_refuse_one("stability", snap, NULL), STATUS_NOT_FOUND);
  ck_assert_int_eq(picture_refuse_one("time", snap, NULL), STATUS_NOT_FOUND);
  json_decref(snap);
}
END_TEST

START_TEST(every_plot_at_every_size) {
  static const char *const plots[] = {"snap-path", "shapes", "held", "stability"};
  json_t *snap = plot_sample_snap(35);
  picture_at_all_sizes(plots[_i], snap, "snap");
  json_decref(snap);
}
END_TEST

/* Stretches that are not stable are dashed: less ink than if they were. */
START_TEST(unstable_stretches_are_dashed) {
  json_t *snap = plot_sample_snap(35);
  size_t with = picture_pixels("snap-path", snap, BLUE), index, k;
  json_t *path, *point;
  json_array_foreach(json_object_get(snap, "paths"), index, path) {
    json_array_foreach(json_object_get(path, "points"), k, point) {
      json_object_set_new(point, "stable", json_true());
    }
  }
  ck_assert_uint_gt(picture_pixels("snap-path", snap, BLUE), with + 300);
  json_decref(snap);
}
END_TEST

/* Both limit points of the pressure path lie in the upper chart, the trigger above the release;
 * the states of rest in the lower one. */
START_TEST(events_are_where_they_belong) {
  json_t *snap = plot_sample_snap(35);
  struct picture picture = picture_of("snap-path", snap, NULL);
  /* h from -2 to 28 mm on about 90 to 780 pixels: limit points at 4.2 and 18.5 mm */
  double trigger = picture_mean_y(&picture, 210, 290, ORANGE);
  double release = picture_mean_y(&picture, 500, 620, ORANGE);
  double rest = picture_mean_y(&picture, 640, 780, GREEN);
  ck_assert_msg(trigger < release && release < 320, "%g, %g", trigger, release);
  ck_assert_msg(rest > 320, "%g", rest);
  free(picture.rgb);
  json_decref(snap);
}
END_TEST

/* Both sides of the axis are drawn, in one scale: the taller shape has more of each material. */
START_TEST(shapes_are_mirrored_and_true) {
  json_t *snap = plot_sample_snap(35), *shapes = json_object_get(snap, "shapes");
  json_t *short_one = json_deep_copy(snap), *tall = json_deep_copy(snap);
  ck_assert_uint_gt(picture_pixels("shapes", snap, ORANGE), 400);
  /* one kept beside the tallest, so that the scale stays */
  json_array_remove(json_object_get(short_one, "shapes"), 1);
  json_array_remove(json_object_get(tall, "shapes"), 0);
  double low = (double)picture_pixels("shapes", short_one, SILICONE);
  double high = (double)picture_pixels("shapes", tall, SILICONE);
  /* 20 + 50 against 45 + 50 mm, but for the edges and the key */
  ck_assert_double_eq_tol(high / low, 95.0 / 70.0, 0.06);
  json_array_clear(shapes);
  json_array_append_new(
      shapes, json_pack("{s:[{s:s, s:[[f]]}]}", "regions", "region", "pet", "outline_mm", 3.0));
  ck_assert_uint_lt(picture_pixels("shapes", snap, ORANGE), 10);
  json_decref(short_one);
  json_decref(tall);
  json_decref(snap);
}
END_TEST

START_TEST(the_published_force_when_there_is_one) {
  json_t *snap = plot_sample_snap(35);
  ck_assert_uint_gt(picture_pixels("held", snap, BLUE), 500);
  ck_assert_uint_eq(picture_pixels("held", snap, ORANGE), 0);
  json_object_set_new(
      snap, "published",
      json_pack("[{s:s, s:f}]", "metric", "force_per_pressure_N_per_kPa", "value", 0.5));
  struct picture picture = picture_of("held", snap, NULL);
  /* the lower slope is the lower line */
  ck_assert_double_gt(picture_mean_y(&picture, 500, 700, ORANGE),
                      picture_mean_y(&picture, 500, 700, BLUE) + 50);
  free(picture.rgb);
  json_decref(snap);
}
END_TEST

/* The harmonic that is lost first has the lowest mark: without it the picture has nothing there. */
START_TEST(the_first_loss_is_the_lowest) {
  json_t *snap = plot_sample_snap(35);
  struct picture picture = picture_of("stability", snap, NULL);
  /* 13 harmonics between 70 and 775: n = 9 about 585 */
  double ninth = picture_mean_y(&picture, 570, 600, BLUE);
  double fifth = picture_mean_y(&picture, 350, 385, BLUE);
  ck_assert_msg(ninth > fifth + 20, "%g is not below %g", ninth, fifth);
  free(picture.rgb);
  json_decref(snap);
}
END_TEST

/* Under vacuum the pressures fall: what is lost first is the highest mark. */
START_TEST(losses_under_vacuum) {
  json_t *snap = plot_sample_snap(35), *state;
  size_t index;
  json_array_foreach(json_object_get(snap, "harmonics"), index, state) {
    double pressure = json_number_value(json_object_get(state, "pressure_kPa"));
    json_object_set_new(state, "pressure_kPa", json_real(-pressure));
  }
  struct picture picture = picture_of("stability", snap, NULL);
  double ninth = picture_mean_y(&picture, 570, 600, BLUE);
  double fifth = picture_mean_y(&picture, 350, 385, BLUE);
  ck_assert_msg(ninth < fifth - 20, "%g is not above %g", ninth, fifth);
  free(picture.rgb);
  json_decref(snap);
}
END_TEST

/* Without a path under axial force the one under pressure has the whole sheet. */
START_TEST(one_load_alone) {
  json_t *snap = plot_sample_snap(35);
  json_array_remove(json_object_get(snap, "paths"), 0);
  struct picture picture = picture_of("snap-path", snap, NULL);
  ck_assert_double_gt(picture_mean_y(&picture, 500, 620, ORANGE), 330);
  free(picture.rgb);
  json_decref(snap);
}
END_TEST

/* The motion that a job asks for is part of its result. */
START_TEST(a_snap_in_motion) {
  char text[300];
  json_t *snap = plot_sample_snap(35), *motion = plot_sample_motion(false);
  size_t alone = picture_pixels("time", motion, GREEN);
  json_object_set_new(snap, "motion", motion);
  ck_assert_str_eq(picture_offered("snap", snap, text),
                   "snap-path shapes held stability motion snap");
  ck_assert_uint_eq(picture_pixels("motion", snap, GREEN), alone);
  picture_at_all_sizes("snap", snap, "of-three");
  json_decref(snap);
}
END_TEST

static void draw_four(json_t *results[4], const char *name) {
  struct plot_input inputs[4];
  for (size_t i = 0; i < 4; i++) {
    inputs[i] = (struct plot_input){.result = results[i], .title = "design", .job_id = 1 + (int)i};
  }
  struct picture picture = picture_draw("overlay", inputs, 4, 800, 600, name);
  ck_assert_uint_gt(picture_count(&picture, BLUE), 200);
  ck_assert_uint_gt(picture_count(&picture, ORANGE), 100);
  ck_assert_uint_gt(picture_count(&picture, GREEN), 100);
  ck_assert_uint_gt(picture_count(&picture, PINK), 100);
  free(picture.rgb);
}

/* Jobs that are compared, and members of a study, have one picture of extension and force. */
START_TEST(four_designs_in_one_picture) {
  json_t *ladders[4], *snaps[4];
  for (size_t i = 0; i < 4; i++) {
    ladders[i] = plot_sample_ladder(22 + 8.0 * (double)i);
    snaps[i] = plot_sample_snap(22 + 8.0 * (double)i);
  }
  draw_four(ladders, "overlay-hlpv");
  draw_four(snaps, "overlay-snap");
  json_t *studies[2] = {plot_sample_bistable_study(ladders, 4),
                        plot_sample_bistable_study(snaps, 4)};
  for (size_t i = 0; i < 2; i++) {
    ck_assert_uint_gt(picture_pixels("curves", studies[i], PINK), 100);
    picture_at_all_sizes("curves", studies[i], i ? "snap" : "hlpv");
    json_decref(studies[i]);
  }
}
END_TEST

/* Without a length at rest there is no ratio, and without forces one chart alone. */
START_TEST(elongation_without_a_ratio) {
  json_t *ladder = plot_sample_ladder(30), *hold;
  size_t index;
  json_object_del(json_object_get(ladder, "metrics"), "extension_ratio");
  json_array_foreach(json_object_get(ladder, "holds"), index, hold) {
    json_object_del(hold, "steady_force_N");
  }
  struct plot_input input = {.result = ladder, .title = "", .job_id = 1};
  struct picture picture = picture_draw("overlay", &input, 1, 800, 600, NULL);
  ck_assert_double_lt(picture_mean_y(&picture, 690, 730, BLUE), 200);
  free(picture.rgb);
  json_decref(ladder);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("plots: bistable actuators");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 120);
  tcase_add_test(tcase, a_snap_offers_what_it_has);
  tcase_add_loop_test(tcase, every_plot_at_every_size, 0, 4);
  tcase_add_test(tcase, unstable_stretches_are_dashed);
  tcase_add_test(tcase, events_are_where_they_belong);
  tcase_add_test(tcase, shapes_are_mirrored_and_true);
  tcase_add_test(tcase, the_published_force_when_there_is_one);
  tcase_add_test(tcase, the_first_loss_is_the_lowest);
  tcase_add_test(tcase, losses_under_vacuum);
  tcase_add_test(tcase, one_load_alone);
  tcase_add_test(tcase, a_snap_in_motion);
  tcase_add_test(tcase, four_designs_in_one_picture);
  tcase_add_test(tcase, elongation_without_a_ratio);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
