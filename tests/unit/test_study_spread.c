/* Studies that spread their members over ranges: what the members are, and what is refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/job/study.h"
#include "tests/unit/suite.h"

#define BASE                                                                                       \
  "{\"kind\":\"hlpv\",\"model\":{\"mass\":\"60 g\",\"gamma\":\"5.577 N/psi\",\"modes\":{\"free\":" \
  "{\"stiffness\":\"2000 N/m\",\"damping\":\"15 N s/m\",\"alpha\":\"-9 1/s\",\"beta\":\"9 1/s\"}"  \
  "}},\"initial\":{\"mode\":\"free\"},\"input\":{\"hold\":[[\"0 s\",\"3 psi\"]]},"                 \
  "\"end\":\"1 s\"}"
#define STUDY(rest) "{\"kind\":\"study\",\"base\":" BASE "," rest "}"
#define MASS "{\"pointer\":\"/model/mass\",\"from\":\"50 g\",\"to\":\"100 g\"}"
#define STIFFNESS                                                                                  \
  "{\"pointer\":\"/model/modes/free/stiffness\",\"from\":\"100 N/m\",\"to\":\"10000 N/m\","        \
  "\"scale\":\"log\"}"
#define DAMPING "{\"pointer\":\"/model/modes/free/damping\",\"values\":[\"10 N s/m\",\"20 N s/m\"]}"
#define TOLERANCE "{\"pointer\":\"/tolerance\",\"from\":1e-6,\"to\":1e-4,\"scale\":\"log\"}"
#define RATE "{\"pointer\":\"/sample_rate\",\"values\":[\"60 Hz\",\"120 Hz\",\"240 Hz\"]}"

static struct job_reader *reader;

static void set_up(void) {
  ck_assert_int_eq(job_reader_create(&reader, NULL), STATUS_OK);
}

static void tear_down(void) {
  job_reader_destroy(reader);
}

static void expand(const char *text, struct job_spec *spec, struct study *study) {
  struct error error = {.status = STATUS_OK};
  enum status status = job_reader_read(reader, text, strlen(text), spec, &error);
  ck_assert_msg(status == STATUS_OK, "%s: %s", error.pointer, error.message);
  ck_assert_int_eq(study_expand(reader, spec->document, true, study, &error), STATUS_OK);
}

static double number_at(const struct study *study, size_t member, const char *pointer) {
  const json_t *value = json_object_get(study->member[member].values, pointer);
  return json_is_string(value) ? strtod(json_string_value(value), NULL) : json_number_value(value);
}

static const char *const samplings[] = {"latin-hypercube", "sobol", "halton"};

/* 64 members: in each eighth of a range there are eight, of the logarithm where that is asked for,
 * exactly for a hypercube and for Sobol's net, nearly for Halton's points; choices come equally
 * often. */
START_TEST(members_are_spread_over_the_ranges) {
  char text[2000];
  struct job_spec spec;
  struct study study;
  int masses[8] = {0}, stiffnesses[8] = {0}, soft = 0;
  snprintf(
      text, sizeof text,
      STUDY("\"sampling\":\"%s\",\"size\":64,\"parameters\":[" MASS "," STIFFNESS "," DAMPING "]"),
      samplings[_i]);
  expand(text, &spec, &study);
  ck_assert_uint_eq(study.count, 64);
  for (size_t i = 0; i < study.count; i++) {
    double mass = number_at(&study, i, "/model/mass");
    double stiffness = number_at(&study, i, "/model/modes/free/stiffness");
    ck_assert(mass >= 50 && mass <= 100 && stiffness >= 100 && stiffness <= 10000);
    masses[(int)fmin(7, (mass - 50) / 50 * 8)]++;
    stiffnesses[(int)fmin(7, log10(stiffness / 100) / 2 * 8)]++;
    soft += number_at(&study, i, "/model/modes/free/damping") == 10;
  }
  for (int k = 0; k < 8; k++) {
    ck_assert_int_le(abs(masses[k] - 8), _i == 2 ? 2 : 0);
    ck_assert_int_le(abs(stiffnesses[k] - 8), _i == 2 ? 2 : 0);
  }
  ck_assert_int_le(abs(soft - 32), _i == 2 ? 3 : 0);
  study_release(&study);
  job_spec_release(&spec);
}
END_TEST

static void hashes(const char *sampling, int size, int seed, char hash[][65]) {
  char text[2000];
  struct job_spec spec;
  struct study study;
  snprintf(
      text, sizeof text,
      STUDY("\"sampling\":\"%s\",\"size\":%d,\"seed\":%d,\"parameters\":[" MASS "," STIFFNESS "]"),
      sampling, size, seed);
  expand(text, &spec, &study);
  for (size_t i = 0; i < study.count; i++) {
    memcpy(hash[i], study.member[i].hash, sizeof hash[i]);
  }
  study_release(&study);
  job_spec_release(&spec);
}

START_TEST(a_larger_study_keeps_the_members_it_had) {
  static char small[50][65], large[150][65], other[50][65];
  hashes(samplings[_i], 50, 3, small);
  hashes(samplings[_i], 150, 3, large);
  hashes(samplings[_i], 50, 4, other);
  for (int i = 0; i < 50; i++) {
    ck_assert_str_eq(small[i], large[i]);
    ck_assert_str_ne(small[i], other[i]);
  }
}
END_TEST

/* A member that is read by its number is the one that the study has. */
START_TEST(members_are_read_alone) {
  struct job_spec spec, member;
  struct study study;
  struct error error;
  expand(STUDY("\"sampling\":\"halton\",\"size\":20,\"parameters\":[" MASS "," RATE "]"), &spec,
         &study);
  for (size_t i = 0; i < study.count; i++) {
    ck_assert_int_eq(study_read_member(reader, spec.document, i, NULL, &member, &error), STATUS_OK);
    ck_assert_str_eq(member.hash, study.member[i].hash);
    job_spec_release(&member);
  }
  study_release(&study);
  job_spec_release(&spec);
}
END_TEST

/* Half of the square is left: mass in hundredths of a kilogram plus another one. Units may differ
 * from those of the limits. */
START_TEST(constraints_hold) {
  struct job_spec spec;
  struct study study;
  expand(STUDY("\"sampling\":\"sobol\",\"size\":200,\"parameters\":[" MASS
               ",{\"pointer\":\"/initial/h\",\"from\":\"0 mm\",\"to\":\"5 mm\"}],"
               "\"constraints\":[{\"sum\":{\"/model/mass\":2},\"at_most\":\"0.15 kg\"},"
               "{\"sum\":{\"/initial/h\":-1},\"at_least\":\"-0.4 cm\"}]"),
         &spec, &study);
  ck_assert_uint_eq(study.count, 200);
  for (size_t i = 0; i < study.count; i++) {
    ck_assert_double_le(number_at(&study, i, "/model/mass"), 75.00001);
    ck_assert_double_le(number_at(&study, i, "/initial/h"), 4.00001);
  }
  study_release(&study);
  job_spec_release(&spec);
}
END_TEST

/* Numbers without a unit, whole where both ends are, and a constraint between numbers alone. */
START_TEST(numbers_are_spread) {
  struct job_spec spec;
  struct study study;
  expand(STUDY("\"sampling\":\"sobol\",\"size\":40,\"parameters\":[" TOLERANCE
               ",{\"pointer\":\"/priority\",\"from\":-3,\"to\":3,\"scale\":\"linear\"}],"
               "\"constraints\":[{\"sum\":{\"/priority\":1},\"at_least\":-2,\"at_most\":2}]"),
         &spec, &study);
  int seen[5] = {0};
  for (size_t i = 0; i < study.count; i++) {
    double tolerance = number_at(&study, i, "/tolerance"),
           whole = number_at(&study, i, "/priority");
    ck_assert(tolerance >= 1e-6 && tolerance <= 1e-4);
    ck_assert(whole >= -2.0 && whole <= 2.0 && whole == floor(whole));
    seen[(int)whole + 2]++;
    /* seven digits, which is what the numbers have */
    ck_assert_uint_lt(strlen(study.member[i].name), sizeof "tolerance 1.234567e-05, priority -1");
  }
  for (int k = 0; k < 5; k++) {
    ck_assert_int_gt(seen[k], 0);
  }
  study_release(&study);
  job_spec_release(&spec);
}
END_TEST

static const struct {
  const char *rest, *pointer, *phrase;
} refusals[] = {
    {"\"sampling\":\"sobol\",\"parameters\":[" MASS "]", "", "\"size\" is missing"},
    {"\"sampling\":\"sobol\",\"size\":0,\"parameters\":[" MASS "]", "/size", "1"},
    {"\"sampling\":\"sobol\",\"size\":10001,\"parameters\":[" MASS "]", "/size", "10000"},
    {"\"sampling\":\"grid\",\"parameters\":[{\"pointer\":\"/model/mass\"}]", "/parameters/0",
     "takes \"values\""},
    {"\"sampling\":\"grid\",\"parameters\":[{\"pointer\":\"/model/mass\",\"values\":[\"1 g\"],"
     "\"to\":\"2 g\"}]",
     "/parameters/0", "takes \"values\""},
    {"\"sampling\":\"grid\",\"parameters\":[{\"pointer\":\"/model/mass\",\"values\":[\"1 g\"],"
     "\"from\":\"2 g\"}]",
     "/parameters/0", "takes \"values\""},
    {"\"sampling\":\"grid\",\"parameters\":[{\"pointer\":\"/model/mass\",\"values\":[\"1 g\"],"
     "\"scale\":\"log\"}]",
     "/parameters/0", "takes \"values\""},
    {"\"sampling\":\"halton\",\"size\":4,\"parameters\":[{\"pointer\":\"/model/mass\",\"values\":"
     "[\"1 g\"],\"scale\":\"log\"}]",
     "/parameters/0", "either values"},
    {"\"sampling\":\"halton\",\"size\":4,\"parameters\":[{\"pointer\":\"/model/mass\",\"values\":"
     "[\"1 g\"],\"from\":\"1 g\",\"to\":\"2 g\"}]",
     "/parameters/0", "either values"},
    {"\"sampling\":\"halton\",\"size\":4,\"parameters\":[{\"pointer\":\"/tolerance\",\"from\":1e-6,"
     "\"to\":\"1e-5\"}]",
     "/parameters/0/to", "another way"},
    {"\"sampling\":\"halton\",\"size\":4,\"parameters\":[{\"pointer\":\"/tolerance\",\"from\":"
     "\"1e-6\",\"to\":1e-5}]",
     "/parameters/0/to", "another way"},
    {"\"sampling\":\"halton\",\"size\":4,\"parameters\":[{\"pointer\":\"/model/mass\",\"from\":"
     "\"1 g\",\"to\":\"g\"}]",
     "/parameters/0/to", "another way"},
    {"\"sampling\":\"halton\",\"size\":4,\"parameters\":[{\"pointer\":\"/model/mass\",\"from\":"
     "\"1e999 g\",\"to\":\"2 g\"}]",
     "/parameters/0/from", "no number"},
    {"\"sampling\":\"sobol\",\"size\":4,\"parameters\":[" TOLERANCE
     "],\"constraints\":[{\"sum\":{\"/tolerance\":1},\"at_most\":\"8 mm\"}]",
     "/constraints/0", "all numbers"},
    {"\"sampling\":\"sobol\",\"size\":4,\"parameters\":[" MASS
     "],\"constraints\":[{\"sum\":{\"/model/mass\":1},\"at_most\":8}]",
     "/constraints/0", "all numbers"},
    {"\"sampling\":\"sobol\",\"size\":4,\"parameters\":[" MASS
     "],\"constraints\":[{\"sum\":{\"/model/mass\":1},\"at_least\":\"1 g\",\"at_most\":8}]",
     "/constraints/0", "all numbers"},
    {"\"sampling\":\"sobol\",\"size\":4,\"parameters\":[" MASS
     "],\"constraints\":[{\"sum\":{\"/model/mass\":1},\"at_least\":\"1 g\",\"at_most\":\"8 mm\"}]",
     "/constraints/0", "mm"},
    {"\"sampling\":\"grid\",\"size\":4,\"parameters\":[" RATE "]", "/size", "no use"},
    {"\"sampling\":\"grid\",\"parameters\":[" MASS "]", "/parameters/0", "takes \"values\""},
    {"\"sampling\":\"halton\",\"size\":4,\"designs\":[{\"set\":{}}],\"parameters\":[" MASS "]",
     "/designs", "no use"},
    {"\"sampling\":\"halton\",\"size\":4,\"parameters\":[{\"pointer\":\"/model/mass\"}]",
     "/parameters/0", "either values"},
    {"\"sampling\":\"halton\",\"size\":4,\"parameters\":[{\"pointer\":\"/model/mass\",\"from\":"
     "\"1 g\"}]",
     "/parameters/0", "either values"},
    {"\"sampling\":\"halton\",\"size\":4,\"parameters\":[{\"pointer\":\"/model/mass\",\"from\":"
     "\"50 g\",\"to\":\"1 kg\"}]",
     "/parameters/0/to", "same unit"},
    {"\"sampling\":\"halton\",\"size\":4,\"parameters\":[{\"pointer\":\"/model/mass\",\"from\":"
     "\"50 g\",\"to\":\"50 g\"}]",
     "/parameters/0/to", "more than"},
    {"\"sampling\":\"halton\",\"size\":4,\"parameters\":[{\"pointer\":\"/model/mass\",\"from\":"
     "\"g\",\"to\":\"50 g\"}]",
     "/parameters/0/from", "no number"},
    {"\"sampling\":\"halton\",\"size\":4,\"parameters\":[{\"pointer\":\"/initial/h\",\"from\":"
     "\"-1 mm\",\"to\":\"5 mm\",\"scale\":\"log\"}]",
     "/parameters/0/from", "above 0"},
    {"\"sampling\":\"halton\",\"size\":4,\"parameters\":[{\"pointer\":\"/model/mass\",\"from\":"
     "\"-50 g\",\"to\":\"50 g\"}]",
     "/parameters/0", "member"},
    {"\"sampling\":\"latin-hypercube\",\"size\":4,\"parameters\":[" MASS
     "],\"constraints\":[{\"sum\":{\"/model/mass\":1},\"at_most\":\"80 g\"}]",
     "/constraints", "no use"},
    {"\"sampling\":\"sobol\",\"size\":4,\"parameters\":[" MASS
     "],\"constraints\":[{\"sum\":{\"/model/mass\":1},\"at_most\":\"8 g\"}]",
     "/constraints", "widen"},
    {"\"sampling\":\"sobol\",\"size\":4,\"parameters\":[" MASS
     "],\"constraints\":[{\"sum\":{\"/model/mass\":1},\"at_most\":\"8 mm\"}]",
     "/constraints/0", "mm"},
    {"\"sampling\":\"sobol\",\"size\":4,\"parameters\":[" MASS
     "],\"constraints\":[{\"sum\":{\"/end\":1},\"at_most\":\"8 s\"}]",
     "/constraints/0", "no parameter"},
    {"\"sampling\":\"sobol\",\"size\":4,\"parameters\":[" MASS
     "],\"constraints\":[{\"sum\":{\"/model/mass\":1}}]",
     "/constraints/0", "at_least"},
};

START_TEST(bad_spreads_are_refused) {
  char text[2000];
  struct job_spec spec;
  struct error error;
  snprintf(text, sizeof text, STUDY("%s"), refusals[_i].rest);
  ck_assert(job_reader_read(reader, text, strlen(text), &spec, &error) != STATUS_OK);
  ck_assert_msg(strncmp(error.pointer, refusals[_i].pointer, strlen(refusals[_i].pointer)) == 0,
                "%s: %s", error.pointer, error.message);
  ck_assert_msg(strstr(error.message, refusals[_i].phrase) != NULL, "%s: %s", error.pointer,
                error.message);
  ck_assert_int_ge(error.line, 1);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: spread studies");
  TCase *tcase = tcase_create("all");
  tcase_add_unchecked_fixture(tcase, set_up, tear_down);
  tcase_add_loop_test(tcase, members_are_spread_over_the_ranges, 0, 3);
  tcase_add_loop_test(tcase, a_larger_study_keeps_the_members_it_had, 1, 3);
  tcase_add_test(tcase, members_are_read_alone);
  tcase_add_test(tcase, constraints_hold);
  tcase_add_test(tcase, numbers_are_spread);
  tcase_add_loop_test(tcase, bad_spreads_are_refused, 0, sizeof refusals / sizeof *refusals);
  tcase_set_timeout(tcase, 300);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
