/* Plots of hybrid models, from a made-up result. */
#include <check.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/plot_pictures.h"
#include "tests/unit/suite.h"

/* The series colours and those of the bands behind them. */
#define BLUE 0, 114, 178
#define ORANGE 213, 94, 0
#define BLUE_BAND 222, 237, 245
#define ORANGE_BAND 250, 234, 222

/* 2 s compressed with h rising to 10 mm, then a jump to 40 mm and 2 s stretched. */
static json_t *sample_result(int count) {
  json_t *samples = json_array();
  for (int i = 0; i < count; i++) {
    double time = 4.0 * i / (count - 1);
    bool late = time > 2.0;
    json_array_append_new(samples,
                          json_pack("{s:f, s:f, s:f, s:f, s:f, s:s}", "time_s", time,
                                    "set_point_kPa", late ? 37.0 : 18.0, "h_mm",
                                    late ? 40.0 + 2.0 * (time - 2.0) : 5.0 * time, "velocity_m_s",
                                    late ? 0.0022 : 0.0047, "pressure_kPa", 10.0 * time, "mode",
                                    late ? "stretched" : "compressed"));
  }
  return json_pack(
      "{s:s, s:s, s:{s:f}, s:o, s:[{s:f, s:{s:f, s:f}, s:{s:f, s:f}}], s:[{s:f, s:f, s:f}, {s:f, "
      "s:f, s:f}, {s:f, s:f, s:f}]}",
      "status", "succeeded", "kind", "hlpv", "metrics", "extension_ratio", 0.5, "samples", samples,
      "events", "time_s", 2.0, "before", "h_m", 0.01, "velocity_m_s", 0.005, "after", "h_m", 0.04,
      "velocity_m_s", 0.002, "holds", "set_point_kPa", 0.0, "end_extension_ratio", 0.0, "end_h_mm",
      0.0, "set_point_kPa", 40.0, "end_extension_ratio", 0.5, "end_h_mm", 44.0, "set_point_kPa",
      20.0, "end_extension_ratio", 0.45, "end_h_mm", 42.0);
}

START_TEST(every_plot_at_every_size) {
  static const char *const plots[] = {"time", "phase", "steady"};
  static const int sizes[][2] = {{800, 600}, {200, 200}, {1600, 1200}, {4000, 200}};
  json_t *result = sample_result(481);
  struct plot_input input = {result, NULL, "bistable", 3, "abc", NULL};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    char name[40];
    snprintf(name, sizeof name, "%s-%d", plots[_i], sizes[i][0]);
    struct picture picture = picture_draw(plots[_i], &input, 1, sizes[i][0], sizes[i][1], name);
    ck_assert_uint_gt(picture_count(&picture, 28, 37, 48), 50); /* the title's ink */
    free(picture.rgb);
  }
  json_decref(result);
}
END_TEST

START_TEST(modes_are_bands_of_time) {
  json_t *result = sample_result(481);
  struct plot_input input = {result, NULL, "", 1, NULL, NULL};
  struct picture picture = picture_draw("time", &input, 1, 800, 600, NULL);
  /* compressed is the left half, stretched the right one */
  ck_assert(picture_mean_y(&picture, 200, 400, BLUE_BAND) > 0);
  ck_assert(isnan(picture_mean_y(&picture, 240, 400, ORANGE_BAND)));
  ck_assert(picture_mean_y(&picture, 500, 700, ORANGE_BAND) > 0);
  ck_assert_uint_gt(picture_count(&picture, ORANGE_BAND), 10000);
  free(picture.rgb);
  json_decref(result);
}
END_TEST

START_TEST(each_mode_has_its_curve_in_the_phase_plane) {
  json_t *result = sample_result(481);
  struct plot_input input = {result, NULL, "", 1, NULL, NULL};
  struct picture picture = picture_draw("phase", &input, 1, 800, 600, NULL);
  ck_assert_uint_gt(picture_count(&picture, BLUE), 60);
  ck_assert_uint_gt(picture_count(&picture, ORANGE), 50);
  /* the faster mode is above the other one */
  double fast = picture_mean_y(&picture, 220, 280, BLUE);
  double slow = picture_mean_y(&picture, 640, 740, ORANGE);
  ck_assert_msg(fast < slow, "%g is not above %g", fast, slow);
  free(picture.rgb);
  json_decref(result);
}
END_TEST

START_TEST(few_or_damaged_data_are_no_failure) {
  static const char *const plots[] = {"time", "phase", "steady"};
  static const char *const results[] = {
      "{\"kind\":\"hlpv\",\"holds\":[1,2]}",
      "{\"kind\":\"hlpv\",\"samples\":[{\"time_s\":1}],\"events\":[{}],\"holds\":[{},null]}",
      "{\"kind\":\"hlpv\",\"samples\":[{\"time_s\":0,\"set_point_kPa\":1,\"h_mm\":1,"
      "\"velocity_m_s\":1,\"pressure_kPa\":1,\"mode\":\"a\"}],\"events\":[{\"time_s\":-1}],"
      "\"holds\":[{\"set_point_kPa\":1,\"end_h_mm\":2},{}]}",
      "{\"kind\":\"hlpv\",\"samples\":7,\"events\":\"x\",\"holds\":[[],[]]}",
  };
  for (size_t i = 0; i < 3; i++) {
    json_t *result = json_loads(results[_i], 0, NULL);
    struct plot_input input = {result, NULL, "", 1, NULL, NULL};
    struct picture picture = picture_draw(plots[i], &input, 1, 400, 300, NULL);
    free(picture.rgb);
    json_decref(result);
  }
}
END_TEST

/* Every sample in another mode: more modes, spans and events than a picture shows. */
START_TEST(many_switches_are_drawn_without_bands) {
  json_t *result = sample_result(2001), *events = json_array(), *sample;
  size_t index;
  json_array_foreach(json_object_get(result, "samples"), index, sample) {
    char name[20];
    snprintf(name, sizeof name, "mode %zu", index % 12);
    json_object_set_new(sample, "mode", json_string(name));
    json_array_append_new(events, json_pack("{s:f}", "time_s", 0.002 * (double)index));
  }
  json_object_set_new(result, "events", events);
  struct plot_input input = {result, NULL, "", 1, NULL, NULL};
  struct picture time = picture_draw("time", &input, 1, 800, 600, NULL);
  ck_assert_uint_lt(picture_count(&time, ORANGE_BAND), 200);
  struct picture phase = picture_draw("phase", &input, 1, 800, 600, NULL);
  free(time.rgb);
  free(phase.rgb);
  json_decref(result);
}
END_TEST

START_TEST(a_ladder_needs_two_steps) {
  json_t *result = sample_result(11);
  struct plot_input input = {result, NULL, "", 1, NULL, NULL};
  const char *names[PLOT_NAMES];
  plot_names_for("hlpv", result, names);
  ck_assert_str_eq(names[0], "time");
  ck_assert_str_eq(names[1], "phase");
  ck_assert_str_eq(names[2], "steady");
  ck_assert_ptr_null(names[3]);
  json_object_del(result, "holds");
  plot_names_for("hlpv", result, names);
  ck_assert_ptr_null(names[2]);
  ck_assert_int_eq(picture_refuse("steady", &input, 1, 800, 600), STATUS_NOT_FOUND);
  json_decref(result);
}
END_TEST

/* The same under a controller, asked for 30 mm after 2 s and told that 40 mm are the nearest. */
static json_t *controlled_result(void) {
  json_t *result = sample_result(481), *sample;
  size_t index;
  json_array_foreach(json_object_get(result, "samples"), index, sample) {
    double time = json_number_value(json_object_get(sample, "time_s"));
    json_object_set_new(sample, "reference_mm", json_real(time > 2.0 ? 30.0 : 10.0));
  }
  json_object_set_new(result, "control", json_object());
  json_object_set_new(result, "steps",
                      json_pack("[{s:f, s:f, s:b, s:f}, {s:f, s:f, s:b, s:f}]", "start_s", 0.0,
                                "end_s", 2.0, "in_reach", 1, "target_mm", 10.0, "start_s", 2.0,
                                "end_s", 4.0, "in_reach", 0, "target_mm", 40.0));
  json_object_set_new(result, "model",
                      json_pack("{s:[{s:{s:f}}]}", "transitions", "when", "h_m", 0.014));
  return result;
}

START_TEST(control_shows_what_was_asked_for) {
  char text[300];
  json_t *result = controlled_result();
  ck_assert_str_eq(picture_offered("hlpv", result, text), "time phase steady control");
  picture_at_all_sizes("control", result, "steps");
  struct picture picture = picture_of("control", result, NULL);
  /* of the second half: the reference at 30 mm is below what is nearest, at 40 mm, by a tenth of
   * the upper chart at least */
  double reference = picture_mean_y(&picture, 470, 700, ORANGE);
  double target = picture_mean_y(&picture, 470, 700, 204, 121, 167);
  ck_assert_msg(target < reference - 20, "%g is not above %g", target, reference);
  free(picture.rgb);
  json_object_del(result, "control");
  ck_assert_int_eq(picture_refuse_one("control", result, NULL), STATUS_NOT_FOUND);
  json_decref(result);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("plots: hybrid models");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 60);
  tcase_add_loop_test(tcase, every_plot_at_every_size, 0, 3);
  tcase_add_test(tcase, modes_are_bands_of_time);
  tcase_add_test(tcase, each_mode_has_its_curve_in_the_phase_plane);
  tcase_add_loop_test(tcase, few_or_damaged_data_are_no_failure, 0, 4);
  tcase_add_test(tcase, many_switches_are_drawn_without_bands);
  tcase_add_test(tcase, a_ladder_needs_two_steps);
  tcase_add_test(tcase, control_shows_what_was_asked_for);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
