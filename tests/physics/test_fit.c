/* Fits of materials: published coefficients from the same curves, known laws from curves made of
 * them, derivatives, confidence, bounds, and how fits end. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/job/embed.h"
#include "solver/material/fit_job.h"
#include "solver/material/regression.h"
#include "tests/unit/suite.h"

/* ---- the measured curves ---------------------------------------------------------------- */

/* Reads a file below the source directory as a job, with the files that it names. */
static void read_job_file(const char *name, struct job_spec *spec) {
  static char text[1 << 16];
  const char *source = getenv("srcdir");
  char path[600], *embedded = NULL;
  size_t length = 0;
  snprintf(path, sizeof path, "%s/jobs/material/%s.json", source ? source : ".", name);
  FILE *file = fopen(path, "rb");
  ck_assert_msg(file != NULL, "%s cannot be opened", path);
  size_t size = fread(text, 1, sizeof text, file);
  fclose(file);
  struct error error = {.status = STATUS_OK};
  ck_assert_msg(embed_files(text, size, path, &embedded, &length, &error) == STATUS_OK, "%s",
                error.message);
  ck_assert_msg(job_spec_read(embedded, length, spec, &error) == STATUS_OK, "%s: %s", error.pointer,
                error.message);
  free(embedded);
}

static json_t *run_fit(const struct job_spec *spec, enum status *ending) {
  struct error error = {.status = STATUS_OK};
  json_t *document = NULL;
  *ending = STATUS_INTERNAL;
  ck_assert_msg(fit_job(spec, NULL, &document, ending, &error) == STATUS_OK, "%s", error.message);
  ck_assert_ptr_nonnull(document);
  return document;
}

static double metric(const json_t *document, const char *key) {
  const json_t *value = json_object_get(json_object_get(document, "metrics"), key);
  ck_assert_msg(json_is_number(value), "no metric %s", key);
  return json_number_value(value);
}

/* The coefficients, in MPa, that an independent fit of the same curves gave. */
static const struct {
  const char *file;
  double c[3], r_squared;
} published[] = {
    {"dragon-skin-20-100", {0.0612, 0.00796, 0.0}, 0.998},
    {"dragon-skin-20-300", {0.0704, 0.00522, -1.13e-4}, 0.9995},
    {"dragon-skin-30-100", {0.0904, 0.00908, 0.0}, 0.999},
    {"dragon-skin-30-300", {0.1006, 0.00639, -1.49e-4}, 0.999},
    {"dragon-skin-10-300", {0.0243, 0.00225, -5.4e-5}, 0.999},
    {"ecoflex-00-30-300", {0.00783, 1.03e-4, -8e-7}, 0.999},
};

START_TEST(published_coefficients_come_out_within_two_percent) {
  static const char *const keys[] = {"C1_MPa", "C2_MPa", "C3_MPa"};
  struct job_spec spec;
  enum status ending;
  read_job_file(published[_i].file, &spec);
  json_t *document = run_fit(&spec, &ending);
  ck_assert_int_eq(ending, STATUS_OK);
  for (int k = 0; k < 3 && published[_i].c[k] != 0.0; k++) {
    double found = metric(document, keys[k]), wanted = published[_i].c[k];
    ck_assert_msg(fabs(found / wanted - 1.0) < 0.02, "%s of %s is %.6g, not %.6g", keys[k],
                  published[_i].file, found, wanted);
  }
  ck_assert_double_ge(metric(document, "r_squared"), published[_i].r_squared - 0.0005);
  json_decref(document);
  job_spec_release(&spec);
}
END_TEST

START_TEST(the_material_can_be_put_into_a_job) {
  struct job_spec spec, with;
  enum status ending;
  read_job_file("dragon-skin-20-300-ogden", &spec);
  json_t *document = run_fit(&spec, &ending);
  char *material = json_dumps(json_object_get(document, "material"), 0);
  suite_must_read("/material", material, &with);
  ck_assert_int_eq(with.material.model, MATERIAL_OGDEN);
  ck_assert_double_eq_tol(1e-6 * material_shear_modulus(&with.material),
                          metric(document, "initial_shear_modulus_MPa"), 1e-7);
  ck_assert_double_eq_tol(with.material.fit_stretch_max, 4.0, 0.03);
  ck_assert_ptr_nonnull(strstr(with.material.source, "Dragon Skin 20"));
  free(material);
  json_decref(document);
  job_spec_release(&spec);
}
END_TEST

/* ---- curves of known laws --------------------------------------------------------------- */

enum { POINTS = 120 };

static const struct known {
  enum material_model model;
  int terms;
  double coefficient[FIT_COEFFICIENTS_MAX];
  double low, high; /* stretches */
} known[] = {
    {MATERIAL_NEO_HOOKE, 1, {4e5}, 0.6, 2.0},
    {MATERIAL_YEOH, 1, {1e5}, 1.02, 3.0},
    {MATERIAL_YEOH, 2, {6e4, 8e3}, 1.02, 3.0},
    {MATERIAL_YEOH, 3, {1e3, 20.0, -0.1}, 1.02, 4.0},
    {MATERIAL_MOONEY_RIVLIN, 2, {2.93e5, 1.77e5}, 1.02, 2.5},
    {MATERIAL_MOONEY_RIVLIN, 2, {3e8, -5e7}, 0.7, 1.5},
    {MATERIAL_OGDEN, 1, {2e5, 3.1}, 0.6, 2.5},
    {MATERIAL_OGDEN, 1, {-2e5, -2.5}, 0.6, 2.5},
    {MATERIAL_OGDEN, 2, {4e5, 2e3, 1.3, 6.0}, 0.4, 4.0},
    /* Ogden's own coefficients for Treloar's rubber (1972). */
    {MATERIAL_OGDEN, 3, {6.3e5, 1.2e3, -1e4, 1.3, 5.0, -2.0}, 0.3, 7.0},
};

static double noise(unsigned *seed) {
  double sum = -6.0; /* the sum of twelve uniform numbers is nearly normal */
  for (int i = 0; i < 12; i++) {
    *seed = *seed * 1664525u + 1013904223u;
    sum += (double)(*seed >> 8) / (1u << 24);
  }
  return sum;
}

/* The curve of a known law with noise of `spread` Pa, and the fit of the same form. */
static void make_curve(const struct known *law, double spread, unsigned *seed, struct fit_spec *fit,
                       struct tensile_curve *curve) {
  static double strain[POINTS], stress[POINTS];
  struct material_spec material = {.model = law->model, .terms = law->terms};
  law_set(&material, law->coefficient);
  *fit = (struct fit_spec){.model = law->model, .terms = law->terms, .bulk_ratio = 1000};
  fit->count = law_count(&material);
  for (int i = 0; i < FIT_COEFFICIENTS_MAX; i++) {
    bool exponent = fit_coefficient_is_exponent(fit, i);
    fit->lower[i] = exponent ? -50.0 : -INFINITY;
    fit->upper[i] = exponent ? 50.0 : INFINITY;
  }
  for (int i = 0; i < POINTS; i++) {
    double stretch = law->low + (law->high - law->low) * i / (POINTS - 1);
    strain[i] = stretch - 1.0;
    stress[i] = law_stress(&material, DEFORMATION_UNIAXIAL, stretch, NULL) + spread * noise(seed);
  }
  *curve = (struct tensile_curve){.count = POINTS, .strain = strain, .stress = stress};
}

static const struct regression_control no_limit = {0, NULL};

static enum status fit_known(const struct known *law, double spread, unsigned *seed,
                             struct regression *result) {
  struct fit_spec fit;
  struct tensile_curve curve;
  struct error error = {.status = STATUS_OK};
  make_curve(law, spread, seed, &fit, &curve);
  return regression_fit(&fit, &curve, &no_limit, result, &error);
}

/* Index in the result of the known coefficient: the terms of an Ogden law have no order. */
static int place_of(const struct known *law, const struct regression *r, int index) {
  int n = law->terms, best = index % n;
  for (int i = 0; law->model == MATERIAL_OGDEN && i < n; i++) {
    double alpha = law->coefficient[n + index % n];
    best = fabs(r->coefficient[n + i] - alpha) < fabs(r->coefficient[n + best] - alpha) ? i : best;
  }
  return index < n ? best : best + n;
}

START_TEST(known_laws_come_back) {
  const struct known *law = &known[_i];
  struct regression r;
  unsigned seed = 1;
  ck_assert_int_eq(fit_known(law, 0.0, &seed, &r), STATUS_OK);
  for (int i = 0; i < r.count; i++) {
    double found = r.coefficient[place_of(law, &r, i)];
    ck_assert_msg(fabs(found / law->coefficient[i] - 1.0) < 1e-5, "%d: %.9g, not %.9g", i, found,
                  law->coefficient[i]);
  }
  ck_assert_double_gt(r.r_squared, 1.0 - 1e-10);
}
END_TEST

START_TEST(derivatives_are_those_of_the_stress) {
  const struct known *law = &known[_i];
  struct material_spec material = {.model = law->model, .terms = law->terms};
  for (enum deformation d = 0; d < DEFORMATION_COUNT; d++) {
    for (double stretch = law->low; stretch < law->high; stretch += 0.21) {
      double gradient[FIT_COEFFICIENTS_MAX], x[FIT_COEFFICIENTS_MAX];
      law_set(&material, law->coefficient);
      law_stress(&material, d, stretch, gradient);
      for (int i = 0; i < law_count(&material); i++) {
        double side[2], h = 1e-5 * fabs(law->coefficient[i]);
        for (int k = 0; k < 2; k++) {
          memcpy(x, law->coefficient, sizeof x);
          x[i] += k == 0 ? -h : h;
          law_set(&material, x);
          side[k] = law_stress(&material, d, stretch, NULL);
        }
        law_set(&material, law->coefficient);
        double difference = (side[1] - side[0]) / (2.0 * h);
        double size = fabs(difference) + fabs(side[1] / law->coefficient[i]);
        ck_assert_double_eq_tol(gradient[i], difference, 1e-7 * size);
      }
    }
  }
}
END_TEST

START_TEST(tangents_are_those_of_the_stress) {
  const struct known *law = &known[_i];
  struct material_spec material = {.model = law->model, .terms = law->terms};
  law_set(&material, law->coefficient);
  for (double stretch = law->low; stretch < law->high; stretch += 0.21) {
    /* In equibiaxial deformation d(t1 - t3) = (h11 + h12) dln(lambda). */
    double lambda[3], h[3], side[2], step = 1e-5;
    deformation_stretches(DEFORMATION_EQUIBIAXIAL, stretch, lambda);
    law_tangent(&material, lambda, h);
    for (int k = 0; k < 2; k++) {
      double at = stretch * exp(k == 0 ? -step : step);
      side[k] = at * law_stress(&material, DEFORMATION_EQUIBIAXIAL, at, NULL);
    }
    double difference = (side[1] - side[0]) / (2.0 * step);
    ck_assert_double_eq_tol(h[0] + h[1], difference, 1e-6 * fabs(difference));
    ck_assert_double_eq_tol(h[0], h[2], 1e-9 * fabs(h[0]));
  }
}
END_TEST

/* 95 % intervals hold the truth in 95 of 100 cases: of 400 fits 380, with a spread of 4.4. */
START_TEST(confidence_intervals_cover_the_truth) {
  static const struct known law = {MATERIAL_YEOH, 2, {6e4, 8e3}, 1.02, 3.0};
  enum { TRIALS = 400 };
  int covered[2] = {0, 0}, in_band = 0;
  unsigned seed = 20;
  struct material_spec truth = {.model = law.model, .terms = law.terms};
  law_set(&truth, law.coefficient);
  for (int trial = 0; trial < TRIALS; trial++) {
    struct regression r;
    ck_assert_int_eq(fit_known(&law, 3e3, &seed, &r), STATUS_OK);
    for (int i = 0; i < 2; i++) {
      covered[i] += fabs(r.coefficient[i] - law.coefficient[i]) < regression_half_width(&r, i);
    }
    double off = law_stress(&r.material, DEFORMATION_UNIAXIAL, 2.2, NULL) -
                 law_stress(&truth, DEFORMATION_UNIAXIAL, 2.2, NULL);
    in_band += fabs(off) < regression_band(&r, 2.2);
  }
  ck_assert_int_ge(covered[0], 365);
  ck_assert_int_le(covered[0], 395);
  ck_assert_int_ge(covered[1], 365);
  ck_assert_int_le(covered[1], 395);
  ck_assert_int_ge(in_band, 365);
  ck_assert_int_le(in_band, 395);
}
END_TEST

START_TEST(intervals_of_an_ogden_law_cover_too) {
  static const struct known law = {MATERIAL_OGDEN, 1, {2e5, 3.1}, 0.6, 2.5};
  enum { TRIALS = 200 };
  int covered[2] = {0, 0};
  unsigned seed = 3;
  for (int trial = 0; trial < TRIALS; trial++) {
    struct regression r;
    ck_assert_int_eq(fit_known(&law, 5e3, &seed, &r), STATUS_OK);
    for (int i = 0; i < 2; i++) {
      covered[i] += fabs(r.coefficient[i] - law.coefficient[i]) < regression_half_width(&r, i);
    }
  }
  for (int i = 0; i < 2; i++) {
    ck_assert_int_ge(covered[i], 180);
    ck_assert_int_le(covered[i], 199);
  }
}
END_TEST

/* ---- bounds ----------------------------------------------------------------------------- */

START_TEST(bounds_are_kept_and_the_rest_is_the_best) {
  static const struct known law = {MATERIAL_YEOH, 3, {6e4, 8e3, -100.0}, 1.02, 3.0};
  struct fit_spec fit;
  struct tensile_curve curve;
  struct regression r, free_two;
  struct error error;
  unsigned seed = 5;
  make_curve(&law, 1e3, &seed, &fit, &curve);
  fit.lower[2] = 0.0;
  ck_assert_int_eq(regression_fit(&fit, &curve, &no_limit, &r, &error), STATUS_OK);
  ck_assert_double_eq(r.coefficient[2], 0.0);
  ck_assert(r.at_bound[2] && !r.at_bound[0] && !r.at_bound[1]);
  ck_assert_double_eq(regression_half_width(&r, 2), 0.0);
  /* With C3 at 0 the other two are those of the law of two terms. */
  fit.terms = fit.count = 2;
  ck_assert_int_eq(regression_fit(&fit, &curve, &no_limit, &free_two, &error), STATUS_OK);
  for (int i = 0; i < 2; i++) {
    ck_assert_double_eq_tol(r.coefficient[i] / free_two.coefficient[i], 1.0, 1e-8);
    ck_assert_double_eq_tol(regression_half_width(&r, i) / regression_half_width(&free_two, i), 1.0,
                            1e-6);
  }
}
END_TEST

START_TEST(bounds_without_effect_change_nothing) {
  const struct known *law = &known[8];
  struct fit_spec fit;
  struct tensile_curve curve;
  struct regression r;
  struct error error;
  unsigned seed = 5;
  make_curve(law, 0.0, &seed, &fit, &curve);
  fit.lower[0] = 0.0;
  fit.upper[0] = 1e6;
  fit.lower[1] = 0.0;
  fit.upper[3] = 20.0;
  ck_assert_int_eq(regression_fit(&fit, &curve, &no_limit, &r, &error), STATUS_OK);
  for (int i = 0; i < r.count; i++) {
    ck_assert(!r.at_bound[i]);
    ck_assert_double_eq_tol(r.coefficient[place_of(law, &r, i)] / law->coefficient[i], 1.0, 1e-5);
  }
}
END_TEST

START_TEST(every_coefficient_may_be_at_its_bound) {
  static const struct known law = {MATERIAL_MOONEY_RIVLIN, 2, {2e5, 1e5}, 1.02, 2.5};
  struct fit_spec fit;
  struct tensile_curve curve;
  struct regression r;
  struct error error;
  unsigned seed = 5;
  make_curve(&law, 0.0, &seed, &fit, &curve);
  fit.upper[0] = 1e5;
  fit.upper[1] = 5e4;
  ck_assert_int_eq(regression_fit(&fit, &curve, &no_limit, &r, &error), STATUS_OK);
  ck_assert_double_eq(r.coefficient[0], 1e5);
  ck_assert_double_eq(r.coefficient[1], 5e4);
}
END_TEST

/* ---- how fits end ----------------------------------------------------------------------- */

/* A fit job of a law to a short table. */
static json_t *run_text(const char *law, const char *table, enum status *ending) {
  char text[2000];
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  snprintf(text, sizeof text,
           "{\"kind\":\"fit-material\",%s,\"data\":{\"csv\":\"%s\"},\"columns\":{\"strain\":"
           "{\"name\":\"e\",\"unit\":\"1\"},\"stress\":{\"name\":\"s\",\"unit\":\"MPa\"}}}",
           law, table);
  ck_assert_msg(job_spec_read(text, strlen(text), &spec, &error) == STATUS_OK, "%s: %s",
                error.pointer, error.message);
  json_t *document = run_fit(&spec, ending);
  job_spec_release(&spec);
  return document;
}

static const char rubber[] = "e,s\\n0,0\\n0.2,0.05\\n0.4,0.09\\n0.6,0.12\\n0.8,0.15\\n1,0.17\\n"
                             "1.2,0.2\\n1.4,0.22\\n";

START_TEST(a_fit_that_makes_no_material_has_diverged) {
  enum status ending;
  json_t *document =
      run_text("\"model\":\"yeoh\",\"bounds\":{\"C1\":[\"-1 MPa\",\"-0.1 MPa\"]}", rubber, &ending);
  ck_assert_int_eq(ending, STATUS_UNSTABLE);
  ck_assert_str_eq(json_string_value(json_object_get(document, "status")), "diverged");
  ck_assert_str_eq(json_string_value(json_object_get(document, "reason")), "material_instability");
  ck_assert_ptr_null(json_object_get(document, "material"));
  ck_assert_uint_eq(json_array_size(json_object_get(document, "samples")), 8);
  json_decref(document);
}
END_TEST

static bool always(void *context) {
  (void)context;
  return true;
}

START_TEST(a_fit_can_be_stopped) {
  struct fit_spec fit;
  struct tensile_curve curve;
  struct regression r;
  struct error error = {.status = STATUS_OK};
  unsigned seed = 5;
  make_curve(&known[9], 0.0, &seed, &fit, &curve);
  struct regression_control cancelled = {0, always}, late = {1e-3, NULL};
  ck_assert_int_eq(regression_fit(&fit, &curve, &cancelled, &r, &error), STATUS_CANCELLED);
  ck_assert_int_eq(regression_fit(&fit, &curve, &late, &r, &error), STATUS_TIMEOUT);
}
END_TEST

START_TEST(coefficients_that_the_curve_does_not_determine_are_named) {
  enum status ending;
  json_t *document = run_text("\"model\":\"ogden\",\"terms\":3", rubber, &ending);
  char *warnings = json_dumps(json_object_get(document, "warnings"), 0);
  ck_assert_msg(ending == STATUS_DIVERGED || strstr(warnings, "does not determine") != NULL ||
                    strstr(warnings, "hardly be told apart") != NULL,
                "%s", warnings);
  free(warnings);
  json_decref(document);
}
END_TEST

START_TEST(true_measures_and_extensions_mean_the_same_curve) {
  static const char *const columns[] = {
      "\"columns\":{\"strain\":{\"name\":\"e\",\"unit\":\"%\"},\"stress\":{\"name\":\"s\","
      "\"unit\":\"kPa\"}}",
      "\"columns\":{\"stretch\":{\"name\":\"l\",\"unit\":\"1\"},\"stress\":{\"name\":\"s\","
      "\"unit\":\"kPa\"}}",
      "\"columns\":{\"extension\":{\"name\":\"x\",\"unit\":\"cm\"},\"gauge\":\"20 mm\",\"stress\":"
      "{\"name\":\"s\",\"unit\":\"kPa\"}}",
      "\"strain\":\"true\",\"stress\":\"true\",\"columns\":{\"strain\":{\"name\":\"t\","
      "\"unit\":\"1\"},\"stress\":{\"name\":\"S\",\"unit\":\"MPa\"}}"};
  char table[4000] = "e;l;x;t;s;S\\n", text[5000];
  struct material_spec material = {.model = MATERIAL_YEOH, .terms = 2, .c = {6e4, 8e3}};
  for (int i = 1; i < 20; i++) {
    double l = 1.0 + 0.1 * i, s = law_stress(&material, DEFORMATION_UNIAXIAL, l, NULL);
    snprintf(table + strlen(table), sizeof table - strlen(table),
             "%.12g;%.12g;%.12g;%.12g;%.12g;%.12g\\n", 100.0 * (l - 1.0), l, 2.0 * (l - 1.0),
             log(l), 1e-3 * s, 1e-6 * s * l);
  }
  for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) {
    struct job_spec spec;
    struct error error = {.status = STATUS_OK};
    enum status ending;
    snprintf(text, sizeof text,
             "{\"kind\":\"fit-material\",\"model\":\"yeoh\",\"data\":{\"csv\":\"%s\"},%s}", table,
             columns[i]);
    ck_assert_msg(job_spec_read(text, strlen(text), &spec, &error) == STATUS_OK, "%s: %s",
                  error.pointer, error.message);
    json_t *document = run_fit(&spec, &ending);
    ck_assert_double_eq_tol(metric(document, "C1_MPa"), 0.06, 1e-9);
    ck_assert_double_eq_tol(metric(document, "C2_MPa"), 0.008, 1e-9);
    json_decref(document);
    job_spec_release(&spec);
  }
}
END_TEST

int main(void) {
  const int laws = sizeof known / sizeof *known;
  Suite *suite = suite_create("material: fits");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 60);
  tcase_add_loop_test(tcase, published_coefficients_come_out_within_two_percent, 0,
                      sizeof published / sizeof *published);
  tcase_add_test(tcase, the_material_can_be_put_into_a_job);
  tcase_add_loop_test(tcase, known_laws_come_back, 0, laws);
  tcase_add_loop_test(tcase, derivatives_are_those_of_the_stress, 0, laws);
  tcase_add_loop_test(tcase, tangents_are_those_of_the_stress, 0, laws);
  tcase_add_test(tcase, confidence_intervals_cover_the_truth);
  tcase_add_test(tcase, intervals_of_an_ogden_law_cover_too);
  tcase_add_test(tcase, bounds_are_kept_and_the_rest_is_the_best);
  tcase_add_test(tcase, bounds_without_effect_change_nothing);
  tcase_add_test(tcase, every_coefficient_may_be_at_its_bound);
  tcase_add_test(tcase, a_fit_that_makes_no_material_has_diverged);
  tcase_add_test(tcase, a_fit_can_be_stopped);
  tcase_add_test(tcase, coefficients_that_the_curve_does_not_determine_are_named);
  tcase_add_test(tcase, true_measures_and_extensions_mean_the_same_curve);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
