/* A computed response against a measured one; and curves of materials against closed forms. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/material/curve_job.h"
#include "solver/post/result_measured.h"
#include "tests/unit/suite.h"

/* A result whose angle is 2 p + p^2 / 50 (p in kPa) at 0, 5, ... `to` kPa. */
static json_t *response(double to) {
  json_t *samples = json_array();
  for (double p = 0; p <= to; p += 5) {
    json_array_append_new(samples, json_pack("{s:f, s:f}", "pressure_kPa", p, "bending_angle_deg",
                                             2 * p + p * p / 50));
  }
  return json_pack("{s:o, s:{}, s:[]}", "samples", samples, "metrics", "warnings");
}

static void read_measured(const char *csv, struct job_spec *spec) {
  char text[1000];
  snprintf(text, sizeof text,
           "{\"data\":{\"csv\":\"%s\"},\"columns\":{\"pressure\":{\"name\":\"p\",\"unit\":\"kPa\"},"
           "\"angle\":{\"name\":\"a\",\"unit\":\"deg\"}}}",
           csv);
  suite_must_read("/measured", text, spec);
}

static double number_at(const json_t *object, const char *key) {
  ck_assert_msg(json_is_number(json_object_get(object, key)), "no %s", key);
  return json_number_value(json_object_get(object, key));
}

START_TEST(figures_of_a_known_difference) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  /* Off by +1, -2 and +2 degrees at recorded pressures. */
  read_measured("p,a\\n10,21\\n20,50\\n40,110\\n", &spec);
  json_t *document = response(50);
  ck_assert_int_eq(result_measured_store(&spec, document, &error), STATUS_OK);
  const json_t *metrics = json_object_get(document, "metrics");
  const json_t *rows = json_object_get(document, "measured");
  ck_assert_uint_eq(json_array_size(rows), 3);
  static const double errors[] = {1, -2, 2};
  for (size_t i = 0; i < 3; i++) {
    ck_assert_double_eq_tol(number_at(json_array_get(rows, i), "error"), errors[i], 1e-9);
  }
  ck_assert_double_eq_tol(number_at(metrics, "measured_rmse_deg"), sqrt(3.0), 1e-9);
  ck_assert_double_eq_tol(number_at(metrics, "measured_max_error_deg"), 2.0, 1e-9);
  double mean = (21 + 50 + 110) / 3.0;
  double about = pow(21 - mean, 2) + pow(50 - mean, 2) + pow(110 - mean, 2);
  ck_assert_double_eq_tol(number_at(metrics, "measured_r_squared"), 1 - 9 / about, 1e-9);
  ck_assert_uint_eq(json_array_size(json_object_get(document, "warnings")), 0);
  json_decref(document);
  job_spec_release(&spec);
}
END_TEST

START_TEST(between_recorded_pressures_the_curve_is_smooth) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  read_measured("p,a\\n12.5,0\\n37.5,0\\n", &spec);
  json_t *document = response(50);
  ck_assert_int_eq(result_measured_store(&spec, document, &error), STATUS_OK);
  const json_t *rows = json_object_get(document, "measured");
  /* A straight line between the records would be 0.125 degrees too high. */
  ck_assert_double_eq_tol(number_at(json_array_get(rows, 0), "simulated"), 28.125, 0.02);
  ck_assert_double_eq_tol(number_at(json_array_get(rows, 1), "simulated"), 103.125, 0.02);
  json_decref(document);
  job_spec_release(&spec);
}
END_TEST

START_TEST(points_beyond_the_simulation_are_left_out) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  read_measured("p,a\\n0,0\\n10,22\\n45,0\\n60,0\\n", &spec);
  json_t *document = response(20); /* stopped early */
  ck_assert_int_eq(result_measured_store(&spec, document, &error), STATUS_OK);
  ck_assert_uint_eq(json_array_size(json_object_get(document, "measured")), 2);
  ck_assert_double_eq_tol(number_at(json_object_get(document, "metrics"), "measured_max_error_deg"),
                          0.0, 1e-9);
  const char *warning = json_string_value(json_array_get(json_object_get(document, "warnings"), 0));
  ck_assert_ptr_nonnull(strstr(warning, "2 of 4 measured points"));
  json_decref(document);
  document = response(-1); /* not even the first state */
  ck_assert_int_eq(result_measured_store(&spec, document, &error), STATUS_OK);
  ck_assert_uint_eq(json_array_size(json_object_get(document, "measured")), 0);
  ck_assert_ptr_null(json_object_get(json_object_get(document, "metrics"), "measured_rmse_deg"));
  json_decref(document);
  job_spec_release(&spec);
}
END_TEST

/* ---- curves of materials ------------------------------------------------------------------ */

static json_t *curve_of(const char *material) {
  char text[400];
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  json_t *document = NULL;
  snprintf(text, sizeof text,
           "{\"kind\":\"material-curve\",\"material\":%s,\"stretch\":[0.5,3],\"points\":26}",
           material);
  ck_assert_msg(job_spec_read(text, strlen(text), &spec, &error) == STATUS_OK, "%s", error.message);
  ck_assert_int_eq(curve_job(&spec, &document, &error), STATUS_OK);
  job_spec_release(&spec);
  return document;
}

/* Incompressible neo-Hooke: uniaxial mu (l - l^-2), equibiaxial mu (l - l^-5), planar
 * mu (l - l^-3). */
START_TEST(neo_hookean_curves_are_the_closed_forms) {
  json_t *document = curve_of("{\"model\":\"neo-hooke\",\"mu\":\"0.4 MPa\"}");
  size_t index;
  json_t *sample;
  json_array_foreach(json_object_get(document, "samples"), index, sample) {
    double l = number_at(sample, "stretch");
    ck_assert_double_eq_tol(l, 0.5 + 0.1 * (double)index, 1e-12);
    ck_assert_double_eq_tol(number_at(sample, "uniaxial_stress_MPa"), 0.4 * (l - pow(l, -2)),
                            1e-12);
    ck_assert_double_eq_tol(number_at(sample, "equibiaxial_stress_MPa"), 0.4 * (l - pow(l, -5)),
                            1e-11);
    ck_assert_double_eq_tol(number_at(sample, "planar_stress_MPa"), 0.4 * (l - pow(l, -3)), 1e-11);
  }
  ck_assert_uint_eq(index, 26);
  const json_t *metrics = json_object_get(document, "metrics");
  ck_assert_double_eq_tol(number_at(metrics, "initial_youngs_modulus_MPa"), 1.2, 1e-12);
  ck_assert_ptr_null(json_object_get(metrics, "stable_to_stretch"));
  json_decref(document);
}
END_TEST

/* The Elastic 50A of the multi-chamber study softens: its equibiaxial stress peaks at 1.32. */
START_TEST(a_softening_material_is_reported) {
  json_t *document = curve_of("\"elastic-50a\"");
  ck_assert_double_eq_tol(number_at(json_object_get(document, "metrics"), "stable_to_stretch"),
                          1.32, 0.005);
  ck_assert_uint_ge(json_array_size(json_object_get(document, "warnings")), 1);
  ck_assert_uint_eq(json_array_size(json_object_get(document, "stability")), 6);
  json_decref(document);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("measured curves");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, figures_of_a_known_difference);
  tcase_add_test(tcase, between_recorded_pressures_the_curve_is_smooth);
  tcase_add_test(tcase, points_beyond_the_simulation_are_left_out);
  tcase_add_test(tcase, neo_hookean_curves_are_the_closed_forms);
  tcase_add_test(tcase, a_softening_material_is_reported);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
