/* Jobs with tables of data: curves of materials and measured responses, and what is refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/job/embed.h"
#include "solver/job/measured.h"
#include "solver/job/tensile.h"
#include "tests/unit/suite.h"

/* ---- fits ------------------------------------------------------------------------------- */

#define CURVE "e,s\\n0,0\\n0.2,0.05\\n0.4,0.09\\n0.6,0.12\\n0.8,0.15\\n1,0.17\\n1.2,0.2\\n"
#define COLUMNS                                                                                    \
  "\"columns\":{\"strain\":{\"name\":\"e\",\"unit\":\"1\"},"                                       \
  "\"stress\":{\"name\":\"s\",\"unit\":\"MPa\"}}"
#define YEOH "\"model\":\"yeoh\""
#define DATA "\"data\":{\"csv\":\"" CURVE "\"}"

static enum status read_fit(const char *members, struct job_spec *spec, struct error *error) {
  char text[6000];
  snprintf(text, sizeof text, "{\"kind\":\"fit-material\",%s}", members);
  return job_spec_read(text, strlen(text), spec, error);
}

START_TEST(fits_are_read) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  enum status status = read_fit("\"model\":\"ogden\"," DATA "," COLUMNS
                                ",\"range\":[0.1,1.2],\"bounds\":{\"mu1\":[\"0 Pa\",\"1 MPa\"],"
                                "\"alpha2\":[-5,-1]},\"density\":\"1 g/cm3\"",
                                &spec, &error);
  ck_assert_msg(status == STATUS_OK, "%s: %s", error.pointer, error.message);
  ck_assert_int_eq(spec.kind, JOB_FIT_MATERIAL);
  ck_assert_int_eq(spec.fit.terms, 2);
  ck_assert_int_eq(spec.fit.count, 4);
  ck_assert_double_eq(spec.fit.from, 0.1);
  ck_assert_double_eq(spec.fit.lower[0], 0.0);
  suite_check_near(spec.fit.upper[0], 1e6);
  ck_assert(isinf(spec.fit.upper[1]));
  ck_assert_double_eq(spec.fit.lower[2], -50.0);
  ck_assert_double_eq(spec.fit.upper[3], -1.0);
  suite_check_near(spec.fit.density_kg_m3, 1000.0);
  ck_assert_ptr_nonnull(spec.document);
  struct tensile_curve curve;
  ck_assert_int_eq(tensile_read(spec.document, &spec.fit, &curve, &error), STATUS_OK);
  ck_assert_uint_eq(curve.count, 6);
  suite_check_near(curve.strain[5], 1.2);
  suite_check_near(curve.stress[5], 0.2e6);
  tensile_release(&curve);
  job_spec_release(&spec);
}
END_TEST

START_TEST(the_hash_is_that_of_the_content) {
  static const char *const tables[] = {CURVE, CURVE,
                                       "e,s\\n0,0\\n0.2,0.05\\n0.4,0.09\\n0.6,0.12\\n"
                                       "0.8,0.15\\n1,0.18\\n"};
  char hash[3][65], members[2000];
  for (int i = 0; i < 3; i++) {
    struct job_spec spec;
    snprintf(members, sizeof members, YEOH ",\"name\":\"n%d\",\"data\":{\"csv\":\"%s\"}," COLUMNS,
             i, tables[i]);
    ck_assert_int_eq(read_fit(members, &spec, NULL), STATUS_OK);
    memcpy(hash[i], spec.hash, sizeof hash[i]);
    job_spec_release(&spec);
  }
  ck_assert_str_eq(hash[0], hash[1]);
  ck_assert_str_ne(hash[0], hash[2]);
}
END_TEST

/* Column names that say nothing, so that the values must tell. */
#define NAMED(abscissa, unit, stress_unit)                                                         \
  "\"columns\":{\"" abscissa "\":{\"name\":\"a\",\"unit\":\"" unit                                 \
  "\"},\"stress\":{\"name\":\"b\",\"unit\":\"" stress_unit "\"}}"

static const struct {
  const char *members, *pointer, *phrase;
} refusals[] = {
    {YEOH "," DATA, "", "\"columns\" is missing"},
    {YEOH "," COLUMNS ",\"data\":{\"file\":\"x.csv\"}", "/data/file", "--embed"},
    {YEOH "," COLUMNS ",\"data\":{\"csv\":5}", "/data/csv", "must be a string"},
    {"\"model\":\"yeo\"," DATA "," COLUMNS, "/model", "did you mean \"yeoh\""},
    {"\"model\":\"neo-hooke\",\"terms\":2," DATA "," COLUMNS, "/terms", "no choice of terms"},
    {YEOH ",\"terms\":4," DATA "," COLUMNS, "/terms", "from 1 to 3"},
    {YEOH ",\"terms\":3,\"range\":[0,0.6]," DATA "," COLUMNS, "/range",
     "4 of 7 points are used: for 3 coefficients at least 5"},
    {YEOH ",\"range\":[1,1]," DATA "," COLUMNS, "/range", "must be below"},
    {YEOH ",\"bounds\":{\"C1\":[\"1 MPa\",\"0 MPa\"]}," DATA "," COLUMNS, "/bounds/C1", "below"},
    {YEOH ",\"bounds\":{\"C3\":[\"0 MPa\",\"1 MPa\"]}," DATA "," COLUMNS, "/bounds",
     "it has \"C1\", \"C2\""},
    {YEOH ",\"bounds\":{\"C1\":[0,1]}," DATA "," COLUMNS, "/bounds/C1/0", "for example \"0 MPa\""},
    {YEOH "," DATA "," NAMED("strain", "mm", "MPa"), "/columns/strain/unit", "\"mm\" is no unit"},
    {YEOH "," DATA "," NAMED("strain", "1", "MPaa"), "/columns/stress/unit", "for example \"MPa\""},
    {YEOH "," DATA "," NAMED("extension", "mm", "MPa"), "/columns", "\"gauge\""},
    {YEOH "," DATA ",\"columns\":{\"stress\":{\"name\":\"s\",\"unit\":\"MPa\"}}", "/columns",
     "0 columns of the strain: one of \"strain\", \"stretch\" and \"extension\""},
    {YEOH "," DATA "," NAMED("strain", "1", "MPa"), "/columns/strain/name",
     "no column \"a\": its header, line 1, has others: \"e\", \"s\""},
    {YEOH "," COLUMNS ",\"data\":{\"csv\":\"e,s\\n0,0\\n0.1,oops\\n\"}", "/data/csv",
     "line 3 of the table, column \"s\": \"oops\" is not a number"},
    {YEOH "," COLUMNS ",\"data\":{\"csv\":\"e,s\\n0,0\\n0.1,\\n\"}", "/data/csv", "line 3"},
    {YEOH ",\"strain\":\"true\"," NAMED("stretch", "1", "MPa") ",\"data\":{\"csv\":\"a,b\\n1,0\"}",
     "/strain", "holds no strain, so no true one"},
    /* No strains. */
    {YEOH "," NAMED("strain", "1", "MPa") ",\"data\":{\"csv\":\"a,b\\n0,0\\n1,1\\n-1.5,-1\\n\"}",
     "/data/csv", "line 4 of the table: -1.5"},
    {YEOH "," NAMED("strain", "1", "MPa") ",\"data\":{\"csv\":\"a,b\\n0,0\\n50,1\\n100,2\\n\"}",
     "/data/csv", "line 3 of the table: 50 in the column of the strain is a stretch of 51"},
    /* Falling, off zero, no elastomer, back and forth. */
    {YEOH "," NAMED("strain", "1", "MPa") ",\"data\":{\"csv\":\"a,b\\n0,0\\n1,-1\\n2,-2\\n\"}",
     "/data/csv", "does not rise with the strain"},
    {YEOH "," NAMED("strain", "1", "MPa") ",\"data\":{\"csv\":\"a,b\\n0.01,1\\n1,1.2\\n2,1.5\\n\"}",
     "/data/csv", "does not start near zero"},
    {YEOH "," NAMED("strain", "%", "MPa") ",\"data\":{\"csv\":\"a,b\\n0,0\\n0.2,40\\n0.4,90\\n\"}",
     "/data/csv", "no elastomer's"},
    {YEOH "," NAMED("strain", "1", "MPa") ",\"data\":{\"csv\":\"a,b\\n0,0\\n.2,1\\n.19,2\\n.3,3\\n"
                                          ".29,4\\n.4,5\\n.39,6\\n.6,7\\n\"}",
     "/data/csv", "goes back 3 times, first in line 4 of the table, while the stress never does"},
};

START_TEST(bad_fits_are_refused) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  ck_assert_int_eq(read_fit(refusals[_i].members, &spec, &error), STATUS_INVALID);
  ck_assert_msg(strcmp(error.pointer, refusals[_i].pointer) == 0, "%s: %s", error.pointer,
                error.message);
  ck_assert_msg(strstr(error.message, refusals[_i].phrase) != NULL, "%s", error.message);
  ck_assert_int_ge(error.line, 1);
}
END_TEST

static const char *const silicones[] = {"dragon-skin-10-300", "dragon-skin-20-300",
                                        "dragon-skin-30-300", "ecoflex-00-30-300"};

/* The job of a silicone with its files, as text that the caller frees. */
static char *job_of(const char *name) {
  static char text[1 << 14];
  const char *source = getenv("srcdir");
  char path[600], *embedded = NULL;
  size_t length = 0;
  snprintf(path, sizeof path, "%s/jobs/material/%s.json", source ? source : ".", name);
  FILE *file = fopen(path, "rb");
  ck_assert_msg(file != NULL, "%s cannot be opened", path);
  size_t size = fread(text, 1, sizeof text, file);
  fclose(file);
  ck_assert_int_eq(embed_files(text, size, path, &embedded, &length, NULL), STATUS_OK);
  return embedded;
}

/* The job with the names of its two columns exchanged and other units. */
static enum status read_exchanged(const char *job, const char *strain, const char *strain_unit,
                                  const char *stress, const char *stress_unit,
                                  struct error *error) {
  struct job_spec spec;
  json_t *document = json_loads(job, 0, NULL);
  json_object_set_new(document, "columns",
                      json_pack("{s:{s:s, s:s}, s:{s:s, s:s}}", "strain", "name", strain, "unit",
                                strain_unit, "stress", "name", stress, "unit", stress_unit));
  char *text = json_dumps(document, 0);
  enum status status = job_spec_read(text, strlen(text), &spec, error);
  if (status == STATUS_OK) {
    job_spec_release(&spec);
  }
  free(text);
  json_decref(document);
  return status;
}

START_TEST(exchanged_columns_of_measured_curves_are_found) {
  static const char e[] = "Engineering Strain", s[] = "Engineering Stress (MPa)";
  struct error error = {.status = STATUS_OK};
  char *job = job_of(silicones[_i]);
  ck_assert_int_eq(read_exchanged(job, e, "1", s, "MPa", &error), STATUS_OK);
  ck_assert_int_eq(read_exchanged(job, s, "1", e, "MPa", &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/columns/strain/name");
  ck_assert_ptr_nonnull(strstr(error.message, "holds a stress, not a strain"));
  free(job);
}
END_TEST

START_TEST(exchanged_columns_without_names_look_driven_by_the_stress) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  struct tensile_curve curve;
  char *job = job_of(silicones[_i]);
  ck_assert_int_eq(job_spec_read(job, strlen(job), &spec, &error), STATUS_OK);
  ck_assert_int_eq(tensile_read(spec.document, &spec.fit, &curve, &error), STATUS_OK);
  ck_assert(!curve.stress_driven);
  tensile_release(&curve);
  /* The reader checks names; here the spec is told that each column is the other one. */
  char *text =
      strdup(json_string_value(json_object_get(json_object_get(spec.document, "data"), "csv")));
  memcpy(strstr(text, "Engineering Strain"), "A                 ", 18);
  memcpy(strstr(text, "Engineering Stress (MPa)"), "B                       ", 24);
  json_object_set_new(spec.document, "data", json_pack("{s:s}", "csv", text));
  strcpy(spec.fit.strain.name, "B");
  strcpy(spec.fit.stress.name, "A");
  spec.fit.from = -INFINITY;
  spec.fit.to = INFINITY;
  enum status status = tensile_read(spec.document, &spec.fit, &curve, &error);
  ck_assert(status == STATUS_INVALID || curve.stress_driven);
  tensile_release(&curve);
  free(text);
  free(job);
  job_spec_release(&spec);
}
END_TEST

START_TEST(material_curves_are_read) {
  static const char text[] = "{\"kind\":\"material-curve\",\"material\":\"elastosil-m4601\"}";
  static const char bad[] = "{\"kind\":\"material-curve\",\"material\":\"elastosil-m4601\","
                            "\"stretch\":[2,1]}";
  struct job_spec spec;
  struct error error;
  ck_assert_int_eq(job_spec_read(text, sizeof text - 1, &spec, &error), STATUS_OK);
  ck_assert_int_eq(spec.kind, JOB_MATERIAL_CURVE);
  ck_assert_int_eq(spec.curve.points, 101);
  ck_assert_double_eq(spec.curve.to, 3.0);
  ck_assert_int_eq(job_spec_read(bad, sizeof bad - 1, &spec, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/stretch");
}
END_TEST

/* ---- measured responses ------------------------------------------------------------------ */

#define MEASURED(csv, pressure, angle)                                                             \
  "{\"data\":{\"csv\":\"" csv "\"},\"columns\":{\"pressure\":" pressure ",\"angle\":" angle "}}"
#define P "{\"name\":\"p\",\"unit\":\"psi\"}"
#define A "{\"name\":\"a\",\"unit\":\"deg\"}"

START_TEST(measured_curves_are_read) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  struct measured_curve curve;
  suite_must_read("/measured", MEASURED("a;p\\n0;0\\n90,5;1\\n", P, A), &spec);
  ck_assert_str_eq(spec.measured.metric, "bending_angle_deg");
  ck_assert_ptr_nonnull(spec.document);
  ck_assert_int_eq(measured_read(spec.document, &spec, &curve, &error), STATUS_OK);
  ck_assert_uint_eq(curve.count, 2);
  ck_assert_double_eq_tol(curve.pressure[1], 6894.757, 1e-3);
  ck_assert_double_eq_tol(curve.angle[1], 90.5 * acos(-1) / 180, 1e-12);
  measured_release(&curve);
  job_spec_release(&spec);
  suite_must_read(NULL, NULL, &spec);
  ck_assert_ptr_null(spec.document);
}
END_TEST

static const struct refusal bad_measured[] = {
    {"/measured", MEASURED("p,a\\n0,0\\n", P, P), STATUS_INVALID, "/measured/columns/angle/unit",
     "\"psi\" is no unit of the angle"},
    {"/measured", MEASURED("p,b\\n0,0\\n", P, A), STATUS_INVALID, "/measured/columns/angle/name",
     "has others: \"p\", \"b\""},
    {"/measured", MEASURED("p,a\\n0,0\\n1,x\\n", P, A), STATUS_INVALID, "/measured/data/csv",
     "line 3"},
    {"/measured", MEASURED("p,a\\n100,1\\n200,2\\n", P, A), STATUS_INVALID, "/measured/data/csv",
     "nothing in common with the load: 0 to 50 kPa"},
    {"/measured",
     MEASURED("Pressure,Angle\\n0,0\\n", "{\"name\":\"Angle\",\"unit\":\"kPa\"}",
              "{\"name\":\"Pressure\",\"unit\":\"deg\"}"),
     STATUS_INVALID, "/measured/columns/pressure/name", "are pressure and angle exchanged?"},
    {"/measured", "{\"data\":{\"file\":\"x.csv\"}}", STATUS_INVALID, "/measured/data/file",
     "--embed"},
};

START_TEST(bad_measured_curves_are_refused) {
  suite_check_refusal(&bad_measured[_i]);
}
END_TEST

int main(void) {
  const int count = sizeof silicones / sizeof *silicones;
  Suite *suite = suite_create("job: data");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, fits_are_read);
  tcase_add_test(tcase, the_hash_is_that_of_the_content);
  tcase_add_loop_test(tcase, bad_fits_are_refused, 0, sizeof refusals / sizeof *refusals);
  tcase_add_loop_test(tcase, exchanged_columns_of_measured_curves_are_found, 0, count);
  tcase_add_loop_test(tcase, exchanged_columns_without_names_look_driven_by_the_stress, 0, count);
  tcase_add_test(tcase, material_curves_are_read);
  tcase_add_test(tcase, measured_curves_are_read);
  tcase_add_loop_test(tcase, bad_measured_curves_are_refused, 0,
                      sizeof bad_measured / sizeof *bad_measured);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
