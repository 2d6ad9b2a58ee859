/* Plots of documents that are not what they should be: a picture or a refusal, nothing else. */
#include <check.h>
#include <stdlib.h>

#include "tests/unit/plot_bistable_samples.h"
#include "tests/unit/plot_pictures.h"
#include "tests/unit/plot_samples.h"
#include "tests/unit/plot_study_samples.h"
#include "tests/unit/suite.h"

#define LONG_NAME                                                                                  \
  "a member whose name goes on and on, as names do that are made of many values, 12 mm, 3 kPa, "   \
  "trapezoidal, with all four faces inclined by different angles, until nobody can read it"

static const char *const all_plots[] = {
    "curves",   "metric",    "ranking",      "workspace", "twist",   "mesh",      "suction",
    "measured", "midline3d", "tip3d",        "angle",     "tip",     "midline",   "contraction",
    "fit",      "stress",    "time",         "phase",     "steady",  "snap-path", "shapes",
    "held",     "stability", "coefficients", "fitted",    "control", "snap",      "overlay"};
enum { ALL = sizeof all_plots / sizeof *all_plots };

static const struct plot_sheet small = {.width = 220, .height = 200};

/* Draws everything that a document may be drawn as: a picture or a refusal, nothing else. */
static void draw_whatever(json_t *document) {
  for (size_t k = 0; k < ALL; k++) {
    struct plot_input input = {.result = document, .title = LONG_NAME, .job_id = 7};
    unsigned char *png = NULL;
    size_t size = 0;
    struct error error = {0};
    enum status status = plot_render(all_plots[k], &input, 1, &small, &png, &size, &error);
    ck_assert_msg(status == STATUS_OK || status == STATUS_NOT_FOUND, "%s: %s", all_plots[k],
                  error.message);
    ck_assert_int_eq(png != NULL, status == STATUS_OK);
    free(png);
  }
}

START_TEST(malformed_documents) {
  static const char *const texts[] = {
      "{}",
      "[]",
      "{\"members\":{}}",
      "{\"members\":[null,7,\"x\",[],{}],\"parameters\":[null,{}],\"published\":[null,{}]}",
      "{\"members\":[{\"samples\":{},\"metrics\":[],\"values\":7,\"name\":3,\"status\":[]}]}",
      "{\"members\":[{\"metrics\":{\"suction_force_N\":1e308,\"sucker_count\":-1e308}}]}",
      "{\"members\":[{\"metrics\":{\"suction_force_N\":1e9,\"sucker_count\":1e9}},"
      "{\"metrics\":{\"suction_force_N\":-1e9,\"sucker_count\":-1e9,\"bending_angle_deg\":0}}]}",
      "{\"parameters\":[{\"pointer\":\"/a\"}],\"members\":[{\"values\":{\"/a\":\"1e999 mm\"},"
      "\"metrics\":{\"bending_angle_deg\":1}},{\"values\":{\"/a\":\"nan\"}}]}",
      "{\"parameters\":[{\"pointer\":\"/a\"}],\"members\":[{\"values\":{\"/a\":1e9},"
      "\"metrics\":{\"bending_angle_deg\":1e9,\"bending_angle_deg_error\":1e9}},"
      "{\"values\":{\"/a\":-1e9},\"metrics\":{\"bending_angle_deg\":-1e9}}]}",
      "{\"published\":[{\"member\":1e300,\"metric\":\"bending_angle_deg\",\"value\":1}],"
      "\"members\":[{\"metrics\":{\"bending_angle_deg\":-1}}]}",
      "{\"ranking\":{\"designs\":[{}]}}",
      "{\"ranking\":{\"designs\":[null,{\"final\":1e9},{\"final\":-2,\"name\":\"x\"}],"
      "\"mean_weight\":7}}",
      "{\"ranking\":[{\"final\":1}]}",
      "{\"members\":[{\"statistics\":{\"unknowns\":1},\"metrics\":{\"bending_angle_deg\":0}},"
      "{\"statistics\":{\"unknowns\":1e9},\"metrics\":{\"bending_angle_deg\":0}}]}",
      "{\"members\":[{\"samples\":[{\"tip_x_mm\":1e9,\"tip_y_mm\":-1e9,\"tip_z_mm\":1e9}],"
      "\"values\":{\"/load/pressure/left\":\"1e9 MPa\",\"/load/pressure/right\":\"-1 Pa\"}}]}",
      "{\"samples\":[{\"strain\":1e9,\"measured_stress_MPa\":-1e9,\"band_MPa\":1e9},"
      "{\"strain\":0,\"fitted_stress_MPa\":1e9,\"band_MPa\":1e9}],\"coefficients\":[null,"
      "{\"name\":\"mu\",\"value\":1e9}],\"metrics\":{\"strain_from\":-1e9,\"strain_to\":1e9}}",
      "{\"samples\":[{\"stretch\":1,\"uniaxial_stress_MPa\":1},{\"stretch\":1,"
      "\"uniaxial_stress_MPa\":-9}],\"metrics\":{\"stable_to_stretch\":-1e9}}",
      "{\"measured\":[null,{},{\"pressure_kPa\":-1e9,\"measured\":1e9,\"error\":-1e9}]}",
      "{\"paths\":[null,{\"name\":\"a\",\"points\":[{\"pressure_kPa\":1e9,\"h_mm\":-1e9},"
      "{\"pressure_kPa\":-1e9,\"h_mm\":1e9,\"force_N\":1e9,\"stable\":7},{}]}],"
      "\"events\":[{\"path\":\"a\",\"type\":\"limit point\",\"h_mm\":0,\"pressure_kPa\":0}]}",
      "{\"shapes\":[{\"regions\":[{\"outline_mm\":[[1e9,1e9],[0,-1e9],[\"x\"]]}]},"
      "{\"regions\":[{\"region\":\"pet\",\"outline_mm\":[[1e-5,0],[1e-5,1e-5]]}]}]}",
      "{\"control\":{},\"steps\":[7,{\"in_reach\":false,\"start_s\":1e9,\"end_s\":-1e9,\"target_"
      "mm\":1}],"
      "\"samples\":[{\"time_s\":-1e9,\"reference_mm\":1e9},{\"reference_mm\":[]}]}",
      "{\"held\":[{\"pressure_kPa\":-1e9,\"force_N\":1e9}],\"published\":"
      "[{\"metric\":\"force_per_pressure_N_per_kPa\",\"value\":1e9}]}",
      "{\"harmonics\":[{\"path\":\"a\",\"pressure_kPa\":1e9,\"negative\":[1,2]},7,"
      "{\"path\":\"b\",\"pressure_kPa\":0,\"negative\":{}}]}",
      "{\"midlines\":[{\"pressure_kPa\":1,\"points_mm\":[[0,1,0],[0,1,0]]}],"
      "\"samples\":[{\"pressure_kPa\":1,\"tip_x_mm\":0,\"tip_y_mm\":1,\"tip_z_mm\":0}]}",
  };
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    json_t *document = json_loads(texts[i], 0, NULL);
    ck_assert_ptr_nonnull(document);
    draw_whatever(document);
    json_decref(document);
  }
}
END_TEST

/* A generator of its own, so that every run tries the same. */
static unsigned next_random(unsigned *state) {
  *state = *state * 1664525u + 1013904223u;
  return *state >> 8;
}

static json_t *odd_value(unsigned choice) {
  static const char *const texts[] = {"null", "true", "\"\"", "\"-3 mm\"", "[]",     "{}",
                                      "0",    "1e9",  "-1e9", "1e308",     "1e-300", "[[1,2],{}]"};
  return json_loads(texts[choice % (sizeof texts / sizeof *texts)], JSON_DECODE_ANY, NULL);
}

/* Replaces or removes one value somewhere below. */
static void damage(json_t *value, unsigned *state) {
  for (int depth = 0; depth < 6; depth++) {
    json_t *next = NULL;
    if (json_is_object(value) && json_object_size(value) > 0) {
      void *at = json_object_iter(value);
      for (size_t i = next_random(state) % json_object_size(value); i > 0; i--) {
        at = json_object_iter_next(value, at);
      }
      next = json_object_iter_value(at);
      if (next_random(state) % 4 == 0 || !(json_is_object(next) || json_is_array(next))) {
        json_object_iter_set_new(value, at, odd_value(next_random(state)));
        return;
      }
    } else if (json_is_array(value) && json_array_size(value) > 0) {
      size_t i = next_random(state) % json_array_size(value);
      next = json_array_get(value, i);
      if (next_random(state) % 4 == 0 || !(json_is_object(next) || json_is_array(next))) {
        json_array_set_new(value, i, odd_value(next_random(state)));
        return;
      }
    } else {
      return;
    }
    value = next;
  }
}

START_TEST(damaged_documents) {
  json_t *whole[] = {plot_sample_grid(3),   plot_sample_designs(4), plot_sample_spatial(60),
                     plot_sample_snap(30),  plot_sample_identify(), plot_sample_motion(true),
                     plot_sample_ladder(30)};
  enum { WHOLE = sizeof whole / sizeof *whole };
  unsigned state = 4;
  plot_sample_rank(whole[1], 4);
  plot_sample_suckers(whole[1]);
  for (int i = 0; i < 210; i++) {
    json_t *document = json_deep_copy(whole[i % WHOLE]);
    if (i / WHOLE % 2) {
      json_object_del(document,
                      "kind"); /* then any plot has a try, and not only those of the kind */
    }
    for (int k = 0; k < 6; k++) {
      damage(document, &state);
    }
    draw_whatever(document);
    json_decref(document);
  }
  for (int k = 0; k < WHOLE; k++) {
    json_decref(whole[k]);
  }
}
END_TEST

int main(void) {
  Suite *suite = suite_create("plots of damaged documents");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 300);
  tcase_add_test(tcase, malformed_documents);
  tcase_add_test(tcase, damaged_documents);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
