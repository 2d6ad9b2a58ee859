/* From the text of a job to its spec: defaults, SI, symmetry, hash, the errors of each part. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/suite.h"

#define DEGREE (3.14159265358979323846 / 180)

START_TEST(lengths_arrive_in_metres_and_defaults_are_filled_in) {
  struct job_spec spec;
  suite_must_read(NULL, NULL, &spec);
  const struct pneunet_spec *p = &spec.pneunet;
  suite_check_near(p->length, 0.118);
  suite_check_near(p->cavity_length, 0.004);
  suite_check_near(p->width, 0.030);
  suite_check_near(p->height_base, 0.0156);
  suite_check_near(p->height_tip, 0.0156);
  suite_check_near(p->side_wall, 0.002);
  suite_check_near(p->top_wall, 0.0015);
  suite_check_near(p->bottom_layer, 0.006);
  suite_check_near(p->taper_left, 2 * DEGREE);
  suite_check_near(p->taper_right, 2 * DEGREE);
  ck_assert_int_eq(p->run_count, 2);
  ck_assert_int_eq(p->chamber_count, 12);
  ck_assert_int_eq(p->runs[0].config, CHAMBER_B);
  ck_assert_int_eq(p->runs[0].count, 7);
  ck_assert_int_eq(p->runs[1].config, CHAMBER_C);
  ck_assert_int_eq(p->runs[1].count, 5);
  suite_check_near(p->chamber_gap, 0.002);
  suite_check_near(p->gap_wall, 0.002);
  suite_check_near(p->slit, 0.001);
  suite_check_near(p->slit_floor, 0.0015);
  suite_check_near(p->stem, 0.004);
  ck_assert(p->has_channel);
  suite_check_near(p->channel_width, 0.004);
  suite_check_near(p->channel_height, 0.002);
  suite_check_near(p->channel_cover, 0.0015);
  ck_assert_double_eq(p->taper_top, 0.0);
  ck_assert_double_eq(p->taper_bottom, 0.0);
}
END_TEST

START_TEST(load_and_options_have_defaults) {
  struct job_spec spec;
  suite_must_read(NULL, NULL, &spec);
  ck_assert_int_eq(spec.kind, JOB_RESPONSE);
  ck_assert_str_eq(spec.name, "test");
  suite_check_near(spec.load.pressure_to, 50e3);
  ck_assert_int_eq(spec.load.steps, 10);
  for (int i = 0; i < 3; i++) {
    ck_assert_double_eq(spec.load.gravity[i], 0.0);
  }
  ck_assert(spec.contact);
  ck_assert(spec.half_model);
  ck_assert_int_eq(spec.accuracy, ACCURACY_STANDARD);
  suite_check_near(spec.timeout_s, 600.0);
  const struct mesh_spec none = {0};
  ck_assert_mem_eq(&spec.mesh, &none, sizeof none);
  ck_assert_double_eq(spec.metrics.fit_from, 0.0);
  suite_check_near(spec.metrics.fit_to, 50e3);
  ck_assert_double_eq(spec.metrics.cai_from, 0.0);
  suite_check_near(spec.metrics.cai_to, 50e3);
  suite_must_read("/name", NULL, &spec);
  ck_assert_str_eq(spec.name, "unnamed");
}
END_TEST

START_TEST(options_are_read) {
  static const char *const edits[][2] = {
      {"/contact", "false"},
      {"/accuracy", "\"fine\""},
      {"/timeout", "\"2 h\""},
      {"/load/gravity", "[0, 0, \"-9.80665 m/s2\"]"},
      {"/load/pressure", "{\"to\": \"1 psi\", \"steps\": 1000}"},
      {"/metrics",
       "{\"fit_range\": [\"1 kPa\", \"6 kPa\"], \"cai_range\": [\"2 kPa\", \"1 psi\"]}"},
      {"/mesh", "{\"gap_wall\": 1, \"cavity\": 2, \"gap\": 3, \"half_width\": 4, \"side_wall\": 5,"
                " \"bottom\": 6, \"height\": 7, \"top\": 40}"},
      {"/labels", "{\"a\": \"b\"}"},
      {"/comment", "[\"one\", \"two\"]"},
      {"/actuator/comment", "\"three\""},
      {"/actuator/gap_shape", "\"rectangular\""},
      {NULL, NULL}};
  struct job_spec spec;
  suite_must_read_edited(edits, &spec);
  ck_assert(!spec.contact);
  ck_assert_int_eq(spec.accuracy, ACCURACY_FINE);
  suite_check_near(spec.timeout_s, 7200.0);
  suite_check_near(spec.load.gravity[2], -9.80665);
  ck_assert_int_eq(spec.load.steps, 1000);
  suite_check_near(spec.metrics.fit_from, 1e3);
  suite_check_near(spec.metrics.fit_to, 6e3);
  suite_check_near(spec.metrics.cai_from, 2e3);
  suite_check_near(spec.metrics.cai_to, spec.load.pressure_to);
  const struct mesh_spec mesh = {1, 2, 3, 4, 5, 6, 7, 40};
  ck_assert_mem_eq(&spec.mesh, &mesh, sizeof mesh);
  ck_assert(spec.half_model);
}
END_TEST

START_TEST(defaults_follow_from_what_is_given) {
  struct job_spec spec;
  static const char *const edits[][2] = {
      {"/actuator/side_wall", "\"3 mm\""}, {"/actuator/top_wall", "\"1 mm\""},
      {"/actuator/length", "\"150 mm\""},  {"/actuator/taper", NULL},
      {"/actuator/channel", NULL},         {NULL, NULL}};
  suite_must_read_edited(edits, &spec);
  suite_check_near(spec.pneunet.gap_wall, 0.003);
  suite_check_near(spec.pneunet.slit_floor, 0.001);
  suite_check_near(spec.pneunet.stem, 0.006);
  ck_assert(!spec.pneunet.has_channel);
  ck_assert_double_eq(spec.pneunet.taper_left, 0.0);
}
END_TEST

START_TEST(an_unsymmetric_body_or_load_needs_the_whole_model) {
  struct job_spec spec;
  suite_must_read("/actuator/taper/left", "\"1 deg\"", &spec);
  ck_assert(!spec.half_model);
  suite_must_read("/load/gravity", "[0, \"1 m/s2\", 0]", &spec);
  ck_assert(!spec.half_model);
  suite_must_read("/load/gravity", "[\"1 m/s2\", 0, \"1 m/s2\"]", &spec);
  ck_assert(spec.half_model);
  suite_must_read("/symmetry", "\"none\"", &spec);
  ck_assert(!spec.half_model);
}
END_TEST

static const struct {
  const char *value;
  enum material_model model;
  int terms;
  double c0, modulus, density;
} laws[] = {
    {"\"dragon-skin-20\"", MATERIAL_YEOH, 2, 61200, 122400, 1080},
    {"{\"model\": \"neo-hooke\", \"mu\": \"0.4 MPa\", \"density\": \"1 g/cm3\"}",
     MATERIAL_NEO_HOOKE, 1, 4e5, 4e5, 1000},
    {"{\"model\": \"yeoh\", \"C\": [\"110 kPa\", \"0.02 MPa\"]}", MATERIAL_YEOH, 2, 1.1e5, 2.2e5,
     1080},
    {"{\"model\": \"mooney-rivlin\", \"C10\": \"0.1 MPa\", \"C01\": \"-20 kPa\"}",
     MATERIAL_MOONEY_RIVLIN, 2, 1e5, 1.6e5, 1080},
    {"{\"model\": \"ogden\", \"mu\": [\"0.63 MPa\", \"-0.01 MPa\"], \"alpha\": [1.3, -2]}",
     MATERIAL_OGDEN, 2, 6.3e5, 0.5 * (6.3e5 * 1.3 + 1e4 * 2), 1080},
};

START_TEST(reads_every_law) {
  struct job_spec spec;
  suite_must_read("/material", laws[_i].value, &spec);
  ck_assert_int_eq(spec.material.model, laws[_i].model);
  ck_assert_int_eq(spec.material.terms, laws[_i].terms);
  suite_check_near(spec.material.c[0], laws[_i].c0);
  suite_check_near(material_shear_modulus(&spec.material), laws[_i].modulus);
  suite_check_near(spec.material.density_kg_m3, laws[_i].density);
  ck_assert_double_eq(spec.material.bulk_ratio, 1000.0);
}
END_TEST

/* ---- hash ------------------------------------------------------------------------------- */

static void check_same_hash(const char *pointer, const char *value, bool same) {
  struct job_spec base, changed;
  suite_must_read(NULL, NULL, &base);
  suite_must_read(pointer, value, &changed);
  ck_assert_uint_eq(strlen(base.hash), 64);
  ck_assert_uint_eq(strspn(base.hash, "0123456789abcdef"), 64);
  ck_assert_msg((strcmp(base.hash, changed.hash) == 0) == same, "%s = %s", pointer, value);
}

START_TEST(the_hash_overlooks_what_only_people_read) {
  check_same_hash("/name", "\"another\"", true);
  check_same_hash("/labels", "{\"a\": \"b\"}", true);
  check_same_hash("/comment", "\"remark\"", true);
  check_same_hash("/actuator/comment", "[\"remark\"]", true);
  check_same_hash("/memory", "\"1 GiB\"", true);
  check_same_hash("/priority", "7", true);
  check_same_hash("/reuse", "true", true);
  check_same_hash("/load/pressure/steps", "10", true); /* its default */
  check_same_hash("/load/pressure/steps", "10.0", true);
  check_same_hash("/contact", "true", true);
  check_same_hash("/actuator/taper/top", "\"0 deg\"", true);
}
END_TEST

START_TEST(the_hash_sees_every_dimension) {
  check_same_hash("/actuator/width", "\"31 mm\"", false);
  check_same_hash("/load/pressure/to", "\"51 kPa\"", false);
  check_same_hash("/contact", "false", false);
  check_same_hash("/actuator/chambers/0/count", "6", false);
  check_same_hash("/material", "\"dragon-skin-20\"", false);
  check_same_hash("/mesh", "{\"gap_wall\": 2}", false);
}
END_TEST

START_TEST(the_hash_does_not_depend_on_order_or_spaces) {
  static const char *const texts[] = {
      "{\"kind\":\"response\",\"actuator\":{\"family\":\"pneunet\",\"length\":\"80 mm\",\"width\":"
      "\"20 mm\",\"height\":\"15 mm\",\"chambers\":[{\"config\":\"B\",\"count\":4}],\"side_wall\":"
      "\"2 mm\",\"top_wall\":\"2 mm\",\"bottom_layer\":\"4 mm\"},\"material\":\"ecoflex-00-30\","
      "\"load\":{\"pressure\":{\"to\":\"5 kPa\"}}}",
      " { \"load\" : { \"pressure\" : { \"to\" : \"5 kPa\" } },\n \"material\": \"ecoflex-00-30\","
      "\"actuator\": {\"bottom_layer\": \"4 mm\", \"top_wall\": \"2 mm\", \"side_wall\": \"2 mm\","
      "\"chambers\": [{\"count\": 4, \"config\": \"B\"}], \"height\": \"15 mm\","
      "\"width\": \"20 mm\", \"length\": \"80 mm\", \"family\": \"pne\\u0075net\"},"
      "\"kind\": \"response\" }\n"};
  struct job_spec spec[2];
  for (int i = 0; i < 2; i++) {
    ck_assert_int_eq(job_spec_read(texts[i], strlen(texts[i]), &spec[i], NULL), STATUS_OK);
  }
  ck_assert_str_eq(spec[0].hash, spec[1].hash);
}
END_TEST

/* ---- errors ----------------------------------------------------------------------------- */

static const struct refusal refusals[] = {
    {"/kind", NULL, STATUS_INVALID, "", "\"kind\" is missing"},
    {"/kind", "\"respons\"", STATUS_INVALID, "/kind", "did you mean \"response\"?"},
    {"/kind", "3", STATUS_INVALID, "/kind", "\"response\""},
    {"/actuator", NULL, STATUS_INVALID, "", "the key \"actuator\" is missing"},
    {"/material", NULL, STATUS_INVALID, "", "the key \"material\" is missing"},
    {"/load", NULL, STATUS_INVALID, "", "the key \"load\" is missing"},
    {"/name", "3", STATUS_INVALID, "/name", "must be a string"},
    {"/name", "\"\"", STATUS_INVALID, "/name", "of 1 to 150"},
    {"/conact", "true", STATUS_INVALID, "/conact", "did you mean \"contact\"?"},
    {"/contact", "\"yes\"", STATUS_INVALID, "/contact", "true or false"},
    {"/accuracy", "\"exact\"", STATUS_INVALID, "/accuracy", "\"fast\", \"standard\" or \"fine\""},
    {"/timeout", "600", STATUS_INVALID, "/timeout", "for example \"600 min\""},
    {"/timeout", "\"0 s\"", STATUS_INVALID, "/timeout", "at least 1 s"},
    {"/timeout", "\"10 mm\"", STATUS_INVALID, "/timeout", "a time is wanted"},
    {"/labels", "{\"a\": 1}", STATUS_INVALID, "/labels/a", "must be a string"},
    {"/labels", "[]", STATUS_INVALID, "/labels", "must be an object"},
    {"/comment", "{}", STATUS_INVALID, "/comment", "characters or an array of"},
    {"/comment", "[1]", STATUS_INVALID, "/comment/0", "must be a string"},
    {"/actuator", "[]", STATUS_INVALID, "/actuator",
     "an array of 0 items is not possible here: it must be an object"},
    {"/actuator/family", "\"pneunets\"", STATUS_INVALID, "/actuator/family", "\"pneunet\""},
    {"/actuator/family", NULL, STATUS_INVALID, "/actuator", "\"family\" is missing"},
    {"/actuator/lenght", "\"1 m\"", STATUS_INVALID, "/actuator/lenght", "did you mean \"length\"?"},
    {"/actuator/length", NULL, STATUS_INVALID, "/actuator", "\"chamber_length\""},
    {"/actuator/length", "118", STATUS_INVALID, "/actuator/length", "for example \"118 mm\""},
    {"/actuator/length", "\"118\"", STATUS_INVALID, "/actuator/length", "for example \"118 mm\""},
    {"/actuator/length", "\"0 mm\"", STATUS_INVALID, "/actuator/length", "at least 1 um"},
    {"/actuator/length", "\"2 km\"", STATUS_INVALID, "/actuator/length", "at most 1 km"},
    {"/actuator/height", "15", STATUS_INVALID, "/actuator/height", "for example \"15 mm\""},
    {"/actuator/height", "{\"base\": \"20 mm\"}", STATUS_INVALID, "/actuator/height",
     "\"tip\" is missing"},
    {"/actuator/height", "true", STATUS_INVALID, "/actuator/height",
     "its unit, at least 1 um and at most 1 km or an object"},
    {"/symmetry", "\"half\"", STATUS_INVALID, "/symmetry", "\"auto\" or \"none\""},
    {"/actuator/chambers", "[]", STATUS_INVALID, "/actuator/chambers", "of 1 to 32 items"},
    {"/actuator/chambers/1/config", "\"D\"", STATUS_INVALID, "/actuator/chambers/1/config",
     "\"A\", \"B\" or \"C\""},
    {"/actuator/chambers/1/count", "0", STATUS_INVALID, "/actuator/chambers/1/count",
     "from 1 to 64"},
    {"/actuator/chambers/1/count", "1.5", STATUS_INVALID, "/actuator/chambers/1/count", "whole"},
    {"/actuator/taper/left", "2", STATUS_INVALID, "/actuator/taper/left", "for example \"2 deg\""},
    {"/actuator/taper/left", "\"-1 deg\"", STATUS_INVALID, "/actuator/taper/left",
     "at least 0 deg"},
    {"/actuator/taper/left", "\"46 deg\"", STATUS_INVALID, "/actuator/taper/left", "at most 45"},
    {"/load/pressure", "\"50 kPa\"", STATUS_INVALID, "/load/pressure", "must be an object"},
    {"/load/pressure/to", "50", STATUS_INVALID, "/load/pressure/to", "for example \"50 kPa\""},
    {"/load/pressure/to", "\"0 kPa\"", STATUS_INVALID, "/load/pressure/to", "more than 0 kPa"},
    {"/load/pressure/to", "\"-5 kPa\"", STATUS_INVALID, "/load/pressure/to", "more than 0 kPa"},
    {"/load/pressure/to", "\"1e400 kPa\"", STATUS_INVALID, "/load/pressure/to", "beyond the range"},
    {"/load/pressure/steps", "0", STATUS_INVALID, "/load/pressure/steps", "from 1 to 1000"},
    {"/load/pressure/steps", "1001", STATUS_INVALID, "/load/pressure/steps", "from 1 to 1000"},
    {"/load/pressure/steps", "1e300", STATUS_INVALID, "/load/pressure/steps", "from 1 to 1000"},
    {"/load/gravity", "[0, 0]", STATUS_INVALID, "/load/gravity", "of 3 items"},
    {"/load/gravity", "[0, 0, -9.8]", STATUS_INVALID, "/load/gravity/2",
     "for example \"-9.8 m/s2\""},
    {"/load/gravity", "[0, 0, \"9.8 m/s\"]", STATUS_INVALID, "/load/gravity/2", "a speed"},
    {"/mesh", "{\"gap_wall\": 41}", STATUS_INVALID, "/mesh/gap_wall", "from 1 to 40"},
    {"/mesh", "{\"gap_walls\": 4}", STATUS_INVALID, "/mesh/gap_walls", "did you mean \"gap_wall\""},
    {"/metrics", "{\"fit_range\": [\"50 kPa\", \"10 kPa\"]}", STATUS_INVALID, "/metrics/fit_range",
     "must be below"},
    {"/metrics", "{\"cai_range\": [\"0 kPa\", \"60 kPa\"]}", STATUS_INVALID, "/metrics/cai_range",
     "beyond the load"},
    {"/metrics", "{\"cai_range\": [\"0 kPa\"]}", STATUS_INVALID, "/metrics/cai_range", "2 items"},
    {"/material", "\"dragonskin-20\"", STATUS_INVALID, "/material",
     "did you mean \"dragon-skin-20\"?"},
    {"/material", "\"steel\"", STATUS_INVALID, "/material", "\"elastic-50a\""},
    {"/material", "3", STATUS_INVALID, "/material", "or \"elastic-50a-sorotoki\" or an object"},
    {"/material", "{\"model\": \"yeo\"}", STATUS_INVALID, "/material/model",
     "did you mean \"yeoh\"?"},
    {"/material", "{\"C\": [\"1 MPa\"]}", STATUS_INVALID, "/material", "\"model\" is missing"},
    {"/material", "{\"model\": \"yeoh\"}", STATUS_INVALID, "/material", "\"C\" is missing"},
    {"/material", "{\"model\": \"yeoh\", \"C\": [0.1]}", STATUS_INVALID, "/material/C/0",
     "for example \"0.1 MPa\""},
    {"/material", "{\"model\": \"yeoh\", \"C\": [\"-1 MPa\"]}", STATUS_INVALID, "/material",
     "initial shear modulus"},
    {"/material", "{\"model\": \"yeoh\", \"C\": [\"1 MPa\"], \"bulk_ratio\": 9}", STATUS_INVALID,
     "/material/bulk_ratio", "from 10 to"},
    {"/material", "{\"model\": \"yeoh\", \"C\": [\"1 MPa\"], \"bulk_ratio\": 2e6}", STATUS_INVALID,
     "/material/bulk_ratio", "from 10 to 1000000"},
    {"/material", "{\"model\": \"ogden\", \"mu\": [\"1 MPa\"], \"alpha\": [1, 2]}", STATUS_INVALID,
     "/material/alpha", "2 exponents for 1 moduli"},
    {"/material", "{\"model\": \"ogden\", \"mu\": [\"1 MPa\"], \"alpha\": [0]}", STATUS_INVALID,
     "/material/alpha/0", "an exponent is 0"},
    {"/material", "{\"model\": \"mooney-rivlin\", \"C10\": \"1 MPa\", \"C01\": \"-1 MPa\"}",
     STATUS_INVALID, "/material", "initial shear modulus"},
};

START_TEST(refuses) {
  suite_check_refusal(&refusals[_i]);
}
END_TEST

START_TEST(errors_have_a_place_in_the_text) {
  static const char text[] = "{ \"kind\": \"response\",\n  \"actuator\": {\n"
                             "    \"family\": \"pneunet\",\n    \"width\": 5 } }";
  struct job_spec spec;
  struct error error;
  ck_assert_int_eq(job_spec_read(text, sizeof text - 1, &spec, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "");
  ck_assert_int_eq(error.line, 1);
  static const char full[] = "{ \"kind\": \"response\", \"material\": \"elastic-50a\",\n"
                             "  \"load\": { \"pressure\": {\n      \"to\": 5 } },\n"
                             "  \"actuator\": {} }";
  ck_assert_int_eq(job_spec_read(full, sizeof full - 1, &spec, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/actuator");
  ck_assert_int_eq(error.line, 4);
  ck_assert_int_eq(error.column, 15);
}
END_TEST

START_TEST(text_that_is_no_job) {
  struct job_spec spec;
  struct error error;
  ck_assert_int_eq(job_spec_read("[]", 2, &spec, &error), STATUS_INVALID);
  ck_assert_int_eq(job_spec_read("", 0, &spec, &error), STATUS_SYNTAX);
  ck_assert_int_eq(job_spec_read("{\"kind\": NaN}", 13, &spec, &error), STATUS_SYNTAX);
  ck_assert_int_eq(error.line, 1);
  ck_assert_int_eq(job_spec_read("{\"a\":1,\"a\":2}", 13, &spec, &error), STATUS_SYNTAX);
  ck_assert_ptr_nonnull(strstr(error.message, "duplicate"));
  ck_assert_int_eq(job_spec_read("{}", 2, &spec, NULL), STATUS_INVALID);
}
END_TEST

/* ---- files and threads ------------------------------------------------------------------ */

/* Reads a file below the source directory into static storage, with a NUL behind it. */
static const char *read_source_file(const char *name, size_t *size) {
  static char text[1 << 18];
  const char *source = getenv("srcdir");
  char path[600];
  snprintf(path, sizeof path, "%s/%s", source ? source : ".", name);
  FILE *file = fopen(path, "rb");
  ck_assert_msg(file != NULL, "%s cannot be opened", path);
  *size = fread(text, 1, sizeof text - 1, file);
  ck_assert_msg(fgetc(file) == EOF, "%s is larger than expected", path);
  fclose(file);
  text[*size] = '\0';
  return text;
}

START_TEST(the_documents_of_the_manual_are_valid) {
  size_t size = 0;
  int documents = 0;
  const char *at = read_source_file("docs/JOBS.md", &size);
  while ((at = strstr(at, "```json\n")) != NULL) {
    at += strlen("```json\n");
    const char *end = strstr(at, "```");
    ck_assert_ptr_nonnull(end);
    struct job_spec spec;
    struct error error;
    ck_assert_msg(job_spec_read(at, (size_t)(end - at), &spec, &error) == STATUS_OK, "%s: %s",
                  error.pointer, error.message);
    job_spec_release(&spec);
    at = end + 3;
    documents++;
  }
  ck_assert_int_eq(documents, 19);
}
END_TEST

static void read_job_file(const char *name, struct job_spec *spec) {
  size_t size = 0;
  struct error error;
  const char *text = read_source_file(name, &size);
  ck_assert_msg(job_spec_read(text, size, spec, &error) == STATUS_OK, "%s: %s: %s", name,
                error.pointer, error.message);
}

/* Its document repeats the baseline's dimensions: they have to stay the same. */
START_TEST(the_design_with_suckers_is_the_baseline_otherwise) {
  struct job_spec base, with;
  read_job_file("jobs/multicurvature/baseline.json", &base);
  read_job_file("jobs/multicurvature/chosen-with-suckers.json", &with);
  ck_assert_int_eq(with.pneunet.sucker_count, 3);
  suite_check_near(with.pneunet.sucker[2].diameter, 0.016);
  suite_check_near(with.pneunet.suction_pressure, 50e3);
  ck_assert_mem_eq(&with.material, &base.material, sizeof base.material);
  ck_assert_mem_eq(&with.load, &base.load, sizeof base.load);
  memset(with.pneunet.sucker, 0, sizeof with.pneunet.sucker);
  with.pneunet.sucker_count = 0;
  ck_assert_mem_eq(&with.pneunet, &base.pneunet, sizeof base.pneunet);
}
END_TEST

START_TEST(every_job_file_of_the_project_is_valid) {
  static const char *const files[] = {"multicurvature/baseline", "prototype/twelve-chambers",
                                      "prototype/twelve-chambers-no-contact"};
  char name[100];
  snprintf(name, sizeof name, "jobs/%s.json", files[_i]);
  size_t size = 0;
  const char *text = read_source_file(name, &size);
  struct job_spec spec;
  struct error error;
  ck_assert_msg(job_spec_read(text, size, &spec, &error) == STATUS_OK, "%s: %s: %s", name,
                error.pointer, error.message);
  suite_check_near(spec.pneunet.length, 0.118);
  ck_assert_int_eq(spec.pneunet.chamber_count, 12);
  ck_assert(spec.half_model);
}
END_TEST

static void *read_often(void *reader) {
  static const char text[] = "{\"kind\": \"response\", \"load\": 3}";
  for (int i = 0; i < 200; i++) {
    struct job_spec spec;
    struct error error;
    if (job_reader_read(reader, text, sizeof text - 1, &spec, &error) != STATUS_INVALID) {
      return reader;
    }
  }
  return NULL;
}

START_TEST(one_reader_serves_several_threads) {
  struct job_reader *reader = NULL;
  ck_assert_int_eq(job_reader_create(&reader, NULL), STATUS_OK);
  pthread_t threads[4];
  for (int i = 0; i < 4; i++) {
    ck_assert_int_eq(pthread_create(&threads[i], NULL, read_often, reader), 0);
  }
  for (int i = 0; i < 4; i++) {
    void *failed = NULL;
    pthread_join(threads[i], &failed);
    ck_assert_ptr_null(failed);
  }
  job_reader_destroy(reader);
  job_reader_destroy(NULL);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: spec");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, lengths_arrive_in_metres_and_defaults_are_filled_in);
  tcase_add_test(tcase, load_and_options_have_defaults);
  tcase_add_test(tcase, options_are_read);
  tcase_add_test(tcase, defaults_follow_from_what_is_given);
  tcase_add_test(tcase, an_unsymmetric_body_or_load_needs_the_whole_model);
  tcase_add_loop_test(tcase, reads_every_law, 0, sizeof laws / sizeof *laws);
  tcase_add_test(tcase, the_hash_overlooks_what_only_people_read);
  tcase_add_test(tcase, the_hash_sees_every_dimension);
  tcase_add_test(tcase, the_hash_does_not_depend_on_order_or_spaces);
  tcase_add_loop_test(tcase, refuses, 0, sizeof refusals / sizeof *refusals);
  tcase_add_test(tcase, errors_have_a_place_in_the_text);
  tcase_add_test(tcase, text_that_is_no_job);
  tcase_add_test(tcase, the_documents_of_the_manual_are_valid);
  tcase_add_test(tcase, the_design_with_suckers_is_the_baseline_otherwise);
  tcase_add_loop_test(tcase, every_job_file_of_the_project_is_valid, 0, 3);
  tcase_add_test(tcase, one_reader_serves_several_threads);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
