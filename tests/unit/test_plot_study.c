/* Plots of studies, of bodies in space and of measurements. */
#include <check.h>
#include <math.h>
#include <stdlib.h>

#include "tests/unit/plot_pictures.h"
#include "tests/unit/plot_samples.h"
#include "tests/unit/plot_study_samples.h"
#include "tests/unit/suite.h"

#define LONG_NAME                                                                                  \
  "a member whose name goes on and on, as names do that are made of many values, 12 mm, 3 kPa, "   \
  "trapezoidal, with all four faces inclined by different angles, until nobody can read it"

static json_t *member_of(json_t *study, size_t index) {
  return json_array_get(json_object_get(study, "members"), index);
}

START_TEST(a_result_offers_what_it_has) {
  char text[300];
  json_t *planar = plot_sample_result(1.27, 50, 10), *spatial = plot_sample_spatial(80);
  json_t *study = plot_sample_study(3), *grid = plot_sample_grid(3), *empty = json_object();
  ck_assert_str_eq(picture_offered("response", planar, text), "angle midline tip surface");
  json_object_set_new(planar, "measured", json_pack("[{}]"));
  ck_assert_str_eq(picture_offered("response", planar, text), "angle midline tip measured surface");
  ck_assert_str_eq(picture_offered("response", spatial, text), "angle midline3d tip3d surface");
  ck_assert_str_eq(picture_offered("study", study, text), "curves metric");
  plot_sample_rank(study, 3);
  ck_assert_str_eq(picture_offered("study", study, text), "curves metric ranking");
  ck_assert_str_eq(picture_offered("study", grid, text),
                   "curves metric workspace twist contraction");
  plot_sample_meshes(study);
  ck_assert_str_eq(picture_offered("study", study, text), "curves metric ranking mesh");
  plot_sample_suckers(study);
  ck_assert_str_eq(picture_offered("study", study, text), "curves metric ranking suction");
  ck_assert_str_eq(picture_offered("study", empty, text), "curves");
  ck_assert_str_eq(picture_offered("no-such-kind", empty, text), "");
  ck_assert_str_eq(picture_offered(NULL, NULL, text), "");
  json_decref(planar);
  json_decref(spatial);
  json_decref(study);
  json_decref(grid);
  json_decref(empty);
}
END_TEST

START_TEST(what_is_not_offered_is_refused) {
  json_t *response = plot_sample_result(1.27, 50, 10), *study = plot_sample_study(3);
  static const char *const of_study[] = {"angle",     "midline3d", "measured", "ranking",
                                         "workspace", "twist",     "mesh",     "contraction",
                                         "suction",   "curve"};
  for (size_t i = 0; i < sizeof of_study / sizeof *of_study; i++) {
    ck_assert_int_eq(picture_refuse_one(of_study[i], study, NULL), STATUS_NOT_FOUND);
  }
  static const char *const of_response[] = {"curves", "metric", "midline3d", "measured", "ranking"};
  for (size_t i = 0; i < sizeof of_response / sizeof *of_response; i++) {
    ck_assert_int_eq(picture_refuse_one(of_response[i], response, NULL), STATUS_NOT_FOUND);
  }
  ck_assert_int_eq(picture_refuse_one("metric", study, "no_such_metric"), STATUS_NOT_FOUND);
  json_decref(response);
  json_decref(study);
}
END_TEST

START_TEST(curves_have_a_colour_each) {
  static const int colours[][3] = {{0, 114, 178}, {213, 94, 0}, {0, 158, 115}, {204, 121, 167}};
  for (size_t count = 1; count <= 4; count++) {
    json_t *study = plot_sample_study(count);
    struct picture picture = picture_of("curves", study, NULL);
    for (size_t i = 0; i < 4; i++) {
      size_t pixels = picture_count(&picture, colours[i][0], colours[i][1], colours[i][2]);
      ck_assert_int_eq(pixels > 200, i < count);
    }
    free(picture.rgb);
    json_decref(study);
  }
}
END_TEST

/* The curve with the larger sensitivity is above. */
START_TEST(curves_are_where_they_belong) {
  json_t *study = plot_sample_study(2);
  struct picture picture = picture_of("curves", study, NULL);
  ck_assert_double_lt(picture_mean_y(&picture, 600, 640, 0, 114, 178),
                      picture_mean_y(&picture, 600, 640, 213, 94, 0) - 20);
  free(picture.rgb);
  json_decref(study);
}
END_TEST

START_TEST(many_curves_are_grey_but_for_the_first) {
  json_t *few = plot_sample_designs(16), *many = plot_sample_designs(76);
  /* edges of markers come near to grey, too */
  ck_assert_uint_gt(picture_pixels("curves", many, 184, 189, 196),
                    2 * picture_pixels("curves", few, 184, 189, 196));
  picture_at_all_sizes("curves", many, "76");
  picture_at_all_sizes("curves", few, "16");
  json_decref(few);
  json_decref(many);
}
END_TEST

START_TEST(members_that_stopped_are_marked) {
  json_t *study = plot_sample_study(3);
  ck_assert_uint_eq(picture_pixels("curves", study, 168, 66, 0), 0);
  ck_assert_uint_eq(picture_pixels("metric", study, 168, 66, 0), 0);
  json_t *member = member_of(study, 1), *samples = json_object_get(member, "samples");
  json_object_set_new(member, "status", json_string("diverged"));
  json_object_set_new(member, "reason", json_string("limit_point"));
  while (json_array_size(samples) > 6) {
    json_array_remove(samples, json_array_size(samples) - 1);
  }
  json_t *failed =
      json_pack("{s:s,s:s,s:s,s:{s:s},s:{},s:[]}", "name", LONG_NAME, "status", "failed", "reason",
                "timeout", "values", "/actuator/chamber_gap", "9 mm", "metrics", "samples");
  json_array_append_new(json_object_get(study, "members"), failed);
  ck_assert_uint_gt(picture_pixels("curves", study, 168, 66, 0), 40);
  ck_assert_uint_gt(picture_pixels("metric", study, 168, 66, 0), 40);
  picture_at_all_sizes("curves", study, "stopped");
  picture_at_all_sizes("metric", study, "stopped");
  json_decref(study);
}
END_TEST

START_TEST(the_metric_with_what_was_published) {
  json_t *study = plot_sample_study(6), *list = plot_sample_designs(6);
  struct picture picture = picture_of("metric", study, NULL);
  /* the sensitivity falls with the gap */
  ck_assert_double_lt(picture_mean_y(&picture, 100, 250, 0, 114, 178),
                      picture_mean_y(&picture, 560, 690, 0, 114, 178) - 100);
  ck_assert_uint_gt(picture_count(&picture, 213, 94, 0), 60); /* three open marks */
  free(picture.rgb);
  size_t with_errors = picture_pixels("metric", study, 0, 114, 178);
  for (size_t i = 0; i < 6; i++) {
    json_object_del(json_object_get(member_of(study, i), "metrics"),
                    "sensitivity_deg_per_kPa_error");
  }
  ck_assert_uint_lt(picture_pixels("metric", study, 0, 114, 178) + 60, with_errors);
  json_object_del(study, "published");
  ck_assert_uint_eq(picture_pixels("metric", study, 213, 94, 0), 0);
  picture = picture_of("metric", study, "bending_angle_deg");
  ck_assert_uint_gt(picture_count(&picture, 0, 114, 178), 200);
  free(picture.rgb);
  /* members without a parameter are columns, as high as their value */
  ck_assert_uint_gt(picture_pixels("metric", list, 89, 153, 199), 20000);
  picture_at_all_sizes("metric", study, "6");
  picture_at_all_sizes("metric", list, "list-6");
  json_decref(study);
  json_decref(list);
}
END_TEST

START_TEST(the_metric_over_two_parameters) {
  json_t *grid = plot_sample_grid(3);
  struct picture picture = picture_of("metric", grid, "twist_angle_deg");
  static const int colours[][3] = {{0, 114, 178}, {213, 94, 0}, {0, 158, 115}};
  for (size_t i = 0; i < 3; i++) {
    ck_assert_uint_gt(picture_count(&picture, colours[i][0], colours[i][1], colours[i][2]), 200);
  }
  free(picture.rgb);
  json_decref(grid);
}
END_TEST

START_TEST(the_ranking_shows_fifteen_bars) {
  json_t *study = plot_sample_designs(76);
  plot_sample_rank(study, 76);
  size_t all = picture_pixels("ranking", study, 0, 114, 178);
  picture_at_all_sizes("metric", study, "76");
  picture_at_all_sizes("ranking", study, "76");
  plot_sample_rank(study, 15);
  ck_assert_uint_eq(picture_pixels("ranking", study, 0, 114, 178), all);
  plot_sample_rank(study, 1);
  json_object_set_new(member_of(study, 0), "name", json_string(LONG_NAME));
  plot_sample_rank(study, 1);
  picture_at_all_sizes("ranking", study, "1");
  /* a score that is not the sum of its parts is not divided */
  json_t *first = json_array_get(json_object_get(json_object_get(study, "ranking"), "designs"), 0);
  ck_assert_uint_gt(picture_pixels("ranking", study, 153, 201, 235), 500);
  json_object_set_new(first, "final", json_real(0.9));
  ck_assert_uint_lt(picture_pixels("ranking", study, 153, 201, 235), 100);
  json_decref(study);
}
END_TEST

START_TEST(the_workspace_in_three_views) {
  json_t *grid = plot_sample_grid(9);
  /* the tips of a single row at its highest pressure, one of each */
  ck_assert_uint_gt(picture_pixels("workspace", grid, 0, 115, 189), 60);
  ck_assert_uint_gt(picture_pixels("workspace", grid, 230, 133, 0), 60);
  picture_at_all_sizes("workspace", grid, "grid");
  picture_at_all_sizes("twist", grid, "grid");
  picture_at_all_sizes("contraction", grid, "grid");
  for (size_t i = 0; i < 81; i++) {
    json_object_del(member_of(grid, i), "values");
  }
  /* by pressure when the rows are not known */
  ck_assert_uint_eq(picture_pixels("workspace", grid, 0, 115, 189), 0);
  ck_assert_uint_gt(picture_pixels("workspace", grid, 62, 0, 92), 20);
  picture_at_all_sizes("workspace", grid, "pressure");
  json_decref(grid);
}
END_TEST

START_TEST(bodies_in_space) {
  json_t *result = plot_sample_spatial(80);
  ck_assert_uint_gt(picture_pixels("midline3d", result, 200, 131, 0), 300);
  ck_assert_uint_gt(picture_pixels("tip3d", result, 200, 131, 0), 20);
  picture_at_all_sizes("midline3d", result, "spatial");
  picture_at_all_sizes("tip3d", result, "spatial");
  json_decref(result);
}
END_TEST

START_TEST(meshes_and_suckers) {
  json_t *study = plot_sample_study(6);
  plot_sample_meshes(study);
  ck_assert_uint_gt(picture_pixels("mesh", study, 247, 223, 204), 4000); /* the band */
  picture_at_all_sizes("mesh", study, "6");
  plot_sample_suckers(study);
  struct picture picture = picture_of("suction", study, NULL);
  ck_assert_double_lt(picture_mean_y(&picture, 0, 800, 0, 114, 178), 300);
  ck_assert_double_gt(picture_mean_y(&picture, 0, 800, 213, 94, 0), 300);
  free(picture.rgb);
  /* another member with two suckers stands beside the line */
  json_object_set_new(json_object_get(member_of(study, 5), "metrics"), "sucker_count",
                      json_integer(2));
  picture_at_all_sizes("suction", study, "6");
  json_decref(study);
}
END_TEST

START_TEST(simulated_and_measured) {
  json_t *result = plot_sample_result(1.27, 50, 10), *list = json_array();
  for (size_t i = 0; i <= 10; i++) {
    const json_t *sample = json_array_get(json_object_get(result, "samples"), i);
    double simulated = json_number_value(json_object_get(sample, "bending_angle_deg"));
    double noise = 0.15 * (double)i * sin(3.1 * (double)i);
    json_array_append_new(list, json_pack("{s:f,s:f,s:f,s:f}", "pressure_kPa", 5.0 * (double)i,
                                          "measured", simulated + noise, "simulated", simulated,
                                          "error", -noise));
  }
  json_object_set_new(result, "measured", list);
  struct picture picture = picture_of("measured", result, NULL);
  ck_assert_uint_gt(picture_count(&picture, 0, 114, 178), 500);
  ck_assert_uint_gt(picture_count(&picture, 213, 94, 0), 300);
  free(picture.rgb);
  picture_at_all_sizes("measured", result, "chosen");
  json_decref(result);
}
END_TEST

START_TEST(fits_and_stresses) {
  json_t *samples = json_array(), *stresses = json_array();
  for (int i = 1; i <= 40; i++) {
    double strain = i / 40.0, stress = 0.3 * strain + 0.02 * sin(9 * strain);
    json_array_append_new(samples,
                          json_pack("{s:f,s:f,s:f,s:f}", "strain", strain, "measured_stress_MPa",
                                    stress, "fitted_stress_MPa", 0.3 * strain, "band_MPa", 0.02));
    double stretch = 0.4 + 0.08 * i, even = stretch - pow(stretch, -2);
    json_array_append_new(
        stresses, json_pack("{s:f,s:f,s:f,s:f}", "stretch", stretch, "uniaxial_stress_MPa",
                            0.2 * even, "planar_stress_MPa", 0.2 * (stretch - pow(stretch, -3)),
                            "equibiaxial_stress_MPa", 0.2 * (stretch - pow(stretch, -5))));
  }
  json_t *fit = json_pack("{s:s,s:o,s:{s:s},s:{s:f,s:f,s:f},s:[{s:s,s:s,s:f,s:f},{s:s,s:s,s:f}]}",
                          "kind", "fit-material", "samples", samples, "material", "model", "yeoh",
                          "metrics", "strain_from", 0.1, "strain_to", 0.8, "r_squared", 0.9978,
                          "coefficients", "name", "mu1", "unit", "MPa", "value", 0.0612,
                          "half_width", 0.0014, "name", "alpha1", "unit", "1", "value", 2.4);
  json_t *curve = json_pack("{s:s,s:o}", "kind", "material-curve", "samples", stresses);
  char text[300];
  ck_assert_str_eq(picture_offered("fit-material", fit, text), "fit");
  ck_assert_str_eq(picture_offered("material-curve", curve, text), "stress");
  ck_assert_uint_gt(picture_pixels("fit", fit, 0, 114, 178), 500);
  ck_assert_uint_gt(picture_pixels("fit", fit, 213, 94, 0), 500);
  ck_assert_uint_gt(picture_pixels("fit", fit, 204, 227, 240), 2000);  /* the band */
  ck_assert_uint_gt(picture_pixels("fit", fit, 237, 240, 244), 20000); /* the range */
  ck_assert_uint_gt(picture_pixels("stress", curve, 0, 158, 115), 300);
  picture_at_all_sizes("fit", fit, "yeoh");
  picture_at_all_sizes("stress", curve, "three");
  json_object_set_new(fit, "samples", json_array());
  picture_at_all_sizes("fit", fit, "none");
  ck_assert_int_eq(picture_refuse_one("stress", fit, NULL), STATUS_NOT_FOUND);
  json_decref(fit);
  json_decref(curve);
}
END_TEST

START_TEST(the_angle_has_its_error) {
  json_t *result = plot_sample_result(1.27, 50, 10);
  size_t without = picture_pixels("angle", result, 0, 114, 178);
  json_object_set_new(json_object_get(result, "metrics"), "bending_angle_deg_error",
                      json_real(6.0));
  ck_assert_uint_gt(picture_pixels("angle", result, 0, 114, 178), without + 40);
  picture_at_all_sizes("angle", result, "error");
  json_decref(result);
}
END_TEST

START_TEST(one_member_and_none) {
  json_t *one = plot_sample_study(1), *none = plot_sample_study(0), *bare = json_object();
  json_object_set_new(member_of(one, 0), "name", json_string(LONG_NAME));
  picture_at_all_sizes("curves", one, "1");
  picture_at_all_sizes("metric", one, "1");
  picture_at_all_sizes("curves", none, "0");
  picture_at_all_sizes("curves", bare, "bare");
  json_decref(one);
  json_decref(none);
  json_decref(bare);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("plot study");
  TCase *pictures = tcase_create("pictures");
  tcase_set_timeout(pictures, 300);
  tcase_add_test(pictures, a_result_offers_what_it_has);
  tcase_add_test(pictures, what_is_not_offered_is_refused);
  tcase_add_test(pictures, curves_have_a_colour_each);
  tcase_add_test(pictures, curves_are_where_they_belong);
  tcase_add_test(pictures, many_curves_are_grey_but_for_the_first);
  tcase_add_test(pictures, members_that_stopped_are_marked);
  tcase_add_test(pictures, the_metric_with_what_was_published);
  tcase_add_test(pictures, the_metric_over_two_parameters);
  tcase_add_test(pictures, the_ranking_shows_fifteen_bars);
  tcase_add_test(pictures, the_workspace_in_three_views);
  tcase_add_test(pictures, bodies_in_space);
  tcase_add_test(pictures, meshes_and_suckers);
  tcase_add_test(pictures, simulated_and_measured);
  tcase_add_test(pictures, fits_and_stresses);
  tcase_add_test(pictures, the_angle_has_its_error);
  tcase_add_test(pictures, one_member_and_none);
  suite_add_tcase(suite, pictures);
  return suite_run(suite);
}
