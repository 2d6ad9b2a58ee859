/* Every case of the verification on its coarsest mesh, within the bound that the table states and
 * explains; the references against values printed in the literature; the jobs of jobs/verify. */
#include <cblas.h>
#include <check.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/job/schema.h"
#include "solver/verify/verify.h"
#include "tests/unit/suite.h"

static json_t *run_case(const char *name, int refinement, double timeout_s, enum status *ending) {
  struct job_spec spec = {.kind = JOB_VERIFY, .timeout_s = timeout_s};
  struct verify_options options = {NULL, NULL};
  struct error error = {0};
  json_t *document = NULL;
  snprintf(spec.verify.name, sizeof spec.verify.name, "%s", name);
  spec.verify.refinement = refinement;
  openblas_set_num_threads(1); /* as the solver does */
  enum status status = verify_job(&spec, &options, &document, ending, &error);
  ck_assert_msg(status == STATUS_OK, "%s: %s", name, error.message);
  ck_assert_ptr_nonnull(document);
  return document;
}

static double metric(const json_t *document, const char *name) {
  const json_t *value = json_object_get(json_object_get(document, "metrics"), name);
  return value ? json_number_value(value) : NAN;
}

START_TEST(error_is_below_its_bound) {
  int count;
  const struct verify_case *c = &verify_cases(&count)[_i];
  enum status ending;
  json_t *document = run_case(c->name, 1, 0, &ending);
  double error = 1e-2 * metric(document, "error_percent");
  double worst = metric(document, "worst_error_percent");
  double worst_bound = c->worst_bound > 0 ? c->worst_bound : c->bound;
  printf("%-32s %.3e of %.3e\n", c->name, error, c->bound);
  fflush(stdout);
  ck_assert_msg(ending == STATUS_OK, "%s: %s", c->name,
                json_string_value(json_object_get(document, "message")));
  ck_assert_msg(error <= c->bound, "%s: error %.3e, bound %.3e", c->name, error, c->bound);
  ck_assert_msg(isnan(worst) || 1e-2 * worst <= worst_bound, "%s: worst error %.3e, bound %.3e",
                c->name, 1e-2 * worst, worst_bound);
  ck_assert_uint_ge(json_array_size(json_object_get(document, "meshes")), 1);
  ck_assert_uint_ge(json_array_size(json_object_get(document, "samples")), 1);
  json_decref(document);
}
END_TEST

/* Where the mesh is the only error, a finer one has a smaller error. */
START_TEST(finer_meshes_err_less) {
  static const char *const names[] = {"thick-cylinder-neo-hooke",
                                      "thick-sphere-neo-hooke",
                                      "thick-cylinder-yeoh",
                                      "cooks-membrane",
                                      "elastica",
                                      "roll-up"};
  enum status ending;
  json_t *document = run_case(names[_i], 2, 0, &ending);
  const json_t *meshes = json_object_get(document, "meshes");
  ck_assert_uint_eq(json_array_size(meshes), 2);
  double error[2];
  for (size_t k = 0; k < 2; k++) {
    error[k] = json_number_value(json_object_get(json_array_get(meshes, k), "error_percent"));
  }
  ck_assert_msg(error[1] < error[0], "%s: %.3e after %.3e", names[_i], error[1], error[0]);
  json_decref(document);
}
END_TEST

/* On a fine mesh the bulk modulus, a million times the shear modulus, lets corrections of the path
 * swing for a while: none of them may be taken for its end. */
START_TEST(fine_sphere_of_revolution) {
  enum status ending;
  json_t *document = run_case("sphere-of-revolution", 4, 0, &ending);
  ck_assert_msg(ending == STATUS_OK, "%s", json_string_value(json_object_get(document, "message")));
  ck_assert_double_lt(metric(document, "error_percent"), 1e-3);
  json_decref(document);
}
END_TEST

/* Values printed elsewhere, against the references that the cases compute. */
static const struct {
  const char *name, *key;
  double x, reference, tolerance;
} printed[] = {
    {"thick-cylinder-neo-hooke", "inner_stretch", 1.1, 0.131562, 1e-6},
    {"thick-cylinder-neo-hooke", "inner_stretch", 1.25, 0.275712, 1e-6},
    {"thick-cylinder-neo-hooke", "inner_stretch", 1.5, 0.428228, 1e-6},
    {"thick-cylinder-neo-hooke", "inner_stretch", 2.0, 0.574054, 1e-6},
    {"thick-sphere-neo-hooke", "inner_stretch", 1.1, 0.287155, 1e-6},
    {"thick-sphere-neo-hooke", "inner_stretch", 1.25, 0.551869, 1e-6},
    {"thick-sphere-neo-hooke", "inner_stretch", 1.5, 0.755433, 1e-6},
    {"thick-sphere-neo-hooke", "inner_stretch", 2.0, 0.806927, 1e-6},
    {"elastica", "load", 1, 0.30172, 1e-5}, /* Bisshopp and Drucker (1945), as in textbooks */
    {"elastica", "load", 10, 0.81061, 1e-5},
    {"treloar-uniaxial", "stretch", 7.6, 64.4 * 0.0980665, 1e-9},
    {"treloar-equibiaxial", "stretch", 4.45, 24.7 * 0.0980665, 1e-9},
};
enum { PRINTED = sizeof printed / sizeof *printed };

static const char *const printed_cases[] = {"thick-cylinder-neo-hooke", "thick-sphere-neo-hooke",
                                            "elastica", "treloar-uniaxial", "treloar-equibiaxial"};
enum { PRINTED_CASES = sizeof printed_cases / sizeof *printed_cases };

START_TEST(references_are_the_printed_ones) {
  enum status ending;
  json_t *document = run_case(printed_cases[_i], 1, 0, &ending), *sample;
  size_t index;
  int checked = 0;
  for (int k = 0; k < PRINTED; k++) {
    if (strcmp(printed[k].name, printed_cases[_i]) != 0) {
      continue;
    }
    json_array_foreach(json_object_get(document, "samples"), index, sample) {
      double x = json_number_value(json_object_get(sample, printed[k].key));
      if (fabs(x - printed[k].x) < 1e-9) {
        ck_assert_double_eq_tol(json_number_value(json_object_get(sample, "reference")),
                                printed[k].reference, printed[k].tolerance);
        checked++;
      }
    }
  }
  ck_assert_int_eq(checked, _i < 2 ? 4 : _i == 2 ? 2 : 1);
  json_decref(document);
}
END_TEST

/* The schema offers just the cases there are. */
START_TEST(schema_names_every_case) {
  int count;
  size_t size, index;
  const struct verify_case *cases = verify_cases(&count);
  const char *text = job_schema_text(&size);
  json_t *schema = json_loadb(text, size, 0, NULL), *name;
  json_t *kind = json_object_get(json_object_get(schema, "$defs"), "verify");
  json_t *property = json_object_get(json_object_get(kind, "properties"), "case");
  json_t *names = json_object_get(property, "enum");
  ck_assert_int_eq((int)json_array_size(names), count);
  json_array_foreach(names, index, name) {
    ck_assert_msg(verify_find(json_string_value(name)) != NULL, "%s", json_string_value(name));
  }
  for (int i = 0; i < count; i++) {
    ck_assert_double_gt(cases[i].bound, 0);
  }
  json_decref(schema);
}
END_TEST

/* jobs/verify has one job for every case, named after it. */
START_TEST(every_case_has_its_job) {
  const char *source = getenv("srcdir");
  char path[1000], text[4000];
  int count;
  const struct verify_case *cases = verify_cases(&count);
  for (int i = 0; i < count; i++) {
    struct job_spec spec;
    struct error error = {0};
    snprintf(path, sizeof path, "%s/jobs/verify/%s.json", source ? source : ".", cases[i].name);
    FILE *file = fopen(path, "r");
    ck_assert_msg(file != NULL, "%s", path);
    size_t size = fread(text, 1, sizeof text, file);
    fclose(file);
    enum status status = job_spec_read(text, size, &spec, &error);
    ck_assert_msg(status == STATUS_OK, "%s: %s", path, error.message);
    ck_assert_int_eq(spec.kind, JOB_VERIFY);
    ck_assert_str_eq(spec.verify.name, cases[i].name);
    ck_assert_str_eq(spec.name, cases[i].title);
  }
}
END_TEST

START_TEST(time_limit_gives_a_result) {
  enum status ending;
  json_t *document = run_case("thick-sphere-limit-point", 4, 0.2, &ending);
  ck_assert_int_eq(ending, STATUS_TIMEOUT);
  ck_assert_str_eq(json_string_value(json_object_get(document, "status")), "diverged");
  ck_assert_str_eq(json_string_value(json_object_get(document, "reason")), "timeout");
  json_decref(document);
}
END_TEST

START_TEST(unknown_case_is_refused) {
  struct job_spec spec = {.kind = JOB_VERIFY, .verify = {.name = "perpetual-motion"}};
  struct verify_options options = {NULL, NULL};
  struct error error = {0};
  enum status ending;
  json_t *document;
  ck_assert_int_eq(verify_job(&spec, &options, &document, &ending, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/case");
}
END_TEST

int main(void) {
  int count;
  verify_cases(&count);
  Suite *suite = suite_create("verification");
  TCase *verify = tcase_create("cases");
  tcase_set_timeout(verify, 120);
  tcase_add_loop_test(verify, error_is_below_its_bound, 0, count);
  tcase_add_loop_test(verify, finer_meshes_err_less, 0, 6);
  tcase_add_test(verify, fine_sphere_of_revolution);
  tcase_add_loop_test(verify, references_are_the_printed_ones, 0, PRINTED_CASES);
  tcase_add_test(verify, schema_names_every_case);
  tcase_add_test(verify, every_case_has_its_job);
  tcase_add_test(verify, time_limit_gives_a_result);
  tcase_add_test(verify, unknown_case_is_refused);
  suite_add_tcase(suite, verify);
  return suite_run(suite);
}
