/* Suckers that pull: their force against pressure times area, its balance, and what hangs on it. */
#include <math.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/grasp/finger.h"
#include "solver/grasp/grasp_job.h"
#include "tests/unit/suite.h"

/* A cup of 8 mm under a finger, above a box that comes up to it. */
static const char text[] =
    "{\"kind\": \"grasp\", \"actuator\": {\"family\": \"pneunet\", \"length\": \"40 mm\", "
    "\"width\": \"16 mm\", \"height\": \"12 mm\", \"chambers\": [{\"config\": \"B\", \"count\": "
    "3}], \"side_wall\": \"2 mm\", \"gap_wall\": \"1.5 mm\", \"top_wall\": \"2 mm\", "
    "\"bottom_layer\": \"4 mm\", \"chamber_gap\": \"1.5 mm\", \"suckers\": [{\"position\": \"22 "
    "mm\", \"diameter\": \"8 mm\", \"depth\": \"1.5 mm\", \"wall\": \"1.5 mm\"}], "
    "\"suction_pressure\": \"5 kPa\"}, \"material\": \"dragon-skin-30\", \"load\": {\"pressure\": "
    "{\"to\": \"0.1 kPa\", \"steps\": 1}, \"gravity\": [0, 0, \"-9.80665 m/s2\"]}, \"object\": "
    "{\"shape\": {\"form\": \"box\", \"size\": [\"20 mm\", \"20 mm\", \"6 mm\"], \"edge\": \"1 "
    "mm\"}, \"position\": [\"22 mm\", 0, \"-4.2 mm\"], \"friction\": 0.5, \"motion\": \"free\", "
    "\"mass\": \"15 g\"}, \"grasp\": {\"approach\": {\"from\": [0, 0, \"-1 mm\"], \"steps\": 1}, "
    "\"numerics\": {\"longest_step\": \"0.3 mm\"}}, \"mesh\": {\"gap_wall\": 1, \"cavity\": 1, "
    "\"gap\": 1, \"half_width\": 1, \"side_wall\": 1, \"bottom\": 1, \"height\": 1, \"top\": 1}}";

static const double suction = 5e3, radius = 4e-3, weight = 15e-3 * 9.80665;

static void read_job(const char *const (*edits)[2], struct job_spec *spec) {
  struct error error = {.status = STATUS_OK};
  enum status status = suite_read_document(text, edits, spec, &error);
  ck_assert_msg(status == STATUS_OK, "%s: %s", error.pointer, error.message);
}

/* On the body at rest the resultant is pressure times area, in the middle of the cup, and what acts
 * on the object is its opposite. */
START_TEST(a_cup_pulls_with_pressure_times_area) {
  static const char *const halves[][4][2] = {
      {{"/mesh/half_width", "6"}, {"/mesh/cavity", "4"}, {NULL, NULL}},
      {{"/mesh/half_width", "6"}, {"/mesh/cavity", "4"}, {"/symmetry", "\"none\""}, {NULL, NULL}}};
  struct job_spec spec;
  struct finger f;
  struct error error = {.status = STATUS_OK};
  read_job(halves[_i], &spec);
  bool half = finger_symmetric(&spec, 0);
  ck_assert_int_eq(half, _i == 0);
  ck_assert_int_eq(finger_prepare(&spec, 0, half, &f, &error), STATUS_OK);
  double sum[3] = {0}, area = suction * M_PI * radius * radius;
  cups_pull(&f, 1);
  ck_assert_double_eq(f.cups.pull, 0); /* none is closed */
  f.cups.holds[0] = true;
  cups_pull(&f, 0.5);
  ck_assert_double_eq_tol(f.whole * f.cups.force[2], 0.5 * area, 0.01 * 0.5 * area);
  ck_assert_double_eq_tol(f.whole * f.cups.pull, 0.5 * area, 0.01 * 0.5 * area);
  ck_assert_double_eq_tol(f.cups.force[0], 0, 1e-12);
  ck_assert_double_eq_tol(-f.cups.force[4] / f.cups.force[2], 22e-3, 1e-5);
  for (int d = 0; d < 3 * f.solve.mesh.node_count; d++) {
    sum[d % 3] += f.solve.model->dead_load[d] - f.cups.weight[d];
  }
  for (int i = 0; i < 3; i++) {
    ck_assert_double_eq_tol(sum[i], -f.cups.force[i], 1e-12 * area);
  }
  cups_pull(&f, 0);
  ck_assert_mem_eq(f.solve.model->dead_load, f.cups.weight,
                   sizeof(double) * 3 * (size_t)f.solve.mesh.node_count);
  finger_release(&f);
  job_spec_release(&spec);
}
END_TEST

static double value_of(const json_t *document, const char *part, const char *key) {
  const json_t *samples = json_object_get(document, "samples");
  const json_t *object = strcmp(part, "metrics") == 0
                             ? json_object_get(document, part)
                             : json_array_get(samples, json_array_size(samples) - 1);
  ck_assert_msg(json_is_number(json_object_get(object, key)), "%s", key);
  return json_number_value(json_object_get(object, key));
}

/* A box under the finger hangs on the cup: the suction bears its weight, and what is more than that
 * presses the rim on it. */
START_TEST(a_box_hangs_on_a_cup) {
  static const char *const unchanged[][2] = {{NULL, NULL}};
  struct job_spec spec;
  struct grasp_options options = {.out_dir = NULL};
  struct error error = {.status = STATUS_OK};
  enum status ending;
  json_t *document;
  read_job(unchanged, &spec);
  ck_assert_int_eq(grasp_job(&spec, &options, &document, &ending, &error), STATUS_OK);
  ck_assert_msg(ending == STATUS_OK, "%s", error.message);
  ck_assert_str_eq(json_string_value(json_object_get(document, "outcome")), "held");
  double full = suction * M_PI * radius * radius;
  double rim = value_of(document, "sample", "normal_force_N");
  double drawn = value_of(document, "sample", "suction_force_N");
  ck_assert_double_eq_tol(value_of(document, "sample", "force_z_N"), weight, 1e-3 * weight);
  ck_assert_double_eq_tol(value_of(document, "metrics", "suction_force_N"), full, 0.03 * full);
  ck_assert_double_eq_tol(rim, drawn - weight, 0.06 * rim); /* not all of it is upright */
  ck_assert_double_lt(value_of(document, "metrics", "energy_error_pct"), 1);
  json_decref(document);
  job_spec_release(&spec);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("suckers that pull");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 300);
  tcase_add_loop_test(tcase, a_cup_pulls_with_pressure_times_area, 0, 2);
  tcase_add_test(tcase, a_box_hangs_on_a_cup);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
