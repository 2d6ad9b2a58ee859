/* Grasps from their job to their result: forces that can be told without a solver, grippers against
 * their fingers, and what is said of grasps that cannot be. */
#include <math.h>
#include <string.h>

#include "solver/grasp/grasp_job.h"
#include "solver/grasp/sample.h"
#include "tests/unit/suite.h"

static const char text[] =
    "{\"kind\": \"grasp\", \"actuator\": {\"family\": \"pneunet\", \"length\": \"40 mm\", "
    "\"width\": \"16 mm\", \"height\": \"12 mm\", \"chambers\": [{\"config\": \"B\", \"count\": "
    "2}], \"side_wall\": \"2 mm\", \"top_wall\": \"2 mm\", \"bottom_layer\": \"3 mm\"}, "
    "\"material\": \"dragon-skin-20\", \"load\": {\"pressure\": {\"to\": \"20 kPa\", \"steps\": "
    "2}}, \"object\": {\"shape\": {\"form\": \"plane\"}, \"position\": [0, 0, \"-1 mm\"], "
    "\"friction\": 0.5}, \"grasp\": {\"pull\": {\"direction\": [1, 0, 0], \"distance\": \"4 mm\", "
    "\"steps\": 4}, \"numerics\": {\"longest_step\": \"1 mm\"}}, \"mesh\": {\"gap_wall\": 1, "
    "\"cavity\": 1, \"gap\": 1, \"half_width\": 1, \"side_wall\": 1, \"bottom\": 1, \"height\": 1, "
    "\"top\": 1}}";

/* The result of the job with a few changes (suite_read_document), or NULL; *status is also that of
 * a course that stopped early. */
static json_t *run(const char *const (*edits)[2], enum status *status, struct error *error) {
  json_t *document = NULL;
  struct job_spec spec;
  struct grasp_options options = {.out_dir = NULL};
  enum status ending = STATUS_OK;
  *error = (struct error){.status = STATUS_OK};
  *status = suite_read_document(text, edits, &spec, error);
  ck_assert_msg(*status == STATUS_OK, "%s: %s", error->pointer, error->message);
  *status = grasp_job(&spec, &options, &document, &ending, error);
  *status = *status == STATUS_OK ? ending : *status;
  job_spec_release(&spec);
  return document;
}

static json_t *solve(const char *const (*edits)[2]) {
  struct error error;
  enum status status;
  json_t *document = run(edits, &status, &error);
  ck_assert_msg(status == STATUS_OK && document, "%s", error.message);
  return document;
}

static const char *const unchanged[][2] = {{NULL, NULL}};

static double metric(const json_t *document, const char *key) {
  const json_t *value = json_object_get(json_object_get(document, "metrics"), key);
  ck_assert_msg(json_is_number(value), "%s", key);
  return json_number_value(value);
}

static double last(const json_t *document, const char *key) {
  const json_t *samples = json_object_get(document, "samples");
  return json_number_value(
      json_object_get(json_array_get(samples, json_array_size(samples) - 1), key));
}

/* On a plane that is drawn away under the finger the force is the friction coefficient times the
 * normal force, and the work of the pull what friction dissipates, but for what the body stores. */
START_TEST(a_plane_drawn_away_is_held_by_friction) {
  json_t *document = solve(unchanged);
  double force = last(document, "grasp_force_N");
  ck_assert_double_gt(force, 0.01);
  ck_assert_double_eq_tol(force, 0.5 * last(document, "normal_force_N"), 1e-3 * force);
  ck_assert_double_eq_tol(last(document, "slip_share"), 1, 1e-9);
  ck_assert_double_eq_tol(metric(document, "grasp_force_peak_N"), force, 5e-3 * force);
  ck_assert_double_lt(metric(document, "energy_error_pct"), 1);
  ck_assert_double_gt(metric(document, "slip_onset_mm"), 0.1);
  ck_assert_str_eq(json_string_value(json_object_get(document, "outcome")), "held");
  json_decref(document);
}
END_TEST

/* Steps half as long, a contact three times as stiff and a pull twice as fast. */
START_TEST(numerics_do_not_decide_the_force) {
  static const char *const edits[][3][2] = {
      {{"/grasp/numerics", "{\"longest_step\": \"0.5 mm\"}"}},
      {{"/grasp/numerics", "{\"longest_step\": \"1 mm\", \"stiffness\": 3}"}},
      {{"/grasp/pull/rate", "\"10 mm/s\""}}};
  json_t *document = solve(unchanged);
  double force = metric(document, "grasp_force_peak_N");
  json_decref(document);
  for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
    document = solve(edits[i]);
    ck_assert_double_eq_tol(metric(document, "grasp_force_peak_N"), force, 0.03 * force);
    json_decref(document);
  }
}
END_TEST

/* A ball that is drawn along under a coarse finger meets row after row of its points. Each rubs
 * from where it touches, so that the force has no dip where one does: no sample of the sliding ball
 * is far below both of its neighbours. */
START_TEST(points_that_touch_anew_rub) {
  const char *const edits[][2] = {
      {"/actuator", "{\"family\": \"pneunet\", \"length\": \"60 mm\", \"width\": \"20 mm\", "
                    "\"height\": \"15 mm\", \"chambers\": [{\"config\": \"B\", \"count\": 4}], "
                    "\"side_wall\": \"2 mm\", \"top_wall\": \"2 mm\", \"bottom_layer\": \"4 mm\"}"},
      {"/load", "{\"pressure\": {\"to\": \"30 kPa\", \"steps\": 3}}"},
      {"/object", "{\"shape\": {\"form\": \"sphere\", \"diameter\": \"30 mm\"}, "
                  "\"position\": [\"45 mm\", 0, \"-15.5 mm\"], \"friction\": 0.5}"},
      {"/grasp", "{\"pull\": {\"direction\": [1, 0, 0], \"distance\": \"12 mm\", \"steps\": 12}}"},
      {NULL, NULL}};
  json_t *document = solve(edits), *samples = json_object_get(document, "samples");
  size_t count = json_array_size(samples), slipping = 0;
  ck_assert_uint_gt(count, 12);
  for (size_t i = count - 12; i + 1 < count; i++) {
    double force[3];
    for (size_t k = 0; k < 3; k++) {
      const json_t *sample = json_array_get(samples, i + k - 1);
      force[k] = json_number_value(json_object_get(sample, "grasp_force_N"));
    }
    if (json_number_value(json_object_get(json_array_get(samples, i - 1), "slip_share")) == 1) {
      ck_assert_double_gt(force[1], 0.85 * fmin(force[0], force[2]));
      slipping++;
    }
  }
  ck_assert_uint_gt(slipping, 6);
  json_decref(document);
}
END_TEST

/* An object out of reach feels nothing, and the result says so. */
START_TEST(what_is_not_touched_feels_nothing) {
  const char *const edits[][2] = {{"/object/position", "[0, 0, \"-60 mm\"]"}, {NULL, NULL}};
  json_t *document = solve(edits);
  ck_assert_double_eq(metric(document, "grasp_force_peak_N"), 0);
  ck_assert_double_eq(metric(document, "grasp_force_mean_N"), 0);
  ck_assert_double_eq(metric(document, "contact_area_mm2"), 0);
  ck_assert_str_eq(json_string_value(json_object_get(document, "outcome")), "never touched");
  const char *warning = json_string_value(json_array_get(json_object_get(document, "warnings"), 0));
  ck_assert_ptr_nonnull(strstr(warning, "never touched"));
  json_decref(document);
}
END_TEST

#define ROD                                                                                        \
  "{\"shape\": {\"form\": \"cylinder\", \"diameter\": \"20 mm\", \"length\": \"100 mm\"}, "        \
  "\"axis\": [1, 0, 0], \"friction\": 0.4}"

/* Two fingers around a rod: one finger twice is the gripper solved finger by finger and whole. */
START_TEST(a_symmetric_gripper_is_its_finger_times_their_number) {
  const char *const fingers[][2] = {
      {"/object", ROD}, {"/grasp/fingers", "{\"count\": 2, \"radius\": \"11 mm\"}"}, {NULL, NULL}};
  const char *const whole[][2] = {{"/object", ROD},
                                  {"/grasp/fingers", "{\"count\": 2, \"radius\": \"11 mm\"}"},
                                  {"/symmetry", "\"none\""},
                                  {NULL, NULL}};
  json_t *sector = solve(fingers), *full = solve(whole);
  const char *const keys[] = {"grasp_force_peak_N", "normal_force_N", "contact_area_mm2"};
  for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
    double value = metric(full, keys[i]);
    ck_assert_double_gt(value, 0);
    ck_assert_double_eq_tol(metric(sector, keys[i]), value, 5e-3 * value);
  }
  ck_assert_double_eq_tol(last(full, "force_z_N"), 0, 1e-3 * last(full, "normal_force_N"));
  ck_assert_uint_eq(json_array_size(json_object_get(sector, "fingers")), 1);
  ck_assert_uint_eq(json_array_size(json_object_get(full, "fingers")), 2);
  json_decref(sector);
  json_decref(full);
}
END_TEST

/* A plate below the tip: no force before the tip reaches it, and then more with the pressure. */
START_TEST(a_blocked_tip_pushes_more_the_nearer_the_plate) {
  static const char *const edits[][3][2] = {
      {{"/object", NULL}, {"/grasp", "{\"blocked\": {\"distance\": \"0.5 mm\"}}"}},
      {{"/object", NULL}, {"/grasp", "{\"blocked\": {\"distance\": \"1.5 mm\"}}"}}};
  double force[2];
  for (int i = 0; i < 2; i++) {
    json_t *document = solve(edits[i]);
    force[i] = metric(document, "blocked_force_N");
    ck_assert_double_eq_tol(force[i], metric(document, "normal_force_N"), 1e-9);
    json_decref(document);
  }
  ck_assert_double_gt(force[1], 0);
  ck_assert_double_gt(force[0], 1.05 * force[1]);
}
END_TEST

/* A thin rod under the tip, from which the tip slips at once when the rod is drawn on: that part,
 * and only that, is marked as motion, and what comes to rest is the finger by itself. */
START_TEST(what_slips_off_at_once_is_followed_in_motion) {
  const char *const rod[][2] = {
      {"/object/shape", "{\"form\": \"cylinder\", \"diameter\": \"4 mm\", \"length\": \"40 mm\"}"},
      {"/object/position", "[\"38 mm\", 0, \"-2.1 mm\"]"},
      {"/object/axis", "[0, 1, 0]"},
      {"/object/friction", "0.3"},
      {"/load/pressure/to", "\"60 kPa\""},
      {"/mesh/height", "2"},
      {"/grasp/pull/distance", "\"3 mm\""},
      {"/grasp/numerics/longest_step", "\"0.2 mm\""},
      {NULL, NULL}};
  const char *const alone[][2] = {{"/object/position", "[0, 0, \"-60 mm\"]"},
                                  {"/load/pressure/to", "\"60 kPa\""},
                                  {"/mesh/height", "2"},
                                  {"/grasp/pull", NULL},
                                  {NULL, NULL}};
  json_t *document = solve(rod), *unhindered = solve(alone), *sample;
  const json_t *samples = json_object_get(document, "samples");
  size_t index, moved = 0;
  double bent = metric(document, "bending_angle_deg");
  json_array_foreach(samples, index, sample) {
    double now = json_number_value(json_object_get(sample, "bending_angle_deg"));
    bool pulls = !strcmp(json_string_value(json_object_get(sample, "stage")), "pull");
    if (json_is_true(json_object_get(sample, "dynamic"))) {
      ck_assert(pulls);
      moved++;
    } else if (pulls) { /* nothing jumps without a word */
      ck_assert_double_eq_tol(now, bent, 1);
    }
    bent = pulls ? now : bent;
  }
  ck_assert_uint_gt(moved, 0);
  ck_assert_uint_lt(moved, json_array_size(samples) / 4);
  ck_assert_double_eq_tol(last(document, "bending_angle_deg"),
                          last(unhindered, "bending_angle_deg"), 0.01);
  ck_assert_double_gt(metric(document, "jumps"), 0);
  ck_assert_double_gt(metric(document, "dynamic_share_pct"), 0);
  ck_assert_double_lt(metric(document, "dynamic_share_pct"), 10);
  const char *warning = json_string_value(json_array_get(json_object_get(document, "warnings"), 0));
  ck_assert_ptr_nonnull(strstr(warning, "marked as dynamic"));
  ck_assert_str_eq(json_string_value(json_object_get(document, "outcome")), "released");
  json_decref(document);
  json_decref(unhindered);
}
END_TEST

START_TEST(an_object_inside_the_body_is_refused_with_place_and_depth) {
  const char *const edits[][2] = {{"/object/position", "[0, 0, \"2.5 mm\"]"}, {NULL, NULL}};
  struct error error;
  enum status status;
  json_t *document = run(edits, &status, &error);
  ck_assert_ptr_null(document);
  ck_assert_int_eq(status, STATUS_GEOMETRY);
  ck_assert_str_eq(error.pointer, "/object/position");
  ck_assert_msg(strstr(error.message, "by 2.5 mm at (0, "), "%s", error.message);
}
END_TEST

START_TEST(a_grasp_without_time_tells_how_far_it_came) {
  const char *const edits[][2] = {{"/timeout", "\"1 s\""},
                                  {"/mesh", "{}"},
                                  {"/accuracy", "\"fine\""},
                                  {"/symmetry", "\"none\""},
                                  {NULL, NULL}};
  struct error error;
  enum status status;
  json_t *document = run(edits, &status, &error);
  ck_assert_ptr_nonnull(document);
  ck_assert_int_eq(status, STATUS_TIMEOUT);
  ck_assert_str_eq(json_string_value(json_object_get(document, "reason")), "timeout");
  ck_assert_ptr_nonnull(
      strstr(json_string_value(json_object_get(document, "message")), "stopped in the"));
  json_decref(document);
}
END_TEST

/* Two fingers at the same places and at others: sums there, interpolated in between. */
START_TEST(fingers_are_summed_where_either_has_a_state) {
  struct grasp_series one = {0}, other = {0}, sum = {0};
  static const double at_one[] = {0, 0.5, 1}, at_other[] = {0, 0.25, 1}, at[] = {0, 0.25, 0.5, 1};
  for (int k = 0; k < 3; k++) {
    struct grasp_sample a = {.stage = STAGE_PULL, .along = at_one[k]};
    struct grasp_sample b = {.stage = STAGE_PULL, .along = at_other[k]};
    a.value[GRASP_HOLD] = 8 * at_one[k];
    b.value[GRASP_HOLD] = 4 * at_other[k];
    a.value[GRASP_FORCE_Z] = b.value[GRASP_FORCE_Z] = 1;
    ck_assert_int_eq(grasp_series_add(&one, &a), STATUS_OK);
    ck_assert_int_eq(grasp_series_add(&other, &b), STATUS_OK);
  }
  struct grasp_share share[2] = {{&one, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                                 {&other, {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}}};
  ck_assert_int_eq(grasp_series_sum(share, 2, &sum), STATUS_OK);
  ck_assert_uint_eq(sum.count, 4);
  for (size_t k = 0; k < sum.count; k++) {
    const struct grasp_sample *s = &sum.sample[k];
    ck_assert_double_eq(s->along, at[k]);
    ck_assert_double_eq_tol(s->value[GRASP_HOLD], 12 * s->along, 1e-12);
    ck_assert_double_eq_tol(s->value[GRASP_FORCE_Z], 0, 1e-15);
  }
  grasp_series_release(&one);
  grasp_series_release(&other);
  grasp_series_release(&sum);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("grasps");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 300);
  tcase_add_test(tcase, a_plane_drawn_away_is_held_by_friction);
  tcase_add_test(tcase, numerics_do_not_decide_the_force);
  tcase_add_test(tcase, points_that_touch_anew_rub);
  tcase_add_test(tcase, what_is_not_touched_feels_nothing);
  tcase_add_test(tcase, a_symmetric_gripper_is_its_finger_times_their_number);
  tcase_add_test(tcase, a_blocked_tip_pushes_more_the_nearer_the_plate);
  tcase_add_test(tcase, what_slips_off_at_once_is_followed_in_motion);
  tcase_add_test(tcase, an_object_inside_the_body_is_refused_with_place_and_depth);
  tcase_add_test(tcase, a_grasp_without_time_tells_how_far_it_came);
  tcase_add_test(tcase, fingers_are_summed_where_either_has_a_state);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
