/* Grasps of objects that are let go, and of objects that are led along a path: weights and friction
 * that can be told without a solver, and ways that lead to the same places. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/grasp/grasp_job.h"
#include "tests/unit/suite.h"

/* Two fingers that hang down around a ball. */
static const char text[] =
    "{\"kind\": \"grasp\", \"actuator\": {\"family\": \"pneunet\", \"length\": \"40 mm\", "
    "\"width\": \"16 mm\", \"height\": \"12 mm\", \"chambers\": [{\"config\": \"B\", \"count\": "
    "3}], \"side_wall\": \"2 mm\", \"gap_wall\": \"1.5 mm\", \"top_wall\": \"2 mm\", "
    "\"bottom_layer\": \"3 mm\", \"chamber_gap\": \"1.5 mm\"}, \"material\": \"dragon-skin-20\", "
    "\"load\": {\"pressure\": {\"to\": \"30 kPa\", \"steps\": 2}}, \"object\": {\"shape\": "
    "{\"form\": \"sphere\", \"diameter\": \"20 mm\"}, \"position\": [\"30 mm\", 0, 0], "
    "\"friction\": 0.5}, \"grasp\": {\"fingers\": {\"count\": 2, \"radius\": \"10.5 mm\"}, "
    "\"numerics\": {\"longest_step\": \"1 mm\"}}, \"mesh\": {\"gap_wall\": 1, \"cavity\": 1, "
    "\"gap\": 1, \"half_width\": 1, \"side_wall\": 1, \"bottom\": 1, \"height\": 1, \"top\": 1}}";

#define DOWN                                                                                       \
  { "/load/gravity", "[\"9.80665 m/s2\", 0, 0]" }
#define FREE(mass)                                                                                 \
  {"/object/motion", "\"free\""}, {                                                                \
    "/object/mass", "\"" mass "\""                                                                 \
  }
#define PULL(keys)                                                                                 \
  { "/grasp/pull", "{" keys "}" }

static const double gravity = 9.80665;

static json_t *solve(const char *const (*edits)[2]) {
  json_t *document = NULL;
  struct job_spec spec;
  struct grasp_options options = {.out_dir = NULL};
  struct error error = {.status = STATUS_OK};
  enum status ending = STATUS_OK, status = suite_read_document(text, edits, &spec, &error);
  ck_assert_msg(status == STATUS_OK, "%s: %s", error.pointer, error.message);
  status = grasp_job(&spec, &options, &document, &ending, &error);
  job_spec_release(&spec);
  ck_assert_msg(status == STATUS_OK && ending == STATUS_OK && document, "%s", error.message);
  return document;
}

static double metric(const json_t *document, const char *key) {
  const json_t *value = json_object_get(json_object_get(document, "metrics"), key);
  ck_assert_msg(json_is_number(value), "%s", key);
  return json_number_value(value);
}

/* Of the last sample of a stage, or of the last one before it that was touched. */
static double value_at_end(const json_t *document, const char *stage, bool touched,
                           const char *key) {
  const json_t *samples = json_object_get(document, "samples"), *sample, *last = NULL;
  size_t i;
  json_array_foreach(samples, i, sample) {
    const char *word = json_string_value(json_object_get(sample, "stage"));
    bool touches = json_number_value(json_object_get(sample, "contact_area_mm2")) > 0;
    last = strcmp(word, stage) == 0 && (touches || !touched) ? sample : last;
  }
  ck_assert_msg(last != NULL, "%s", stage);
  return json_number_value(json_object_get(last, key));
}

static double at_end(const json_t *document, const char *stage, const char *key) {
  return value_at_end(document, stage, false, key);
}

static void check_outcome(const json_t *document, const char *outcome) {
  ck_assert_str_eq(json_string_value(json_object_get(document, "outcome")), outcome);
}

/* ---- free objects ---- */

/* A ball between two fingers: they bear its weight, and a force draws it out where the same way of
 * a fixed ball meets the most resistance, but for what it jumps over: on a mesh this coarse the
 * force falls for a while where the contact goes on to the next face. */
START_TEST(a_ball_is_held_until_it_is_drawn_out) {
  const char *const drawn[][2] = {
      DOWN,
      FREE("5 g"),
      PULL("\"direction\": [1, 0, 0], \"force\": \"0.15 N\", \"steps\": 2"),
      {NULL, NULL}};
  const char *const led[][2] = {
      DOWN, PULL("\"direction\": [1, 0, 0], \"distance\": \"3 mm\", \"steps\": 3"), {NULL, NULL}};
  json_t *document = solve(drawn), *fixed = solve(led);
  double weight = 5e-3 * gravity;
  ck_assert_double_eq_tol(metric(document, "object_weight_N"), weight, 1e-12);
  ck_assert_double_eq_tol(metric(document, "weight_carried_N"), weight, 1e-4 * weight);
  ck_assert_double_eq_tol(-at_end(document, "letting go", "force_x_N"), weight, 1e-4 * weight);
  ck_assert_double_eq(metric(document, "held"), 1);
  double force = metric(document, "grasp_force_peak_N");
  ck_assert_double_gt(force, weight);
  ck_assert_double_eq_tol(force, metric(fixed, "grasp_force_peak_N"), 0.1 * force);
  check_outcome(document, "released");
  json_decref(document);
  json_decref(fixed);
}
END_TEST

/* A rod along the fingers is held by friction alone: up to mu N, and it falls when it is heavier.
 */
START_TEST(a_rod_is_held_up_to_the_limit_of_friction) {
  static const char *const mass[] = {"8 g", "9 g"};
  for (int k = 0; k < 2; k++) {
    char object[300];
    snprintf(object, sizeof object,
             "{\"shape\": {\"form\": \"cylinder\", \"diameter\": \"20 mm\", \"length\": \"14 mm\", "
             "\"rim\": \"2 mm\"}, \"axis\": [1, 0, 0], \"position\": [\"37 mm\", 0, 0], "
             "\"friction\": 0.5, \"motion\": \"free\", \"mass\": \"%s\"}",
             mass[k]);
    const char *const edits[][2] = {DOWN, {"/object", object}, {NULL, NULL}};
    json_t *document = solve(edits);
    double weight = metric(document, "object_weight_N");
    double carried = metric(document, "weight_carried_N");
    double limit = 0.5 * value_at_end(document, "letting go", true, "normal_force_N");
    ck_assert_double_eq(metric(document, "held"), 1 - k);
    check_outcome(document, k == 0 ? "held" : "fell");
    if (k == 0) {
      ck_assert_double_eq_tol(-at_end(document, "letting go", "force_x_N"), weight, 1e-3 * weight);
      ck_assert_double_le(at_end(document, "letting go", "friction_force_N"), 1.001 * limit);
      ck_assert_double_lt(metric(document, "object_displacement_mm"), 0.5);
      ck_assert_double_lt(metric(document, "energy_error_pct"), 1);
    } else {
      ck_assert_double_lt(carried, weight);
      double friction = value_at_end(document, "letting go", true, "friction_force_N");
      ck_assert_double_eq_tol(friction, limit, 0.01 * limit);
      ck_assert_double_le(carried, friction); /* a little of it acts across */
      ck_assert_double_gt(carried, 0.95 * limit);
      ck_assert_double_eq(at_end(document, "letting go", "contact_area_mm2"), 0);
    }
    json_decref(document);
  }
}
END_TEST

/* A box that is let go above a finger falls on it and comes to rest: with it the weight is borne.
 */
START_TEST(a_box_falls_onto_a_finger_and_rests) {
  const char *const edits[][2] = {
      {"/load", "{\"pressure\": {\"to\": \"2 kPa\", \"steps\": 1}, \"gravity\": [0, 0, \"9.80665 "
                "m/s2\"]}"},
      {"/object", "{\"shape\": {\"form\": \"box\", \"size\": [\"10 mm\", \"10 mm\", \"10 mm\"], "
                  "\"edge\": \"2 mm\"}, \"position\": [\"10 mm\", 0, \"-5.05 mm\"], \"friction\": "
                  "0.5, \"motion\": \"free\", \"mass\": \"3 g\"}"},
      {"/grasp", "{}"},
      {NULL, NULL}};
  json_t *document = solve(edits);
  double weight = 3e-3 * gravity;
  check_outcome(document, "held");
  ck_assert_double_eq_tol(-at_end(document, "letting go", "force_z_N"), weight, 1e-3 * weight);
  ck_assert_double_eq_tol(metric(document, "weight_carried_N"), weight, 1e-3 * weight);
  ck_assert_double_lt(metric(document, "object_displacement_mm"), 1);
  ck_assert_double_gt(metric(document, "jumps"), 0);
  json_decref(document);
}
END_TEST

/* ---- paths ---- */

/* Two legs in one direction are a straight pull. */
START_TEST(a_path_along_a_line_is_a_pull) {
  const char *const straight[][2] = {
      PULL("\"direction\": [1, 0, 0], \"distance\": \"2 mm\", \"steps\": 2"), {NULL, NULL}};
  const char *const path[][2] = {
      PULL("\"path\": [{\"move\": [\"0.8 mm\", 0, 0]}, {\"move\": [\"1.2 "
           "mm\", 0, 0]}], \"steps\": 1"),
      {NULL, NULL}};
  json_t *one = solve(straight), *two = solve(path);
  double force = at_end(one, "pull", "grasp_force_N");
  ck_assert_double_gt(force, 0.05);
  ck_assert_double_eq_tol(at_end(two, "pull", "grasp_force_N"), force, 0.01 * force);
  ck_assert_double_eq_tol(at_end(two, "pull", "displacement_mm"), 2, 1e-9);
  ck_assert_double_eq_tol(at_end(two, "pull", "time_s"), at_end(one, "pull", "time_s"), 1e-9);
  ck_assert_double_eq_tol(metric(two, "pull_work_mJ"), metric(one, "pull_work_mJ"),
                          0.05 * metric(one, "pull_work_mJ"));
  json_decref(one);
  json_decref(two);
}
END_TEST

/* Without friction a way there and back ends as it began, and has taken no work. */
START_TEST(a_closed_path_returns) {
  const char *const edits[][2] = {
      {"/object/friction", "0"},
      PULL("\"path\": [{\"move\": [\"1 mm\", 0, 0]}, {\"move\": [\"-1 mm\", 0, 0]}], \"steps\": 2"),
      {NULL, NULL}};
  static const char *const keys[] = {"force_x_N", "normal_force_N", "bending_angle_deg"};
  json_t *document = solve(edits);
  for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
    double before = at_end(document, "inflation", keys[i]);
    ck_assert_double_eq_tol(at_end(document, "pull", keys[i]), before, 2e-3 * fabs(before));
  }
  ck_assert_double_eq_tol(metric(document, "friction_work_mJ"), 0, 1e-12);
  ck_assert_double_lt(metric(document, "energy_error_pct"), 1);
  json_decref(document);
}
END_TEST

/* A ball that is turned once about the axis of the gripper rubs with mu N at its radius, but for
 * where it sticks at first. */
START_TEST(a_whole_turn_meets_the_moment_of_friction) {
  const char *const edits[][2] = {
      PULL("\"path\": [{\"turn\": {\"axis\": [1, 0, 0], \"angle\": \"360 deg\"}}], \"steps\": 1"),
      {"/grasp/numerics", "{\"longest_step\": \"5 mm\"}"},
      {NULL, NULL}};
  json_t *document = solve(edits);
  double moment = at_end(document, "pull", "grasp_moment_N_mm");
  double limit = 0.5 * at_end(document, "pull", "normal_force_N") * 10;
  ck_assert_double_eq_tol(moment, limit, 0.02 * limit);
  ck_assert_double_ge(metric(document, "grasp_moment_peak_N_mm"), moment);
  ck_assert_double_eq_tol(at_end(document, "pull", "turned_deg"), 360, 1e-9);
  ck_assert_double_eq_tol(metric(document, "friction_work_mJ"), 2 * M_PI * limit,
                          0.1 * 2 * M_PI * limit);
  json_decref(document);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("free objects and paths");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 300);
  tcase_add_test(tcase, a_ball_is_held_until_it_is_drawn_out);
  tcase_add_test(tcase, a_rod_is_held_up_to_the_limit_of_friction);
  tcase_add_test(tcase, a_box_falls_onto_a_finger_and_rests);
  tcase_add_test(tcase, a_path_along_a_line_is_a_pull);
  tcase_add_test(tcase, a_closed_path_returns);
  tcase_add_test(tcase, a_whole_turn_meets_the_moment_of_friction);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
