/* The search of a study, told results that are made here instead of solved: what it asks for, what
 * it finds, that repetition leads to the same, and what is refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/job/study.h"
#include "solver/job/study_optimise.h"
#include "tests/unit/suite.h"

#define HYBRID                                                                                     \
  "{\"kind\":\"hlpv\",\"model\":{\"mass\":\"60 g\",\"gamma\":\"5.577 N/psi\",\"modes\":{\"free\":" \
  "{\"stiffness\":\"2000 N/m\",\"damping\":\"15 N s/m\",\"alpha\":\"-9 1/s\",\"beta\":\"9 1/s\"}"  \
  "}},\"initial\":{\"mode\":\"free\"},\"input\":{\"hold\":[[\"0 s\",\"3 psi\"]]},"                 \
  "\"end\":\"1 s\"}"
#define BODY                                                                                       \
  "{\"kind\":\"response\",\"actuator\":{\"family\":\"pneunet\",\"length\":\"40 mm\",\"width\":"    \
  "\"20 mm\",\"height\":\"15 mm\",\"chambers\":[{\"config\":\"B\",\"count\":3}],\"side_wall\":"    \
  "\"2 mm\",\"top_wall\":\"2 mm\",\"bottom_layer\":\"4 mm\"},\"material\":\"dragon-skin-20\","     \
  "\"load\":{\"pressure\":{\"to\":\"20 kPa\",\"steps\":2}}}"
#define STUDY(base, rest)                                                                          \
  "{\"kind\":\"study\",\"base\":" base ",\"sampling\":\"optimise\"," rest "}"
#define MASS "{\"pointer\":\"/model/mass\",\"from\":\"50 g\",\"to\":\"100 g\"}"
#define STIFFNESS                                                                                  \
  "{\"pointer\":\"/model/modes/free/stiffness\",\"from\":\"100 N/m\",\"to\":\"10000 N/m\","        \
  "\"scale\":\"log\"}"
#define WALL                                                                                       \
  "{\"pointer\":\"/actuator/side_wall\",\"from\":\"1 mm\",\"to\":\"3 mm\",\"start\":\"2.8 mm\"}"
#define TOP "{\"pointer\":\"/actuator/top_wall\",\"from\":\"1 mm\",\"to\":\"3 mm\"}"
#define TARGET "\"objective\":{\"target\":{\"bending_angle_deg\":30}}"

static struct job_reader *reader;

static void set_up(void) {
  ck_assert_int_eq(job_reader_create(&reader, NULL), STATUS_OK);
}

static void tear_down(void) {
  job_reader_destroy(reader);
}

static void read_study(const char *text, struct job_spec *spec, struct study_search **search) {
  struct error error = {.status = STATUS_OK};
  enum status status = job_reader_read(reader, text, strlen(text), spec, &error);
  ck_assert_msg(status == STATUS_OK, "%s: %s", error.pointer, error.message);
  ck_assert_int_eq(study_search_create(reader, spec->document, search, &error), STATUS_OK);
}

static double value_of(const json_t *document, size_t parameter, size_t member) {
  const json_t *entry = json_array_get(json_object_get(document, "parameters"), parameter);
  const json_t *value = json_array_get(json_object_get(entry, "values"), member);
  ck_assert_ptr_nonnull(value);
  return json_is_string(value) ? strtod(json_string_value(value), NULL) : json_number_value(value);
}

/* A result whose angle is 60 / (s^2 + t / 2) for walls s and t in mm, and whose mass is s + 2 t. */
static json_t *make_body(const json_t *document, size_t member) {
  double s = value_of(document, 0, member), t = value_of(document, 1, member);
  double d = s * s + t / 2, angle = 60 / d;
  return json_pack(
      "{s:s, s:{s:f, s:f}, s:[{s:f, s:f}, {s:f, s:f}, {s:f, s:f}], s:{s:[{s:{s:f, s:f}, "
      "s:[{s:f, s:f}, {s:f, s:f}, {s:f, s:f}]}, {s:{s:f, s:f}, s:[{s:f, s:f}, {s:f, s:f}, "
      "{s:f, s:f}]}]}}",
      "status", "succeeded", "metrics", "bending_angle_deg", angle, "mass_g", s + 2 * t, "samples",
      "pressure_kPa", 0.0, "bending_angle_deg", 0.0, "pressure_kPa", 10.0, "bending_angle_deg",
      angle / 3, "pressure_kPa", 20.0, "bending_angle_deg", angle, "sensitivity", "parameters",
      "metrics", "bending_angle_deg", -120 * s / (d * d), "mass_g", 1.0, "samples", "pressure_kPa",
      0.0, "bending_angle_deg", 0.0, "pressure_kPa", 10.0, "bending_angle_deg", -40 * s / (d * d),
      "pressure_kPa", 20.0, "bending_angle_deg", -120 * s / (d * d), "metrics", "bending_angle_deg",
      -30 / (d * d), "mass_g", 2.0, "samples", "pressure_kPa", 0.0, "bending_angle_deg", 0.0,
      "pressure_kPa", 10.0, "bending_angle_deg", -10 / (d * d), "pressure_kPa", 20.0,
      "bending_angle_deg", -30 / (d * d));
}

/* A metric m = (mass / 80 g - 1)^2 + log10(stiffness / 1000)^2 without derivatives. */
static json_t *make_hybrid(const json_t *document, size_t member) {
  double m = value_of(document, 0, member) / 80 - 1;
  double k = log10(value_of(document, 1, member) / 1000);
  return json_pack("{s:s, s:{s:f}}", "status", "succeeded", "metrics", "m", m * m + k * k);
}

/* Runs the search to its end or for so many rounds; returns the members. */
static size_t search_on(struct study_search *search, const json_t *document,
                        json_t *(*make)(const json_t *, size_t), size_t rounds) {
  struct error error;
  bool more = true;
  size_t told = 0;
  for (size_t round = 0; more && round < rounds; round++) {
    for (; told < study_search_members(search); told++) {
      json_t *result = make(document, told);
      ck_assert_int_eq(study_search_tell(search, told, result, &error), STATUS_OK);
      json_decref(result);
    }
    ck_assert_int_eq(study_search_next(search, &more, &error), STATUS_OK);
  }
  return study_search_members(search);
}

static json_t *report_of(const struct study_search *search) {
  json_t *document = json_object();
  ck_assert_int_eq(study_search_report(search, document), STATUS_OK);
  return document;
}

static double optimum(const json_t *report, const char *key) {
  return json_number_value(json_object_get(json_object_get(report, "optimum"), key));
}

START_TEST(a_target_is_reached_with_derivatives) {
  struct job_spec spec;
  struct study_search *search;
  read_study(STUDY(BODY, TARGET ",\"tolerance\":1e-6,\"parameters\":[" WALL "," TOP "]"), &spec,
             &search);
  const json_t *set = json_object_get(spec.document, "set");
  ck_assert_uint_eq(
      json_array_size(json_object_get(json_object_get(set, "/sensitivity"), "parameters")), 2);
  ck_assert_double_eq(value_of(spec.document, 0, 0), 2.8);
  ck_assert_double_eq(value_of(spec.document, 1, 0), 2);
  size_t members = search_on(search, spec.document, make_body, 100);
  ck_assert_uint_le(members, 8);
  json_t *report = report_of(search);
  double s = value_of(spec.document, 0, (size_t)optimum(report, "member"));
  double t = value_of(spec.document, 1, (size_t)optimum(report, "member"));
  ck_assert_double_eq_tol(60 / (s * s + t / 2), 30, 1e-4);
  ck_assert_double_le(optimum(report, "value"), 1e-6);
  ck_assert_uint_eq(json_array_size(json_object_get(report, "history")), members);
  json_decref(report);
  study_search_destroy(search);
  job_spec_release(&spec);
}
END_TEST

/* 5 deg at 10 kPa is 15 deg at 20 kPa, as this body has it; between them it is linear. */
START_TEST(pressures_are_those_asked_for) {
  static const char *const objectives[] = {
      "\"objective\":{\"target\":{\"bending_angle_deg\":5},\"at_pressure\":\"10 kPa\"}",
      "\"objective\":{\"target\":{\"bending_angle_deg\":10},\"at_pressure\":\"15 kPa\"}",
      "\"objective\":{\"targets\":[{\"metric\":\"bending_angle_deg\",\"value\":5,\"at_pressure\":"
      "\"10 kPa\"},{\"metric\":\"bending_angle_deg\",\"value\":15}]}"};
  struct job_spec spec;
  struct study_search *search;
  char text[2000];
  snprintf(text, sizeof text, STUDY(BODY, "%s,\"parameters\":[" WALL "," TOP "]"), objectives[_i]);
  read_study(text, &spec, &search);
  search_on(search, spec.document, make_body, 100);
  json_t *report = report_of(search);
  double s = value_of(spec.document, 0, (size_t)optimum(report, "member"));
  double t = value_of(spec.document, 1, (size_t)optimum(report, "member"));
  ck_assert_double_eq_tol(60 / (s * s + t / 2), 15, 0.05);
  json_decref(report);
  study_search_destroy(search);
  job_spec_release(&spec);
}
END_TEST

/* Least s + 2 t with 60 / (s^2 + t/2) <= 15, so s^2 + t/2 >= 4, and t >= 1: at t = 1. With
 * s + t >= 3.5 as well, at t = 3.5 - s and s^2 + (3.5 - s)/2 = 4: least t, s = 2.5 and t = 1. */
START_TEST(limits_on_metrics_and_sums_hold) {
  static const char *const sums[] = {
      "",
      ",{\"sum\":{\"/actuator/side_wall\":1,\"/actuator/top_wall\":1},\"at_least\":\"3.5 mm\"}"};
  static const double walls[] = {1.8708287, 2.5};
  struct job_spec spec;
  struct study_search *search;
  char text[2000];
  snprintf(text, sizeof text,
           STUDY(BODY, "\"objective\":{\"minimise\":\"mass_g\"},\"tolerance\":1e-5,"
                       "\"constraints\":[{\"metric\":\"bending_angle_deg\",\"at_most\":15}%s],"
                       "\"parameters\":[" WALL "," TOP "]"),
           sums[_i]);
  read_study(text, &spec, &search);
  ck_assert_uint_le(search_on(search, spec.document, make_body, 100), 25);
  json_t *report = report_of(search);
  size_t member = (size_t)optimum(report, "member");
  ck_assert_double_eq_tol(value_of(spec.document, 0, member), walls[_i], 1e-3);
  ck_assert_double_eq_tol(value_of(spec.document, 1, member), 1, 1e-3);
  ck_assert_double_le(optimum(report, "violation"), 1e-5);
  json_decref(report);
  study_search_destroy(search);
  job_spec_release(&spec);
}
END_TEST

START_TEST(without_derivatives_there_is_a_way_too) {
  struct job_spec spec;
  struct study_search *search;
  read_study(STUDY(HYBRID, "\"objective\":{\"minimise\":\"m\"},\"budget\":200,\"starts\":2,"
                           "\"tolerance\":1e-4,\"parameters\":[" MASS "," STIFFNESS "]"),
             &spec, &search);
  ck_assert_uint_eq(study_search_members(search), 2);
  ck_assert_uint_le(search_on(search, spec.document, make_hybrid, 1000), 200);
  json_t *report = report_of(search);
  size_t member = (size_t)optimum(report, "member");
  ck_assert_double_eq_tol(value_of(spec.document, 0, member), 80, 0.5);
  ck_assert_double_eq_tol(value_of(spec.document, 1, member), 1000, 20);
  ck_assert_uint_eq(json_array_size(json_object_get(report, "starts")), 2);
  json_decref(report);
  study_search_destroy(search);
  job_spec_release(&spec);
}
END_TEST

/* A search that is taken up after any round, from its document as it was sent, goes the same way.
 */
START_TEST(repetition_leads_to_the_same_members) {
  static const char text[] =
      STUDY(BODY, TARGET ",\"starts\":3,\"seed\":5,\"parameters\":[" WALL "," TOP "]");
  struct job_spec whole, again;
  struct study_search *first, *second;
  read_study(text, &whole, &first);
  ck_assert_uint_eq(study_search_members(first), 3);
  search_on(first, whole.document, make_body, 100);
  read_study(text, &again, &second);
  search_on(second, again.document, make_body, 2);
  study_search_destroy(second);
  job_spec_release(&again);
  read_study(text, &again, &second);
  search_on(second, again.document, make_body, 100);
  ck_assert(json_equal(json_object_get(whole.document, "parameters"),
                       json_object_get(again.document, "parameters")));
  study_search_destroy(first);
  study_search_destroy(second);
  job_spec_release(&whole);
  job_spec_release(&again);
}
END_TEST

/* Bodies with walls below 1.5 mm fail. The largest angle, 21.8 deg at s = 1.5 and t = 1, lies on
 * that edge, of which nothing is known before a step across it: the search has to come near,
 * from 7.1 deg. More than near it cannot come by the method: every step follows the gradient, which
 * points across the edge, and is halved until it ends before it. So s is within 1e-3 of the edge at
 * the sixth design, but t stays near 1.79: 87 % of the largest angle after 30 designs. */
static json_t *make_some(const json_t *document, size_t member) {
  return value_of(document, 0, member) < 1.5 ? NULL : make_body(document, member);
}

START_TEST(members_that_fail_are_gone_round) {
  struct job_spec spec;
  struct study_search *search;
  read_study(STUDY(BODY, "\"objective\":{\"maximise\":\"bending_angle_deg\"},\"budget\":30,"
                         "\"parameters\":[" WALL "," TOP "]"),
             &spec, &search);
  search_on(search, spec.document, make_some, 100);
  json_t *report = report_of(search);
  ck_assert_double_gt(optimum(report, "value"), 0.85 * 60 / (1.5 * 1.5 + 0.5));
  json_decref(report);
  study_search_destroy(search);
  job_spec_release(&spec);
}
END_TEST

static json_t *make_none(const json_t *document, size_t member) {
  (void)document;
  (void)member;
  return NULL;
}

START_TEST(a_search_without_results_ends_without_an_optimum) {
  struct job_spec spec;
  struct study_search *search;
  read_study(STUDY(BODY, TARGET ",\"starts\":2,\"parameters\":[" WALL "," TOP "]"), &spec, &search);
  ck_assert_uint_eq(search_on(search, spec.document, make_none, 100), 2);
  json_t *report = report_of(search);
  ck_assert(json_is_null(json_object_get(report, "optimum")));
  json_decref(report);
  study_search_destroy(search);
  job_spec_release(&spec);
}
END_TEST

/* ---- refusals ----------------------------------------------------------------------------- */

static const struct {
  const char *base, *rest, *pointer, *phrase;
} refusals[] = {
    {BODY, "\"parameters\":[" WALL "]", "", "\"objective\" is missing"},
    {BODY, "\"objective\":{},\"parameters\":[" WALL "]", "/objective", "0 objectives"},
    {BODY,
     "\"objective\":{\"minimise\":\"mass_g\",\"maximise\":\"chord_angle_deg\"},\"parameters\":"
     "[" WALL "]",
     "/objective", "2 objectives"},
    {BODY,
     "\"objective\":{\"target\":{\"bending_angle_deg\":9},\"at_pressure\":\"30 kPa\"},"
     "\"parameters\":[" WALL "]",
     "/objective/at_pressure", "at most 20 kPa"},
    {HYBRID,
     "\"objective\":{\"minimise\":\"m\",\"at_pressure\":\"30 kPa\"},\"parameters\":[" MASS "]",
     "/objective/at_pressure", "no load"},
    {BODY, "\"objective\":{\"profile\":[[1,1,1],[1,1,1]]},\"parameters\":[" WALL "]",
     "/objective/profile", "all points are one"},
    {HYBRID, "\"objective\":{\"minimise\":\"m\"},\"method\":\"slsqp\",\"parameters\":[" MASS "]",
     "/method", "cobyla"},
    {BODY,
     "\"objective\":{\"minimise\":\"mass_g\"},\"method\":\"gauss-newton\",\"parameters\":[" WALL
     "]",
     "/method", "gauss-newton is for"},
    {BODY,
     "\"objective\":{\"minimise\":\"max_stretch\"},\"method\":\"mma\",\"parameters\":[" WALL "]",
     "/method", "derivatives"},
    {BODY, TARGET ",\"size\":4,\"parameters\":[" WALL "]", "/size", "no use"},
    {BODY, TARGET ",\"parameters\":[{\"pointer\":\"/actuator/side_wall\",\"values\":[\"1 mm\"]}]",
     "/parameters/0", "takes a range"},
    {BODY,
     TARGET ",\"parameters\":[{\"pointer\":\"/actuator/side_wall\",\"from\":\"1 mm\",\"to\":"
            "\"3 mm\",\"start\":\"4 mm\"}]",
     "/parameters/0/start", "within the range"},
    {BODY,
     TARGET ",\"parameters\":[{\"pointer\":\"/actuator/side_wall\",\"from\":\"9 mm\",\"to\":"
            "\"12 mm\"}]",
     "/parameters", "the first start"},
    {BODY,
     TARGET ",\"constraints\":[{\"metric\":\"mass_g\",\"at_most\":\"30 g\"}],\"parameters\":[" WALL
            "]",
     "/constraints/0", "number"},
    {BODY, TARGET ",\"constraints\":[{\"at_most\":\"30 g\"}],\"parameters\":[" WALL "]",
     "/constraints/0", "either a sum"},
    {BODY,
     TARGET ",\"constraints\":[{\"sum\":{\"/actuator/side_wall\":1},\"at_most\":\"30 g\"}],"
            "\"parameters\":[" WALL "]",
     "/parameters/0/from", "dimension"},
};

START_TEST(bad_searches_are_refused) {
  char text[3000];
  struct job_spec spec;
  struct error error = {0};
  snprintf(text, sizeof text, STUDY("%s", "%s"), refusals[_i].base, refusals[_i].rest);
  ck_assert(job_reader_read(reader, text, strlen(text), &spec, &error) != STATUS_OK);
  ck_assert_msg(strncmp(error.pointer, refusals[_i].pointer, strlen(refusals[_i].pointer)) == 0,
                "%s: %s", error.pointer, error.message);
  ck_assert_msg(strstr(error.message, refusals[_i].phrase) != NULL, "%s: %s", error.pointer,
                error.message);
}
END_TEST

/* Other samplings know no metrics before their members are solved, and no starts. */
START_TEST(other_samplings_do_not_search) {
  static const char *const rests[] = {
      "\"size\":4,\"parameters\":[" WALL "]",
      "\"size\":4,\"constraints\":[{\"metric\":\"mass_g\",\"at_most\":30}],\"parameters\":[" TOP
      "]"};
  static const char *const pointers[] = {"/parameters/0/start", "/constraints/0"};
  char text[3000];
  struct job_spec spec;
  struct error error = {0};
  snprintf(text, sizeof text, "{\"kind\":\"study\",\"base\":" BODY ",\"sampling\":\"sobol\",%s}",
           rests[_i]);
  ck_assert(job_reader_read(reader, text, strlen(text), &spec, &error) == STATUS_INVALID);
  ck_assert_str_eq(error.pointer, pointers[_i]);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: studies that search");
  TCase *tcase = tcase_create("all");
  tcase_add_unchecked_fixture(tcase, set_up, tear_down);
  tcase_add_test(tcase, a_target_is_reached_with_derivatives);
  tcase_add_loop_test(tcase, pressures_are_those_asked_for, 0, 3);
  tcase_add_loop_test(tcase, limits_on_metrics_and_sums_hold, 0, 2);
  tcase_add_test(tcase, without_derivatives_there_is_a_way_too);
  tcase_add_test(tcase, repetition_leads_to_the_same_members);
  tcase_add_test(tcase, members_that_fail_are_gone_round);
  tcase_add_test(tcase, a_search_without_results_ends_without_an_optimum);
  tcase_add_loop_test(tcase, bad_searches_are_refused, 0, sizeof refusals / sizeof *refusals);
  tcase_add_loop_test(tcase, other_samplings_do_not_search, 0, 2);
  tcase_set_timeout(tcase, 300);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
